//! glTF 2.0 and its binary container GLB.
//!
//! The document stays JSON from reading to writing, so that everything Karui
//! does not model (animations, skins, cameras, lights, variants, metadata,
//! unknown extensions) comes out as it went in: the reader attaches it to the
//! scene and the writer starts from it.

mod accessor;
mod budget;
mod container;
mod document;
mod draco;
mod encode;
mod feature_table;
mod heirs;
mod inspect;
mod instancing;
mod json;
mod lod;
mod material;
mod meshopt;
mod node;
mod origin;
mod pack;
mod primitive;
mod quantize;
mod read;
mod read_mesh;
mod references;
pub(crate) mod slices;
mod tie;
pub(crate) mod uri;
mod write;
mod write_image;
mod write_mesh;
mod write_node;
mod write_vertices;

pub use feature_table::{FeatureColumn, FeatureTable, FeatureValues};
pub(crate) use inspect::Inspected;
pub(crate) use read::read;
pub use write::GltfOptions;
pub(crate) use write::{glb_bytes, write};

/// What a scene read from glTF carries for the writer.
struct GltfSource {
    document: document::Document,
    /// Placements of its nodes, to tell whether they are still the same.
    placements: Vec<Option<std::sync::Arc<karui::mesh::Placements>>>,
}
