//! Half-edge connectivity of a manifold mesh with or without boundary.
//!
//! Topology only: vertices are numbers, whether vertex ids or position ids.
//! The two halves of edge `e` are `2 e` and `2 e + 1`. A half-edge without a
//! face lies on the boundary; `next` leads along the boundary loop there.

mod build;
mod check;
mod walk;

pub use walk::{FaceLoop, Ring};

/// A vertex of a [`Halfedge`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct VertexId(pub u32);

/// A directed half of an edge of a [`Halfedge`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct HalfedgeId(pub u32);

/// A face of a [`Halfedge`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FaceId(pub u32);

/// "No face" and "no half-edge" in the arrays.
const NONE: u32 = u32::MAX;

/// Half-edge connectivity. Every edge has one or two faces, which run through
/// it in opposite directions, and the faces around every vertex form one fan.
///
/// Ids given to the methods must come from the same object; others panic like
/// an index out of range.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Halfedge {
    origin: Vec<u32>,
    next: Vec<u32>,
    prev: Vec<u32>,
    face: Vec<u32>,
    /// Boundary half-edge if there is one, else the least.
    of_vertex: Vec<u32>,
    /// The one that starts at the face's first corner.
    of_face: Vec<u32>,
}

impl Halfedge {
    /// Number of vertices, isolated ones included.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.of_vertex.len()
    }

    /// Number of half-edges, twice the number of edges.
    #[must_use]
    pub fn halfedge_count(&self) -> usize {
        self.origin.len()
    }

    /// Number of edges.
    #[must_use]
    pub fn edge_count(&self) -> usize {
        self.origin.len() / 2
    }

    /// Number of faces.
    #[must_use]
    pub fn face_count(&self) -> usize {
        self.of_face.len()
    }

    /// The half-edge after `h` around its face or along its boundary loop.
    #[must_use]
    pub fn next(&self, h: HalfedgeId) -> HalfedgeId {
        HalfedgeId(self.next[h.0 as usize])
    }

    /// The half-edge before `h` around its face or along its boundary loop.
    #[must_use]
    pub fn prev(&self, h: HalfedgeId) -> HalfedgeId {
        HalfedgeId(self.prev[h.0 as usize])
    }

    /// The other half of the same edge.
    #[must_use]
    pub fn twin(&self, h: HalfedgeId) -> HalfedgeId {
        HalfedgeId(h.0 ^ 1)
    }

    /// The vertex `h` starts at.
    #[must_use]
    pub fn origin(&self, h: HalfedgeId) -> VertexId {
        VertexId(self.origin[h.0 as usize])
    }

    /// The vertex `h` ends at.
    #[must_use]
    pub fn target(&self, h: HalfedgeId) -> VertexId {
        self.origin(self.twin(h))
    }

    /// The face to the left of `h`; `None` on the boundary.
    #[must_use]
    pub fn face(&self, h: HalfedgeId) -> Option<FaceId> {
        let face = self.face[h.0 as usize];
        (face != NONE).then_some(FaceId(face))
    }

    /// Whether `h` has no face.
    #[must_use]
    pub fn is_boundary(&self, h: HalfedgeId) -> bool {
        self.face[h.0 as usize] == NONE
    }

    /// A half-edge that starts at `v`, the one without a face if there is one;
    /// `None` for an isolated vertex.
    #[must_use]
    pub fn halfedge_of_vertex(&self, v: VertexId) -> Option<HalfedgeId> {
        let h = self.of_vertex[v.0 as usize];
        (h != NONE).then_some(HalfedgeId(h))
    }

    /// The half-edge that starts at the first corner of `f`.
    #[must_use]
    pub fn halfedge_of_face(&self, f: FaceId) -> HalfedgeId {
        HalfedgeId(self.of_face[f.0 as usize])
    }

    /// Whether `v` lies on the boundary. An isolated vertex does not.
    #[must_use]
    pub fn is_boundary_vertex(&self, v: VertexId) -> bool {
        self.halfedge_of_vertex(v)
            .is_some_and(|h| self.is_boundary(h))
    }

    /// The half-edge from `a` to `b`, if there is such an edge.
    #[must_use]
    pub fn find(&self, a: VertexId, b: VertexId) -> Option<HalfedgeId> {
        self.ring(a).find(|&h| self.target(h) == b)
    }
}
