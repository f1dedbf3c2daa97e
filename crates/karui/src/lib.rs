//! Karui decides how much detail of a 3D model is worth drawing, storing and
//! sending, and produces exactly that much, with errors that are measured.
//!
//! This crate holds geometry and algorithms only: no file formats, no network,
//! no printing. Files are read and written by `karui-io`.

pub mod error;
pub mod geom;
pub mod hierarchy;
pub mod hlod;
pub mod lod;
pub mod mesh;
pub mod metrics;
pub mod outofcore;
pub mod partition;
pub mod progress;
pub mod render;
pub mod saliency;
pub mod simplify;
pub mod spatial;
pub mod subdiv;

pub use error::{Error, Result};
pub use mesh::{PolyMesh, Scene, TriMesh};
pub use progress::{Progress, Silent};
pub use simplify::{SimplifyOptions, Stop, simplify, simplify_chain};
