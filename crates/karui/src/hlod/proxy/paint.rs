//! What colour the members have, at every place of their surface.

use super::group::Group;
use crate::geom::{DVec3, Vec2, Vec4};
use crate::mesh::AlphaMode;
use crate::render::Footprint;

/// Base colours over the surface of a group.
pub(super) struct Paint<'a> {
    group: &'a Group<'a>,
    slot_of: Vec<u32>,
}

impl<'a> Paint<'a> {
    pub fn new(group: &'a Group<'a>) -> Self {
        Self {
            group,
            slot_of: group.mesh.range_of_triangles(),
        }
    }

    /// Slot of a triangle.
    pub fn slot(&self, triangle: u32) -> usize {
        self.slot_of[triangle as usize] as usize
    }

    /// Base colour on a triangle, linear with straight alpha, filtered over a step
    /// of `texel` model units. Alpha is 1 where it does not matter, and half where a
    /// mask begins.
    pub fn color(&self, triangle: u32, weights: [f64; 3], texel: f64) -> Vec4 {
        let slot = &self.group.slots[self.slot(triangle)];
        let vertices = self.group.mesh.triangles[triangle as usize].map(|v| v as usize);
        let attributes = &self.group.mesh.attributes;
        let weights = weights.map(|w| w as f32);
        let mut color = slot.look.colors.at(slot.material, |set| {
            let uvs = attributes.uvs.get(set).filter(|_| set < slot.uv_sets)?;
            let uvs = vertices.map(|v| uvs[v]);
            let uv = uvs[0] * weights[0] + uvs[1] * weights[1] + uvs[2] * weights[2];
            let slopes = self.slopes(triangle, uvs, texel);
            Some(Footprint { uv, slopes })
        });
        if let Some(colors) = attributes.colors.first() {
            let [a, b, c] = vertices.map(|v| colors[v]);
            color *= a * weights[0] + b * weights[1] + c * weights[2];
        }
        color.w = self.alpha(slot.material().map(|m| m.alpha_mode), color.w);
        color
    }

    fn alpha(&self, mode: Option<AlphaMode>, alpha: f32) -> f32 {
        match mode {
            None | Some(AlphaMode::Opaque) => 1.0,
            Some(AlphaMode::Mask(cutoff)) if cutoff > 0.0 => (alpha * 0.5 / cutoff).clamp(0.0, 1.0),
            Some(AlphaMode::Mask(_)) => 1.0,
            Some(AlphaMode::Blend) => alpha.clamp(0.0, 1.0),
        }
    }

    /// How UVs move over a step along the surface, one way and across.
    fn slopes(&self, triangle: u32, uvs: [Vec2; 3], texel: f64) -> [Vec2; 2] {
        let [a, b, c] = self.group.mesh.corners(triangle as usize);
        let (p, q) = (b - a, c - a);
        let (d, e) = (uvs[1] - uvs[0], uvs[2] - uvs[0]);
        let x = p.normalize_or_zero();
        let y = (q - x * q.dot(x)).normalize_or(DVec3::ZERO);
        let (length, height) = (p.length(), q.dot(y));
        if !(length > 0.0 && height > 0.0) {
            return [Vec2::ZERO; 2];
        }
        let along = d / length as f32;
        let across = (e - along * q.dot(x) as f32) / height as f32;
        [along, across].map(|slope| slope * texel as f32)
    }
}
