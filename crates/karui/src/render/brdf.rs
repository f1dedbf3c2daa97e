//! How much of the light that falls on a surface goes to the viewer.
//!
//! Products, quotients and square roots only. Factors of pi cancel: a light's
//! intensity is what a white matte surface facing it gives back.

use super::options::{Ambient, Shading};
use crate::geom::Vec3;

/// A point of a surface and what it is made of.
#[derive(Debug, Clone, Copy)]
pub(super) struct Surface {
    pub base: Vec3,
    pub alpha: f32,
    pub metallic: f32,
    pub roughness: f32,
    pub emissive: Vec3,
    /// Share of the ambient light that gets there.
    pub occlusion: f32,
    /// Of length 1.
    pub normal: Vec3,
    /// Of length 1, to the viewer.
    pub to_viewer: Vec3,
}

/// Light that falls on a point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Incident {
    /// Of length 1, to the light.
    pub to_light: Vec3,
    pub radiance: Vec3,
}

/// Reflectance of what is not metal, seen straight on.
const DIELECTRIC: f32 = 0.04;

/// Roughness below which a highlight is smaller than a pixel ever is.
const LEAST_ROUGHNESS: f32 = 0.05;

/// Terms that do not depend on the light.
pub(super) struct Answer {
    surface: Surface,
    shading: Shading,
    /// Reflectance seen straight on.
    specular: Vec3,
    diffuse: Vec3,
    /// Square of the width of the distribution of microfacets.
    width: f32,
    /// Cosine between normal and view, and the same not cut off.
    facing: f32,
    cosine: f32,
    /// The viewer's part of the masking.
    masking: f32,
}

impl Answer {
    #[inline]
    pub(super) fn new(surface: Surface, shading: Shading) -> Self {
        let metallic = surface.metallic;
        let specular = Vec3::splat(DIELECTRIC * (1.0 - metallic)) + surface.base * metallic;
        let alpha = surface.roughness.max(LEAST_ROUGHNESS);
        let width = (alpha * alpha) * (alpha * alpha);
        let cosine = surface.normal.dot(surface.to_viewer);
        let facing = cosine.max(1e-3);
        Self {
            shading,
            specular,
            diffuse: surface.base * (1.0 - metallic),
            width,
            facing,
            cosine,
            masking: masking(facing, width),
            surface,
        }
    }

    /// What one light adds. The normal halfway between light and viewer is never
    /// made: its cosines follow from those of the two.
    #[inline]
    pub(super) fn to(&self, light: &Incident) -> Vec3 {
        let lit = self.surface.normal.dot(light.to_light);
        if lit <= 0.0 {
            return Vec3::ZERO;
        }
        // Squared cosine between half the way and either.
        let open = 0.5 + 0.5 * light.to_light.dot(self.surface.to_viewer);
        if open < 1e-6 {
            return self.diffuse * light.radiance * lit;
        }
        let along = (lit + self.cosine).max(0.0);
        let squared = (along * along / (4.0 * open)).min(1.0);
        let fresnel = schlick(self.specular, open.sqrt());
        let highlight = match self.shading {
            Shading::BlinnPhong => self.blinn(squared.sqrt()),
            _ => self.ggx(squared, lit),
        };
        let matte = self.diffuse * (Vec3::ONE - fresnel);
        (matte + fresnel * highlight) * light.radiance * lit
    }

    /// Distribution times masking, by four cosines, times pi.
    #[inline]
    fn ggx(&self, squared: f32, lit: f32) -> f32 {
        let spread = squared * (self.width - 1.0) + 1.0;
        let masking = lit * self.masking + self.facing * masking(lit, self.width);
        0.5 * self.width / (spread * spread * masking)
    }

    /// A power of the cosine, scaled so that no light is gained; the exponent is
    /// the one whose highlight is as wide as that of the microfacets.
    fn blinn(&self, cosine: f32) -> f32 {
        let exponent = (2.0 / self.width - 2.0).clamp(1.0, 2048.0) as u32;
        power(cosine, exponent) * (exponent as f32 + 8.0) * 0.125
    }

    /// What light from all around adds.
    #[inline]
    pub(super) fn to_ambient(&self, ambient: &Ambient, up: Vec3) -> Vec3 {
        let from = |direction: Vec3| {
            let above = 0.5 + 0.5 * direction.dot(up).clamp(-1.0, 1.0);
            ambient.ground + (ambient.sky - ambient.ground) * above
        };
        let Surface {
            normal, to_viewer, ..
        } = self.surface;
        let mirrored = normal * (2.0 * self.cosine) - to_viewer;
        // A rough surface mirrors less where it is seen from the side.
        let most = Vec3::splat(1.0 - self.surface.roughness).max(self.specular);
        let grazing = fifth(1.0 - self.facing.min(1.0));
        let specular = self.specular + (most - self.specular) * grazing;
        (self.diffuse * from(normal) + specular * from(mirrored)) * self.surface.occlusion
    }
}

#[inline]
fn masking(cosine: f32, width: f32) -> f32 {
    (cosine * cosine * (1.0 - width) + width).sqrt()
}

#[inline]
fn schlick(straight: Vec3, cosine: f32) -> Vec3 {
    straight + (Vec3::ONE - straight) * fifth(1.0 - cosine.clamp(0.0, 1.0))
}

fn fifth(x: f32) -> f32 {
    let square = x * x;
    square * square * x
}

/// A whole power by repeated squaring.
fn power(base: f32, mut exponent: u32) -> f32 {
    let (mut result, mut square) = (1.0, base);
    while exponent > 0 {
        if exponent & 1 == 1 {
            result *= square;
        }
        square *= square;
        exponent >>= 1;
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    fn surface(roughness: f32, metallic: f32) -> Surface {
        Surface {
            base: Vec3::ONE,
            alpha: 1.0,
            metallic,
            roughness,
            emissive: Vec3::ZERO,
            occlusion: 1.0,
            normal: Vec3::Z,
            to_viewer: Vec3::new(0.6, 0.0, 0.8),
        }
    }

    /// Over all directions of light, a surface gives back at most what it gets.
    #[test]
    fn no_light_is_gained() {
        for shading in [Shading::Pbr, Shading::BlinnPhong] {
            for (roughness, metallic) in [(0.3, 0.0), (0.3, 1.0), (0.6, 1.0), (1.0, 0.0)] {
                let answer = Answer::new(surface(roughness, metallic), shading);
                let (steps, mut sum, mut count) = (300, 0.0, 0);
                for (i, j) in (0..steps * steps).map(|k| (k / steps, k % steps)) {
                    let at = |k: i32| (k as f32 + 0.5) / steps as f32 * 2.0 - 1.0;
                    let (x, y) = (at(i), at(j));
                    let rest = 1.0 - x * x - y * y;
                    if rest > 0.0 {
                        // Even over the disc is already weighted by the cosine.
                        let to_light = Vec3::new(x, y, rest.sqrt());
                        let light = Incident {
                            to_light,
                            radiance: Vec3::ONE / to_light.z,
                        };
                        sum += answer.to(&light).x;
                        count += 1;
                    }
                }
                let mean = sum / count as f32;
                assert!(
                    mean < 1.03 && mean > 0.4,
                    "{shading:?} {roughness} {metallic}: {mean}"
                );
            }
        }
    }

    #[test]
    fn a_white_matte_surface_facing_the_light_is_white() {
        let mut matte = surface(1.0, 0.0);
        matte.to_viewer = Vec3::Z;
        let light = Incident {
            to_light: Vec3::Z,
            radiance: Vec3::ONE,
        };
        let found = Answer::new(matte, Shading::Pbr).to(&light).x;
        assert!((found - (0.96 + 0.04 * 0.25)).abs() < 1e-4, "{found}");
    }

    #[test]
    fn powers_are_products() {
        assert_eq!(power(2.0, 10), 1024.0);
        assert_eq!(power(0.5, 0), 1.0);
        assert!((power(0.99, 2048) - 0.99f32.powi(2048)).abs() < 1e-12);
    }
}
