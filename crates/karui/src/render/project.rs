//! Vertices on the grid of sub-pixels.

use super::geometry::Geometry;
use super::view::View;
use crate::geom::Vec3;
use rayon::prelude::*;

/// Positions are rounded to 1/256 of a sample.
pub(super) const SUB_BITS: u32 = 8;

/// A vertex in the picture.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Corner {
    /// Position in sub-pixels, counted from the centre of the first sample.
    pub x: i32,
    pub y: i32,
    /// See [`View::closeness`].
    pub closeness: f32,
    /// Planes it lies outside of; the rest means nothing then.
    pub outside: u32,
}

/// Vertices a task.
const CHUNK: usize = 4096;

/// All vertices, as they are numbered through all instances.
pub(super) fn project(view: &View, geometry: &Geometry<'_>) -> Vec<Corner> {
    let mut corners = vec![Corner::default(); geometry.vertices];
    let chunks = corners.par_chunks_mut(CHUNK).enumerate();
    chunks.for_each(|(c, corners)| {
        let range = c * CHUNK..c * CHUNK + corners.len();
        for (corner, p) in corners.iter_mut().zip(geometry.positions(range)) {
            *corner = project_one(view, p);
        }
    });
    corners
}

#[inline]
fn project_one(view: &View, p: Vec3) -> Corner {
    let h = view.homogeneous(p);
    let outside = view.outside(&h);
    if outside != 0 {
        return Corner {
            outside,
            ..Corner::default()
        };
    }
    corner_of(view, &h)
}

/// A position within all planes.
#[inline]
pub(super) fn corner_of(view: &View, h: &super::view::Homogeneous) -> Corner {
    let scale = f64::from(1u32 << SUB_BITS) / h.w;
    let half = f64::from(1u32 << (SUB_BITS - 1));
    Corner {
        x: nearest(h.x * scale - half),
        y: nearest(h.y * scale - half),
        closeness: view.closeness(h),
        outside: 0,
    }
}

/// The nearest integer, ties to even, for |x| < 2^31: adding 1.5 * 2^52 leaves no
/// room for a fraction, and the integer in the lowest bits.
#[inline]
fn nearest(x: f64) -> i32 {
    const SHIFT: f64 = 1.5 * (1u64 << 52) as f64;
    (x + SHIFT).to_bits() as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_is_to_the_nearest() {
        for (x, expected) in [
            (0.4, 0),
            (-0.6, -1),
            (2.5, 2),
            (3.5, 4),
            (-2e9, -2_000_000_000),
        ] {
            assert_eq!(nearest(x), expected, "{x}");
        }
    }
}
