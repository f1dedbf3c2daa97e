//! A stand-in and what is known of it.

use super::{Look, Member, Objects};
use crate::geom::{DMat4, DVec3};
use crate::mesh::{ImageData, Scene, TriMesh};
use crate::render::Picture;

/// Name of the vertex attribute that tells objects apart (`EXT_mesh_features`):
/// one `u32` a vertex, the same at all corners of a triangle.
pub const FEATURE_ID: &str = "_FEATURE_ID_0";

/// Id of what stands for several objects at once and can tell none of them.
pub const NO_OBJECT: u32 = u32::MAX;

/// How a stand-in was made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum ProxyKind {
    /// By [`box_proxy`](super::box_proxy()).
    Box,
    /// By [`impostor`](super::impostor()).
    Impostor,
    /// By [`merged`](super::merged()).
    Merged,
}

/// A stand-in for a group.
#[derive(Debug, Clone, PartialEq)]
pub struct Proxy {
    /// How it was made.
    pub kind: ProxyKind,
    /// Where the origin of its scene lies in the world: positions are relative to
    /// it, so that `f32` holds them wherever the group is.
    pub origin: DVec3,
    /// The stand-in alone: one mesh under one node at the origin, and what it
    /// needs; images are [`ImageData::Pixels`].
    pub scene: Scene,
    /// Largest distance between it and the members' original surfaces, world
    /// units: measured against the members given, to which their own errors are
    /// added, so that it is at least each of theirs.
    pub error: f64,
    /// Memory that its vertices, indices and images take, without smaller copies
    /// of the images; bytes.
    pub bytes: usize,
    /// How different it looks from the members, if [`choose`](super::choose())
    /// has looked.
    pub image_error: Option<f64>,
    /// Whether its texture is coarser than was asked for, being as large as it may.
    pub coarser: bool,
}

impl Proxy {
    pub(super) fn new(kind: ProxyKind, origin: DVec3, scene: Scene, error: f64) -> Self {
        Self {
            kind,
            origin,
            bytes: bytes(&scene),
            scene,
            error,
            image_error: None,
            coarser: false,
        }
    }

    /// Its mesh, in world units around [`Proxy::origin`].
    #[must_use]
    pub fn mesh(&self) -> &TriMesh {
        &self.scene.meshes[0].mesh
    }

    /// Number of triangles.
    #[must_use]
    pub fn triangles(&self) -> usize {
        self.scene.triangle_count()
    }

    /// Its images as pictures, for [`Look::of_scene`] and for rendering.
    #[must_use]
    pub fn pictures(&self) -> Vec<Option<Picture>> {
        let picture = |data: &ImageData| match data {
            ImageData::Pixels { width, pixels } => {
                let height = pixels.len() / (*width).max(1) as usize;
                Picture::new(*width, height as u32, pixels.to_vec()).ok()
            }
            ImageData::Bytes { .. } | ImageData::Missing { .. } => None,
        };
        self.scene.images.iter().map(|i| picture(&i.data)).collect()
    }

    /// As a member of a larger group; `look` is that of its scene and its pictures.
    #[must_use]
    pub fn member<'a>(&'a self, look: &'a Look<'a>) -> Member<'a> {
        Member {
            mesh: self.mesh(),
            world_from_mesh: DMat4::from_translation(self.origin),
            look,
            objects: Objects::OfVertices,
            error: self.error,
        }
    }
}

fn bytes(scene: &Scene) -> usize {
    let meshes = scene.meshes.iter().map(|m| mesh_bytes(&m.mesh));
    let images = scene.images.iter().map(|image| match &image.data {
        ImageData::Pixels { pixels, .. } => 4 * pixels.len(),
        ImageData::Bytes { bytes, .. } => bytes.len(),
        ImageData::Missing { .. } => 0,
    });
    meshes.chain(images).sum()
}

pub(super) fn mesh_bytes(mesh: &TriMesh) -> usize {
    let attributes = &mesh.attributes;
    let vertex = 12
        + if attributes.normals.is_some() { 12 } else { 0 }
        + 8 * attributes.uvs.len()
        + 4 * attributes.colors.len()
        + 4 * attributes.custom.len();
    let index = if mesh.positions.len() <= 1 << 16 {
        2
    } else {
        4
    };
    mesh.positions.len() * vertex + mesh.triangles.len() * 3 * index
}
