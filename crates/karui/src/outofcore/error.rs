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
    /// A file of the block store could not be read or written.
    #[error("{}: {cause}", path.display())]
    Store {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        cause: io::Error,
    },
    /// An operation on a block in memory failed, or was cancelled.
    #[error(transparent)]
    Block(#[from] crate::Error),
}

/// Shorthand of this module.
pub type Result<T> = std::result::Result<T, Error>;
