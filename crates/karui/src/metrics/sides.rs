//! Edges of triangles.

use rayon::prelude::*;

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
    fn sides_of_a_square() {
        let sides = sorted_sides(&[[2, 0, 1], [0, 2, 3], [3, 3, 3]]);
        assert_eq!(sides, [[0, 1], [0, 2], [0, 2], [0, 3], [1, 2], [2, 3]]);
    }
}
