//! What a checker of tilesets asks a glTF file: where its points are, and the
//! raw document with its metadata.

use super::{GltfSource, budget::Budget, document::Document, json, primitive::triangle_mode};
use crate::{error::Result, source::Source};
use glam::{DMat4, DQuat, DVec3, Quat};
use karui::{
    Scene,
    mesh::{Attribute, AttributeValues, Node, Transform},
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

    /// Every mesh of the default scene in its place, those of
    /// `EXT_mesh_gpu_instancing` once an instance. Meshes of skins stand where
    /// their joints are, and are left out.
    pub fn placed(&self) -> Vec<Placed> {
        let mut found = Vec::new();
        let mut seen = vec![false; self.scene.nodes.len()];
        let roots = self.scene.roots.iter().rev();
        let mut stack: Vec<(u32, DMat4)> = roots.map(|&r| (r, DMat4::IDENTITY)).collect();
        while let Some((n, world_from_parent)) = stack.pop() {
            let Some(node) = self.scene.nodes.get(n as usize) else {
                continue;
            };
            if std::mem::replace(&mut seen[n as usize], true) {
                continue;
            }
            let world_from_node = world_from_parent * matrix(node);
            if let (Some(mesh), None) = (node.mesh, node.skin) {
                self.place(n, mesh, world_from_node, &mut found);
            }
            stack.extend(node.children.iter().rev().map(|&c| (c, world_from_node)));
        }
        found
    }

    fn place(&self, node: u32, mesh: u32, world_from_node: DMat4, found: &mut Vec<Placed>) {
        let instances = self.instances(node as usize);
        let room = INSTANCES.saturating_sub(found.len());
        let matrices = instances.unwrap_or_else(|| vec![DMat4::IDENTITY]);
        found.extend(matrices.into_iter().take(room).map(|m| Placed {
            mesh,
            world_from_mesh: world_from_node * m,
        }));
    }

    /// Placements of `EXT_mesh_gpu_instancing`; `None` for a plain node.
    fn instances(&self, node: usize) -> Option<Vec<DMat4>> {
        let raw = self.json().get("nodes")?.get(node)?;
        let attributes = json::extension(raw, "EXT_mesh_gpu_instancing")?.get("attributes")?;
        let moved = self.floats::<3>(attributes, "TRANSLATION", [0.0; 3]);
        let turned = self.floats::<4>(attributes, "ROTATION", [0.0, 0.0, 0.0, 1.0]);
        let scaled = self.floats::<3>(attributes, "SCALE", [1.0; 3]);
        let counts = [moved.as_ref().map(Vec::len), turned.as_ref().map(Vec::len)];
        let counts = counts.into_iter().chain([scaled.as_ref().map(Vec::len)]);
        let count = counts.flatten().min()?;
        let matrix = |i: usize| {
            let moved = moved.as_ref().map_or([0.0; 3], |m| m[i]);
            let turned = turned
                .as_ref()
                .map_or(Quat::IDENTITY, |t| Quat::from_array(t[i]));
            let scaled = scaled.as_ref().map_or([1.0; 3], |s| s[i]);
            DMat4::from_scale_rotation_translation(
                DVec3::from(scaled.map(f64::from)),
                turned.as_dquat().normalize(),
                DVec3::from(moved.map(f64::from)),
            )
        };
        Some((0..count.min(INSTANCES)).map(matrix).collect())
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

fn matrix(node: &Node) -> DMat4 {
    match node.transform {
        Transform::Matrix(matrix) => matrix.as_dmat4(),
        Transform::Trs {
            translation,
            rotation,
            scale,
        } => {
            let rotation: DQuat = rotation.as_dquat();
            let (scale, translation) = (scale.as_dvec3(), translation.as_dvec3());
            DMat4::from_scale_rotation_translation(scale, rotation, translation)
        }
    }
}
