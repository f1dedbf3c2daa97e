//! Boxes that keep their precision far from the origin.

use crate::geom::{Aabb, DVec3};
use glam::DMat4;

/// An axis-aligned box in double precision, world units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Least corner.
    pub min: DVec3,
    /// Greatest corner.
    pub max: DVec3,
}

impl Bounds {
    /// The box that is this point alone.
    #[must_use]
    pub fn point(point: DVec3) -> Self {
        Self {
            min: point,
            max: point,
        }
    }

    /// A box of single precision; `None` if it is empty.
    #[must_use]
    pub fn of_aabb(bounds: Aabb) -> Option<Self> {
        (!bounds.is_empty()).then(|| Self {
            min: bounds.min.as_dvec3(),
            max: bounds.max.as_dvec3(),
        })
    }

    /// Smallest box around both.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// Edge lengths.
    #[must_use]
    pub fn size(&self) -> DVec3 {
        self.max - self.min
    }

    /// Centre.
    #[must_use]
    pub fn center(&self) -> DVec3 {
        self.min + 0.5 * self.size()
    }

    /// Volume; 0 for a flat box.
    #[must_use]
    pub fn volume(&self) -> f64 {
        let size = self.size();
        size.x * size.y * size.z
    }

    /// Length of the space diagonal.
    #[must_use]
    pub fn diagonal(&self) -> f64 {
        self.size().length()
    }

    /// Distance between the boxes; 0 where they touch or overlap.
    #[must_use]
    pub fn gap(&self, other: &Self) -> f64 {
        let apart = (self.min - other.max).max(other.min - self.max);
        apart.max(DVec3::ZERO).length()
    }

    /// Distance from `point`; 0 inside.
    #[must_use]
    pub fn distance(&self, point: DVec3) -> f64 {
        self.gap(&Self::point(point))
    }

    /// Whether `other` lies inside or on the surface.
    #[must_use]
    pub fn contains(&self, other: &Self) -> bool {
        self.min.cmple(other.min).all() && self.max.cmpge(other.max).all()
    }

    /// Smallest box around the box that `matrix`, an affine one, makes of this one.
    #[must_use]
    pub fn transformed(&self, matrix: &DMat4) -> Self {
        let center = matrix.transform_point3(self.center());
        let half = 0.5 * self.size();
        let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|a| a.truncate().abs());
        let reach = x * half.x + y * half.y + z * half.z;
        Self {
            min: center - reach,
            max: center + reach,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(at: DVec3) -> Bounds {
        Bounds {
            min: at,
            max: at + 1.0,
        }
    }

    #[test]
    fn gaps_are_measured_between_the_nearest_points() {
        let unit = cube(DVec3::ZERO);
        assert_eq!(unit.gap(&cube(DVec3::new(4.0, 5.0, 0.5))), 5.0);
        assert_eq!(unit.gap(&cube(DVec3::new(1.0, 0.0, 0.0))), 0.0);
        assert_eq!(unit.gap(&cube(DVec3::splat(0.5))), 0.0);
        assert_eq!(unit.distance(DVec3::new(0.5, 3.0, 0.5)), 2.0);
        assert_eq!(unit.distance(DVec3::splat(0.5)), 0.0);
    }

    #[test]
    fn a_turned_box_has_all_its_corners_inside() {
        let matrix = DMat4::from_rotation_z(0.6) * DMat4::from_scale(DVec3::new(-2.0, 1.0, 3.0));
        let turned = cube(DVec3::ONE).transformed(&matrix);
        for corner in 0..8 {
            let axis = |k: u32| 1.0 + f64::from(corner >> k & 1);
            let corner = matrix.transform_point3(DVec3::new(axis(0), axis(1), axis(2)));
            assert!(turned.distance(corner) < 1e-12);
        }
    }

    #[test]
    fn far_from_the_origin_nothing_is_lost() {
        let far = cube(DVec3::splat(1e9));
        assert_eq!(far.volume(), 1.0);
        assert_eq!(far.gap(&cube(DVec3::new(1e9 + 1.25, 1e9, 1e9))), 0.25);
    }
}
