//! Which corners and edges meet at a vertex, which corners at an edge.

use super::{Level, Rows};

#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(in crate::subdiv) struct Rings {
    pub edge_corners: Rows,
    pub vertex_corners: Rows,
    pub vertex_edges: Rows,
}

impl Level {
    /// Finds what meets where, and puts it in order around every vertex that has one; the
    /// others become `odd_vertices`.
    pub(in crate::subdiv) fn build_rings(&mut self) {
        let by = |list: &[u32]| -> Vec<(u32, u32)> {
            list.iter()
                .enumerate()
                .map(|(c, &to)| (to, c as u32))
                .collect()
        };
        let corner_pairs = by(&self.corners);
        let edge_pairs = by(&self.corner_edges);
        let ends = || {
            let edges = self.edges.iter().enumerate();
            edges.flat_map(|(e, ends)| ends.map(|v| (v, e as u32)))
        };
        self.rings = Rings {
            edge_corners: Rows::group(self.edges.len(), || edge_pairs.iter().copied()),
            vertex_corners: Rows::group(self.vertices, || corner_pairs.iter().copied()),
            vertex_edges: Rows::group(self.vertices, ends),
        };
        let (mut corners, mut edges) = (Vec::new(), Vec::new());
        for v in 0..self.vertices {
            if self.odd_vertices[v] {
                continue;
            }
            if self.walk(v as u32, &mut corners, &mut edges) {
                self.rings
                    .vertex_corners
                    .row_mut(v)
                    .copy_from_slice(&corners);
                self.rings.vertex_edges.row_mut(v).copy_from_slice(&edges);
            } else {
                self.odd_vertices[v] = true;
            }
        }
    }

    /// Goes around `v` counter-clockwise; `false` if that does not meet everything once.
    fn walk(&self, v: u32, corners: &mut Vec<u32>, edges: &mut Vec<u32>) -> bool {
        corners.clear();
        edges.clear();
        let all = self.vertex_corners(v);
        let edge_count = self.vertex_edges(v).len();
        let ends = |&&c: &&u32| self.edge_corners(self.corner_edges[c as usize]).len() == 1;
        let is_open = edge_count > all.len();
        let start = if is_open {
            all.iter().find(ends)
        } else {
            all.first()
        };
        let Some(&start) = start else {
            return false;
        };
        let mut corner = start;
        loop {
            corners.push(corner);
            edges.push(self.corner_edges[corner as usize]);
            let trailing = self.corner_edges[self.faces.previous(corner) as usize];
            let next = self.across(trailing, corner);
            match next {
                Some(next) if next == start => break,
                Some(next) if corners.len() < all.len() => corner = next,
                Some(_) => return false,
                None => {
                    edges.push(trailing);
                    break;
                }
            }
        }
        corners.len() == all.len() && edges.len() == edge_count
    }

    /// The corner at which another face than that of `corner` starts along `edge`.
    fn across(&self, edge: u32, corner: u32) -> Option<u32> {
        let face = self.faces.of_corner(corner);
        let others = self.edge_corners(edge).iter().copied();
        others
            .into_iter()
            .find(|&c| self.faces.of_corner(c) != face)
    }
}
