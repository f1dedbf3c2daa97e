//! Colours of surfaces apart from any picture.

use super::Picture;
use super::material::{Materials, Prepared};
use super::model::Model;
use super::srgb::{Srgb, plain_code};
use crate::geom::{Vec2, Vec4};
use crate::mesh::{Material, Texture};

/// Base colours of materials, their textures with smaller copies at hand.
#[derive(Debug, Clone, Default)]
pub(crate) struct BaseColors<'a>(Materials<'a>);

/// Place in a UV set, and how far it moves over a step in either direction.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Footprint {
    pub uv: Vec2,
    pub slopes: [Vec2; 2],
}

impl<'a> BaseColors<'a> {
    /// Textures that cannot be found are done without.
    pub fn new(
        materials: &[Material],
        textures: &'a [Texture],
        images: &'a [Option<Picture>],
    ) -> Self {
        let model = Model {
            textures,
            images,
            ..Model::default()
        };
        let mut all = Materials::default();
        for material in materials {
            let plain = Material {
                base_color: material.base_color,
                base_color_texture: material.base_color_texture,
                ..Material::default()
            };
            let prepared = all.prepare(&model, &plain);
            all.prepared.push(prepared);
        }
        Self(all)
    }

    /// Factor and texture of a material, linear with straight alpha; the grey of
    /// what has no material for `None`. `footprint` tells where a UV set is
    /// looked up, `None` if there is no such set.
    pub fn at(
        &self,
        material: Option<u32>,
        footprint: impl FnOnce(usize) -> Option<Footprint>,
    ) -> Vec4 {
        let known = material.and_then(|m| self.0.prepared.get(m as usize));
        let prepared = known.unwrap_or(&Prepared::CLAY);
        let Some(lookup) = &prepared.base_color_lookup else {
            return prepared.base_color;
        };
        let Some(at) = footprint(lookup.uv_set) else {
            return prepared.base_color;
        };
        let chain = &self.0.chains[lookup.chain];
        let texel = lookup.at(chain, Srgb::new(), at.uv, at.slopes);
        prepared.base_color * Vec4::from_array(texel)
    }

    /// Whether the colour of a material depends on the place.
    pub fn is_textured(&self, material: Option<u32>) -> bool {
        let known = material.and_then(|m| self.0.prepared.get(m as usize));
        known.is_some_and(|p| p.base_color_lookup.is_some())
    }
}

/// A linear colour with straight alpha as pixels have it.
pub(crate) fn encoded(color: Vec4) -> [u8; 4] {
    let code = |c| Srgb::new().code(c);
    [
        code(color.x),
        code(color.y),
        code(color.z),
        plain_code(color.w),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{TextureRef, Wrap};

    #[test]
    fn factor_times_texture_filtered_over_the_footprint() {
        let checks = [[255; 4], [0, 0, 0, 255], [0, 0, 0, 255], [255; 4]];
        let images = [Some(Picture::new(2, 2, checks.to_vec()).unwrap())];
        let textures = [Texture {
            image: Some(0),
            wrap: [Wrap::Repeat; 2],
            nearest: false,
        }];
        let material = Material {
            base_color: Vec4::new(0.5, 1.0, 1.0, 1.0),
            base_color_texture: Some(TextureRef {
                texture: 0,
                uv_set: 0,
                transform: None,
            }),
            ..Material::default()
        };
        let colors = BaseColors::new(&[material], &textures, &images);
        let at = |slope: f32| {
            let slopes = [Vec2::new(slope, 0.0), Vec2::ZERO];
            let uv = Vec2::splat(0.25);
            colors.at(Some(0), |_| Some(Footprint { uv, slopes }))
        };
        assert_eq!(at(0.0), Vec4::new(0.5, 1.0, 1.0, 1.0));
        // From afar half of it is black.
        assert!((at(4.0).x - 0.25).abs() < 0.01 && (at(4.0).y - 0.5).abs() < 0.01);
        assert!(colors.is_textured(Some(0)) && !colors.is_textured(None));
        assert_eq!(colors.at(Some(9), |_| None), Prepared::CLAY.base_color);
        assert_eq!(encoded(Vec4::new(0.0, 1.0, 2.0, 0.5)), [0, 255, 255, 128]);
    }
}
