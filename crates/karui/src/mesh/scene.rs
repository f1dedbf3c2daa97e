//! What a file holds: meshes, materials and where they stand.

use super::{Image, Material, Texture, TriMesh};
use crate::geom::Aabb;
use glam::{Mat4, Quat, Vec3};
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
    /// An extension Karui does not model may be about its mesh, as
    /// `EXT_mesh_gpu_instancing` is.
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

    /// Box around all placed meshes in the world's space; skins, which would
    /// move their meshes, are left aside.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        let placed = self.instances();
        let corners = placed.iter().flat_map(|&(n, world_from_mesh)| {
            let mesh = self.nodes[n as usize].mesh;
            let mesh = mesh.and_then(|m| self.meshes.get(m as usize));
            let positions = mesh.map_or(&[][..], |m| &m.mesh.positions);
            positions
                .iter()
                .map(move |&p| world_from_mesh.transform_point3(p))
        });
        Aabb::of(corners)
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

    /// Every placed mesh: node index and the matrix that takes the mesh's
    /// space to the world's, in depth-first order from the roots. A node is
    /// visited once even if a damaged tree names it twice.
    #[must_use]
    pub fn instances(&self) -> Vec<(u32, Mat4)> {
        let mut found = Vec::new();
        let mut seen = vec![false; self.nodes.len()];
        let mut stack: Vec<(u32, Mat4)> = Vec::new();
        stack.extend(self.roots.iter().rev().map(|&r| (r, Mat4::IDENTITY)));
        while let Some((n, world_from_parent)) = stack.pop() {
            let Some(node) = self.nodes.get(n as usize) else {
                continue;
            };
            if std::mem::replace(&mut seen[n as usize], true) {
                continue;
            }
            let world_from_node = world_from_parent * node.transform.matrix();
            if node.mesh.is_some() {
                found.push((n, world_from_node));
            }
            stack.extend(node.children.iter().rev().map(|&c| (c, world_from_node)));
        }
        found
    }
}
