//! How much two things are seen as two.

use super::object::Object;
use super::oklab::oklab;
use crate::error::{Error, Result};
use crate::geom::Vec3;

/// Weights of Omega, the measure of Kato, Kanoh and Nishihara (1998):
/// `Omega = a_p F_p + a_s F_s + a_c F_c + a_f F_f` (equation 3), each term by
/// distance to the eye. The tree knows `Omega0`, which is Omega seen from `L0`.
///
/// The default is free of any scale: it takes differences of shape and colour to
/// be as large as the two together, so that Omega is the angle, in radians, under
/// which one sees what would change. Its `L0` is 1 world unit: `Omega0` is the
/// length of what would change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OmegaOptions {
    /// a_p, of the gap between the two boxes. Default: 1.
    pub proximity: f64,
    /// a_s, of the share of the merged shape that is empty. Default: 0.5.
    pub shape: f64,
    /// a_c, of the distance between mean colours. Default: 2.
    pub color: f64,
    /// a_f, of the difference of velocities, seconds. Default: 1.
    pub fate: f64,
    /// L0, the distance to the eye at which the tree is built, world units.
    /// Default: 1.
    pub distance: f64,
    /// Whether a_s and a_c are lengths or shares of the size. Default: shares.
    pub lengths: Lengths,
    /// Where colours are compared. Default: Oklab.
    pub color_space: ColorSpace,
}

/// What differences of shape and colour, which have no unit, are multiplied by to
/// be seen under an angle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lengths {
    /// Nothing: a_s and a_c are lengths, world units, as in the paper.
    World,
    /// The diagonal of the box around both: a_s and a_c are shares of it.
    Pair,
}

/// Where colours are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColorSpace {
    /// Linear RGB, as the objects have it (equation 9).
    Rgb,
    /// Oklab, in which equal distances are seen as equal.
    Oklab,
}

impl Default for OmegaOptions {
    fn default() -> Self {
        Self {
            proximity: 1.0,
            shape: 0.5,
            color: 2.0,
            fate: 1.0,
            distance: 1.0,
            lengths: Lengths::Pair,
            color_space: ColorSpace::Oklab,
        }
    }
}

impl OmegaOptions {
    /// The constants of the paper (section 4.1), made for its scenes and their
    /// unit; go with [`Thresholds::kato1998`](super::Thresholds::kato1998).
    #[must_use]
    pub fn kato1998() -> Self {
        Self {
            proximity: 0.1,
            shape: 2000.0,
            color: 2000.0,
            fate: 0.1,
            distance: 5000.0,
            lengths: Lengths::World,
            color_space: ColorSpace::Rgb,
        }
    }

    /// # Errors
    /// [`Error::BadOption`] for weights that are negative or no numbers, or a
    /// distance that is not positive.
    pub(super) fn check(&self) -> Result<()> {
        let weight = |x: f64| (0.0..=1e30).contains(&x);
        for (option, value, good) in [
            ("omega.proximity", self.proximity, weight(self.proximity)),
            ("omega.shape", self.shape, weight(self.shape)),
            ("omega.color", self.color, weight(self.color)),
            ("omega.fate", self.fate, weight(self.fate)),
            (
                "omega.distance",
                self.distance,
                weight(self.distance) && self.distance >= 1e-30,
            ),
        ] {
            if !good {
                return Err(Error::BadOption {
                    option,
                    found: value.to_string(),
                    expected: "between 0 and 1e30, the distance at least 1e-30",
                });
            }
        }
        Ok(())
    }

    /// The colour as it is compared.
    pub(super) fn shade(&self, color: Vec3) -> Vec3 {
        match self.color_space {
            ColorSpace::Rgb => color,
            ColorSpace::Oklab => oklab(color),
        }
    }
}

/// An object together with its colour as it is compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Seen {
    pub object: Object,
    pub shade: Vec3,
}

impl Seen {
    pub fn new(object: Object, options: &OmegaOptions) -> Self {
        Self {
            object,
            shade: options.shade(object.color),
        }
    }

    pub fn merged(&self, other: &Self, options: &OmegaOptions) -> Self {
        Self::new(self.object.merged(&other.object), options)
    }
}

/// `Omega0` of two objects or groups: Omega when they are
/// [`OmegaOptions::distance`] away. 0 is one and the same to the eye.
///
/// The gap is the distance between the boxes (0 where they touch); the merged shape
/// is the box around both, and one without volume adds nothing (0 / 0 is 0);
/// otherwise equations 3 to 11.
#[must_use]
pub fn omega0(a: &Object, b: &Object, options: &OmegaOptions) -> f64 {
    between(&Seen::new(*a, options), &Seen::new(*b, options), options)
}

pub(super) fn between(a: &Seen, b: &Seen, options: &OmegaOptions) -> f64 {
    let (x, y) = (&a.object, &b.object);
    let around = x.bounds.union(&y.bounds);
    let volumes = x.volume + y.volume;
    let unlike = Unlike {
        gap: x.bounds.gap(&y.bounds),
        shape: added(around.volume(), volumes),
        color: f64::from((a.shade - b.shade).length()),
        diagonal: around.diagonal(),
    };
    let speed = (x.velocity - y.velocity).as_dvec3().length();
    unlike.omega0(options) + options.fate * speed / options.distance
}

/// What two differ in at rest.
#[derive(Debug, Clone, Copy)]
pub(super) struct Unlike {
    /// L2.
    pub gap: f64,
    /// M_s.
    pub shape: f64,
    /// M_c.
    pub color: f64,
    /// Of the box around both.
    pub diagonal: f64,
}

impl Unlike {
    #[inline]
    pub fn omega0(&self, options: &OmegaOptions) -> f64 {
        let length = match options.lengths {
            Lengths::World => 1.0,
            Lengths::Pair => self.diagonal,
        };
        let alike = options.shape * self.shape + options.color * self.color;
        (options.proximity * self.gap + alike * length) / options.distance
    }
}

/// M_s (equation 7): the share of the merged shape, a box, that neither fills.
/// Things that stick into each other or out of the box may fill more than it has.
fn added(merged: f64, volumes: f64) -> f64 {
    if merged > 0.0 {
        (1.0 - volumes / merged).max(0.0)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::super::bounds::Bounds;
    use super::*;
    use crate::geom::DVec3;

    fn cube(x: f64) -> Object {
        Object {
            bounds: Bounds {
                min: DVec3::new(x, 0.0, 0.0),
                max: DVec3::new(x + 1.0, 1.0, 1.0),
            },
            volume: 1.0,
            area: 6.0,
            color: Vec3::ZERO,
            velocity: Vec3::ZERO,
        }
    }

    #[test]
    fn the_terms_are_those_of_the_paper() {
        let kato = OmegaOptions::kato1998();
        let found = omega0(&cube(0.0), &cube(4.0), &kato);
        let shape = (5.0 - 2.0) / 5.0;
        let expected = (0.1 * 3.0 + 2000.0 * shape) / 5000.0;
        assert!((found - expected).abs() < 1e-15, "{found} {expected}");
        let other = Object {
            color: Vec3::new(0.0, 0.6, 0.8),
            velocity: Vec3::new(0.0, 3.0, 4.0),
            ..cube(1.0)
        };
        let found = omega0(&cube(0.0), &other, &kato);
        let expected = (2000.0 + 0.1 * 5.0) / 5000.0;
        assert!((found - expected).abs() < 1e-7, "{found} {expected}");
    }

    #[test]
    fn the_default_has_no_unit() {
        let options = OmegaOptions::default();
        let scaled = |object: Object, by: f64| Object {
            bounds: Bounds {
                min: object.bounds.min * by,
                max: object.bounds.max * by,
            },
            volume: object.volume * by * by * by,
            color: Vec3::X * object.bounds.min.x as f32 * 0.1,
            ..object
        };
        let of = |by: f64| omega0(&scaled(cube(0.0), by), &scaled(cube(2.5), by), &options) / by;
        let (one, large) = (
            omega0(&cube(0.0), &cube(2.5), &options),
            omega0(&scaled(cube(0.0), 1.0), &scaled(cube(2.5), 1.0), &options),
        );
        assert!(large > one);
        let color_free = OmegaOptions {
            color: 0.0,
            ..options
        };
        let of_color_free =
            |by: f64| omega0(&scaled(cube(0.0), by), &scaled(cube(2.5), by), &color_free) / by;
        assert!((of_color_free(1e3) / of_color_free(1.0) - 1.0).abs() < 1e-12);
        assert!(of(1.0) > of_color_free(1.0));
    }

    #[test]
    fn nothing_by_nothing_is_nothing() {
        let point = Object {
            bounds: Bounds::point(DVec3::ZERO),
            volume: 0.0,
            ..cube(0.0)
        };
        for options in [OmegaOptions::default(), OmegaOptions::kato1998()] {
            assert_eq!(omega0(&point, &point, &options), 0.0);
            assert!(omega0(&point, &cube(0.0), &options).is_finite());
        }
        let wrong = OmegaOptions {
            color: f64::NAN,
            ..OmegaOptions::default()
        };
        assert!(wrong.check().is_err());
    }
}
