//! What perception knows of an object or a group.

use super::bounds::Bounds;
use crate::error::{Error, Result};
use crate::geom::Vec3;

/// Largest coordinate accepted, world units: the products of three differences of
/// such still are numbers.
const FARTHEST: f64 = 1e30;
/// Largest volume and area accepted.
const LARGEST: f64 = 1e90;

/// What perception knows of one placed object, or of a group as a whole.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Object {
    /// Box around it, world units.
    pub bounds: Bounds,
    /// Volume, cubic world units; 0 or more. Of a group, that of all in it.
    pub volume: f64,
    /// Area of the surface that is seen, square world units; 0 or more. The weight
    /// of colour and velocity in a group.
    pub area: f64,
    /// Mean colour of the surface, linear RGB in 0..=1.
    pub color: Vec3,
    /// Velocity, world units a second.
    pub velocity: Vec3,
}

impl Object {
    /// What both are together: the box around both, the sum of volumes and areas,
    /// the mean of colours and velocities weighted by area.
    ///
    /// The volume is that of what is in the group, not of the box that is drawn for
    /// it: a group whose box counted as full would take in for nothing whatever lies
    /// in that box.
    #[must_use]
    pub fn merged(&self, other: &Self) -> Self {
        let area = self.area + other.area;
        let share = if area > 0.0 { other.area / area } else { 0.5 };
        let mean = |a: Vec3, b: Vec3| {
            let mixed = a.as_dvec3().lerp(b.as_dvec3(), share).as_vec3();
            // A mean lies between, whatever rounding does.
            mixed.clamp(a.min(b), a.max(b))
        };
        Self {
            bounds: self.bounds.union(&other.bounds),
            volume: self.volume + other.volume,
            area,
            color: mean(self.color, other.color),
            velocity: mean(self.velocity, other.velocity),
        }
    }

    /// Checks what the numbers must be for sums and products of them to be numbers.
    pub(super) fn check(&self, index: usize) -> Result<()> {
        let Bounds { min, max } = self.bounds;
        let numbers = [self.volume, self.area];
        let vectors = [self.color, self.velocity];
        if !(min.is_finite() && max.is_finite())
            || numbers.iter().any(|x| !x.is_finite())
            || vectors.iter().any(|v| !v.is_finite())
        {
            let what = "object".into();
            return Err(Error::NotFinite { what, index });
        }
        match self.broken_rule() {
            Some(rule) => Err(Error::Broken { rule, index }),
            None => Ok(()),
        }
    }

    fn broken_rule(&self) -> Option<&'static str> {
        let Bounds { min, max } = self.bounds;
        let far = min.abs().max(max.abs()).max_element() > FARTHEST;
        let fast = f64::from(self.velocity.abs().max_element()) > FARTHEST;
        let color = self.color;
        let is_color = color.cmpge(Vec3::ZERO).all() && color.cmple(Vec3::ONE).all();
        let is_measure = |x: f64| (0.0..=LARGEST).contains(&x);
        [
            (min.cmple(max).all(), "the box of an object is not empty"),
            (
                !far && !fast,
                "coordinates and velocities of objects lie within 1e30",
            ),
            (
                is_measure(self.volume) && is_measure(self.area),
                "volumes and areas of objects lie between 0 and 1e90",
            ),
            (is_color, "colours of objects lie between 0 and 1"),
        ]
        .into_iter()
        .find_map(|(good, rule)| (!good).then_some(rule))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::DVec3;

    fn ball(x: f64, area: f64, color: Vec3) -> Object {
        Object {
            bounds: Bounds {
                min: DVec3::new(x, 0.0, 0.0),
                max: DVec3::new(x + 1.0, 1.0, 1.0),
            },
            volume: 0.5,
            area,
            color,
            velocity: Vec3::ZERO,
        }
    }

    #[test]
    fn a_group_is_its_box_and_the_mean_of_what_is_seen() {
        let group = ball(0.0, 1.0, Vec3::X).merged(&ball(3.0, 3.0, Vec3::Y));
        assert_eq!((group.volume, group.bounds.volume()), (1.0, 4.0));
        assert_eq!(group.area, 4.0);
        assert_eq!(group.color, Vec3::new(0.25, 0.75, 0.0));
        let group = ball(0.0, 0.0, Vec3::X).merged(&ball(0.0, 0.0, Vec3::Y));
        assert_eq!(group.color, Vec3::new(0.5, 0.5, 0.0));
    }

    #[test]
    fn what_is_no_number_is_refused() {
        let good = ball(0.0, 1.0, Vec3::X);
        assert_eq!(good.check(0), Ok(()));
        let mut bad = [good; 6];
        bad[0].bounds.min.x = f64::NAN;
        bad[1].bounds.max.x = -1.0;
        bad[2].bounds.max.x = 1e40;
        bad[3].volume = -1.0;
        bad[4].color.x = 1.5;
        bad[5].velocity.z = f32::INFINITY;
        assert!(bad.iter().enumerate().all(|(i, o)| o.check(i).is_err()));
    }
}
