//! How much of the light that falls on a surface goes to the viewer.
//!
//! Products, quotients and square roots only. Factors of pi cancel: a light's
//! intensity is what a white matte surface facing it gives back.

use super::options::{Ambient, Shading};
use crate::geom::{Vec3, Vec4};

/// A point of a surface and what it is made of.
#[derive(Debug, Clone, Copy)]
pub(super) struct Surface {
    /// Linear colour, and alpha.
    pub base: Vec4,
    pub metallic: f32,
    pub roughness: f32,
    pub emissive: Vec4,
    /// Share of the ambient light that gets there.
    pub occlusion: f32,
    /// Of length 1.
    pub normal: Vec3,
    /// Of length 1, to the viewer.
    pub to_viewer: Vec3,
}

/// Four lights that fall on a point; those that are not there have no radiance.
/// All of them are worked on at a time.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Incident {
    /// Components of the unit vectors to the lights.
    x: [f32; 4],
    y: [f32; 4],
    z: [f32; 4],
    radiance: [Vec4; 4],
}

impl Incident {
    /// Up to four lights: unit vector to each, and radiance.
    pub(super) fn new(lights: &[(Vec3, Vec3)]) -> Self {
        let mut all = Self::default();
        for (k, (to_light, radiance)) in lights.iter().take(4).enumerate() {
            (all.x[k], all.y[k], all.z[k]) = (to_light.x, to_light.y, to_light.z);
            all.radiance[k] = radiance.extend(0.0);
        }
        all
    }

    #[inline]
    fn dot(&self, v: Vec3) -> [f32; 4] {
        four(|k| v.x * self.x[k] + v.y * self.y[k] + v.z * self.z[k])
    }
}

/// A loop that compilers see through.
#[inline]
fn four(mut f: impl FnMut(usize) -> f32) -> [f32; 4] {
    [f(0), f(1), f(2), f(3)]
}

/// Reflectance of what is not metal, seen straight on.
const DIELECTRIC: f32 = 0.04;

/// Roughness below which a highlight is smaller than a pixel ever is.
const LEAST_ROUGHNESS: f32 = 0.05;

/// Terms that do not depend on the light. Colours have a fourth component that
/// nobody reads.
pub(super) struct Answer {
    shading: Shading,
    normal: Vec3,
    to_viewer: Vec3,
    /// Reflectance seen straight on, and what is left to 1.
    specular: Vec4,
    rest: Vec4,
    diffuse: Vec4,
    roughness: f32,
    occlusion: f32,
    /// Square of the width of the distribution of microfacets.
    width: f32,
    /// Cosine between normal and view, and the same not cut off.
    facing: f32,
    cosine: f32,
}

impl Answer {
    #[inline]
    pub(super) fn new(surface: &Surface, shading: Shading) -> Self {
        let metallic = surface.metallic;
        let specular = Vec4::splat(DIELECTRIC * (1.0 - metallic)) + surface.base * metallic;
        let alpha = surface.roughness.max(LEAST_ROUGHNESS);
        let cosine = surface.normal.dot(surface.to_viewer);
        Self {
            shading,
            normal: surface.normal,
            to_viewer: surface.to_viewer,
            specular,
            rest: Vec4::ONE - specular,
            diffuse: surface.base * (1.0 - metallic),
            roughness: surface.roughness,
            occlusion: surface.occlusion,
            width: (alpha * alpha) * (alpha * alpha),
            facing: cosine.max(1e-3),
            cosine,
        }
    }

    /// What four lights add. The normals halfway between light and viewer are never
    /// made: their cosines follow from those of the two.
    #[inline]
    pub(super) fn to(&self, lights: &Incident) -> Vec4 {
        let lit = lights.dot(self.normal).map(|l| l.max(0.0));
        // Squared cosine between half the way and either.
        let open = lights
            .dot(self.to_viewer)
            .map(|c| (0.5 + 0.5 * c).max(1e-6));
        let along = lit.map(|l| (l + self.cosine).max(0.0));
        let squared = four(|k| (along[k] * along[k] / (4.0 * open[k])).min(1.0));
        let grazing = open.map(|o| fifth((1.0 - o.sqrt()).max(0.0)));
        let highlight = match self.shading {
            Shading::BlinnPhong => squared.map(|s| self.blinn(s.sqrt())),
            _ => self.ggx(squared, lit),
        };
        let matte = self.diffuse * self.rest;
        let mut sum = Vec4::ZERO;
        for k in 0..4 {
            // Fresnel is specular + rest * grazing, matte what is left of the diffuse.
            let mirrored = (self.specular + self.rest * grazing[k]) * highlight[k];
            sum += (mirrored + matte * (1.0 - grazing[k])) * (lights.radiance[k] * lit[k]);
        }
        sum
    }

    /// Distribution times masking, by four cosines, times pi.
    #[inline]
    fn ggx(&self, squared: [f32; 4], lit: [f32; 4]) -> [f32; 4] {
        let rest = 1.0 - self.width;
        let masking = |cosine: f32| (cosine * cosine * rest + self.width).sqrt();
        let viewer = masking(self.facing);
        let spread = squared.map(|s| 1.0 - s * rest);
        let masked = lit.map(|l| l * viewer + self.facing * masking(l));
        four(|k| 0.5 * self.width / (spread[k] * spread[k] * masked[k]))
    }

    /// A power of the cosine, scaled so that no light is gained; the exponent is
    /// the one whose highlight is as wide as that of the microfacets.
    fn blinn(&self, cosine: f32) -> f32 {
        let exponent = (2.0 / self.width - 2.0).clamp(1.0, 2048.0) as u32;
        power(cosine, exponent) * (exponent as f32 + 8.0) * 0.125
    }

    /// What light from all around adds.
    #[inline]
    pub(super) fn to_ambient(&self, ambient: &Ambient, up: Vec3) -> Vec4 {
        let (sky, ground) = (ambient.sky.extend(0.0), ambient.ground.extend(0.0));
        let from = |along_up: f32| ground + (sky - ground) * (0.5 + 0.5 * along_up);
        let normal = self.normal.dot(up);
        let mirrored = 2.0 * self.cosine * normal - self.to_viewer.dot(up);
        // A rough surface mirrors less where it is seen from the side.
        let most = Vec4::splat(1.0 - self.roughness).max(self.specular);
        let grazing = fifth(1.0 - self.facing.min(1.0));
        let specular = self.specular + (most - self.specular) * grazing;
        (self.diffuse * from(normal) + specular * from(mirrored)) * self.occlusion
    }
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
            base: Vec4::ONE,
            metallic,
            roughness,
            emissive: Vec4::ZERO,
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
                let answer = Answer::new(&surface(roughness, metallic), shading);
                let (steps, mut sum, mut count) = (300, 0.0, 0);
                for (i, j) in (0..steps * steps).map(|k| (k / steps, k % steps)) {
                    let at = |k: i32| (k as f32 + 0.5) / steps as f32 * 2.0 - 1.0;
                    let (x, y) = (at(i), at(j));
                    let rest = 1.0 - x * x - y * y;
                    if rest > 0.0 {
                        // Even over the disc is already weighted by the cosine.
                        let to_light = Vec3::new(x, y, rest.sqrt());
                        let light = Incident::new(&[(to_light, Vec3::ONE / to_light.z)]);
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
        let light = Incident::new(&[(Vec3::Z, Vec3::ONE)]);
        let found = Answer::new(&matte, Shading::Pbr).to(&light).x;
        assert!((found - (0.96 + 0.04 * 0.25)).abs() < 1e-4, "{found}");
    }

    #[test]
    fn powers_are_products() {
        assert_eq!(power(2.0, 10), 1024.0);
        assert_eq!(power(0.5, 0), 1.0);
        assert!((power(0.99, 2048) - 0.99f32.powi(2048)).abs() < 1e-12);
    }
}
