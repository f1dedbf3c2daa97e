//! Every n-gon into n quads.

use super::Child;
use crate::subdiv::level::{Faces, Level};
use rayon::prelude::*;

impl Level {
    pub(super) fn quads(&self) -> Child {
        let (faces, corners) = (self.faces.count(), self.corners.len());
        let first_edge_point = self.vertices + faces;
        let mut child = Child {
            vertices: first_edge_point + self.edges.len(),
            faces: Faces::Uniform {
                size: 4,
                count: corners as u32,
            },
            corners: vec![0; 4 * corners],
            corner_edges: vec![0; 4 * corners],
            edges: Vec::with_capacity(corners + 2 * self.edges.len()),
            holes: Vec::new(),
            first_edge_point,
        };
        let quads = child.corners.par_chunks_exact_mut(4);
        let edges = child.corner_edges.par_chunks_exact_mut(4);
        quads.zip(edges).enumerate().for_each(|(c, (quad, edges))| {
            let (vertices, found, turn) = self.quad(c as u32);
            for i in 0..4 {
                quad[(i + turn) & 3] = vertices[i];
                edges[(i + turn) & 3] = found[i];
            }
        });
        let edge_point = |e: usize| (first_edge_point + e) as u32;
        let inside = (0..corners).map(|c| {
            let face = self.faces.of_corner(c as u32);
            [
                self.vertices as u32 + face,
                edge_point(self.corner_edges[c] as usize),
            ]
        });
        child.edges.extend(inside);
        let along = self.edges.iter().enumerate();
        let halves = along.flat_map(|(e, ends)| ends.map(|v| [edge_point(e), v]));
        child.edges.extend(halves);
        if !self.holes.is_empty() {
            let hole = |c: usize| self.holes[self.faces.of_corner(c as u32) as usize];
            child.holes = (0..corners).map(hole).collect();
        }
        child
    }

    /// The child face at corner `c`: its vertices and edges, from that corner on, and how
    /// far it is turned so that quads of one quad lie alike.
    fn quad(&self, c: u32) -> ([u32; 4], [u32; 4], usize) {
        let face = self.faces.of_corner(c);
        let range = self.faces.corners(face as usize);
        let before = self.faces.previous(c);
        let vertex = self.corners[c as usize];
        let [leading, trailing] = [c, before].map(|c| self.corner_edges[c as usize]);
        let first_edge_point = (self.vertices + self.faces.count()) as u32;
        let inside = self.corners.len() as u32;
        let vertices = [
            vertex,
            first_edge_point + leading,
            self.vertices as u32 + face,
            first_edge_point + trailing,
        ];
        let edges = [
            inside + 2 * leading + self.half(leading, vertex, true),
            c,
            before,
            inside + 2 * trailing + self.half(trailing, vertex, false),
        ];
        let turn = if range.len() == 4 {
            c as usize - range.start
        } else {
            0
        };
        (vertices, edges, turn)
    }
}
