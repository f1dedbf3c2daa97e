//! Clusters of triangles in levels of detail: a graph whose every cut is the
//! whole surface without cracks.
//!
//! The mesh is split into clusters of about 128 triangles. Neighbouring clusters
//! are grouped, and each group is simplified to half of its triangles while
//! what it shares with other groups stays as it is; what comes of it is split
//! into clusters again, half as many. Groups of the next level are chosen so
//! that what was locked lies inside. So on, up to a root.
//!
//! All clusters of a group go together: error and sphere are the group's, they
//! grow from level to level, and so every cluster can decide alone whether it is
//! drawn: its own group must be good enough, the group that it was simplified in
//! must not be.
//!
//! - F. Ponchio: Multiresolution structures for interactive visualization of
//!   very large 3D datasets, 2008 (clusters and groups with dependent cuts).
//! - B. Karis, R. Stubbe, G. Wihlidal: A Deep Dive into Nanite Virtualized
//!   Geometry, SIGGRAPH 2021 courses.
//! - A. Kapoulkine: meshoptimizer, `demo/clusterlod.h` and `src/partition.cpp`.

mod angle;
mod bounds;
mod build;
mod bytes;
mod cut;
mod groups;
mod options;
mod patch;
mod source;
mod split;
mod validate;
mod view;

pub use bounds::{Bounds, Cone, Sphere};
pub use cut::Cut;
pub use options::ClusterDagOptions;
pub use view::{Detail, View};

use crate::error::Result;
use crate::mesh::TriMesh;
use std::ops::Range;

/// Clusters of a mesh at all levels of detail. Triangles are those of an index
/// buffer over the vertices of that mesh, which is not kept.
///
/// # Examples
/// ```
/// use karui::hierarchy::cluster::{ClusterDag, ClusterDagOptions};
/// use karui::mesh::shapes;
///
/// let sphere = shapes::icosphere(5);
/// let dag = ClusterDag::build(&sphere, &ClusterDagOptions::default())?;
/// assert_eq!(dag.input_triangles(), sphere.triangles.len());
/// assert!(dag.triangles_of_roots() * 50 < sphere.triangles.len());
/// # Ok::<(), karui::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ClusterDag {
    pub(super) clusters: Vec<Cluster>,
    pub(super) groups: Vec<Group>,
    /// Clusters of all groups, group by group.
    pub(super) members: Vec<u32>,
    /// Vertices of all clusters.
    pub(super) vertices: Vec<u32>,
    /// Triangles of all clusters, by number among the cluster's vertices.
    pub(super) corners: Vec<[u8; 3]>,
    /// Clusters that no group has, ascending.
    pub(super) roots: Vec<u32>,
    pub(super) input: Input,
    /// Attempts to simplify a group that failed.
    pub(super) stuck: u32,
}

/// What is remembered of the mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Input {
    pub vertices: u32,
    pub triangles: u32,
    /// Number of material ranges, at least 1.
    pub ranges: u32,
}

/// A few neighbouring triangles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cluster {
    /// Place of its first vertex among those of all clusters.
    pub first_vertex: u32,
    /// Place of its first triangle among those of all clusters.
    pub first_triangle: u32,
    /// Number of vertices, at most 255.
    pub vertices: u8,
    /// Number of triangles, at most 255; at least 1.
    pub triangles: u8,
    /// 0 for what is as in the mesh; else one more than the group's
    /// [`level`](Group::level).
    pub level: u16,
    /// Material range of the mesh.
    pub range: u32,
    /// Group that it was made of; none at level 0.
    pub own: Option<u32>,
    /// Group that it was simplified in; none for a root.
    pub parent: Option<u32>,
    /// Around its vertices.
    pub sphere: Sphere,
    /// Around the normals of its triangles.
    pub cone: Cone,
}

/// Clusters that were simplified together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Group {
    /// How far what was made of it is from the input, and where it is.
    pub bounds: Bounds,
    /// Place of its first cluster among those of all groups.
    pub first: u32,
    /// Number of clusters.
    pub count: u32,
    /// Highest level of its clusters.
    pub level: u16,
}

impl ClusterDag {
    /// Clusters of `mesh` and of ever coarser versions of it. The result is the
    /// same for any number of threads.
    ///
    /// Coarser clusters use vertices of `mesh` alone, attributes and all. Against
    /// new vertices where they fit best that makes the error larger, by 1.2 to
    /// 1.3 times on rough land and up to 3 times on a smooth sphere; that group
    /// borders are locked, by another tenth.
    /// Where normals break along nearly all edges (flat shading), triangles of
    /// coarser clusters have those of the vertices there that fit them best.
    ///
    /// Errors are accumulated: the largest of a group's clusters and how far
    /// simplification moved the group, both ways, measured at the vertices
    /// that are gone, the middles of the edges that are new and of triangles,
    /// and a tenth more for what lies between. That is no proof, but has been
    /// an upper bound of the distance to the mesh wherever it was measured.
    ///
    /// # Errors
    /// What [`TriMesh::validate`] finds, [`Error::BadOption`](crate::Error),
    /// [`Error::Cancelled`](crate::Error::Cancelled).
    pub fn build(mesh: &TriMesh, options: &ClusterDagOptions<'_>) -> Result<Self> {
        build::build(mesh, options)
    }

    /// All clusters; those of one group follow each other.
    #[must_use]
    pub fn clusters(&self) -> &[Cluster] {
        &self.clusters
    }

    /// All groups, finer ones before those that they are part of.
    #[must_use]
    pub fn groups(&self) -> &[Group] {
        &self.groups
    }

    /// Clusters that nothing coarser replaces, ascending.
    #[must_use]
    pub fn roots(&self) -> &[u32] {
        &self.roots
    }

    /// Clusters that were simplified together in a group, which must exist,
    /// ascending.
    #[must_use]
    pub fn members(&self, group: u32) -> &[u32] {
        let Group { first, count, .. } = self.groups[group as usize];
        &self.members[first as usize..(first + count) as usize]
    }

    /// What decides whether a cluster, which must exist, is good enough: error 0 and its own
    /// sphere and cone at level 0, else those of the group it was made of.
    #[must_use]
    pub fn own(&self, cluster: u32) -> Bounds {
        let cluster = &self.clusters[cluster as usize];
        match cluster.own {
            Some(group) => self.groups[group as usize].bounds,
            None => Bounds {
                error: 0.0,
                sphere: cluster.sphere,
                cone: cluster.cone,
            },
        }
    }

    /// What decides whether something coarser than a cluster is good enough:
    /// [`Bounds::NEVER`] for a root.
    #[must_use]
    pub fn parent(&self, cluster: u32) -> Bounds {
        match self.clusters[cluster as usize].parent {
            Some(group) => self.groups[group as usize].bounds,
            None => Bounds::NEVER,
        }
    }

    /// Vertices of a cluster, by number in the mesh, ascending.
    #[must_use]
    pub fn vertices_of(&self, cluster: u32) -> &[u32] {
        let c = &self.clusters[cluster as usize];
        &self.vertices[c.first_vertex as usize..][..usize::from(c.vertices)]
    }

    /// Triangles of a cluster, by number among its vertices.
    #[must_use]
    pub fn corners_of(&self, cluster: u32) -> &[[u8; 3]] {
        let c = &self.clusters[cluster as usize];
        &self.corners[c.first_triangle as usize..][..usize::from(c.triangles)]
    }

    /// Triangles of a cluster as an index buffer of the mesh.
    pub fn triangles_of(&self, cluster: u32) -> impl ExactSizeIterator<Item = [u32; 3]> + '_ {
        let vertices = self.vertices_of(cluster);
        let corners = self.corners_of(cluster).iter();
        corners.map(|t| t.map(|v| vertices[usize::from(v)]))
    }

    /// Triangles of the mesh it was built of.
    #[must_use]
    pub fn input_triangles(&self) -> usize {
        self.input.triangles as usize
    }

    /// Triangles of all roots: the coarsest cut.
    #[must_use]
    pub fn triangles_of_roots(&self) -> usize {
        let triangles = |&c: &u32| usize::from(self.clusters[c as usize].triangles);
        self.roots.iter().map(triangles).sum()
    }

    /// Number of levels: one more than the highest of any cluster; 0 without
    /// clusters.
    #[must_use]
    pub fn levels(&self) -> usize {
        let levels = self.clusters.iter().map(|c| usize::from(c.level) + 1);
        levels.max().unwrap_or(0)
    }

    /// How often a group could not be simplified. Its clusters then tried again
    /// with other neighbours, until all that were left were stuck.
    #[must_use]
    pub fn stuck(&self) -> usize {
        self.stuck as usize
    }

    /// Bytes in memory.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(&self.clusters[..])
            + size_of_val(&self.groups[..])
            + size_of_val(&self.members[..])
            + size_of_val(&self.vertices[..])
            + size_of_val(&self.corners[..])
            + size_of_val(&self.roots[..])
    }

    fn ids(&self) -> Range<u32> {
        0..self.clusters.len() as u32
    }
}
