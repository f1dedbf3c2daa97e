//! Which ways the triangles of a hierarchy face, to tell at once of a whole
//! neighbourhood that nothing in it faces away.

use super::bvh::{Bvh, LEAF, NONE, Node};
use crate::geom::normal_times_two_areas;
use glam::{Vec3, Vec4};
use rayon::prelude::*;
use smallvec::SmallVec;

/// The normals in every box of a [`Bvh`].
#[derive(Debug, Clone)]
pub struct Facings {
    /// Of every node.
    ways: Vec<Ways>,
    /// Place of every triangle in leaf order.
    slot: Vec<u32>,
}

/// Least and greatest coordinates of the unit normals in four boxes, by axis.
#[derive(Debug, Clone, Copy)]
struct Ways {
    min: [Vec4; 3],
    max: [Vec4; 3],
}

/// Least and greatest coordinates of some unit normals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Normals {
    /// Least coordinates.
    pub min: Vec3,
    /// Greatest coordinates.
    pub max: Vec3,
}

impl Normals {
    /// Of none.
    pub const NONE: Self = Self {
        min: Vec3::INFINITY,
        max: Vec3::NEG_INFINITY,
    };

    /// These and another, which must be of unit length.
    #[must_use]
    pub fn with(self, normal: Vec3) -> Self {
        Self {
            min: self.min.min(normal),
            max: self.max.max(normal),
        }
    }
}

impl Facings {
    /// The normals of the triangles of `index`. One without area faces
    /// nowhere.
    #[must_use]
    pub fn of(index: &Bvh) -> Self {
        let of_leaves = |node: &Node| Ways::of_leaves(index, node);
        let mut ways: Vec<Ways> = index.nodes.par_iter().map(of_leaves).collect();
        // Children come after their parents.
        for (at, node) in index.nodes.iter().enumerate().rev() {
            for (lane, &child) in node.child.iter().enumerate() {
                if child < LEAF {
                    let all = ways[child as usize].all();
                    ways[at].set(lane, all);
                }
            }
        }
        let mut slot = vec![0; index.len()];
        for (at, &t) in index.order().iter().enumerate() {
            slot[t as usize] = at as u32;
        }
        Self { ways, slot }
    }

    /// Place of a triangle in the index's leaf order.
    pub(crate) fn slot_of(&self, triangle: u32) -> u32 {
        self.slot[triangle as usize]
    }

    /// Whether no triangle of `index` that is at most `radius` away from
    /// `center` is at a right angle, or more, to any direction between
    /// `normals.min` and `normals.max`. May say no where it is so, as boxes
    /// are all that is looked at. `index` is the one these are of.
    #[must_use]
    pub fn agree(&self, index: &Bvh, center: Vec3, radius: f32, normals: Normals) -> bool {
        let margin = 4.0 * f32::EPSILON * center.length();
        let radius = radius * (1.0 + 1e-5) + margin;
        let reach = Vec4::splat(radius * radius);
        let mut open = SmallVec::<[u32; 64]>::new();
        open.push(0);
        while let Some(at) = open.pop() {
            let (node, ways) = (&index.nodes[at as usize], &self.ways[at as usize]);
            let near = node.distances_squared(center).cmple(reach);
            let mut doubtful = (near & !ways.agree(normals)).bitmask();
            while doubtful != 0 {
                let child = node.child[doubtful.trailing_zeros() as usize];
                doubtful &= doubtful - 1;
                if child < LEAF {
                    open.push(child);
                } else if child != NONE {
                    return false;
                }
            }
        }
        true
    }
}

impl Ways {
    fn of_leaves(index: &Bvh, node: &Node) -> Self {
        let mut ways = Self {
            min: [Vec4::INFINITY; 3],
            max: [Vec4::NEG_INFINITY; 3],
        };
        for (lane, &child) in node.child.iter().enumerate() {
            if child >= LEAF && child != NONE {
                let normal = normal_times_two_areas(index.corners(child & !LEAF));
                let normal = normal.normalize_or_zero().as_vec3();
                ways.set(lane, Normals::NONE.with(normal));
            }
        }
        ways
    }

    fn set(&mut self, lane: usize, normals: Normals) {
        for axis in 0..3 {
            self.min[axis][lane] = normals.min[axis];
            self.max[axis][lane] = normals.max[axis];
        }
    }

    fn all(&self) -> Normals {
        Normals {
            min: Vec3::from(self.min.map(Vec4::min_element)),
            max: Vec3::from(self.max.map(Vec4::max_element)),
        }
    }

    /// In which boxes every normal is at less than a right angle to all of
    /// `normals`: the least product there can be, axis by axis, is positive.
    #[inline(always)]
    fn agree(&self, normals: Normals) -> glam::BVec4A {
        let least = |axis: usize| {
            let (min, max) = (normals.min[axis], normals.max[axis]);
            let low = (self.min[axis] * min).min(self.min[axis] * max);
            low.min((self.max[axis] * min).min(self.max[axis] * max))
        };
        (least(0) + least(1) + least(2)).cmpgt(Vec4::splat(1e-5))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{closest_barycentric, interpolate};
    use crate::mesh::shapes;

    /// Every triangle one by one.
    fn by_definition(index: &Bvh, center: Vec3, radius: f32, normals: [Vec3; 2]) -> bool {
        (0..index.len() as u32).all(|slot| {
            let (corners, center) = (index.corners(slot), center.as_dvec3());
            let nearest = interpolate(corners, closest_barycentric(center, corners));
            let normal = normal_times_two_areas(corners).as_vec3();
            nearest.distance(center) > f64::from(radius)
                || normals.iter().all(|n| n.dot(normal) > 0.0)
        })
    }

    #[test]
    fn what_agrees_does_so_by_definition() {
        let mesh = shapes::torus(1.0, 0.4, 40, 24);
        let index = Bvh::build_quick(&mesh).unwrap();
        let facings = Facings::of(&index);
        let mut agreed = 0;
        for (t, _) in mesh.triangles.iter().enumerate() {
            let corners = mesh.corners(t);
            let center = corners[0].as_vec3();
            let normal = normal_times_two_areas(corners).normalize().as_vec3();
            let tilted = (normal + 0.3 * normal.any_orthonormal_vector()).normalize();
            for radius in [0.01, 0.1, 0.3, 0.9] {
                let normals = Normals::NONE.with(normal).with(tilted);
                if facings.agree(&index, center, radius, normals) {
                    agreed += 1;
                    assert!(by_definition(&index, center, radius, [normal, tilted]));
                }
            }
        }
        assert!(agreed > mesh.triangles.len(), "{agreed}");
    }

    #[test]
    fn the_other_side_of_a_thin_plate_does_not_agree() {
        let mesh = shapes::cube(4);
        let index = Bvh::build_quick(&mesh).unwrap();
        let facings = Facings::of(&index);
        let up = Normals::NONE.with(Vec3::Z);
        let top = Vec3::new(0.0, 0.0, 0.5);
        assert!(facings.agree(&index, top, 0.2, up));
        assert!(!facings.agree(&index, top, 1.1, up));
        assert!(!facings.agree(&index, top, 0.2, Normals::NONE.with(-Vec3::Z)));
    }
}
