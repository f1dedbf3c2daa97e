//! Order along a Morton (Z-order) curve.

use crate::geom::Aabb;
use glam::Vec3;
use rayon::prelude::*;

/// Bits an axis: three of them fill a `u64` but for one bit.
const BITS: u32 = 21;

/// Place of `point` on the curve that fills `bounds`; points outside, and
/// coordinates that are not numbers, are taken to the nearest face.
#[must_use]
pub fn code(point: Vec3, bounds: Aabb) -> u64 {
    let size = bounds.size().max_element().max(f32::MIN_POSITIVE);
    let cells = (1u64 << BITS) as f32;
    // Divided before it is scaled, so that huge models do not overflow.
    let cell = ((point - bounds.min) / size * cells).to_array();
    let last = (1u64 << BITS) - 1;
    let [x, y, z] = cell.map(|c| spread((c as u64).min(last)));
    x | y << 1 | z << 2
}

/// Indices of `points` in the order of the curve; equal places keep the order
/// of their indices.
#[must_use]
pub fn order(points: &[Vec3]) -> Vec<u32> {
    let bounds = Aabb::of(points.iter().copied());
    let mut keyed: Vec<(u64, u32)> = points
        .par_iter()
        .enumerate()
        .map(|(i, &p)| (code(p, bounds), i as u32))
        .collect();
    keyed.par_sort_unstable();
    keyed.into_iter().map(|(_, i)| i).collect()
}

/// Puts two zero bits before every one of the lower 21 bits.
pub(crate) fn spread(mut x: u64) -> u64 {
    x = (x | x << 32) & 0x001f_0000_0000_ffff;
    x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spread_agrees_with_bit_by_bit() {
        for x in [0, 1, 5, 0x1f_ffff, 0x15_5a5a] {
            let slow = (0..BITS).fold(0, |code, bit| code | (x >> bit & 1) << (3 * bit));
            assert_eq!(spread(x), slow);
        }
    }

    #[test]
    fn a_cube_is_walked_in_z_order() {
        let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32);
        let points: Vec<Vec3> = [6, 1, 7, 0, 3, 2, 5, 4].map(corner).into();
        let walked: Vec<Vec3> = order(&points).iter().map(|&i| points[i as usize]).collect();
        assert_eq!(walked, (0..8).map(corner).collect::<Vec<_>>());
    }

    #[test]
    fn odd_points_have_a_place() {
        let bounds = Aabb::of([Vec3::ZERO, Vec3::ONE]);
        assert_eq!(code(Vec3::NAN, bounds), 0);
        assert_eq!(code(Vec3::splat(-3.0), bounds), 0);
        assert_eq!(code(Vec3::INFINITY, bounds), (1 << 63) - 1);
        assert_eq!(code(Vec3::ONE, Aabb::of([Vec3::ONE])), 0);
    }
}
