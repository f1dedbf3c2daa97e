//! Where a surface draws the eye: curvature and saliency of every vertex.
//!
//! - G. Taubin: Estimating the Tensor of Curvature of a Surface from a
//!   Polyhedral Approximation, ICCV 1995.
//! - C. H. Lee, A. Varshney, D. W. Jacobs: Mesh Saliency, SIGGRAPH 2005.
//! - An Guangming: master's thesis, Tokyo University of Technology, 2014.

mod curvature;
mod gauss;
mod mesh;
mod quantile;
mod stars;
mod weight;

pub use curvature::{Curvature, curvature};
pub use mesh::{MeshSaliencyOptions, Suppression, mesh_saliency};
pub use weight::WeightMap;
