//! What the builders of scenes share.

use crate::mesh::{
    Attributes, Material, MaterialRange, NamedMesh, Node, Placements, Scene, TriMesh,
};
use glam::{Quat, Vec2, Vec3};
use std::sync::Arc;

/// Triangles of one colour after the other.
#[derive(Default)]
pub(super) struct Painter {
    mesh: TriMesh,
    normals: Vec<Vec3>,
}

impl Painter {
    /// A flat polygon that is convex; corners run counter-clockwise seen from
    /// its front. `normal` is for all corners, the flat one if `None`.
    pub fn polygon(&mut self, corners: &[Vec3], normal: Option<Vec3>) {
        let first = self.mesh.positions.len() as u32;
        let [a, b, c] = [0, 1, 2].map(|i| corners[i]);
        let flat = (b - a).cross(c - a).normalize_or(Vec3::Y);
        self.mesh.positions.extend(corners);
        self.normals
            .resize(self.mesh.positions.len(), normal.unwrap_or(flat));
        let fan = (2..corners.len() as u32).map(|i| [first, first + i - 1, first + i]);
        self.mesh.triangles.extend(fan);
    }

    /// A box of 12 triangles, 10 without its bottom.
    pub fn block(&mut self, [min, max]: [Vec3; 2], bottom: bool) {
        let at = |x: usize, y: usize, z: usize| {
            let pick = |side: usize, axis: usize| if side == 0 { min[axis] } else { max[axis] };
            Vec3::new(pick(x, 0), pick(y, 1), pick(z, 2))
        };
        let faces = [
            [at(1, 0, 1), at(1, 0, 0), at(1, 1, 0), at(1, 1, 1)],
            [at(0, 0, 0), at(0, 0, 1), at(0, 1, 1), at(0, 1, 0)],
            [at(0, 0, 1), at(1, 0, 1), at(1, 1, 1), at(0, 1, 1)],
            [at(1, 0, 0), at(0, 0, 0), at(0, 1, 0), at(1, 1, 0)],
            [at(0, 1, 1), at(1, 1, 1), at(1, 1, 0), at(0, 1, 0)],
            [at(0, 0, 0), at(1, 0, 0), at(1, 0, 1), at(0, 0, 1)],
        ];
        for face in &faces[..if bottom { 6 } else { 5 }] {
            self.polygon(face, None);
        }
    }

    /// Ends a range: what came since the last one is of `material`.
    pub fn paint(&mut self, material: u32) {
        let first = self.mesh.ranges.last().map_or(0, |r| r.first + r.count);
        self.mesh.ranges.push(MaterialRange {
            first,
            count: self.mesh.triangles.len() as u32 - first,
            material: Some(material),
            source: None,
        });
    }

    /// The mesh; all of it must have been painted.
    pub fn finish(self) -> TriMesh {
        TriMesh {
            attributes: Attributes {
                normals: Some(self.normals),
                ..Attributes::default()
            },
            ..self.mesh
        }
    }
}

/// A rough material of an sRGB colour.
pub(super) fn material(name: &str, [r, g, b]: [u8; 3], double_sided: bool) -> Material {
    let linear = |byte: u8| (f32::from(byte) / 255.0).powf(2.2);
    Material {
        name: Some(name.into()),
        base_color: glam::Vec4::new(linear(r), linear(g), linear(b), 1.0),
        metallic: 0.0,
        double_sided,
        ..Material::default()
    }
}

/// Placements as they come.
#[derive(Default)]
pub(super) struct Places {
    translations: Vec<Vec3>,
    rotations: Vec<Quat>,
    scales: Vec<Vec3>,
}

impl Places {
    /// A placement turned about the vertical by `yaw` radians.
    pub fn push(&mut self, at: Vec3, yaw: f32, scale: f32) {
        let (sin, cos) = (f64::from(yaw) * 0.5).sin_cos();
        self.translations.push(at);
        self.rotations
            .push(Quat::from_xyzw(0.0, sin as f32, 0.0, cos as f32));
        self.scales.push(Vec3::splat(scale));
    }

    pub fn is_empty(&self) -> bool {
        self.translations.is_empty()
    }

    /// All of them; arrays that say nothing are left out.
    fn finish(self) -> Arc<Placements> {
        let turned = self.rotations.iter().any(|&q| q != Quat::IDENTITY);
        let scaled = self.scales.iter().any(|&s| s != Vec3::ONE);
        Arc::new(Placements {
            translations: self.translations,
            rotations: turned.then_some(self.rotations),
            scales: scaled.then_some(self.scales),
            attributes: Vec::new(),
        })
    }
}

/// Adds a root node that shows `mesh` everywhere in `places`; none if it is
/// nowhere. Returns its index.
pub(super) fn add_places(scene: &mut Scene, mesh: u32, places: Places) -> Option<u32> {
    if places.is_empty() {
        return None;
    }
    Some(add_root(
        scene,
        Node {
            name: scene.meshes[mesh as usize].name.clone(),
            mesh: Some(mesh),
            placements: Some(places.finish()),
            ..Node::default()
        },
    ))
}

/// Adds a root node; returns its index.
pub(super) fn add_root(scene: &mut Scene, node: Node) -> u32 {
    let index = scene.nodes.len() as u32;
    scene.nodes.push(node);
    scene.roots.push(index);
    index
}

/// Adds a mesh; returns its index.
pub(super) fn add_mesh(scene: &mut Scene, name: &str, mesh: TriMesh) -> u32 {
    scene.meshes.push(NamedMesh {
        name: Some(name.into()),
        mesh,
    });
    scene.meshes.len() as u32 - 1
}

/// The direction of step `step` of `steps` around the vertical, in x and z.
pub(super) fn around(step: u32, steps: u32) -> Vec2 {
    let (sin, cos) = crate::mesh::shapes::turn(step, steps);
    Vec2::new(cos as f32, -sin as f32)
}
