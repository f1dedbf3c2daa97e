//! What a frame may cost, and what it did.

use std::ops::Range;
use std::time::Duration;

/// What a frame may cost at most.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Budget {
    /// Triangles. Of what the criteria keep, that stays which is largest on the
    /// screen; still the same camera gives the same mesh.
    pub triangles: Option<usize>,
    /// Time. What is largest on the screen comes first; what is left over waits
    /// for the next frame, so that the mesh depends on the path.
    pub time: Option<Duration>,
}

impl Budget {
    /// As much as the criteria ask for.
    pub const UNLIMITED: Self = Self {
        triangles: None,
        time: None,
    };

    /// At most this many triangles.
    #[must_use]
    pub fn triangles(triangles: usize) -> Self {
        Self {
            triangles: Some(triangles),
            time: None,
        }
    }

    /// At most about this much time.
    #[must_use]
    pub fn time(time: Duration) -> Self {
        Self {
            triangles: None,
            time: Some(time),
        }
    }
}

/// What a frame has changed.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Change {
    /// Ranges of [`Cut::indices`](super::Cut::indices) that are new, in order and
    /// apart: what is to be uploaded.
    pub ranges: Vec<Range<u32>>,
    /// Triangles to draw: the length of the index buffer now.
    pub triangles: usize,
    /// Collapses undone.
    pub splits: usize,
    /// Collapses applied.
    pub collapses: usize,
    /// Nodes that criteria were asked about.
    pub tests: usize,
    /// Whether all was done that the criteria asked for. With a budget in
    /// triangles it may not be even so: `floor` tells.
    pub complete: bool,
    /// Square pixels below which the budget has left out what the criteria would
    /// have kept; 0 if it has left out nothing.
    pub floor: f64,
    /// Time taken by tests and changes.
    pub time: Duration,
}
