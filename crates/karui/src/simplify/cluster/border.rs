//! Which vertices and edges lie on open borders, without a list of edges.

use crate::mesh::{PositionIds, TriMesh};
use rayon::prelude::*;

/// The open borders of a mesh.
///
/// Around an inner vertex every neighbour is the next corner of one triangle
/// and the last of another, so that the sum of next minus last, as numbers
/// modulo 2^32, vanishes. On a border it is the difference of the neighbours
/// along the border; only where several fans meet in a point could these add
/// up to nothing.
pub(super) struct Border<'a> {
    ids: &'a PositionIds,
    /// That sum of every position.
    sums: Vec<u32>,
    /// Whether it is not 0, of every vertex.
    open: Vec<bool>,
}

impl<'a> Border<'a> {
    /// `None` if there is no border.
    pub fn of(mesh: &TriMesh, ids: &'a PositionIds) -> Option<Self> {
        let size = ids
            .count
            .div_ceil(rayon::current_num_threads())
            .max(1 << 14);
        let blocks = (0..ids.count).into_par_iter().step_by(size);
        let sums: Vec<u32> = blocks
            .flat_map_iter(|first| sums(mesh, ids, first, size.min(ids.count - first)))
            .collect();
        if sums.iter().all(|&sum| sum == 0) {
            return None;
        }
        let vertices = ids.of_vertex.par_iter();
        Some(Self {
            open: vertices.map(|&id| sums[id as usize] != 0).collect(),
            ids,
            sums,
        })
    }

    /// Whether the edge from `a` to `b` of a triangle is on a border: its ends
    /// are, and so are the neighbours along the border that their sums tell of.
    pub fn has(&self, a: u32, b: u32) -> bool {
        let (a, b) = (a as usize, b as usize);
        if !(self.open[a] && self.open[b]) {
            return false;
        }
        let [p, q] = [a, b].map(|v| self.ids.of_vertex[v]);
        let sum = |p: u32| self.sums.get(p as usize).copied().unwrap_or(0);
        sum(q.wrapping_sub(sum(p))) != 0 && sum(p.wrapping_add(sum(q))) != 0
    }
}

/// The sums of a range of positions.
fn sums(mesh: &TriMesh, ids: &PositionIds, first: usize, count: usize) -> Vec<u32> {
    let mut sums = vec![0u32; count];
    let mut add = |id: u32, next: u32, last: u32| {
        if let Some(sum) = sums.get_mut((id as usize).wrapping_sub(first)) {
            *sum = sum.wrapping_add(next).wrapping_sub(last);
        }
    };
    let linked = ids.count < mesh.positions.len();
    for triangle in &mesh.triangles {
        let [a, b, c] = match linked {
            true => triangle.map(|v| ids.of_vertex[v as usize]),
            false => *triangle,
        };
        add(a, b, c);
        add(b, c, a);
        add(c, a, b);
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes;

    #[test]
    fn a_grid_has_a_rim() {
        let grid = shapes::grid(17, 15);
        let ids = PositionIds::of_mesh(&grid);
        let border = Border::of(&grid, &ids).unwrap();
        let inner = |v: usize| (1..17).contains(&(v % 18)) && (1..15).contains(&(v / 18));
        for (v, open) in border.open.iter().enumerate() {
            assert_eq!(*open, !inner(v), "{v}");
        }
        let sides = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]];
        let edges = grid.triangles.iter().flat_map(sides);
        assert_eq!(
            edges.filter(|&[a, b]| border.has(a, b)).count(),
            2 * (17 + 15)
        );
    }

    #[test]
    fn closed_shapes_have_none_seams_or_not() {
        for mesh in [
            shapes::icosphere(3),
            shapes::textured_sphere(12, 16),
            shapes::cube(3),
            shapes::cubes_sharing_edge(),
        ] {
            assert!(Border::of(&mesh, &PositionIds::of_mesh(&mesh)).is_none());
        }
    }
}
