//! Finding things in space: a hierarchy of boxes over triangles, and orders
//! that put neighbours next to each other.

mod bvh;
mod facings;
pub mod morton;
mod morton_build;
mod radix;
mod ray;
mod sah_build;

pub use bvh::{Bvh, Hit};
pub use facings::{Facings, Normals};
pub use ray::Ray;
