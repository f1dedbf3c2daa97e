//! Finding things in space: a hierarchy of boxes over triangles, and orders
//! that put neighbours next to each other.

mod build;
mod bvh;
pub mod morton;

pub use bvh::{Bvh, Hit};
