//! The materials in use, as one list that stands alone.

use super::group::Slot;
use crate::geom::Vec4;
use crate::mesh::{
    Image, ImageData, Material, NamedMesh, Node, Scene, Texture, TextureRef, TriMesh,
};
use crate::render::{Instance, Model, Picture};
use std::sync::Arc;

/// Materials and what they need, and nothing else.
#[derive(Debug, Clone, Default)]
pub(super) struct Outfit {
    pub materials: Vec<Material>,
    pub textures: Vec<Texture>,
    pub images: Vec<Option<Picture>>,
}

/// What is drawn where there is no material.
pub(super) fn clay() -> Material {
    Material {
        base_color: Vec4::new(0.6, 0.6, 0.6, 1.0),
        metallic: 0.0,
        roughness: 0.7,
        double_sided: true,
        ..Material::default()
    }
}

impl Outfit {
    /// One material for every slot, in their order.
    pub fn of(slots: &[Slot<'_>]) -> Self {
        let mut collector = Collector::default();
        for slot in slots {
            let material = collector.material(slot);
            collector.outfit.materials.push(material);
        }
        collector.outfit
    }

    /// A mesh whose ranges name the slots.
    pub fn model<'a>(&'a self, mesh: &'a TriMesh) -> Model<'a> {
        Model {
            meshes: vec![mesh],
            instances: vec![Instance {
                mesh: 0,
                node: None,
                world_from_mesh: crate::geom::Mat4::IDENTITY,
            }],
            materials: &self.materials,
            textures: &self.textures,
            images: &self.images,
        }
    }

    /// A scene of one such mesh.
    pub fn scene(self, mesh: TriMesh) -> Scene {
        let images = self.images.into_iter().flatten();
        Scene {
            meshes: vec![NamedMesh { name: None, mesh }],
            materials: self.materials,
            textures: self.textures,
            images: images.map(image).collect(),
            nodes: vec![Node {
                mesh: Some(0),
                ..Node::default()
            }],
            roots: vec![0],
            ..Scene::default()
        }
    }
}

fn image(picture: Picture) -> Image {
    Image {
        name: None,
        mime: String::new(),
        data: ImageData::Pixels {
            width: picture.width(),
            pixels: Arc::from(picture.pixels()),
        },
    }
}

#[derive(Default)]
struct Collector<'a> {
    outfit: Outfit,
    /// Image in use, wherever it comes from.
    known: Vec<&'a Picture>,
}

impl<'a> Collector<'a> {
    fn material(&mut self, slot: &Slot<'a>) -> Material {
        let Some(mut material) = slot.material().cloned() else {
            return clay();
        };
        for used in [
            &mut material.base_color_texture,
            &mut material.metallic_roughness_texture,
            &mut material.normal_texture,
            &mut material.occlusion_texture,
            &mut material.emissive_texture,
        ] {
            *used = used.and_then(|used| self.texture(slot, used));
        }
        material
    }

    /// `None` for one without UVs or image.
    fn texture(&mut self, slot: &Slot<'a>, used: TextureRef) -> Option<TextureRef> {
        if used.uv_set as usize >= slot.uv_sets {
            return None;
        }
        let texture = slot.look.textures.get(used.texture as usize)?;
        let picture = slot.look.images.get(texture.image? as usize)?.as_ref()?;
        if picture.pixels().is_empty() {
            return None;
        }
        let texture = Texture {
            image: Some(self.image(picture)),
            ..*texture
        };
        let known = self.outfit.textures.iter().position(|t| *t == texture);
        let index = known.unwrap_or(self.outfit.textures.len());
        if known.is_none() {
            self.outfit.textures.push(texture);
        }
        Some(TextureRef {
            texture: index as u32,
            ..used
        })
    }

    fn image(&mut self, picture: &'a Picture) -> u32 {
        let known = self.known.iter().position(|k| std::ptr::eq(*k, picture));
        let index = known.unwrap_or(self.known.len());
        if known.is_none() {
            self.known.push(picture);
            self.outfit.images.push(Some(picture.clone()));
        }
        index as u32
    }
}
