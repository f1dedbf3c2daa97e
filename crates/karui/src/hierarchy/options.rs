//! What a caller may ask of a hierarchy.

use crate::progress::{Progress, Silent};
use std::fmt;

/// Options of [`Hierarchy::build`](super::Hierarchy::build).
#[derive(Clone, Copy)]
pub struct HierarchyOptions<'a> {
    /// The hierarchy goes down to one in `alpha` of the vertices, `>= 1`;
    /// infinity goes as far as can be. Default: 10, as published.
    pub alpha: f64,
    /// One weight a vertex, `>= 0`; 1 is neutral, a larger one keeps detail.
    pub weights: Option<&'a [f32]>,
    /// Vertices that do not vanish.
    pub locks: Option<&'a [bool]>,
    /// Told about the work and asked whether to go on.
    pub progress: &'a dyn Progress,
}

impl Default for HierarchyOptions<'_> {
    fn default() -> Self {
        Self {
            alpha: 10.0,
            weights: None,
            locks: None,
            progress: &Silent,
        }
    }
}

impl fmt::Debug for HierarchyOptions<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("HierarchyOptions")
            .field("alpha", &self.alpha)
            .field("weights", &self.weights.map(<[f32]>::len))
            .field("locks", &self.locks.map(<[bool]>::len))
            .finish_non_exhaustive()
    }
}

/// What a build found and did.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct BuildCounts {
    /// Triangles left out: without three different positions, or exact duplicates.
    pub dropped: usize,
    /// Edges cut open because more than two triangles meet there, or two in the
    /// same direction.
    pub split_edges: usize,
    /// Positions whose triangles were taken apart into several fans. They never
    /// vanish, so that no crack opens.
    pub split_vertices: usize,
    /// Triangles of the coarsest mesh.
    pub coarsest: usize,
}
