//! Where a frame is seen from.

use super::super::bounds::Bounds;
use crate::error::{Error, Result};
use crate::geom::{Camera, DVec3, Projection};

/// What a frame is to show, and at what cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Where the picture is taken from. Without perspective, too, things are seen
    /// from the distance to the eye.
    pub camera: Camera,
    /// Where the origin of the camera's coordinates lies, world units: far from
    /// the world's origin, single precision alone would not tell where the eye is.
    /// Default: the world's origin.
    pub origin: DVec3,
    /// Width of the picture by its height. Default: 16 / 9.
    pub aspect: f64,
    /// Whether what lies outside the picture is left out. Default: yes.
    pub frustum: bool,
    /// `Omega_t`: a group of less is drawn as one; 0 or more. With the default
    /// weights, an angle in radians. Default: 0.01.
    pub threshold: f64,
    /// Factor to the diagonal of a group's box, as long as which its Omega0 is taken to
    /// be if that is less: then what is large on the screen is taken apart however
    /// alike its members are. With the default weights, 1 counts the whole diagonal.
    /// Default: 0, as published.
    pub size: f64,
    /// Most triangles. The threshold rises as far as it must; only groups that the
    /// eye is inside of are taken apart at any cost. Default: no limit.
    pub triangles: Option<u64>,
    /// Share of the threshold, below 1, by which Omega must fall below before a
    /// group that the frame before had taken apart is one again. 0 means that the
    /// same view gives the same list whatever was before. Default: 0.
    pub hysteresis: f64,
}

impl View {
    /// The defaults, seen from `camera`.
    #[must_use]
    pub fn new(camera: Camera) -> Self {
        Self {
            camera,
            origin: DVec3::ZERO,
            aspect: 16.0 / 9.0,
            frustum: true,
            threshold: 0.01,
            size: 0.0,
            triangles: None,
            hysteresis: 0.0,
        }
    }

    fn check(&self) -> Result<()> {
        let eye = self.camera.eye.as_dvec3() + self.origin;
        for (option, found, good, expected) in [
            ("camera.eye", eye.length(), eye.is_finite(), "finite"),
            (
                "view.aspect",
                self.aspect,
                self.aspect > 0.0 && self.aspect.is_finite(),
                "positive",
            ),
            (
                "view.size",
                self.size,
                self.size >= 0.0 && self.size.is_finite(),
                "finite, 0 or more",
            ),
            (
                "view.threshold",
                self.threshold,
                self.threshold >= 0.0,
                "0 or more",
            ),
            (
                "view.hysteresis",
                self.hysteresis,
                (0.0..1.0).contains(&self.hysteresis),
                "at least 0, below 1",
            ),
        ] {
            if !good {
                return Err(Error::BadOption {
                    option,
                    found: found.to_string(),
                    expected,
                });
            }
        }
        Ok(())
    }
}

/// Planes that a box is not known to lie within, one bit each.
pub(super) type Open = u8;

/// A view, ready to be asked.
#[derive(Debug, Clone)]
pub(super) struct Eye {
    at: DVec3,
    /// What the picture shows lies on the side the normal points to, this far from
    /// the eye at least.
    planes: Vec<(DVec3, f64)>,
}

impl Eye {
    /// # Errors
    /// [`Error::BadOption`] for a view that sees nothing.
    pub fn new(view: &View) -> Result<Self> {
        view.check()?;
        let camera = &view.camera;
        let axes = camera.axes()?;
        let scale = camera.scale()?;
        let mut eye = Self {
            at: view.origin + camera.eye.as_dvec3(),
            planes: Vec::new(),
        };
        if !view.frustum {
            return Ok(eye);
        }
        let perspective = matches!(camera.projection, Projection::Perspective { .. });
        for (axis, half) in [(axes.right, view.aspect / scale), (axes.up, 1.0 / scale)] {
            for axis in [axis, -axis] {
                eye.planes.push(match perspective {
                    true => ((axes.forward * half + axis).normalize(), 0.0),
                    false => (axis, -half),
                });
            }
        }
        let near = camera.near.or(perspective.then_some(0.0));
        for (option, depth, normal) in [
            ("camera.near", near, axes.forward),
            ("camera.far", camera.far, -axes.forward),
        ] {
            let Some(depth) = depth.map(f64::from) else {
                continue;
            };
            if depth.is_nan() {
                return Err(Error::BadOption {
                    option,
                    found: depth.to_string(),
                    expected: "a number",
                });
            }
            eye.planes.push((normal, depth * normal.dot(axes.forward)));
        }
        Ok(eye)
    }

    pub fn all_planes(&self) -> Open {
        (0..self.planes.len()).fold(0, |open, plane| open | 1 << plane)
    }

    pub fn distance(&self, bounds: &Bounds) -> f64 {
        bounds.distance(self.at)
    }

    /// Which of the `open` planes a box crosses; `None` if it lies beyond one. All
    /// steps round the same way for a box inside another, so that nothing is lost
    /// by asking the outer one first.
    #[inline]
    pub fn crossed(&self, bounds: &Bounds, open: Open) -> Option<Open> {
        let (low, high) = (bounds.min - self.at, bounds.max - self.at);
        let mut crossed = 0;
        let mut rest = open;
        while rest != 0 {
            let plane = rest.trailing_zeros();
            rest &= rest - 1;
            let (normal, limit) = self.planes[plane as usize];
            let (a, b) = (low * normal, high * normal);
            let [farthest, nearest] = [a.max(b), a.min(b)].map(|v| v.x + v.y + v.z);
            if farthest < limit {
                return None;
            }
            crossed |= Open::from(nearest < limit) << plane;
        }
        Some(crossed)
    }
}
