//! How large an error looks, and from where on it may be shown.

use crate::error::{Error, Result};

/// The screen a model is looked at on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Screen {
    /// Height in pixels; 1080 by default.
    pub height_px: f64,
    /// Vertical field of view in radians; 60 degrees by default.
    pub fov_y: f64,
    /// Largest error that may be seen, pixels; 1 by default.
    pub tolerance_px: f64,
}

impl Default for Screen {
    fn default() -> Self {
        Self {
            height_px: 1080.0,
            fov_y: std::f64::consts::FRAC_PI_3,
            tolerance_px: 1.0,
        }
    }
}

impl Screen {
    /// Distance from the eye at which a length of `error` looks as large as
    /// the tolerance; closer, it looks larger. In the unit of `error`.
    #[must_use]
    pub fn switch_distance(&self, error: f64) -> f64 {
        error * self.height_px / (2.0 * self.half_height() * self.tolerance_px)
    }

    /// The largest error that may be shown of an object of the given diameter
    /// when that is `pixels` high on the screen. In the unit of `diameter`.
    #[must_use]
    pub fn error_at_size(&self, pixels: f64, diameter: f64) -> f64 {
        self.tolerance_px * diameter / pixels
    }

    /// Share of the screen's height that a sphere covers at a distance, cut
    /// off at 1 (the approximation by the height of its great circle, which
    /// `MSFT_screencoverage` is meant with).
    #[must_use]
    pub fn coverage(&self, radius: f64, distance: f64) -> f64 {
        let share = radius / (distance * self.half_height());
        // 0 / 0, a point that is seen from where it stands, fills nothing.
        if share.is_nan() {
            0.0
        } else {
            share.clamp(0.0, 1.0)
        }
    }

    /// Half the screen's height at distance 1.
    pub(super) fn half_height(&self) -> f64 {
        (0.5 * self.fov_y).tan()
    }

    pub(super) fn check(&self) -> Result<()> {
        positive("screen.height_px", self.height_px)?;
        positive("screen.tolerance_px", self.tolerance_px)?;
        if self.fov_y > 0.0 && self.fov_y < std::f64::consts::PI {
            return Ok(());
        }
        Err(Error::BadOption {
            option: "screen.fov_y",
            found: self.fov_y.to_string(),
            expected: "between 0 and pi radians (180 degrees)",
        })
    }
}

/// Refuses what is not a positive, finite number.
pub(super) fn positive(option: &'static str, value: f64) -> Result<()> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(Error::BadOption {
        option,
        found: value.to_string(),
        expected: "a positive number",
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    /// Height in pixels of a segment of `length` seen square on in the middle
    /// of the screen, by projecting its ends.
    fn projected(screen: &Screen, length: f64, distance: f64) -> f64 {
        let pixel_of = |y: f64| {
            let ndc = (y / distance) / (0.5 * screen.fov_y).tan();
            0.5 * screen.height_px * (1.0 + ndc)
        };
        pixel_of(0.5 * length) - pixel_of(-0.5 * length)
    }

    #[test]
    fn an_error_looks_as_large_as_the_tolerance_where_it_is_switched() {
        for (height_px, fov_y, tolerance_px) in [
            (1080.0, 1.0, 1.0),
            (720.0, FRAC_PI_2, 0.5),
            (2160.0, 0.3, 4.0),
        ] {
            let screen = Screen {
                height_px,
                fov_y,
                tolerance_px,
            };
            let distance = screen.switch_distance(0.02);
            let pixels = projected(&screen, 0.02, distance);
            assert!((pixels - tolerance_px).abs() < 1e-9, "{pixels}");
        }
    }

    #[test]
    fn coverage_is_the_projected_share() {
        let screen = Screen {
            fov_y: FRAC_PI_2,
            ..Screen::default()
        };
        let share = projected(&screen, 2.0, 10.0) / screen.height_px;
        assert!((screen.coverage(1.0, 10.0) - share).abs() < 1e-12);
        assert_eq!(screen.coverage(1.0, 0.0), 1.0);
        assert_eq!(screen.coverage(0.0, 0.0), 0.0);
        assert_eq!(screen.coverage(1.0, f64::INFINITY), 0.0);
    }

    #[test]
    fn size_in_pixels_gives_the_error() {
        let screen = Screen {
            tolerance_px: 2.0,
            ..Screen::default()
        };
        let error = screen.error_at_size(100.0, 5.0);
        // Where the object is 100 pixels high, the error is 2.
        let distance = screen.switch_distance(error);
        assert!((projected(&screen, 5.0, distance) - 100.0).abs() < 1e-9);
    }

    #[test]
    fn nonsense_is_refused() {
        let bad = |screen: Screen| screen.check().is_err();
        assert!(Screen::default().check().is_ok());
        assert!(bad(Screen {
            height_px: 0.0,
            ..Screen::default()
        }));
        assert!(bad(Screen {
            tolerance_px: f64::NAN,
            ..Screen::default()
        }));
        assert!(bad(Screen {
            fov_y: 4.0,
            ..Screen::default()
        }));
    }
}
