//! Connectivity of the next level. Vertices of the parent keep their numbers.

mod quads;
mod triangles;

use super::level::{Faces, Level, Rings};

/// How faces are divided, and whether anything moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Kind {
    /// Triangles into four triangles rather than n-gons into n quads.
    pub triangles: bool,
    /// New vertices are means of old ones, which stay.
    pub linear: bool,
}

/// The parts that a way of splitting decides.
struct Child {
    vertices: usize,
    faces: Faces,
    corners: Vec<u32>,
    corner_edges: Vec<u32>,
    edges: Vec<[u32; 2]>,
    /// Children of every face.
    holes: Vec<bool>,
    /// Number of the first edge point.
    first_edge_point: usize,
}

impl Kind {
    pub const CATMULL_CLARK: Self = Self {
        triangles: false,
        linear: false,
    };
}

impl Level {
    /// The next level. Rings are found only if `complete`: the last level needs none unless
    /// its limits are asked for.
    pub(super) fn refined(&self, kind: Kind, complete: bool) -> Self {
        let child = if kind.triangles {
            self.triangles()
        } else {
            self.quads()
        };
        let (mut vertex_sharpness, halves) = self.decayed();
        vertex_sharpness.resize(child.vertices, 0.0);
        let inside = child.edges.len() - 2 * self.edges.len();
        let mut edge_sharpness = vec![0.0; inside];
        edge_sharpness.extend(halves.as_flattened());
        let mut odd_edges = vec![false; inside];
        odd_edges.extend(self.odd_edges.iter().flat_map(|&odd| [odd; 2]));
        let mut odd_vertices = self.odd_vertices.clone();
        odd_vertices.resize(child.first_edge_point, false);
        odd_vertices.extend(&self.odd_edges);
        let mut level = Self {
            vertices: child.vertices,
            faces: child.faces,
            corners: child.corners,
            corner_edges: child.corner_edges,
            edges: child.edges,
            edge_sharpness,
            vertex_sharpness,
            odd_edges,
            odd_vertices,
            holes: child.holes,
            rings: Rings::default(),
            rules: Vec::new(),
            creases: self.creases,
            triangles: self.triangles,
            linear_boundaries: self.linear_boundaries,
            dependents: self.dependents.clone(),
        };
        if self.linear_boundaries {
            level.pin_edge_points(self, child.first_edge_point);
        }
        if complete {
            level.build_rings();
            level.find_rules();
        }
        level
    }

    /// Keeps the new vertices of boundaries where they are.
    fn pin_edge_points(&mut self, parent: &Self, first: usize) {
        for e in 0..parent.edges.len() {
            if parent.edge_corners(e as u32).len() < 2 {
                self.vertex_sharpness[first + e] = super::cage::INFINITELY_SHARP;
            }
        }
    }

    /// Which of the two halves of `e` is at the corner that `e` leaves (`true`) or enters.
    fn half(&self, e: u32, vertex: u32, leaves: bool) -> u32 {
        let [a, b] = self.edges[e as usize];
        if a == b {
            u32::from(!leaves)
        } else {
            u32::from(a != vertex)
        }
    }
}
