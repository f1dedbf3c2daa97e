//! Pictures of meshes, the same to the bit on every machine.

mod picture;

pub use picture::Picture;
