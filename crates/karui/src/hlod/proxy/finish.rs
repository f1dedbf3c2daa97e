//! How surfaces answer light, in the mean.

use super::group::{Group, Slot};
use super::outfit::clay;
use crate::geom::{Vec3, area};
use crate::mesh::{Material, TextureRef};

/// Pixels looked at for the mean of an image.
const LOOKED_AT: usize = 4096;

/// Mean metalness, roughness and emission of a surface.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Finish {
    pub metallic: f32,
    pub roughness: f32,
    pub emissive: Vec3,
}

impl Finish {
    /// Of the slots chosen, by their area.
    pub fn of(group: &Group<'_>, chosen: impl Fn(usize) -> bool) -> Self {
        let mut sum = Self::default();
        let mut whole = 0.0;
        for (s, slot) in group.slots.iter().enumerate().filter(|(s, _)| chosen(*s)) {
            let triangles = group.mesh.ranges[s].triangles();
            let size: f64 = triangles.map(|t| area(group.mesh.corners(t))).sum();
            let (size, one) = (size as f32, Self::of_slot(slot));
            sum.metallic += one.metallic * size;
            sum.roughness += one.roughness * size;
            sum.emissive += one.emissive * size;
            whole += size;
        }
        let by = if whole > 0.0 { 1.0 / whole } else { 0.0 };
        Self {
            metallic: (sum.metallic * by).clamp(0.0, 1.0),
            roughness: (sum.roughness * by).clamp(0.0, 1.0),
            emissive: sum.emissive * by,
        }
    }

    fn of_slot(slot: &Slot<'_>) -> Self {
        let clay = clay();
        let material = slot.material().unwrap_or(&clay);
        let mean = |used: &Option<TextureRef>| mean(slot, used.as_ref()?);
        let [_, rough, metal] = mean(&material.metallic_roughness_texture).unwrap_or([1.0; 3]);
        let glow = mean(&material.emissive_texture).unwrap_or([1.0; 3]);
        Self {
            metallic: material.metallic * metal,
            roughness: material.roughness * rough,
            // Codes are squared for light: near enough for a mean.
            emissive: material.emissive * Vec3::from_array(glow.map(|g| g * g)),
        }
    }

    /// A material that answers light so, otherwise the default.
    pub fn material(&self) -> Material {
        Material {
            metallic: self.metallic,
            roughness: self.roughness,
            emissive: self.emissive,
            ..Material::default()
        }
    }
}

/// Mean of an image's channels, 0 to 1, by every so manieth pixel.
fn mean(slot: &Slot<'_>, used: &TextureRef) -> Option<[f32; 3]> {
    let texture = slot.look.textures.get(used.texture as usize)?;
    let picture = slot.look.images.get(texture.image? as usize)?.as_ref()?;
    if used.uv_set as usize >= slot.uv_sets || picture.pixels().is_empty() {
        return None;
    }
    // An odd step does not stay in one column.
    let step = (picture.pixels().len() / LOOKED_AT) | 1;
    let mut sums = [0u64; 3];
    let mut count = 0u64;
    for pixel in picture.pixels().iter().step_by(step) {
        count += 1;
        (0..3).for_each(|k| sums[k] += u64::from(pixel[k]));
    }
    Some(sums.map(|sum| (sum as f64 / (255 * count) as f64) as f32))
}
