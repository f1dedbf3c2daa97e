//! Vertices at one position as one.

use glam::Vec3;
use rayon::prelude::*;

/// For every position the index of the first one exactly equal to it. Zeros of
/// either sign are equal; NaNs are equal to their like.
pub(super) fn representatives(positions: &[Vec3]) -> Vec<u32> {
    let key = |v: u32| {
        positions[v as usize]
            .to_array()
            .map(|c| (c + 0.0).to_bits())
    };
    let mut sorted: Vec<([u32; 3], u32)> = (0..positions.len() as u32)
        .into_par_iter()
        .map(|v| (key(v), v))
        .collect();
    sorted.par_sort_unstable();
    let mut first = vec![0; positions.len()];
    for group in sorted.chunk_by(|a, b| a.0 == b.0) {
        group
            .iter()
            .for_each(|&(_, v)| first[v as usize] = group[0].1);
    }
    first
}

/// Both ends of every side of a triangle.
pub(super) fn sides([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

/// All sides of all triangles, smaller end first, sorted; a side of several
/// triangles occurs as often. Sides between a vertex and itself are left out.
pub(super) fn sorted_sides(triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let mut all: Vec<[u32; 2]> = triangles
        .par_iter()
        .flat_map_iter(|&t| sides(t))
        .filter(|[a, b]| a != b)
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    all.par_sort_unstable();
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_positions_share_the_first_index() {
        let p = [Vec3::X, Vec3::ZERO, Vec3::X, Vec3::new(-0.0, 0.0, -0.0)];
        assert_eq!(representatives(&p), [0, 1, 0, 1]);
    }

    #[test]
    fn sides_of_a_square() {
        let sides = sorted_sides(&[[2, 0, 1], [0, 2, 3], [3, 3, 3]]);
        assert_eq!(sides, [[0, 1], [0, 2], [0, 2], [0, 3], [1, 2], [2, 3]]);
    }
}
