//! Where a surface draws the eye: curvature and saliency of every vertex.
//!
//! - G. Taubin: Estimating the Tensor of Curvature of a Surface from a
//!   Polyhedral Approximation, ICCV 1995.
//! - L. Itti, C. Koch, E. Niebur: A Model of Saliency-Based Visual Attention for
//!   Rapid Scene Analysis, PAMI 1998.
//! - N. Max: Weights for Computing Vertex Normals from Facet Normals, Journal of
//!   Graphics Tools 4(2), 1999.
//! - C. H. Lee, A. Varshney, D. W. Jacobs: Mesh Saliency, SIGGRAPH 2005.
//! - An Guangming: master's thesis, Tokyo University of Technology, 2014.

mod curvature;
mod gauss;
mod hybrid;
mod image;
mod kind;
mod mesh;
mod preset;
mod quantile;
mod smooth;
mod stars;
mod views;
mod weight;

pub use curvature::{
    Curvature, CurvatureOptions, Estimator, curvature, curvature_sizes, curvature_with,
};
pub use hybrid::{Class, Hybrid, HybridOptions, hybrid};
pub use image::{ImageSaliency, ImageSaliencyOptions, Opponency, SaliencyMap, image_saliency};
pub use kind::Kind;
pub use mesh::{MeshSaliencyOptions, Suppression, mesh_saliency, mesh_saliency_observed};
pub use preset::Preset;
pub use smooth::{SMOOTHING, smooth};
pub use views::{MultiView, MultiViewOptions, Unseen, ViewLights, Views, multi_view};
pub use weight::WeightMap;
