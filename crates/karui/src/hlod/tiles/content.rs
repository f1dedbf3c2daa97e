//! What is drawn in a tile, as a scene of its own.

use super::{Hlod, TileContent};
use crate::geom::{DMat4, DVec3, Mat4};
use crate::hlod::proxy::{FEATURE_ID, Proxy};
use crate::mesh::{
    Attribute, AttributeValues, Image, Material, NamedMesh, Node, Placements, Scene, Texture,
    TextureRef, Transform, TriMesh,
};
use glam::{DQuat, Quat, Vec3};
use std::collections::BTreeMap;
use std::sync::Arc;

impl Hlod<'_> {
    /// What is drawn in a tile, with coordinates relative to `origin`; `None` if there
    /// is nothing, or no such tile. Objects of one mesh are one node with
    /// [`Placements`], which have the objects' numbers as their attribute
    /// [`FEATURE_ID`]; vertices of stand-ins have it likewise.
    #[must_use]
    pub fn content(&self, tile: u32, origin: DVec3) -> Option<Scene> {
        match &self.tiles.get(tile as usize)?.content {
            TileContent::Nothing => None,
            TileContent::Proxy(proxy) => Some(moved(proxy, origin)),
            TileContent::Objects(objects) => Some(self.placed(objects, origin, false)),
            TileContent::Coarse(objects) => Some(self.placed(objects, origin, true)),
        }
    }

    fn placed(&self, objects: &[u32], origin: DVec3, coarse: bool) -> Scene {
        let mut of_mesh: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for &object in objects {
            let mesh = self.objects[object as usize].mesh;
            of_mesh.entry(mesh).or_default().push(object);
        }
        let mut part = Part::default();
        for (mesh, objects) in of_mesh {
            let named = &self.scene.meshes[mesh as usize];
            let level = self.coarse[mesh as usize].as_ref().filter(|_| coarse);
            let mesh = part.add_mesh(self.scene, named, level.map_or(&named.mesh, |l| &l.mesh));
            self.add_nodes(&mut part.scene, mesh, &objects, origin);
        }
        part.scene
    }

    /// One node for all objects whose matrices are scale, rotation and translation, one
    /// each for others.
    fn add_nodes(&self, scene: &mut Scene, mesh: u32, objects: &[u32], origin: DVec3) {
        let mut all = Placements::default();
        let (mut rotations, mut scales, mut ids) = (Vec::new(), Vec::new(), Vec::new());
        let from_world = DMat4::from_translation(-origin);
        for &object in objects {
            let matrix = from_world * self.objects[object as usize].world_from_mesh;
            match parts(&matrix) {
                Some((scale, rotation, translation)) => {
                    all.translations.push(translation);
                    rotations.push(rotation);
                    scales.push(scale);
                    ids.push(object);
                }
                None => {
                    let mut node = node(mesh, single(object));
                    node.transform = Transform::Matrix(matrix.as_mat4());
                    push(scene, node);
                }
            }
        }
        if ids.is_empty() {
            return;
        }
        all.rotations = rotations
            .iter()
            .any(|r| *r != Quat::IDENTITY)
            .then_some(rotations);
        all.scales = scales.iter().any(|s| *s != Vec3::ONE).then_some(scales);
        all.attributes.push(feature_ids(ids));
        push(scene, node(mesh, all));
    }
}

fn push(scene: &mut Scene, node: Node) {
    scene.roots.push(scene.nodes.len() as u32);
    scene.nodes.push(node);
}

fn node(mesh: u32, placements: Placements) -> Node {
    Node {
        mesh: Some(mesh),
        placements: Some(Arc::new(placements)),
        ..Node::default()
    }
}

/// An object where its node is.
fn single(object: u32) -> Placements {
    Placements {
        translations: vec![Vec3::ZERO],
        attributes: vec![feature_ids(vec![object])],
        ..Placements::default()
    }
}

fn feature_ids(ids: Vec<u32>) -> Attribute {
    Attribute {
        name: FEATURE_ID.into(),
        components: 1,
        values: AttributeValues::U32(ids),
    }
}

/// Scale, rotation and translation of a matrix that is nothing else, but for the
/// rounding to single precision.
fn parts(matrix: &DMat4) -> Option<(Vec3, Quat, Vec3)> {
    let (scale, rotation, translation) = matrix.to_scale_rotation_translation();
    let rotation: DQuat = rotation.normalize();
    if !(scale.is_finite() && rotation.is_finite() && scale.cmpne(DVec3::ZERO).all()) {
        return None;
    }
    let same = DMat4::from_scale_rotation_translation(scale, rotation, translation);
    let within = 1e-6 * scale.abs().max_element();
    let is_same = |c: usize| {
        same.col(c)
            .truncate()
            .abs_diff_eq(matrix.col(c).truncate(), within)
    };
    let parts = (scale.as_vec3(), rotation.as_quat(), translation.as_vec3());
    [0, 1, 2].into_iter().all(is_same).then_some(parts)
}

fn moved(proxy: &Proxy, origin: DVec3) -> Scene {
    let mut scene = proxy.scene.clone();
    let by = (proxy.origin - origin).as_vec3();
    for &root in &scene.roots.clone() {
        let node = &mut scene.nodes[root as usize];
        node.transform = match node.transform {
            Transform::Trs {
                translation,
                rotation,
                scale,
            } => Transform::Trs {
                translation: translation + by,
                rotation,
                scale,
            },
            Transform::Matrix(matrix) => Transform::Matrix(Mat4::from_translation(by) * matrix),
        };
    }
    scene
}

/// A scene of some meshes of another, with the materials, textures and images that
/// these need and no more.
#[derive(Default)]
struct Part {
    scene: Scene,
    materials: BTreeMap<u32, u32>,
    textures: BTreeMap<u32, u32>,
    images: BTreeMap<u32, u32>,
}

impl Part {
    fn add_mesh(&mut self, of: &Scene, named: &NamedMesh, mesh: &TriMesh) -> u32 {
        let mut mesh = mesh.clone();
        // Nothing moves in a tile.
        mesh.attributes.skins.clear();
        mesh.attributes.morphs.clear();
        for range in &mut mesh.ranges {
            range.source = None;
            range.material = range.material.and_then(|m| self.material(of, m));
        }
        self.scene.meshes.push(NamedMesh {
            name: named.name.clone(),
            mesh,
        });
        self.scene.meshes.len() as u32 - 1
    }

    fn material(&mut self, of: &Scene, m: u32) -> Option<u32> {
        if let Some(&known) = self.materials.get(&m) {
            return Some(known);
        }
        let mut material: Material = of.materials.get(m as usize)?.clone();
        for texture in [
            &mut material.base_color_texture,
            &mut material.metallic_roughness_texture,
            &mut material.normal_texture,
            &mut material.occlusion_texture,
            &mut material.emissive_texture,
        ] {
            *texture = texture.and_then(|t| self.texture(of, t));
        }
        let new = self.scene.materials.len() as u32;
        self.scene.materials.push(material);
        self.materials.insert(m, new);
        Some(new)
    }

    fn texture(&mut self, of: &Scene, reference: TextureRef) -> Option<TextureRef> {
        let t = reference.texture;
        let new = match self.textures.get(&t) {
            Some(&known) => known,
            None => {
                let mut texture: Texture = *of.textures.get(t as usize)?;
                texture.image = texture.image.and_then(|i| self.image(of, i));
                let new = self.scene.textures.len() as u32;
                self.scene.textures.push(texture);
                self.textures.insert(t, new);
                new
            }
        };
        Some(TextureRef {
            texture: new,
            ..reference
        })
    }

    fn image(&mut self, of: &Scene, i: u32) -> Option<u32> {
        if let Some(&known) = self.images.get(&i) {
            return Some(known);
        }
        let mut image: Image = of.images.get(i as usize)?.clone();
        if let crate::mesh::ImageData::Bytes { uri, .. } = &mut image.data {
            // It goes into the tile's file.
            *uri = None;
        }
        let new = self.scene.images.len() as u32;
        self.scene.images.push(image);
        self.images.insert(i, new);
        Some(new)
    }
}
