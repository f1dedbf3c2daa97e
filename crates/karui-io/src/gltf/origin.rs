//! What a scene was read from, seen by the writer: raw elements, and accessors
//! and buffer views that are passed through as they are.

use super::{
    accessor::Elements,
    budget::Budget,
    document::Document,
    json::{self, At},
    pack::{Packer, Use},
    primitive::triangle_mode,
    references::Target,
};
use crate::error::Result;
use serde_json::{Value, json};

/// The document a scene was read from.
pub(super) struct Origin<'a> {
    document: Option<&'a Document>,
    meshes: &'a [Value],
    /// Number of the first primitive of each mesh.
    first_primitives: Vec<u32>,
    budget: Budget,
    /// New index by old, once asked for.
    accessors: Vec<Option<usize>>,
    views: Vec<Option<usize>>,
}

impl<'a> Origin<'a> {
    /// `None` for a scene that was not read from glTF.
    pub fn new(document: Option<&'a Document>) -> Self {
        let meshes = document.and_then(|d| d.json.get("meshes")?.as_array());
        let meshes = meshes.map_or(&[][..], Vec::as_slice);
        let mut first_primitives = Vec::with_capacity(meshes.len());
        let mut next = 0;
        for mesh in meshes {
            first_primitives.push(next);
            next += json::count(mesh, "primitives") as u32;
        }
        let accessors = document.map_or(0, |d| json::count(&d.json, "accessors"));
        Self {
            document,
            meshes,
            first_primitives,
            budget: Budget::new(document.map_or(0, Document::size), 0),
            accessors: vec![None; accessors],
            views: vec![None; document.map_or(0, Document::view_count)],
        }
    }

    /// The JSON to start from.
    pub fn json(&self) -> Value {
        let json = self.document.map(|d| d.json.clone());
        json.unwrap_or_else(|| json!({ "asset": { "version": "2.0" } }))
    }

    /// Mesh `index` as it was in the file.
    pub fn mesh(&self, index: usize) -> Option<&'a Value> {
        self.meshes.get(index)
    }

    /// Mesh and primitive that have the given number in the file.
    pub fn primitive(&self, number: u32) -> Option<(usize, &'a Value)> {
        let after = self.first_primitives.partition_point(|&f| f <= number);
        let mesh = after.checked_sub(1)?;
        let index = (number - self.first_primitives[mesh]) as usize;
        let primitive = self.meshes[mesh].get("primitives")?.get(index)?;
        Some((mesh, primitive))
    }

    /// Number in the file of the first primitive of a mesh.
    pub fn first_primitive(&self, mesh: usize) -> u32 {
        self.first_primitives.get(mesh).copied().unwrap_or(u32::MAX)
    }

    /// Names of the attributes that some triangle primitive of a mesh has.
    pub fn attribute_names(&self, mesh: usize) -> Vec<&'a str> {
        let primitives = self
            .mesh(mesh)
            .and_then(|m| m.get("primitives")?.as_array());
        let mut names: Vec<&str> = Vec::new();
        for primitive in primitives.into_iter().flatten() {
            if triangle_mode(primitive).is_some()
                && let Some(attributes) = primitive["attributes"].as_object()
            {
                names.extend(attributes.keys().map(String::as_str));
            }
        }
        names.sort_unstable();
        names.dedup();
        names
    }

    /// The accessor behind an attribute of a primitive.
    pub fn accessor(&self, primitive: &Value, name: &str) -> Option<&'a Value> {
        let index = primitive.get("attributes")?.get(name)?.as_u64()?;
        self.document?.json.get("accessors")?.get(index as usize)
    }

    /// Replaces a reference to an old accessor or view by one to a copy.
    pub fn pass(
        &mut self,
        target: Target,
        value: &mut Value,
        usage: Use,
        at: &At<'_>,
        packer: &mut Packer,
    ) -> Result<()> {
        let (Some(document), Some(old)) = (self.document, value.as_u64()) else {
            return Ok(());
        };
        let old = old as usize;
        let new = match target {
            Target::Accessor => {
                json::in_range(old, self.accessors.len(), "accessor", at)?;
                match self.accessors[old] {
                    Some(new) => new,
                    None => copy_accessor(document, old, usage, &self.budget, packer)?,
                }
            }
            Target::View => {
                json::in_range(old, self.views.len(), "bufferView", at)?;
                self.views[old].unwrap_or_else(|| copy_view(document, old, packer))
            }
        };
        match target {
            Target::Accessor => self.accessors[old] = Some(new),
            Target::View => self.views[old] = Some(new),
        }
        *value = json!(new);
        Ok(())
    }
}

fn copy_accessor(
    document: &Document,
    old: usize,
    usage: Use,
    budget: &Budget,
    packer: &mut Packer,
) -> Result<usize> {
    let elements = document.elements(old, budget)?;
    let mut accessor = document.json["accessors"][old].clone();
    for key in ["bufferView", "byteOffset", "sparse"] {
        json::remove(&mut accessor, key);
    }
    let size = elements.layout.size();
    let stride = match usage {
        Use::Vertices => size.next_multiple_of(4),
        _ => size,
    };
    let bytes = spread(elements, stride);
    Ok(packer.push_accessor(accessor, bytes, Some(stride), usage))
}

/// Elements every `stride` bytes, zeros between.
fn spread(elements: Elements<'_>, stride: usize) -> Vec<u8> {
    if stride == elements.layout.size() {
        return elements.into_bytes();
    }
    let mut bytes = Vec::with_capacity(elements.count * stride);
    for i in 0..elements.count {
        bytes.extend_from_slice(elements.element(i));
        bytes.resize((i + 1) * stride, 0);
    }
    bytes
}

fn copy_view(document: &Document, old: usize, packer: &mut Packer) -> usize {
    let mut view = document.json["bufferViews"][old].clone();
    for key in ["buffer", "byteOffset", "byteLength"] {
        json::remove(&mut view, key);
    }
    for name in super::document::MESHOPT {
        json::remove_extension(&mut view, name);
    }
    packer.push_view(view, document.view(old).to_vec())
}
