//! Pictures of meshes, the same to the bit on every machine.
//!
//! A rasteriser on the CPU. Vertices are rounded to 1/256 of a sample, so that
//! which samples a triangle covers is decided by integers; the closest triangle
//! is kept for every sample, the lower number at the same distance; what is seen
//! is shaded afterwards, once. Bands of rows are drawn in parallel and do not
//! know of each other.
//!
//! ```
//! use karui::geom::{Camera, Light, Vec3};
//! use karui::{mesh::shapes, render::{RenderOptions, Renderer}};
//!
//! # fn main() -> karui::Result<()> {
//! let mesh = shapes::torus(1.0, 0.3, 64, 32);
//! let renderer = Renderer::of_mesh(&mesh)?;
//! let camera = Camera::looking_at(renderer.bounds(), Vec3::new(1.0, 1.0, 1.0), 0.6);
//! let lights = Light::three_points(&camera)?;
//! let frame = renderer.frame(&camera, &lights, &RenderOptions::default())?;
//! assert!(frame.hit(256, 256).is_none(), "one looks through the hole");
//! # Ok(())
//! # }
//! ```

mod band;
mod base_color;
mod bins;
mod brdf;
mod clip;
mod edges;
mod frame;
mod geometry;
mod heat;
mod layers;
mod material;
mod mips;
mod model;
mod options;
mod pass;
mod picture;
mod place;
mod project;
mod renderer;
mod resolve;
mod shade;
mod srgb;
mod surface;
mod texture;
mod view;

pub(crate) use base_color::{BaseColors, Footprint, encoded};
pub use frame::{Frame, Hit};
pub use heat::{heat_color, heat_table};
pub use model::{Instance, Model};
pub use options::{
    Ambient, Faces, MAX_SIDE, Normals, Outputs, Paint, RenderOptions, Scalar, Shading, Wireframe,
};
pub use picture::Picture;
pub use renderer::{Renderer, render};
pub(crate) use srgb::linear_of_codes;
pub use view::View;
