//! The planes that meet in a vertex, summed.

use crate::geom::normal_times_two_areas;
use glam::{DVec3, Vec3};

/// One in fixed point: 2^24 triangles at one vertex fit into 64 bits.
const ONE: f64 = (1u64 << 38) as f64;

/// The quadric of the planes around a vertex, seen from the vertex.
///
/// All of them go through the vertex, so that of the 4 x 4 matrix sum of K_p (Garland &
/// Heckbert 1997) only the sum of n n^T is left, and nothing cancels however far from the
/// origin the model is. In fixed point, so that the sum does not depend on the order of
/// the triangles, nor on how slices split them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct PlaneSum {
    /// xx, xy, xz, yy, yz and zz of the sum, in 2^-38.
    pub entries: [i64; 6],
}

impl PlaneSum {
    /// Adds the plane of a triangle at the vertex; one without area has none.
    pub fn add_triangle(&mut self, corners: [Vec3; 3]) {
        let normal = normal_times_two_areas(corners.map(|c| c.as_dvec3()));
        let length = normal.length();
        if !(length > 0.0 && length.is_finite()) {
            return;
        }
        let n = normal / length;
        let products = [
            n.x * n.x,
            n.x * n.y,
            n.x * n.z,
            n.y * n.y,
            n.y * n.z,
            n.z * n.z,
        ];
        // Rounded by hand: `round` is a call into a library on plain x86-64.
        let entries = products.map(|p| (p * ONE + 0.5f64.copysign(p)) as i64);
        self.merge(&Self { entries });
    }

    /// Adds the planes of other triangles at the same vertex. More than 2^24 of them in
    /// one plane are as good as 2^24.
    pub fn merge(&mut self, other: &Self) {
        for (sum, added) in self.entries.iter_mut().zip(other.entries) {
            *sum = sum.saturating_add(added);
        }
    }

    /// Sum of the squared distances, in square model units, of a point from the planes;
    /// `offset` leads from the vertex to the point.
    #[must_use]
    pub fn cost(&self, offset: DVec3) -> f64 {
        self.to_f64().cost(offset)
    }

    /// For several costs.
    pub(super) fn to_f64(self) -> Quadric {
        Quadric(self.entries.map(|e| e as f64 / ONE))
    }
}

/// A [`PlaneSum`] that is complete.
#[derive(Debug, Clone, Copy)]
pub(super) struct Quadric([f64; 6]);

impl Quadric {
    /// As [`PlaneSum::cost`].
    pub fn cost(&self, DVec3 { x, y, z }: DVec3) -> f64 {
        let [xx, xy, xz, yy, yz, zz] = self.0;
        let squares = xx * x * x + yy * y * y + zz * z * z;
        let mixed = xy * x * y + xz * x * z + yz * y * z;
        // Below zero by rounding only; NaN stays.
        let cost = squares + 2.0 * mixed;
        if cost < 0.0 { 0.0 } else { cost }
    }
}
