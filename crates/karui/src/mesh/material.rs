//! Physically based materials in glTF's metallic-roughness model.

use glam::{Vec2, Vec3, Vec4};
use std::sync::Arc;

/// A metallic-roughness material (glTF 2.0, 3.9).
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Name, if it has one.
    pub name: Option<String>,
    /// Linear RGBA factor.
    pub base_color: Vec4,
    /// sRGB base colour texture.
    pub base_color_texture: Option<TextureRef>,
    /// 0 dielectric to 1 metal.
    pub metallic: f32,
    /// 0 smooth to 1 rough.
    pub roughness: f32,
    /// Roughness in green, metalness in blue.
    pub metallic_roughness_texture: Option<TextureRef>,
    /// Tangent-space normal map.
    pub normal_texture: Option<TextureRef>,
    /// Scale of the normal map's x and y.
    pub normal_scale: f32,
    /// Occlusion in red.
    pub occlusion_texture: Option<TextureRef>,
    /// 0 no occlusion to 1 full.
    pub occlusion_strength: f32,
    /// Linear RGB emission.
    pub emissive: Vec3,
    /// sRGB emissive texture.
    pub emissive_texture: Option<TextureRef>,
    /// How alpha is used.
    pub alpha_mode: AlphaMode,
    /// Whether back faces are shown.
    pub double_sided: bool,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: None,
            base_color: Vec4::ONE,
            base_color_texture: None,
            metallic: 1.0,
            roughness: 1.0,
            metallic_roughness_texture: None,
            normal_texture: None,
            normal_scale: 1.0,
            occlusion_texture: None,
            occlusion_strength: 1.0,
            emissive: Vec3::ZERO,
            emissive_texture: None,
            alpha_mode: AlphaMode::Opaque,
            double_sided: false,
        }
    }
}

/// How a material's alpha is used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AlphaMode {
    /// Ignored.
    Opaque,
    /// Drawn where alpha is at least the cutoff.
    Mask(f32),
    /// Blended over what lies behind.
    Blend,
}

/// Use of a texture by a material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TextureRef {
    /// Index into [`Scene::textures`](super::Scene::textures).
    pub texture: u32,
    /// UV set it is looked up with.
    pub uv_set: u32,
    /// `KHR_texture_transform`, if any.
    pub transform: Option<UvTransform>,
}

/// `KHR_texture_transform`: uv' = translation * rotation * scale * uv.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UvTransform {
    /// Offset in UV units.
    pub offset: Vec2,
    /// Rotation in radians, counter-clockwise.
    pub rotation: f32,
    /// Scale.
    pub scale: Vec2,
}

/// An image together with how it is sampled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Texture {
    /// Index into [`Scene::images`](super::Scene::images); `None` when only an
    /// extension Karui does not model names one.
    pub image: Option<u32>,
    /// Behaviour outside 0..1 along u and v.
    pub wrap: [Wrap; 2],
    /// Nearest instead of linear magnification.
    pub nearest: bool,
}

/// Behaviour of a texture outside 0..1.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Wrap {
    /// Tiled.
    #[default]
    Repeat,
    /// Tiled, every second one mirrored.
    Mirror,
    /// The edge's colour.
    Clamp,
}

/// An image, encoded (PNG, JPEG, KTX2, ...) unless it was made here.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    /// Name, if it has one.
    pub name: Option<String>,
    /// E.g. `image/png`; empty if unknown, or if it is not encoded.
    pub mime: String,
    /// The bytes or where they lie.
    pub data: ImageData,
}

/// Where an image's content is.
#[derive(Debug, Clone, PartialEq)]
pub enum ImageData {
    /// In memory, with the relative URI of the file they were read from if
    /// they were not embedded.
    Bytes {
        /// The encoded file.
        bytes: Arc<[u8]>,
        /// Relative URI it came from.
        uri: Option<String>,
    },
    /// Named by the model but not found when it was read.
    Missing {
        /// Relative URI as written in the file.
        uri: String,
    },
    /// Made here and not encoded yet: a writer takes it as a PNG.
    Pixels {
        /// Pixels a row; rows are as many as there are pixels for, from the top.
        width: u32,
        /// sRGB codes with straight alpha.
        pixels: Arc<[[u8; 4]]>,
    },
}
