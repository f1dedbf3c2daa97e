//! Axis-aligned bounding boxes.

use glam::Vec3;

/// An axis-aligned box, empty when `min > max` on any axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    /// Least corner.
    pub min: Vec3,
    /// Greatest corner.
    pub max: Vec3,
}

impl Default for Aabb {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl Aabb {
    /// The box that holds nothing; the identity of [`Aabb::union`].
    pub const EMPTY: Self = Self {
        min: Vec3::INFINITY,
        max: Vec3::NEG_INFINITY,
    };

    /// Smallest box around `points`; empty for none.
    #[must_use]
    pub fn of(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::with)
    }

    /// Smallest box around `self` and `point`.
    #[must_use]
    pub fn with(self, point: Vec3) -> Self {
        Self {
            min: self.min.min(point),
            max: self.max.max(point),
        }
    }

    /// Smallest box around both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// Whether no point lies inside.
    #[must_use]
    pub fn is_empty(self) -> bool {
        self.min.cmpgt(self.max).any()
    }

    /// Centre; the origin for the empty box.
    #[must_use]
    pub fn center(self) -> Vec3 {
        if self.is_empty() {
            return Vec3::ZERO;
        }
        self.min + (self.max - self.min) * 0.5
    }

    /// Edge lengths; zero for the empty box.
    #[must_use]
    pub fn size(self) -> Vec3 {
        if self.is_empty() {
            return Vec3::ZERO;
        }
        self.max - self.min
    }

    /// Length of the space diagonal, the unit of every relative error.
    #[must_use]
    pub fn diagonal(self) -> f64 {
        self.size().as_dvec3().length()
    }

    /// Squared distance from `point` to the box; 0 inside.
    #[must_use]
    pub fn distance_squared(self, point: Vec3) -> f32 {
        let outside = (self.min - point).max(point - self.max).max(Vec3::ZERO);
        outside.length_squared()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn empty_box_has_no_size() {
        assert!(Aabb::EMPTY.is_empty());
        assert_eq!(Aabb::EMPTY.diagonal(), 0.0);
        assert_eq!(Aabb::EMPTY.center(), Vec3::ZERO);
    }

    #[test]
    fn box_of_a_unit_cube() {
        let unit = Aabb::of([Vec3::ZERO, Vec3::ONE]);
        assert_eq!(unit.diagonal(), 3f64.sqrt());
        assert_eq!(unit.distance_squared(Vec3::splat(0.5)), 0.0);
        assert_eq!(unit.distance_squared(Vec3::new(3.0, 0.5, 0.5)), 4.0);
    }
}
