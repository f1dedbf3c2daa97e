//! Meshes of polygons with any number of corners.

use super::TriMesh;
use super::attributes::{Attribute, Attributes};
use glam::Vec3;

/// An indexed polygon mesh; faces are stored one after the other.
#[derive(Debug, Clone, PartialEq)]
pub struct PolyMesh {
    /// Vertex positions, model units.
    pub positions: Vec<Vec3>,
    /// Vertex indices of all faces, counter-clockwise seen from outside.
    pub indices: Vec<u32>,
    /// Face `f` has the corners `indices[offsets[f]..offsets[f + 1]]`; one
    /// entry more than there are faces.
    pub offsets: Vec<u32>,
    /// Per-vertex attributes.
    pub attributes: Attributes,
    /// Per-face attributes.
    pub face_attributes: Vec<Attribute>,
    /// Material of every face; empty if none has one.
    pub face_materials: Vec<Option<u32>>,
}

impl Default for PolyMesh {
    fn default() -> Self {
        Self {
            positions: Vec::new(),
            indices: Vec::new(),
            offsets: vec![0],
            attributes: Attributes::default(),
            face_attributes: Vec::new(),
            face_materials: Vec::new(),
        }
    }
}

impl PolyMesh {
    /// Number of faces.
    #[must_use]
    pub fn face_count(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// Corners of face `f`.
    #[must_use]
    pub fn face(&self, f: usize) -> &[u32] {
        &self.indices[self.offsets[f] as usize..self.offsets[f + 1] as usize]
    }

    /// All faces in order.
    pub fn faces(&self) -> impl ExactSizeIterator<Item = &[u32]> {
        (0..self.face_count()).map(|f| self.face(f))
    }

    /// Appends a face.
    pub fn push_face(&mut self, corners: &[u32]) {
        self.indices.extend_from_slice(corners);
        self.offsets.push(self.indices.len() as u32);
    }
}

/// Triangles as polygons.
impl From<TriMesh> for PolyMesh {
    fn from(mesh: TriMesh) -> Self {
        let mut face_materials = Vec::new();
        for range in &mesh.ranges {
            face_materials.resize(face_materials.len() + range.count as usize, range.material);
        }
        Self {
            offsets: (0..=mesh.triangles.len()).map(|t| 3 * t as u32).collect(),
            indices: mesh.triangles.into_flattened(),
            positions: mesh.positions,
            attributes: mesh.attributes,
            face_attributes: mesh.face_attributes,
            face_materials,
        }
    }
}
