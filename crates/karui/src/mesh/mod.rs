//! Meshes, their attributes and the scenes they stand in.

mod attributes;
mod material;
mod poly_mesh;
mod scene;
mod tri_mesh;

pub use attributes::{Attribute, AttributeValues, Attributes, MorphTarget, SkinWeights};
pub use material::{AlphaMode, Image, ImageData, Material, Texture, TextureRef, UvTransform, Wrap};
pub use poly_mesh::PolyMesh;
pub use scene::{Attachment, LodLinks, NamedMesh, Node, Scene, Transform};
pub use tri_mesh::{MaterialRange, TriMesh};
