//! Materials with their textures at hand.

use super::bins::Kind;
use super::mips::Encoding;
use super::model::Model;
use super::options::{Paint, RenderOptions};
use super::srgb::unit;
use super::texture::{Chain, Lookup};
use crate::geom::{Vec3, Vec4};
use crate::mesh::{AlphaMode, Material, TextureRef};

#[derive(Debug, Clone, Copy)]
pub(super) struct Prepared {
    pub base_color: Vec4,
    pub metallic: f32,
    pub roughness: f32,
    pub emissive: Vec3,
    pub normal_scale: f32,
    pub occlusion_strength: f32,
    pub base_color_lookup: Option<Lookup>,
    pub metallic_roughness_lookup: Option<Lookup>,
    pub normal_lookup: Option<Lookup>,
    pub occlusion_lookup: Option<Lookup>,
    pub emissive_lookup: Option<Lookup>,
    /// Whether a lookup but that of the colour and the normal is there.
    pub textured: bool,
    pub alpha_mode: AlphaMode,
    pub double_sided: bool,
}

impl Prepared {
    /// Of surfaces without material, and of all if there are to be none.
    pub(super) const CLAY: Self = Self {
        base_color: Vec4::new(0.6, 0.6, 0.6, 1.0),
        metallic: 0.0,
        roughness: 0.7,
        emissive: Vec3::ZERO,
        normal_scale: 1.0,
        occlusion_strength: 1.0,
        base_color_lookup: None,
        metallic_roughness_lookup: None,
        normal_lookup: None,
        occlusion_lookup: None,
        emissive_lookup: None,
        textured: false,
        alpha_mode: AlphaMode::Opaque,
        double_sided: true,
    };

    pub(super) fn kind(&self, options: &RenderOptions<'_>) -> Kind {
        match self.alpha_mode {
            AlphaMode::Opaque => Kind::Opaque,
            AlphaMode::Mask(_) => Kind::Masked,
            AlphaMode::Blend if options.paint != Paint::Material => Kind::Opaque,
            AlphaMode::Blend if options.outputs.color => Kind::Blended,
            AlphaMode::Blend => Kind::Hidden,
        }
    }
}

/// All materials, and the images they need.
#[derive(Debug, Clone, Default)]
pub(super) struct Materials<'a> {
    pub prepared: Vec<Prepared>,
    pub chains: Vec<Chain<'a>>,
}

impl<'a> Materials<'a> {
    /// References have been checked.
    pub(super) fn new(model: &Model<'a>) -> Self {
        let mut all = Self::default();
        for material in model.materials {
            let prepared = all.prepare(model, material);
            all.prepared.push(prepared);
        }
        all
    }

    pub(super) fn prepare(&mut self, model: &Model<'a>, m: &Material) -> Prepared {
        let mut lookup =
            |used: &Option<TextureRef>, encoding| self.lookup(model, used.as_ref()?, encoding);
        let metallic_roughness_lookup = lookup(&m.metallic_roughness_texture, Encoding::Plain);
        let occlusion_lookup = lookup(&m.occlusion_texture, Encoding::Plain);
        let emissive_lookup = lookup(&m.emissive_texture, Encoding::Srgb);
        Prepared {
            base_color: m.base_color,
            metallic: unit(m.metallic),
            roughness: unit(m.roughness),
            emissive: m.emissive,
            normal_scale: m.normal_scale,
            occlusion_strength: unit(m.occlusion_strength),
            base_color_lookup: lookup(&m.base_color_texture, Encoding::Srgb),
            metallic_roughness_lookup,
            normal_lookup: lookup(&m.normal_texture, Encoding::Plain),
            occlusion_lookup,
            emissive_lookup,
            textured: [metallic_roughness_lookup, occlusion_lookup, emissive_lookup]
                .iter()
                .any(Option::is_some),
            alpha_mode: m.alpha_mode,
            double_sided: m.double_sided,
        }
    }

    fn lookup(
        &mut self,
        model: &Model<'a>,
        used: &TextureRef,
        encoding: Encoding,
    ) -> Option<Lookup> {
        let texture = model.textures.get(used.texture as usize)?;
        let index = texture.image?;
        let known = self
            .chains
            .iter()
            .position(|c| (c.index, c.encoding) == (index, encoding));
        let chain = match known {
            Some(known) => known,
            None => {
                let image = model.images.get(index as usize)?.as_ref()?;
                self.chains.push(Chain::new(image, index, encoding)?);
                self.chains.len() - 1
            }
        };
        Some(Lookup::new(chain, texture, used))
    }
}
