//! What can go wrong with a model that is not in memory.

use std::{io, path::PathBuf};

/// What can go wrong with a model that is not in memory.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The input could not be read, or says what cannot be; the cause names file and place.
    #[error(transparent)]
    Source(Box<dyn std::error::Error + Send + Sync>),
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} uses vertex {index}, but there are only {vertices} vertices")]
    IndexOutOfRange {
        /// Number of the triangle in the whole model.
        triangle: u64,
        /// The offending vertex.
        index: u64,
        /// Vertices of the whole model.
        vertices: u64,
    },
    /// A position is NaN or infinite.
    #[error("the position of vertex {vertex} is not finite")]
    NotFinite {
        /// Number of the vertex in the whole model.
        vertex: u64,
    },
    /// A slice of the input holds another number of vertices than was asked for.
    #[error("vertices {first}..{end} were asked for, but {found} came")]
    ShortSlice {
        /// First vertex.
        first: u64,
        /// One past the last.
        end: u64,
        /// Vertices that came.
        found: u64,
    },
    /// A file of the block store could not be read or written.
    #[error("{}: {cause}", path.display())]
    Store {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        cause: io::Error,
    },
    /// What should be in the block store is not.
    #[error("`{name}` is not in the store")]
    Missing {
        /// Its name.
        name: String,
    },
    /// What is in the block store is not what was put there.
    #[error("`{name}` is damaged: {problem}")]
    Damaged {
        /// Its name.
        name: String,
        /// What is wrong.
        problem: &'static str,
    },
    /// A manifest or a plan cannot be understood.
    #[error("`{name}`, line {line}: {problem}")]
    Manifest {
        /// Name of the manifest.
        name: String,
        /// Line, from 1.
        line: usize,
        /// What is wrong.
        problem: String,
    },
    /// A manifest has no such row.
    #[error("there is no row {row}; rows are 0 to {}", rows.saturating_sub(1))]
    NoRow {
        /// The number asked for.
        row: u64,
        /// Rows that there are.
        rows: u64,
    },
    /// A phase cannot be closed: a row has no result.
    #[error("row {row} of {rows} has no result")]
    NotDone {
        /// The first such row.
        row: u64,
        /// Rows that there are.
        rows: u64,
    },
    /// The store holds the work on another model, or with other options.
    #[error("the store holds another plan: its {what} is {found}, not {expected}")]
    OtherPlan {
        /// What differs.
        what: &'static str,
        /// In the store.
        found: String,
        /// Asked for.
        expected: String,
    },
    /// The result could not be written.
    #[error(transparent)]
    Sink(Box<dyn std::error::Error + Send + Sync>),
    /// An operation on a block in memory failed, or was cancelled.
    #[error(transparent)]
    Block(#[from] crate::Error),
}

impl Error {
    /// Names the file or object that would have to be made anew, if that would help.
    #[must_use]
    pub fn lost(&self) -> Option<&str> {
        match self {
            Self::Missing { name } | Self::Damaged { name, .. } => Some(name),
            _ => None,
        }
    }
}

/// Shorthand of this module.
pub type Result<T> = std::result::Result<T, Error>;
