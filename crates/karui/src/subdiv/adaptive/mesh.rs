//! What a view gets.

use crate::mesh::{PolyMesh, TriMesh};

/// A cage refined where it is looked at.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct AdaptiveMesh {
    /// Faces of 3 or 4 corners, or as many as the cage has where nothing is split; normals
    /// of the limit surface. Where the surface has an edge that stays sharp, a vertex is
    /// there once a side.
    pub mesh: PolyMesh,
    /// Face of the cage that every face is part of; for one across an edge of the cage, the
    /// first of its two.
    pub parents: Vec<u32>,
    /// Number of √2 steps that have made every face.
    pub depths: Vec<u8>,
    /// Vertices that are one, but for normals and texture coordinates, have one number here,
    /// any others not: that of the cage's vertex, or if it is none a larger one.
    pub points: Vec<u32>,
    /// Whether more would have been split, but for
    /// [`AdaptiveOptions::max_faces`](super::AdaptiveOptions::max_faces).
    pub truncated: bool,
}

impl AdaptiveMesh {
    /// The same in triangles, in the same order.
    #[must_use]
    pub fn to_tri_mesh(&self) -> TriMesh {
        self.mesh.clone().triangulate()
    }

    /// Leaves nothing but the memory.
    pub(super) fn clear(&mut self) {
        let mesh = std::mem::take(&mut self.mesh);
        let mut normals = mesh.attributes.normals.unwrap_or_default();
        self.mesh.positions = mesh.positions;
        self.mesh.indices = mesh.indices;
        self.mesh.offsets = mesh.offsets;
        self.mesh.face_materials = mesh.face_materials;
        self.mesh.attributes.uvs = mesh.attributes.uvs;
        self.mesh.attributes.colors = mesh.attributes.colors;
        self.mesh.positions.clear();
        self.mesh.indices.clear();
        self.mesh.offsets.truncate(1);
        normals.clear();
        self.mesh.attributes.normals = Some(normals);
        self.parents.clear();
        self.depths.clear();
        self.points.clear();
    }
}
