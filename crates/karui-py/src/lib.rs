//! The Python package `karui`: what the interpreter loads.
//!
//! Every function takes arrays apart, does its work without the GIL ([`progress::run`]) and puts
//! arrays together; what it means is in `karui` and `karui-io`.

mod arrays;
mod attributes;
mod camera;
mod choice;
mod errors;
mod hierarchy;
mod lod;
mod measure;
mod mesh;
mod plan;
mod progress;
mod render;
mod result;
mod saliency;
mod scene;
mod simplify;
mod subdiv;
mod whole_file;

/// Compiled part of karui; use `karui`.
#[pyo3::pymodule]
mod _karui {
    #[pymodule_export]
    use super::camera::Camera;
    #[pymodule_export]
    use super::hierarchy::{Change, Cut, Hierarchy};
    #[pymodule_export]
    use super::lod::{Level, lod};
    #[pymodule_export]
    use super::measure::{Distance, OneWay, measure, vertex_distances};
    #[pymodule_export]
    use super::mesh::Mesh;
    #[pymodule_export]
    use super::plan::Plan;
    #[pymodule_export]
    use super::render::render;
    #[pymodule_export]
    use super::result::Summary;
    #[pymodule_export]
    use super::saliency::{saliency, saliency_weights};
    #[pymodule_export]
    use super::scene::{Scene, read, write};
    #[pymodule_export]
    use super::simplify::{Simplified, simplify};
    #[pymodule_export]
    use super::subdiv::subdivide::subdivide;
    #[pymodule_export]
    use super::subdiv::{Adaptive, AdaptiveMesh, ControlMesh, Limits, Polygons, Refinement};

    /// Version of the package; workers of a cluster must have the same.
    #[pymodule_export]
    #[expect(non_upper_case_globals, reason = "that is its name in Python")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
