//! Meshes, their attributes and the scenes they stand in.

mod attributes;
mod ear_clip;
mod material;
mod poly_mesh;
mod position_ids;
mod scene;
pub mod shapes;
mod single_mesh;
mod tri_mesh;
mod triangulate;
mod validate;
mod validate_scene;

pub use attributes::{Attribute, AttributeValues, Attributes, MorphTarget, SkinWeights};
pub use material::{AlphaMode, Image, ImageData, Material, Texture, TextureRef, UvTransform, Wrap};
pub use poly_mesh::PolyMesh;
pub use position_ids::PositionIds;
pub use scene::{Attachment, LodLinks, NamedMesh, Node, Scene, Transform};
pub use tri_mesh::{MaterialRange, TriMesh};
