//! How far a surface is from another, how sound a mesh is, and how different two
//! pictures look.

pub mod image;
mod quality;
mod sampling;
mod sides;
mod surface;
mod surface_distance;
mod tally;
mod vertex_distance;

pub use quality::{Quality, flipped, quality};
pub use surface::Surface;
pub use surface_distance::{
    Distance, Samples, SurfaceDistance, SurfaceDistanceOptions, directed_distance,
    surface_distance, surface_distance_between,
};
pub use vertex_distance::{vertex_distances, vertex_distances_observed, vertex_distances_to};
