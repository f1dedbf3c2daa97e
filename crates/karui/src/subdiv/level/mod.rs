//! Connectivity and sharpness of one level: what every scheme refines and every mask reads.
//!
//! Edges are numbered by first appearance along the faces. A refined level has, in this
//! order, the vertices of its parent, its face points and its edge points; its edges are
//! those inside the parent's faces, one a corner, then two for every parent's edge; its
//! faces are one a corner. This is OpenSubdiv's order.

mod edges;
mod faces;
mod rings;
mod rows;
mod sharpness;

pub(super) use edges::of_faces as edges_of_faces;
pub use faces::Faces;
pub(super) use rings::Rings;
pub(super) use rows::Rows;

use super::cage::Cage;
use super::crease::{Around, Blend, Rule, blend};
use super::options::{CreaseMethod, SubdivOptions, TriangleRule};
use crate::error::Result;

/// Connectivity and sharpness of one level.
#[derive(Debug, Clone, PartialEq)]
pub struct Level {
    pub(super) vertices: usize,
    pub(super) faces: Faces,
    /// Vertex of every corner.
    pub(super) corners: Vec<u32>,
    /// Edge from every corner to the next of its face.
    pub(super) corner_edges: Vec<u32>,
    pub(super) edges: Vec<[u32; 2]>,
    pub(super) edge_sharpness: Vec<f32>,
    pub(super) vertex_sharpness: Vec<f32>,
    /// Edges that are not one face's end or two faces' seam in one sense, and vertices that
    /// are not one fan or ring.
    pub(super) odd_edges: Vec<bool>,
    pub(super) odd_vertices: Vec<bool>,
    /// Faces left out of the result; empty if there are none.
    pub(super) holes: Vec<bool>,
    pub(super) rings: Rings,
    /// What every vertex is at this level.
    pub(super) rules: Vec<Rule>,
    pub(super) creases: CreaseMethod,
    pub(super) triangles: TriangleRule,
    /// Whether new vertices of boundaries stay where they are.
    pub(super) linear_boundaries: bool,
    /// Vertices that are as sharp as another one, in order.
    pub(super) dependents: Vec<[u32; 2]>,
}

impl Level {
    /// Connectivity of a cage, boundaries and what is not manifold made sharp.
    ///
    /// # Errors
    /// As [`Cage::validate`].
    pub fn of_cage(cage: &Cage, options: &SubdivOptions) -> Result<Self> {
        cage.validate()?;
        let faces = Faces::of_offsets(&cage.offsets);
        let found = edges_of_faces(&faces, &cage.indices);
        let mut level = Self {
            vertices: cage.vertices,
            faces,
            corners: cage.indices.clone(),
            corner_edges: found.corner_edges,
            edge_sharpness: vec![0.0; found.edges.len()],
            vertex_sharpness: vec![0.0; cage.vertices],
            odd_vertices: vec![false; cage.vertices],
            edges: found.edges,
            odd_edges: found.odd,
            holes: Vec::new(),
            rings: Rings::default(),
            rules: Vec::new(),
            creases: options.creases,
            triangles: options.triangles,
            linear_boundaries: false,
            dependents: Vec::new(),
        };
        for (edge, _) in level.odd_edges.iter().enumerate().filter(|(_, odd)| **odd) {
            let ends = level.edges[edge];
            for v in ends {
                level.odd_vertices[v as usize] = true;
            }
        }
        level.build_rings();
        level.apply_tags(cage, options.boundary)?;
        level.find_rules();
        Ok(level)
    }

    /// Number of vertices.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.vertices
    }

    /// Number of edges.
    #[must_use]
    pub fn edge_count(&self) -> usize {
        self.edges.len()
    }

    /// The faces as ranges of corners.
    #[must_use]
    pub fn faces(&self) -> &Faces {
        &self.faces
    }

    /// Vertex of every corner.
    #[must_use]
    pub fn corners(&self) -> &[u32] {
        &self.corners
    }

    /// Edge from every corner to the next one of its face.
    #[must_use]
    pub fn corner_edges(&self) -> &[u32] {
        &self.corner_edges
    }

    /// The ends of edge `e`.
    #[must_use]
    pub fn edge(&self, e: u32) -> [u32; 2] {
        self.edges[e as usize]
    }

    /// Corners at which edge `e` starts in their faces: one at a boundary, else two.
    #[must_use]
    pub fn edge_corners(&self, e: u32) -> &[u32] {
        self.rings.edge_corners.row(e as usize)
    }

    /// Corners at vertex `v`, counter-clockwise where the surface is a manifold; at a
    /// boundary the first one's edge is the first boundary edge.
    #[must_use]
    pub fn vertex_corners(&self, v: u32) -> &[u32] {
        self.rings.vertex_corners.row(v as usize)
    }

    /// Edges at vertex `v`, in the order of its corners.
    #[must_use]
    pub fn vertex_edges(&self, v: u32) -> &[u32] {
        self.rings.vertex_edges.row(v as usize)
    }

    /// Sharpness of edge `e`.
    #[must_use]
    pub fn edge_sharpness(&self, e: u32) -> f32 {
        self.edge_sharpness[e as usize]
    }

    /// Own sharpness of vertex `v`.
    #[must_use]
    pub fn vertex_sharpness(&self, v: u32) -> f32 {
        self.vertex_sharpness[v as usize]
    }

    /// What vertex `v` is at this level.
    #[must_use]
    pub fn rule(&self, v: u32) -> Rule {
        self.rules[v as usize]
    }

    /// Whether face `f` is left out of the result.
    #[must_use]
    pub fn is_hole(&self, f: usize) -> bool {
        self.holes.get(f).copied().unwrap_or(false)
    }

    /// Whether every face has this number of corners.
    #[must_use]
    pub fn is_uniform(&self, size: u32) -> bool {
        self.faces.size() == Some(size)
    }

    /// The end of `e` that is not `v`.
    pub(super) fn other_end(&self, e: u32, v: u32) -> u32 {
        let [a, b] = self.edges[e as usize];
        if a == v { b } else { a }
    }

    /// Sharpness of the edges around `v`.
    pub(super) fn around(&self, v: u32) -> Around {
        let edges = self.vertex_edges(v).iter();
        edges.map(|&e| self.edge_sharpness[e as usize]).collect()
    }

    /// How `v` goes through the next step.
    #[must_use]
    pub fn blend(&self, v: u32) -> Blend {
        if let Ok(found) = self.dependents.binary_search_by_key(&v, |d| d[0]) {
            let other = self.own_blend(self.dependents[found][1]);
            if other.before == Rule::Corner {
                return other;
            }
        }
        self.own_blend(v)
    }

    fn own_blend(&self, v: u32) -> Blend {
        if self.rules[v as usize] == Rule::Smooth {
            return Blend {
                before: Rule::Smooth,
                after: Rule::Smooth,
                share: 1.0,
            };
        }
        blend(self.vertex_sharpness(v), &self.around(v), self.creases)
    }

    pub(super) fn find_rules(&mut self) {
        let rule = |v| Rule::of(self.vertex_sharpness[v as usize], &self.around(v));
        self.rules = (0..self.vertices as u32).map(rule).collect();
    }
}
