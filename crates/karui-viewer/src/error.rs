//! What keeps a viewer from opening.

use std::io;
use std::path::PathBuf;

/// Why there is no viewer.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A model cannot be read.
    #[error(transparent)]
    Read(#[from] karui_io::Error),
    /// A model has nothing to show.
    #[error("{}: the model has no triangles", .0.display())]
    NoTriangles(PathBuf),
    /// A model cannot be sent to the page.
    #[error("{}: {error}", .path.display())]
    Model {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        error: karui_io::Error,
    },
    /// The folder of a tileset cannot be listed.
    #[error("{}: {error}", .path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// Why.
        error: io::Error,
    },
    /// The folder of a tileset holds more files than are kept track of.
    #[error("{}: more than {limit} files in the folder of the tileset", .path.display())]
    TooManyFiles {
        /// The folder.
        path: PathBuf,
        /// Files that would have been accepted.
        limit: usize,
    },
    /// Nothing can listen on the port.
    #[error("cannot listen on 127.0.0.1:{port}: {error}")]
    Listen {
        /// The port; 0 for any.
        port: u16,
        /// Why.
        error: io::Error,
    },
    /// The operating system has no random numbers.
    #[error("no random numbers for the token: {0}")]
    Random(String),
    /// The server ended on its own.
    #[error("the server stopped: {0}")]
    Serve(#[from] io::Error),
}

/// Shorthand for results of this crate.
pub type Result<T, E = Error> = std::result::Result<T, E>;
