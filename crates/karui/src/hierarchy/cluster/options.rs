//! What a caller may ask of a cluster DAG.

use crate::error::{Error, Result};
use crate::progress::{Progress, Silent};
use crate::simplify::{AttributeWeights, Border, Quality, Topology};
use std::fmt;

/// Options of [`ClusterDag::build`](super::ClusterDag::build).
#[derive(Clone, Copy)]
pub struct ClusterDagOptions<'a> {
    /// Most triangles of a cluster, 8 to 255. Default: 128.
    pub max_triangles: usize,
    /// Most vertices of a cluster, 8 to 255. Default: 255.
    pub max_vertices: usize,
    /// Most clusters of a group, 2 to 64; up to 128 where fewer cannot be
    /// simplified. More of them lock less of the surface but can only be refined
    /// together. Default: 24.
    pub group_size: usize,
    /// How groups are simplified. Default: [`Quality::Fast`].
    pub quality: Quality,
    /// Influence of each attribute on what is simplified away.
    pub attributes: AttributeWeights,
    /// What happens to open borders of the mesh. Default: [`Border::Preserve`].
    pub border: Border,
    /// Whether small parts may go, and holes and handles. The error tells how
    /// far they are from what is left. Default: [`Topology::Simplify`].
    pub topology: Topology,
    /// Told about the work and asked whether to go on.
    pub progress: &'a dyn Progress,
}

impl Default for ClusterDagOptions<'_> {
    fn default() -> Self {
        Self {
            max_triangles: 128,
            max_vertices: 255,
            group_size: 24,
            quality: Quality::Fast,
            attributes: AttributeWeights::default(),
            border: Border::Preserve,
            topology: Topology::Simplify,
            progress: &Silent,
        }
    }
}

impl fmt::Debug for ClusterDagOptions<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ClusterDagOptions")
            .field("max_triangles", &self.max_triangles)
            .field("max_vertices", &self.max_vertices)
            .field("group_size", &self.group_size)
            .field("quality", &self.quality)
            .field("attributes", &self.attributes)
            .field("border", &self.border)
            .field("topology", &self.topology)
            .finish_non_exhaustive()
    }
}

impl ClusterDagOptions<'_> {
    pub(super) fn check(&self) -> Result<()> {
        let small = 8..=255;
        let checks = [
            (
                "max_triangles",
                self.max_triangles,
                small.clone(),
                "8 to 255",
            ),
            ("max_vertices", self.max_vertices, small, "8 to 255"),
            ("group_size", self.group_size, 2..=64, "2 to 64"),
        ];
        match checks.iter().find(|c| !c.2.contains(&c.1)) {
            None => Ok(()),
            Some(&(option, found, _, expected)) => Err(Error::BadOption {
                option,
                found: found.to_string(),
                expected,
            }),
        }
    }
}
