//! Walks over half-edges: around vertices, around faces, along the boundary.

use super::{FaceId, Halfedge, HalfedgeId, NONE, VertexId};

/// The half-edges that leave a vertex; see [`Halfedge::ring`].
#[derive(Debug, Clone)]
pub struct Ring<'a> {
    topology: &'a Halfedge,
    first: Option<HalfedgeId>,
    current: Option<HalfedgeId>,
}

impl Iterator for Ring<'_> {
    type Item = HalfedgeId;

    fn next(&mut self) -> Option<HalfedgeId> {
        let current = self.current?;
        let following = self.topology.next(self.topology.twin(current));
        self.current = (Some(following) != self.first).then_some(following);
        Some(current)
    }
}

/// The half-edges of a face or a boundary loop; see [`Halfedge::loop_from`].
#[derive(Debug, Clone)]
pub struct FaceLoop<'a> {
    topology: &'a Halfedge,
    first: HalfedgeId,
    current: Option<HalfedgeId>,
}

impl Iterator for FaceLoop<'_> {
    type Item = HalfedgeId;

    fn next(&mut self) -> Option<HalfedgeId> {
        let current = self.current?;
        let following = self.topology.next(current);
        self.current = (following != self.first).then_some(following);
        Some(current)
    }
}

impl Halfedge {
    /// The half-edges that leave `v`, clockwise seen from outside. On the
    /// boundary the one without a face comes first, so the faces of the others
    /// form the fan in order.
    #[must_use]
    pub fn ring(&self, v: VertexId) -> Ring<'_> {
        let first = self.halfedge_of_vertex(v);
        Ring {
            topology: self,
            first,
            current: first,
        }
    }

    /// The neighbours of `v` in the order of [`Halfedge::ring`].
    pub fn neighbors(&self, v: VertexId) -> impl Iterator<Item = VertexId> {
        self.ring(v).map(|h| self.target(h))
    }

    /// The half-edges of the face or boundary loop of `h`, `h` first.
    #[must_use]
    pub fn loop_from(&self, h: HalfedgeId) -> FaceLoop<'_> {
        FaceLoop {
            topology: self,
            first: h,
            current: Some(h),
        }
    }

    /// The corners of `f`, its first corner first.
    pub fn face_vertices(&self, f: FaceId) -> impl Iterator<Item = VertexId> {
        self.loop_from(self.halfedge_of_face(f))
            .map(|h| self.origin(h))
    }

    /// One half-edge of every boundary loop, the least of each, in order.
    #[must_use]
    pub fn boundary_loops(&self) -> Vec<HalfedgeId> {
        let mut seen = vec![false; self.face.len()];
        let mut loops = Vec::new();
        for h in (0..self.face.len()).filter(|&h| self.face[h] == NONE) {
            if seen[h] {
                continue;
            }
            loops.push(HalfedgeId(h as u32));
            for member in self.loop_from(HalfedgeId(h as u32)) {
                seen[member.0 as usize] = true;
            }
        }
        loops
    }

    /// Euler characteristic: vertices that have edges - edges + faces.
    #[must_use]
    pub fn euler_characteristic(&self) -> i64 {
        let vertices = self.of_vertex.iter().filter(|&&h| h != NONE).count();
        vertices as i64 - self.edge_count() as i64 + self.face_count() as i64
    }
}
