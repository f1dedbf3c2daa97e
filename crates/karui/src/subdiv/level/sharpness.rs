//! What a cage's tags, boundaries and odd places make sharp.

use super::Level;
use crate::error::Result;
use crate::subdiv::cage::{Cage, INFINITELY_SHARP};
use crate::subdiv::crease::{decayed, decayed_around};
use crate::subdiv::options::{Boundary, CreaseMethod};

impl Level {
    pub(super) fn apply_tags(&mut self, cage: &Cage, boundary: Boundary) -> Result<()> {
        for crease in &cage.creases {
            let [a, b] = crease.vertices;
            let edges = self.vertex_edges(a).iter();
            // A crease between vertices that no edge joins makes nothing sharp.
            if let Some(&e) = edges.clone().find(|&&e| self.other_end(e, a) == b) {
                self.edge_sharpness[e as usize] = crease.sharpness.max(0.0);
            }
        }
        for corner in &cage.corners {
            self.vertex_sharpness[corner.vertex as usize] = corner.sharpness.max(0.0);
        }
        if !cage.holes.is_empty() || boundary == Boundary::None {
            self.holes = vec![false; self.faces.count()];
        }
        cage.holes
            .iter()
            .for_each(|&f| self.holes[f as usize] = true);
        if boundary == Boundary::None {
            self.leave_out_boundaries();
        }
        self.sharpen_edges();
        self.sharpen_vertices(boundary == Boundary::EdgeAndCorner);
        Ok(())
    }

    /// Makes holes of the faces around a vertex of a boundary that no tag makes sharp.
    fn leave_out_boundaries(&mut self) {
        for e in 0..self.edges.len() as u32 {
            let open = self.edge_corners(e).len() < 2;
            if !open || self.edge_sharpness(e) >= INFINITELY_SHARP {
                continue;
            }
            for v in self.edge(e) {
                for i in 0..self.vertex_corners(v).len() {
                    let face = self.faces.of_corner(self.vertex_corners(v)[i]);
                    self.holes[face as usize] = true;
                }
            }
        }
    }

    fn sharpen_edges(&mut self) {
        for e in 0..self.edges.len() {
            if self.odd_edges[e] || self.edge_corners(e as u32).len() < 2 {
                self.edge_sharpness[e] = INFINITELY_SHARP;
            }
        }
    }

    fn sharpen_vertices(&mut self, corners: bool) {
        for v in 0..self.vertices as u32 {
            let (faces, edges) = (self.vertex_corners(v).len(), self.vertex_edges(v));
            let is_corner = faces == 1 && edges.len() == 2;
            let odd = edges
                .iter()
                .filter(|&&e| self.odd_edges[e as usize])
                .count();
            let open = edges.iter().any(|&e| self.edge_corners(e).len() < 2);
            // Three sheets and more that meet in a curve are no reason to stop the curve.
            let is_curve = odd == 2 && !open && faces > edges.len();
            if (is_corner && corners) || (self.odd_vertices[v as usize] && !is_curve) {
                self.vertex_sharpness[v as usize] = INFINITELY_SHARP;
            }
        }
    }

    /// Sharpness of the vertices and of both halves of every edge one level later.
    pub(in crate::subdiv) fn decayed(&self) -> (Vec<f32>, Vec<[f32; 2]>) {
        let vertices = self.vertex_sharpness.iter().map(|&s| decayed(s)).collect();
        let halves = self.edge_sharpness.iter().map(|&s| [decayed(s); 2]);
        let mut halves: Vec<[f32; 2]> = halves.collect();
        if self.creases == CreaseMethod::Chaikin {
            for v in 0..self.vertices as u32 {
                let next = decayed_around(&self.around(v), self.creases);
                for (&e, s) in self.vertex_edges(v).iter().zip(next) {
                    let end = usize::from(self.edges[e as usize][0] != v);
                    halves[e as usize][end] = s;
                }
            }
        }
        (vertices, halves)
    }
}

impl Level {
    /// Share of the sharp rule in the point of an edge that is sharp for a fraction of a
    /// level; 1 if a crease goes on on both sides.
    pub(in crate::subdiv) fn edge_share(&self, e: u32) -> f32 {
        let goes_on = |v: u32| {
            let next = decayed_around(&self.around(v), self.creases);
            let mut around = self.vertex_edges(v).iter().zip(next);
            around.any(|(&at, s)| at == e && s > 0.0)
        };
        let both = self.creases == CreaseMethod::Chaikin && self.edge(e).into_iter().all(goes_on);
        if both {
            1.0
        } else {
            self.edge_sharpness(e).min(1.0)
        }
    }

    /// The first and last sharp edge around `v`: of those sharp now, or of those still sharp
    /// one level later.
    pub(in crate::subdiv) fn crease_ends(&self, v: u32, later: bool) -> [u32; 2] {
        let mut around = self.around(v);
        if later {
            around = decayed_around(&around, self.creases);
        }
        let edges = self.vertex_edges(v);
        let first = around.iter().position(|&s| s > 0.0);
        let last = around.iter().rposition(|&s| s > 0.0);
        [first, last].map(|i| edges[i.unwrap_or(0)])
    }
}
