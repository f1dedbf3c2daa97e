//! What a file holds: meshes, materials and where they stand.

use super::{Image, Material, Placements, Texture, TriMesh};
use glam::{DMat4, Mat4, Quat, Vec3};
use std::{any::Any, fmt, sync::Arc};

/// Everything a model file holds.
///
/// Elements are named by index. Operations append elements and change meshes
/// in place but never reorder or remove elements, so that an index in an
/// [`Attachment`] keeps its meaning.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Scene {
    /// Meshes.
    pub meshes: Vec<NamedMesh>,
    /// Materials.
    pub materials: Vec<Material>,
    /// Textures.
    pub textures: Vec<Texture>,
    /// Images.
    pub images: Vec<Image>,
    /// Nodes of all trees.
    pub nodes: Vec<Node>,
    /// Root nodes of the scene shown by default.
    pub roots: Vec<u32>,
    /// What the reader wants a writer of the same format to see again: skins,
    /// animations, cameras, unknown extensions.
    pub attachment: Attachment,
}

/// A mesh and its name.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct NamedMesh {
    /// Name, if it has one.
    pub name: Option<String>,
    /// The mesh.
    pub mesh: TriMesh,
}

/// A node of the scene tree.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Node {
    /// Name, if it has one.
    pub name: Option<String>,
    /// Placement in the parent's space.
    pub transform: Transform,
    /// Index into [`Scene::meshes`].
    pub mesh: Option<u32>,
    /// Where in the node's space the mesh stands, if it does so any other way
    /// than once as it is. Children are not repeated.
    pub placements: Option<Arc<Placements>>,
    /// Index of the skin in the file it was read from.
    pub skin: Option<u32>,
    /// Indices into [`Scene::nodes`].
    pub children: Vec<u32>,
    /// Coarser stand-ins for this node (`MSFT_lod`).
    pub lods: Option<LodLinks>,
    /// What else the file says about this node.
    pub tie: NodeTie,
}

/// What else a file says about a node, so that it cannot simply be replaced by
/// another one.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum NodeTie {
    /// Nothing.
    #[default]
    None,
    /// Something moves it or hangs on it: an animation, a skin, a camera, a
    /// light. Its mesh may as well be on a child.
    Placement,
    /// An extension Karui does not model may be about its mesh.
    Mesh,
}

/// `MSFT_lod`: the nodes that may replace a node, finest first.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LodLinks {
    /// Indices into [`Scene::nodes`], the node itself not among them.
    pub nodes: Vec<u32>,
    /// `MSFT_screencoverage`: least share of the screen's height at which each
    /// level, the node itself first, is shown. May be empty.
    pub coverage: Vec<f32>,
}

/// Placement of a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Transform {
    /// Scale, then rotate, then translate.
    Trs {
        /// Translation.
        translation: Vec3,
        /// Unit rotation.
        rotation: Quat,
        /// Scale along each axis.
        scale: Vec3,
    },
    /// Any affine matrix.
    Matrix(Mat4),
}

impl Default for Transform {
    fn default() -> Self {
        Self::Trs {
            translation: Vec3::ZERO,
            rotation: Quat::IDENTITY,
            scale: Vec3::ONE,
        }
    }
}

impl Transform {
    /// As a matrix that takes the node's space to its parent's.
    #[must_use]
    pub fn matrix(&self) -> Mat4 {
        match *self {
            Self::Trs {
                translation,
                rotation,
                scale,
            } => Mat4::from_scale_rotation_translation(scale, rotation, translation),
            Self::Matrix(matrix) => matrix,
        }
    }

    /// [`Transform::matrix`] before it is rounded.
    #[must_use]
    pub fn matrix_f64(&self) -> DMat4 {
        match *self {
            Self::Trs {
                translation,
                rotation,
                scale,
            } => DMat4::from_scale_rotation_translation(
                scale.as_dvec3(),
                rotation.as_dquat(),
                translation.as_dvec3(),
            ),
            Self::Matrix(matrix) => matrix.as_dmat4(),
        }
    }
}

/// Data that only its creator understands; operations carry it untouched.
/// Two attachments are equal if they are the same object.
#[derive(Clone, Default)]
pub struct Attachment(Option<Arc<dyn Any + Send + Sync>>);

impl Attachment {
    /// Wraps `data`.
    #[must_use]
    pub fn new<T: Any + Send + Sync>(data: T) -> Self {
        Self(Some(Arc::new(data)))
    }

    /// The data, if there is any and it is a `T`.
    #[must_use]
    pub fn get<T: Any>(&self) -> Option<&T> {
        self.0.as_deref()?.downcast_ref()
    }
}

impl fmt::Debug for Attachment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let content = if self.0.is_some() { ".." } else { "none" };
        write!(f, "Attachment({content})")
    }
}

impl PartialEq for Attachment {
    fn eq(&self, other: &Self) -> bool {
        match (&self.0, &other.0) {
            (None, None) => true,
            (Some(a), Some(b)) => Arc::ptr_eq(a, b),
            _ => false,
        }
    }
}

impl Scene {
    /// A scene of one mesh under one root node.
    #[must_use]
    pub fn from_mesh(mesh: TriMesh) -> Self {
        Self {
            meshes: vec![NamedMesh { name: None, mesh }],
            nodes: vec![Node {
                mesh: Some(0),
                ..Node::default()
            }],
            roots: vec![0],
            ..Self::default()
        }
    }

    /// Triangles of all meshes, each mesh counted once.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.meshes.iter().map(|m| m.mesh.triangles.len()).sum()
    }

    /// For every node, whether it is a stand-in of another ([`Node::lods`]) or
    /// lies below one.
    #[must_use]
    pub fn stand_ins(&self) -> Vec<bool> {
        let mut found = vec![false; self.nodes.len()];
        let links = self.nodes.iter().filter_map(|n| n.lods.as_ref());
        let mut stack: Vec<u32> = links.flat_map(|l| l.nodes.iter().copied()).collect();
        while let Some(n) = stack.pop() {
            if let Some(seen @ false) = found.get_mut(n as usize) {
                *seen = true;
                stack.extend(&self.nodes[n as usize].children);
            }
        }
        found
    }
}
