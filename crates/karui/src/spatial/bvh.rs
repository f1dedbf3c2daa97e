//! Nearest point of a triangle mesh, by a four-wide hierarchy of boxes.
//!
//! Boxes are `f32` and only ever decide what to skip, with a margin for their
//! rounding; every distance that is compared or returned is computed in `f64`
//! from the mesh's own coordinates.

use super::{morton_build, sah_build};
use crate::error::{Error, Result};
use crate::geom::{Aabb, closest_barycentric, interpolate};
use crate::mesh::TriMesh;
use glam::{DVec3, Vec3, Vec4};
use smallvec::SmallVec;

/// Bounding volume hierarchy over the triangles of a mesh; keeps a copy of
/// their corners, so the mesh may go.
#[derive(Debug, Clone)]
pub struct Bvh {
    pub(super) nodes: Vec<Node>,
    /// Corners of the triangles in leaf order.
    corners: Vec<[Vec3; 3]>,
    /// Triangle of the mesh at every place of the leaf order.
    order: Vec<u32>,
    bounds: Aabb,
}

/// Four boxes and what is in them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Node {
    /// Least x, least y and least z of the four boxes.
    pub min: [Vec4; 3],
    /// Greatest x, y and z.
    pub max: [Vec4; 3],
    /// A node, or a place in the leaf order with [`LEAF`] set, or [`NONE`].
    pub child: [u32; 4],
}

/// Marks a child that is a triangle.
pub(super) const LEAF: u32 = 1 << 31;
/// No child.
pub(super) const NONE: u32 = u32::MAX;

/// The nearest point of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// The point.
    pub point: DVec3,
    /// Its squared distance, model units squared.
    pub distance_squared: f64,
    /// Triangle of the mesh it lies on; of several equally near ones, the
    /// first.
    pub triangle: u32,
    /// Its barycentric coordinates there: none negative, sum 1.
    pub barycentric: [f64; 3],
    /// Place of the triangle in leaf order.
    pub(crate) slot: u32,
}

/// Boxes still to be opened, each with a lower bound of its squared distance.
type Stack = SmallVec<[(f32, u32); 128]>;

impl Bvh {
    /// Sorts the triangles of `mesh` into boxes (binned surface area
    /// heuristic, Wald 2007), on all threads of the current pool. Degenerate
    /// triangles take part as the segments or points they are.
    ///
    /// The one to take for many queries, as in measuring: building takes
    /// several times as long as [`Bvh::build_quick`], a query somewhat less.
    ///
    /// # Errors
    /// [`Error::Empty`] without triangles, [`Error::IndexOutOfRange`],
    /// [`Error::NotFinite`] for a NaN or infinite corner, [`Error::TooLarge`]
    /// from 2^31 - 1 triangles.
    pub fn build(mesh: &TriMesh) -> Result<Self> {
        check(mesh)?;
        let (nodes, order) = sah_build::build(mesh);
        let corners = order.iter().map(|&t| corners_of(mesh, t)).collect();
        Ok(Self::of(nodes, corners, order))
    }

    /// As [`Bvh::build`], but sorted along a Morton curve: the one to take for
    /// fewer queries than the mesh has triangles. Both give the same results.
    ///
    /// # Errors
    /// As [`Bvh::build`].
    pub fn build_quick(mesh: &TriMesh) -> Result<Self> {
        match morton_build::build(mesh) {
            Some((nodes, corners, order)) => Ok(Self::of(nodes, corners, order)),
            None => Self::build(mesh),
        }
    }

    fn of(nodes: Vec<Node>, corners: Vec<[Vec3; 3]>, order: Vec<u32>) -> Self {
        Self {
            bounds: nodes[0].bounds(),
            nodes,
            corners,
            order,
        }
    }

    /// Number of triangles, at least 1.
    #[must_use]
    #[allow(clippy::len_without_is_empty, reason = "it is never empty")]
    pub fn len(&self) -> usize {
        self.order.len()
    }

    /// Box around all triangles.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// The triangles in an order that keeps neighbours close.
    #[must_use]
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// The nearest point of the surface. A point that is not finite gets an
    /// arbitrary one, at a distance that is not finite.
    #[must_use]
    pub fn closest(&self, point: DVec3) -> Hit {
        self.closest_from(point, 0)
    }

    /// As [`Bvh::closest`], faster if `near` (the hit of a nearby point)
    /// already is close. The result does not depend on it.
    #[must_use]
    pub fn closest_near(&self, point: DVec3, near: &Hit) -> Hit {
        self.closest_from(point, near.slot)
    }

    /// Triangle of the mesh at a place of the leaf order.
    pub(super) fn triangle(&self, slot: u32) -> u32 {
        self.order[slot as usize]
    }

    /// Corners of the triangle at a place of the leaf order.
    pub(crate) fn corners(&self, slot: u32) -> [DVec3; 3] {
        self.corners[slot as usize].map(Vec3::as_dvec3)
    }

    /// As [`Bvh::closest`], faster if the triangle at `slot` of the leaf order
    /// is close.
    pub(crate) fn closest_from(&self, point: DVec3, slot: u32) -> Hit {
        self.closest_or_within(point, slot, -1.0)
    }

    /// Some point of the surface whose squared distance is at most `enough`;
    /// the nearest if there is none.
    pub(crate) fn closest_or_within(&self, point: DVec3, slot: u32, enough: f64) -> Hit {
        let slot = slot.min(self.order.len() as u32 - 1);
        let mut search = Search::new(self, point, slot);
        let mut stack = Stack::new();
        stack.push((0.0, 0));
        while let Some((distance, child)) = stack.pop() {
            if search.distance_squared <= enough {
                break;
            }
            if distance > search.bound {
                continue;
            }
            if child & LEAF == 0 {
                search.open(&self.nodes[child as usize], &mut stack);
            } else {
                search.try_triangle(child & !LEAF);
            }
        }
        search.hit()
    }
}

fn check(mesh: &TriMesh) -> Result<()> {
    if mesh.triangles.is_empty() {
        return Err(Error::Empty { what: "mesh" });
    }
    if mesh.triangles.len() >= (NONE & !LEAF) as usize {
        return Err(Error::TooLarge {
            what: "triangles",
            found: mesh.triangles.len(),
            limit: (NONE & !LEAF) as usize - 1,
        });
    }
    for (face, triangle) in mesh.triangles.iter().enumerate() {
        for &index in triangle {
            let position = mesh.positions.get(index as usize);
            let position = position.ok_or(Error::IndexOutOfRange {
                face,
                index,
                vertices: mesh.positions.len(),
            })?;
            if !position.is_finite() {
                return Err(Error::NotFinite {
                    what: "position".into(),
                    index: index as usize,
                });
            }
        }
    }
    Ok(())
}

/// Corners of a triangle of a valid mesh.
pub(super) fn corners_of(mesh: &TriMesh, triangle: u32) -> [Vec3; 3] {
    let [a, b, c] = mesh.triangles[triangle as usize].map(|v| v as usize);
    [mesh.positions[a], mesh.positions[b], mesh.positions[c]]
}

/// One query: the best triangle so far and what can still beat it.
struct Search<'a> {
    bvh: &'a Bvh,
    point: DVec3,
    rounded: Vec3,
    /// What rounding the point to `f32` may change in a distance.
    margin: f64,
    /// Boxes further than this (squared) hold nothing nearer.
    bound: f32,
    distance_squared: f64,
    slot: u32,
    barycentric: [f64; 3],
}

impl<'a> Search<'a> {
    fn new(bvh: &'a Bvh, point: DVec3, slot: u32) -> Self {
        let mut search = Self {
            bvh,
            point,
            rounded: point.as_vec3(),
            margin: f64::from(f32::EPSILON) * point.length(),
            bound: f32::INFINITY,
            distance_squared: f64::INFINITY,
            slot,
            barycentric: [1.0, 0.0, 0.0],
        };
        search.try_triangle(slot);
        search
    }

    /// Tests one triangle; of two equally near the lower index wins, which
    /// makes the result independent of the order of the search.
    fn try_triangle(&mut self, slot: u32) {
        let corners = self.bvh.corners(slot);
        let barycentric = closest_barycentric(self.point, corners);
        let distance_squared = self
            .point
            .distance_squared(interpolate(corners, barycentric));
        let order = &self.bvh.order;
        let wins = distance_squared < self.distance_squared
            || (distance_squared == self.distance_squared
                && order[slot as usize] < order[self.slot as usize]);
        if wins {
            self.distance_squared = distance_squared;
            self.slot = slot;
            self.barycentric = barycentric;
            let reach = distance_squared.sqrt() + self.margin;
            // The factor covers the rounding of a box's squared distance.
            self.bound = (reach * reach * (1.0 + 1e-6)) as f32;
        }
    }

    /// Pushes the children of `node` that may hold something nearer, the
    /// nearest last.
    fn open(&self, node: &Node, stack: &mut Stack) {
        let distances = node.distances_squared(self.rounded);
        let mut near = distances.cmple(Vec4::splat(self.bound)).bitmask();
        let distances = distances.to_array();
        let first = stack.len();
        while near != 0 {
            let lane = near.trailing_zeros() as usize;
            near &= near - 1;
            if node.child[lane] == NONE {
                continue;
            }
            stack.push((distances[lane], node.child[lane]));
            let mut at = stack.len() - 1;
            while at > first && stack[at - 1].0 < stack[at].0 {
                stack.swap(at - 1, at);
                at -= 1;
            }
        }
    }

    fn hit(&self) -> Hit {
        Hit {
            point: interpolate(self.bvh.corners(self.slot), self.barycentric),
            distance_squared: self.distance_squared,
            triangle: self.bvh.order[self.slot as usize],
            barycentric: self.barycentric,
            slot: self.slot,
        }
    }
}

impl Node {
    pub(super) const EMPTY: Self = Self {
        min: [Vec4::INFINITY; 3],
        max: [Vec4::NEG_INFINITY; 3],
        child: [NONE; 4],
    };

    pub(super) fn set(&mut self, lane: usize, bounds: Aabb, child: u32) {
        for axis in 0..3 {
            self.min[axis][lane] = bounds.min[axis];
            self.max[axis][lane] = bounds.max[axis];
        }
        self.child[lane] = child;
    }

    /// Box around the four boxes.
    pub(super) fn bounds(&self) -> Aabb {
        Aabb {
            min: Vec3::from(self.min.map(Vec4::min_element)),
            max: Vec3::from(self.max.map(Vec4::max_element)),
        }
    }

    /// The node with inner children `base` further on.
    pub(super) fn moved(mut self, base: u32) -> Self {
        for child in &mut self.child {
            *child += if *child < LEAF { base } else { 0 };
        }
        self
    }

    /// Squared distances from `point` to the four boxes.
    #[inline(always)]
    pub(super) fn distances_squared(&self, point: Vec3) -> Vec4 {
        let outside = |axis: usize| {
            let p = Vec4::splat(point[axis]);
            let gap = (self.min[axis] - p).max(p - self.max[axis]).max(Vec4::ZERO);
            gap * gap
        };
        outside(0) + outside(1) + outside(2)
    }
}
