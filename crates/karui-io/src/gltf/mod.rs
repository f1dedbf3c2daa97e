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
mod json;
mod lod;
mod material;
mod meshopt;
mod node;
mod pack;
mod primitive;
mod read;
mod read_mesh;
mod references;
mod uri;

pub(crate) use read::read;

/// What a scene read from glTF carries for the writer.
struct GltfSource {
    document: document::Document,
}
