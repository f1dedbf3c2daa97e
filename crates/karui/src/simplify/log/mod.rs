//! The log of a simplification: which vertices went into which, in order. It
//! gives every level between the input and the result, on the input or on
//! another mesh of the same connectivity.
//!
//! - H. Hoppe: Progressive Meshes, SIGGRAPH 1996 (there the other way, from the
//!   coarsest level up).
//! - A. Mohr, M. Gleicher: Deformation Sensitive Decimation, 2003, for why
//!   poses had better share one connectivity.

mod base;
pub(crate) mod bytes;
mod replay;
mod scene;

pub use replay::{Replay, Replayed};

pub(super) use base::Base;

use super::options::Stop;
use super::rounds::Collapse;
use crate::error::Result;
use crate::mesh::TriMesh;
use std::sync::Arc;

/// What [`simplify`](super::simplify) did, collapse by collapse; ask for it
/// with [`SimplifyOptions::log`](super::SimplifyOptions::log).
///
/// Order is that of the run: round by round, the cheapest first in each. So the
/// levels between are those that the run passed through; one that was run to
/// with smaller rounds is closer, most of all early on. The log of a chain
/// ([`simplify_chain`](super::simplify_chain)) has all levels of the chain as
/// they are. Logs of one chain share their memory: 24 bytes a collapse.
///
/// # Examples
/// ```
/// use karui::{mesh::shapes, simplify::{SimplifyOptions, Stop, simplify}};
///
/// let sphere = shapes::icosphere(4);
/// let coarse = simplify(&sphere, &SimplifyOptions {
///     stop: Stop::ratio(0.1),
///     log: true,
///     ..Default::default()
/// })?;
/// let log = coarse.log.ok_or(karui::Error::Empty { what: "log" })?;
///
/// // Any level between.
/// let half = log.level(&sphere, Stop::ratio(0.5))?;
/// assert_eq!(half.mesh.triangles.len(), sphere.triangles.len() / 2);
///
/// // What has become of vertex 7.
/// let vertex = log.map(&sphere)?[7];
/// assert!(vertex.is_some_and(|v| (v as usize) < coarse.mesh.positions.len()));
///
/// // The same triangles on another shape of the mesh.
/// let mut pose = sphere.clone();
/// pose.positions.iter_mut().for_each(|p| p.z *= 1.0 + p.x);
/// let posed = log.level(&pose, Stop::default())?;
/// assert_eq!(posed.mesh.triangles, coarse.mesh.triangles);
/// # Ok::<(), karui::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct CollapseLog {
    base: Arc<Base>,
    /// Of the whole chain.
    collapses: Arc<Vec<Collapse>>,
    /// How many of them are this log's.
    len: usize,
}

impl CollapseLog {
    /// Logs that end after so many collapses each.
    pub(super) fn chain(base: Base, collapses: Vec<Collapse>, ends: &[usize]) -> Vec<Self> {
        let (base, collapses) = (Arc::new(base), Arc::new(collapses));
        let log = |&len: &usize| Self {
            base: Arc::clone(&base),
            collapses: Arc::clone(&collapses),
            len,
        };
        ends.iter().map(log).collect()
    }

    /// Number of collapses.
    #[must_use]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether nothing collapsed.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Starts again from `mesh`, to stop at one level after another. If it is
    /// the mesh that the log is of, vertices go where they went; if it differs
    /// in positions (a pose, the target of a morph), where the surface of this
    /// mesh wants them. Attributes are those of `mesh`, mixed anew.
    ///
    /// # Errors
    /// What [`TriMesh::validate`] finds;
    /// [`Error::OtherMesh`](crate::Error::OtherMesh) for other vertices or
    /// triangles than the log's; [`Error::BadLog`](crate::Error::BadLog) for a
    /// log that was read and does not hold together.
    pub fn replay<'a>(&'a self, mesh: &'a TriMesh) -> Result<Replay<'a>> {
        Replay::new(self, mesh)
    }

    /// One level of `mesh`; at the end of the log if `stop` is never met. For
    /// several [`Self::replay`] is faster.
    ///
    /// # Errors
    /// As [`Self::replay`] and [`Replay::advance`].
    pub fn level(&self, mesh: &TriMesh, stop: Stop) -> Result<Replayed> {
        let mut replay = self.replay(mesh)?;
        replay.advance(&stop)?;
        replay.level()
    }

    /// For every vertex of `mesh` the vertex of the result that it has become
    /// part of; `None` for those that no triangle used. Where the result has
    /// several at one place because its normals were made anew, one of them.
    /// (Of another level: [`Replayed::map`].)
    ///
    /// # Errors
    /// As [`Self::level`].
    pub fn map(&self, mesh: &TriMesh) -> Result<Vec<Option<u32>>> {
        Ok(self.level(mesh, Stop::default())?.map)
    }

    pub(super) fn collapses(&self) -> &[Collapse] {
        &self.collapses[..self.len]
    }
}
