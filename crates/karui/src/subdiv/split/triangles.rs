//! Every triangle into four.

use super::Child;
use crate::subdiv::level::{Faces, Level};
use rayon::prelude::*;

impl Level {
    /// The triangle at every corner, then the one between.
    pub(super) fn triangles(&self) -> Child {
        let (faces, corners) = (self.faces.count(), self.corners.len());
        let mut child = Child {
            vertices: self.vertices + self.edges.len(),
            faces: Faces::Uniform {
                size: 3,
                count: 4 * faces as u32,
            },
            corners: vec![0; 12 * faces],
            corner_edges: vec![0; 12 * faces],
            edges: Vec::with_capacity(corners + 2 * self.edges.len()),
            holes: Vec::new(),
            first_edge_point: self.vertices,
        };
        let all = child.corners.par_chunks_exact_mut(12);
        let edges = child.corner_edges.par_chunks_exact_mut(12);
        all.zip(edges).enumerate().for_each(|(f, (to, edges))| {
            let found = self.four(f);
            to.copy_from_slice(found[0].as_flattened());
            edges.copy_from_slice(found[1].as_flattened());
        });
        let point = |c: usize| self.vertices as u32 + self.corner_edges[c];
        let inside =
            (0..corners).map(|c| [point(c), point(self.faces.previous(c as u32) as usize)]);
        child.edges.extend(inside);
        for (e, ends) in self.edges.iter().enumerate() {
            let point = (self.vertices + e) as u32;
            child.edges.extend(ends.map(|v| [point, v]));
        }
        child.holes = self.holes.iter().flat_map(|&hole| [hole; 4]).collect();
        child
    }

    /// Vertices and edges of the four children of face `f`.
    fn four(&self, f: usize) -> [[[u32; 3]; 4]; 2] {
        let (first, inside) = (3 * f as u32, self.corners.len() as u32);
        let corner = |i: usize| self.corners[3 * f + i % 3];
        let edge = |i: usize| self.corner_edges[3 * f + i % 3];
        let point = |i: usize| self.vertices as u32 + edge(i);
        // Half of edge i at corner i, which it leaves, or at the next, which it enters.
        let start = |i: usize| inside + 2 * edge(i) + self.half(edge(i), corner(i), true);
        let end = |i: usize| inside + 2 * edge(i) + self.half(edge(i), corner(i + 1), false);
        let vertices = [
            [corner(0), point(0), point(2)],
            [point(0), corner(1), point(1)],
            [point(2), point(1), corner(2)],
            [point(1), point(2), point(0)],
        ];
        let edges = [
            [start(0), first, end(2)],
            [end(0), start(1), first + 1],
            [first + 2, end(1), start(2)],
            [first + 2, first, first + 1],
        ];
        [vertices, edges]
    }
}
