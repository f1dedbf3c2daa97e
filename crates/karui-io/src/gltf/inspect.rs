//! What a checker of tilesets asks a glTF file: where its points are, and the
//! raw document with its metadata.

use super::{GltfSource, budget::Budget, document::Document, json, primitive::triangle_mode};
use crate::{error::Result, source::Source};
use glam::{DMat4, DVec3};
use karui::{
    Scene,
    mesh::{Attribute, AttributeValues, Instance},
};
use serde_json::Value;

/// Instances of all nodes that are looked at; the first of a huge file.
const INSTANCES: usize = 1 << 22;

/// A glTF file, read and checked.
pub(crate) struct Inspected {
    /// What it holds.
    pub scene: Scene,
}

/// A mesh placed in the file's world, in `f64`.
pub(crate) struct Placed {
    /// Index of the mesh.
    pub mesh: u32,
    /// Takes the mesh's frame to the world's, y up.
    pub world_from_mesh: DMat4,
}

impl Inspected {
    /// Reads a file as any glTF is read.
    pub fn read(source: &mut Source<'_>) -> Result<Self> {
        let scene = super::read(source)?;
        Ok(Self { scene })
    }

    fn document(&self) -> Option<&Document> {
        let source = self.scene.attachment.get::<GltfSource>();
        source.map(|s| &s.document)
    }

    /// The document.
    pub fn json(&self) -> &Value {
        self.document().map_or(&Value::Null, |d| &d.json)
    }

    /// The bytes of a buffer view of the metadata.
    pub fn view(&self, index: usize) -> Option<&[u8]> {
        let document = self.document()?;
        (index < document.view_count()).then(|| document.view(index))
    }

    /// Every mesh of the default scene in its place, once for each of its
    /// placements. Meshes of skins stand where their joints are, and are left out.
    pub fn placed(&self) -> Vec<Placed> {
        let placed = self.scene.iter_instances();
        let stands = placed.filter(|i| self.scene.nodes[i.node as usize].skin.is_none());
        let placed = |i: Instance| Placed {
            mesh: i.mesh,
            world_from_mesh: i.world_from_mesh,
        };
        stands.take(INSTANCES).map(placed).collect()
    }

    fn floats<const N: usize>(
        &self,
        attributes: &Value,
        name: &str,
        default: [f32; N],
    ) -> Option<Vec<[f32; N]>> {
        let accessor = attributes.get(name)?.as_u64()? as usize;
        let document = self.document()?;
        let budget = Budget::new(document.size(), 0);
        let elements = document.elements(accessor, &budget).ok()?;
        Some(elements.floats(default))
    }

    /// The points of a mesh that are drawn: those of its triangles, and all of
    /// its points and lines.
    pub fn points(&self, mesh: usize) -> Vec<DVec3> {
        let Some(named) = self.scene.meshes.get(mesh) else {
            return Vec::new();
        };
        let positions = &named.mesh.positions;
        let mut used = vec![false; positions.len()];
        for &v in named.mesh.triangles.as_flattened() {
            used[v as usize] = true;
        }
        let drawn = positions.iter().zip(used).filter(|(_, used)| *used);
        let mut points: Vec<DVec3> = drawn.map(|(p, _)| p.as_dvec3()).collect();
        for primitive in self.primitives(mesh) {
            if triangle_mode(primitive).is_none() {
                let found = self.floats::<3>(&primitive["attributes"], "POSITION", [0.0; 3]);
                let found = found.unwrap_or_default();
                points.extend(found.iter().map(|p| DVec3::from(p.map(f64::from))));
            }
        }
        points
    }

    /// Primitives of a mesh in the document.
    pub fn primitives(&self, mesh: usize) -> &[Value] {
        let found = self.json().pointer(&format!("/meshes/{mesh}/primitives"));
        found.and_then(Value::as_array).map_or(&[], Vec::as_slice)
    }

    /// Values of a feature id attribute of a primitive, one a vertex drawn.
    /// `None` if there is no such attribute.
    pub fn feature_ids(&self, mesh: usize, primitive: usize, name: &str) -> Option<Vec<f64>> {
        let raw = self.primitives(mesh).get(primitive)?;
        let accessor = raw["attributes"].get(name)?;
        if triangle_mode(raw).is_none() {
            return self.scalars(accessor);
        }
        let first: usize = (0..mesh).map(|m| self.primitives(m).len()).sum();
        let number = (first + primitive) as u32;
        let named = self.scene.meshes.get(mesh)?;
        let attributes = &named.mesh.attributes.custom;
        let attribute = attributes.iter().find(|a| a.name == name)?;
        let ranges = named
            .mesh
            .ranges
            .iter()
            .filter(|r| r.source == Some(number));
        let triangles = ranges.flat_map(|r| &named.mesh.triangles[r.triangles()]);
        let corners = triangles.flatten();
        Some(corners.map(|&v| scalar(attribute, v as usize)).collect())
    }

    /// Values of a scalar accessor that is not one of triangles.
    pub fn scalars(&self, accessor: &Value) -> Option<Vec<f64>> {
        let document = self.document()?;
        let budget = Budget::new(document.size(), 0);
        let index = accessor.as_u64()? as usize;
        if index >= json::count(&document.json, "accessors") {
            return None;
        }
        let elements = document.elements(index, &budget).ok()?;
        Some(
            (0..elements.count)
                .map(|i| f64::from(elements.float(i, 0)))
                .collect(),
        )
    }
}

fn scalar(attribute: &Attribute, element: usize) -> f64 {
    let i = element * attribute.components;
    match &attribute.values {
        AttributeValues::I8(v) => f64::from(v[i]),
        AttributeValues::U8(v) => f64::from(v[i]),
        AttributeValues::I16(v) => f64::from(v[i]),
        AttributeValues::U16(v) => f64::from(v[i]),
        AttributeValues::I32(v) => f64::from(v[i]),
        AttributeValues::U32(v) => f64::from(v[i]),
        AttributeValues::F32(v) => f64::from(v[i]),
        AttributeValues::F64(v) => v[i],
    }
}
