//! Spheres and cones around clusters and groups, and how they are joined so
//! that the larger one holds the smaller ones whatever rounding does.

use super::angle::Angle;
use crate::geom::Aabb;
use glam::{DVec3, Vec3};

/// A sphere.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Sphere {
    /// Centre, model units.
    pub center: Vec3,
    /// Radius, model units; 0 or more.
    pub radius: f32,
}

impl Sphere {
    /// Around these points; the origin for none.
    #[must_use]
    pub fn around(points: impl Iterator<Item = Vec3> + Clone) -> Self {
        let center = Aabb::of(points.clone()).center();
        let far = |r: f64, p: Vec3| r.max(p.as_dvec3().distance(center.as_dvec3()));
        Self {
            center,
            radius: up(points.fold(0.0, far)),
        }
    }

    /// Around these spheres; the origin for none.
    #[must_use]
    pub fn joined(spheres: &[Self]) -> Self {
        let ends = |s: &Self| [s.center - s.radius, s.center + s.radius];
        let center = Aabb::of(spheres.iter().flat_map(ends)).center();
        let reach = |s: &Self| {
            let way = s.center.as_dvec3().distance(center.as_dvec3());
            way + f64::from(s.radius)
        };
        Self {
            center,
            radius: up(spheres.iter().map(reach).fold(0.0, f64::max)),
        }
    }

    /// Whether `other` lies inside, in exact arithmetic but for the last bits
    /// of `f64`.
    #[must_use]
    pub fn holds(&self, other: &Self) -> bool {
        let way = self.center.as_dvec3().distance(other.center.as_dvec3());
        way + f64::from(other.radius) <= f64::from(self.radius)
    }
}

/// Rounds up with room to spare: nesting has to outlast the rounding of what
/// is computed from it in `f64`.
fn up(value: f64) -> f32 {
    if value == 0.0 {
        return 0.0;
    }
    ((value * (1.0 + 2e-7)) as f32).next_up().min(f32::MAX)
}

/// Larger than `error` by little: an error that grows strictly from child to
/// parent grows on the screen too, however the distance is rounded.
pub(super) fn grown(error: f64) -> f32 {
    ((error * (1.0 + 1e-6)) as f32).next_up().min(f32::MAX)
}

/// Directions within an angle of an axis: the normals of some triangles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cone {
    /// The axis, of length 1.
    pub axis: Vec3,
    /// Cosine of the angle between the axis and the farthest direction; -1
    /// holds all directions.
    pub cos: f32,
}

/// By how much a cosine is lowered whenever cones are joined.
const SLACK: f64 = 1e-6;

impl Cone {
    /// All directions.
    pub const FULL: Self = Self {
        axis: Vec3::Z,
        cos: -1.0,
    };

    /// Sine of half the opening angle; 1 if that is a right angle or more.
    #[must_use]
    pub fn sin(&self) -> f32 {
        let cos = self.cos.max(0.0);
        ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt()
    }

    /// Around these unit normals; zero ones do not count. [`Cone::FULL`] for
    /// none.
    #[must_use]
    pub fn around(normals: impl Iterator<Item = DVec3> + Clone) -> Self {
        let sum: DVec3 = normals.clone().sum();
        let Some(axis) = sum.try_normalize() else {
            return Self::FULL;
        };
        let axis = axis.as_vec3();
        let long = axis.as_dvec3().normalize();
        let counted = normals.filter(|n| *n != DVec3::ZERO);
        let least = counted.map(|n| n.dot(long)).fold(1.0, f64::min);
        Self {
            axis,
            cos: lowered(least),
        }
    }

    /// Around these cones; [`Cone::FULL`] for none.
    #[must_use]
    pub fn joined(cones: &[Self]) -> Self {
        let sum: DVec3 = cones.iter().map(|c| c.axis.as_dvec3()).sum();
        let Some(axis) = sum.try_normalize() else {
            return Self::FULL;
        };
        let axis = axis.as_vec3();
        let long = axis.as_dvec3().normalize();
        let reach = |c: &Self| Angle::between(long, c.unit()).plus(c.angle()).cos;
        let least = cones.iter().map(reach).fold(1.0, f64::min);
        Self {
            axis,
            cos: lowered(least),
        }
    }

    pub(super) fn unit(&self) -> DVec3 {
        self.axis.as_dvec3().normalize_or_zero()
    }

    pub(super) fn angle(&self) -> Angle {
        Angle::of_cos(f64::from(self.cos))
    }
}

fn lowered(cos: f64) -> f32 {
    ((cos - SLACK) as f32).next_down().max(-1.0)
}

/// What decides whether a group's coarse clusters will do: the same for all
/// that it was made from and for all that was made of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Upper estimate of the distance to the input, model units.
    pub error: f32,
    /// Around the group and all that it was made from, at every level.
    pub sphere: Sphere,
    /// Around the normals of all that.
    pub cone: Cone,
}

impl Bounds {
    /// What a root is simplified in: nothing is coarse enough for it.
    pub const NEVER: Self = Self {
        error: f32::INFINITY,
        sphere: Sphere {
            center: Vec3::ZERO,
            radius: f32::INFINITY,
        },
        cone: Cone::FULL,
    };

    /// As the criteria of hierarchies know bounds.
    pub(super) fn as_of_a_node(&self) -> crate::hierarchy::Bounds {
        let normals = self.cone.angle();
        crate::hierarchy::Bounds {
            center: self.sphere.center.as_dvec3(),
            radius: f64::from(self.sphere.radius),
            axis: self.cone.unit(),
            spread: (normals.cos >= 0.0).then_some([normals.sin, normals.cos]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn some() -> impl Strategy<Value = Vec3> {
        let c = || -1e3f32..1e3;
        (c(), c(), c()).prop_map(|(x, y, z)| Vec3::new(x, y, z))
    }

    proptest! {
        #[test]
        fn joined_spheres_hold_their_parts(centers in prop::collection::vec((some(), 0f32..100.0), 1..9)) {
            let parts: Vec<Sphere> = centers.iter()
                .map(|&(center, radius)| Sphere { center, radius }).collect();
            let whole = Sphere::joined(&parts);
            prop_assert!(parts.iter().all(|p| whole.holds(p)));
        }

        #[test]
        fn joined_cones_hold_their_parts(normals in prop::collection::vec(prop::collection::vec(some(), 1..5), 1..5)) {
            let units: Vec<Vec<DVec3>> = normals.iter()
                .map(|n| n.iter().map(|n| n.as_dvec3().normalize_or_zero()).collect()).collect();
            let parts: Vec<Cone> = units.iter().map(|n| Cone::around(n.iter().copied())).collect();
            let whole = Cone::joined(&parts);
            let inside = |n: &DVec3| n.dot(whole.unit()) >= f64::from(whole.cos);
            prop_assert!(units.iter().flatten().all(inside));
        }
    }
}
