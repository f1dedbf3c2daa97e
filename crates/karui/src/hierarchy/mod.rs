//! Detail where the camera and the light need it: a mesh is prepared once, then
//! refined frame by frame.
//!
//! - H. Miyamura, M. Imai: view- and lighting-dependent simplification on
//!   half-edge hierarchies.
//! - R. Pajarola: FastMesh: Efficient View-dependent Meshing, Pacific Graphics 2001.
//! - H. Hoppe: View-Dependent Refinement of Progressive Meshes, SIGGRAPH 1997.
//! - R. Klein, A. Schilling: Efficient rendering of multiresolution meshes with
//!   guaranteed image quality, 1999 (lights).

mod build;
mod bytes;
mod check;
pub mod cluster;
mod criteria;
mod cut;
mod facing;
mod node;
mod options;
mod order;
mod surface;

pub use bytes::checksum;
pub use criteria::{Criteria, Keep, Prepared, Silhouette, Vantage, ViewAndLight, Way};
pub use cut::{Budget, Change, Cut, Glide, Gliding};
pub use node::Bounds;
pub use options::{BuildCounts, HierarchyOptions};

use crate::geom::Aabb;
use crate::mesh::TriMesh;
use bytemuck::cast_slice;
use node::Node;
use surface::{NONE, Surface};

/// A mesh prepared for refinement: its half-edge collapses, and which of them
/// must come before which. Immutable; any number of [`Cut`]s share it.
///
/// Vertices are those of the mesh it was built from, which it does not hold.
///
/// # Examples
/// ```
/// use karui::geom::{Camera, Vec3};
/// use karui::hierarchy::{Budget, Hierarchy, HierarchyOptions, ViewAndLight};
/// use karui::mesh::shapes;
///
/// let mesh = shapes::icosphere(5);
/// let hierarchy = Hierarchy::build(&mesh, &HierarchyOptions::default())?;
/// let mut cut = hierarchy.coarsest(); // all state of one view
/// let criteria = ViewAndLight {
///     camera: Camera::looking_at(mesh.bounds(), Vec3::Z, 0.7),
///     area: 100.0, // square pixels
///     ..ViewAndLight::default()
/// };
/// let change = cut.refine(&criteria, Budget::UNLIMITED)?;
/// assert_eq!(change.triangles, cut.indices().len());
/// assert!(change.triangles < mesh.triangles.len());
/// # Ok::<(), karui::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Hierarchy {
    /// Vertices of the mesh.
    vertices: usize,
    /// All faces, none hidden.
    surface: Surface,
    /// Triangle of the mesh that every face is.
    triangle_of_face: Vec<u32>,
    /// The collapses in the order in which they were found.
    nodes: Vec<Node>,
    /// What waits for each node but its parent, node after node.
    dependents: Vec<u32>,
    /// Box around the mesh.
    bounds: Aabb,
    mesh: MeshHash,
    counts: BuildCounts,
}

/// Tells one mesh from another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct MeshHash {
    triangles: u64,
    positions: u64,
}

impl MeshHash {
    fn of(mesh: &TriMesh) -> Self {
        let little =
            |words: &[u32]| -> Vec<u8> { words.iter().flat_map(|w| w.to_le_bytes()).collect() };
        Self {
            triangles: checksum(&little(mesh.triangles.as_flattened())),
            positions: checksum(&little(cast_slice(&mesh.positions))),
        }
    }
}

impl Hierarchy {
    /// Number of collapses.
    #[must_use]
    pub fn node_count(&self) -> usize {
        self.nodes.len()
    }

    /// Number of triangles of the finest mesh.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.triangle_of_face.len()
    }

    /// Number of vertices of the mesh it was built from.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.vertices
    }

    /// Whether it was built from this mesh: the same triangles and positions.
    #[must_use]
    pub fn is_of(&self, mesh: &TriMesh) -> bool {
        mesh.positions.len() == self.vertices && self.mesh == MeshHash::of(mesh)
    }

    /// Box around the mesh, model units.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// What the build found and did.
    #[must_use]
    pub fn counts(&self) -> BuildCounts {
        self.counts
    }

    /// Bytes that the nodes and their order take.
    #[must_use]
    pub fn node_bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice()) + size_of_val(self.dependents.as_slice())
    }

    /// What every node covers, in the order of the collapses.
    pub fn node_bounds(&self) -> impl Iterator<Item = Bounds> {
        self.nodes.iter().map(|n| n.cover.bounds())
    }

    /// What waits for `node`, its parent excluded.
    #[inline]
    fn dependents(&self, node: u32) -> &[u32] {
        let first = |i: usize| {
            self.nodes
                .get(i)
                .map_or(self.dependents.len(), |n| n.first_dependent as usize)
        };
        &self.dependents[first(node as usize)..first(node as usize + 1)]
    }

    /// All that waits for `node`.
    #[inline]
    fn waiting(&self, node: u32) -> impl Iterator<Item = u32> {
        let parent = self.nodes[node as usize].parent;
        let parent = (parent != NONE).then_some(parent);
        self.dependents(node).iter().copied().chain(parent)
    }
}
