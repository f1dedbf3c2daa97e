//! Meshes, their attributes and the scenes they stand in.

mod attributes;
mod components;
mod diagnose;
mod disjoint_sets;
mod ear_clip;
mod edges;
mod halfedge;
mod instances;
mod material;
mod normals;
mod placements;
mod poly_mesh;
mod position_ids;
mod random;
mod repair;
mod scene;
pub mod scenes;
pub mod shapes;
mod single_mesh;
mod tri_mesh;
mod triangulate;
mod validate;
mod validate_scene;
mod weld;

pub(crate) use disjoint_sets::DisjointSets;

pub use attributes::{Attribute, AttributeValues, Attributes, MorphTarget, SkinWeights};
pub use components::Components;
pub use diagnose::{TopologyReport, diagnose, diagnose_with};
pub use halfedge::{FaceId, FaceLoop, Halfedge, HalfedgeId, Ring, VertexId};
pub use instances::Instance;
pub use material::{AlphaMode, Image, ImageData, Material, Texture, TextureRef, UvTransform, Wrap};
pub use normals::{NormalWeight, vertex_normals};
pub use placements::Placements;
pub use poly_mesh::PolyMesh;
pub use position_ids::PositionIds;
pub use repair::{RepairCounts, RepairOptions, Repaired, repair};
pub use scene::{Attachment, LodLinks, NamedMesh, Node, NodeTie, Scene, Transform};
pub use tri_mesh::{MaterialRange, TriMesh};
pub use weld::{WeldOptions, Welded, weld};
