//! Subdivision surfaces, for Python.

mod adaptive;
mod control_mesh;
mod options;
mod polygons;
mod refinement;
pub mod subdivide;

pub use adaptive::{Adaptive, AdaptiveMesh};
pub use control_mesh::ControlMesh;
pub use polygons::Polygons;
pub use refinement::{Limits, Refinement};
