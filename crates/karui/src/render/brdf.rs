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
    pub emissive: Vec3,
    /// Share of the ambient light that gets there.
    pub occlusion: f32,
    /// Of length 1.
    pub normal: Vec3,
    /// Of length 1, to the viewer.
    pub to_viewer: Vec3,
}

/// One value each for four points: all of them are worked on at a time.
pub(super) type Four = [f32; 4];

/// A vector or a colour each.
pub(super) type Four3 = [Four; 3];

/// A loop that compilers see through.
#[inline]
fn four(mut f: impl FnMut(usize) -> f32) -> Four {
    [f(0), f(1), f(2), f(3)]
}

/// Components of four vectors.
#[inline]
pub(super) fn components(vectors: &[Vec3; 4]) -> Four3 {
    [
        four(|k| vectors[k].x),
        four(|k| vectors[k].y),
        four(|k| vectors[k].z),
    ]
}

#[inline]
fn dot(a: &Four3, b: &Four3) -> Four {
    four(|k| a[0][k] * b[0][k] + a[1][k] * b[1][k] + a[2][k] * b[2][k])
}

/// Light that falls on four points.
#[derive(Debug, Clone, Copy)]
pub(super) struct Incident {
    /// Of length 1, to the light.
    to_light: Four3,
    radiance: Four3,
}

impl Incident {
    /// Of one light: unit vector to it from each point, and radiance.
    pub(super) fn new(to_light: &[Vec3; 4], radiance: &[Vec3; 4]) -> Self {
        Self {
            to_light: components(to_light),
            radiance: components(radiance),
        }
    }
}

/// Reflectance of what is not metal, seen straight on.
const DIELECTRIC: f32 = 0.04;

/// Roughness below which a highlight is smaller than a pixel ever is.
const LEAST_ROUGHNESS: f32 = 0.05;

/// Terms that do not depend on the light, for four points.
pub(super) struct Answer {
    shading: Shading,
    normal: Four3,
    to_viewer: Four3,
    /// Reflectance seen straight on.
    specular: Four3,
    diffuse: Four3,
    roughness: Four,
    occlusion: Four,
    /// Square of the width of the distribution of microfacets.
    width: Four,
    /// Cosine between normal and view, and the same not cut off.
    facing: Four,
    cosine: Four,
}

impl Answer {
    #[inline]
    pub(super) fn new(points: &[Surface; 4], shading: Shading) -> Self {
        let metallic = four(|k| points[k].metallic);
        let base = [0, 1, 2].map(|c| four(|k| points[k].base[c]));
        let alpha = four(|k| points[k].roughness.max(LEAST_ROUGHNESS));
        let normal = components(&points.map(|p| p.normal));
        let to_viewer = components(&points.map(|p| p.to_viewer));
        let cosine = dot(&normal, &to_viewer);
        let dielectric = metallic.map(|m| DIELECTRIC * (1.0 - m));
        Self {
            shading,
            normal,
            to_viewer,
            specular: base.map(|c| four(|k| dielectric[k] + c[k] * metallic[k])),
            diffuse: base.map(|c| four(|k| c[k] * (1.0 - metallic[k]))),
            roughness: four(|k| points[k].roughness),
            occlusion: four(|k| points[k].occlusion),
            width: alpha.map(|a| (a * a) * (a * a)),
            facing: cosine.map(|c| c.max(1e-3)),
            cosine,
        }
    }

    /// Adds what one light does. The normal halfway between light and viewer is never
    /// made: its cosines follow from those of the two.
    #[inline]
    pub(super) fn add(&self, light: &Incident, sum: &mut Four3) {
        let lit = dot(&light.to_light, &self.normal).map(|l| l.max(0.0));
        // Squared cosine between half the way and either.
        let open = dot(&light.to_light, &self.to_viewer).map(|c| (0.5 + 0.5 * c).max(1e-6));
        let along = four(|k| (lit[k] + self.cosine[k]).max(0.0));
        let squared = four(|k| (along[k] * along[k] / (4.0 * open[k])).min(1.0));
        let grazing = open.map(|o| fifth((1.0 - o.sqrt()).max(0.0)));
        let highlight = match self.shading {
            Shading::BlinnPhong => four(|k| blinn(squared[k].sqrt(), self.width[k])),
            _ => self.ggx(squared, lit),
        };
        for (c, sum) in sum.iter_mut().enumerate() {
            let (specular, diffuse) = (&self.specular[c], &self.diffuse[c]);
            *sum = four(|k| {
                let fresnel = specular[k] + (1.0 - specular[k]) * grazing[k];
                let given = diffuse[k] * (1.0 - fresnel) + fresnel * highlight[k];
                sum[k] + given * (light.radiance[c][k] * lit[k])
            });
        }
    }

    /// Distribution times masking, by four cosines, times pi.
    #[inline]
    fn ggx(&self, squared: Four, lit: Four) -> Four {
        let rest = self.width.map(|w| 1.0 - w);
        let masking =
            |cosine: Four| four(|k| (cosine[k] * cosine[k] * rest[k] + self.width[k]).sqrt());
        let (viewer, light) = (masking(self.facing), masking(lit));
        let masked = four(|k| lit[k] * viewer[k] + self.facing[k] * light[k]);
        let spread = four(|k| 1.0 - squared[k] * rest[k]);
        four(|k| 0.5 * self.width[k] / (spread[k] * spread[k] * masked[k]))
    }

    /// What light from all around does.
    #[inline]
    pub(super) fn ambient(&self, ambient: &Ambient, up: Vec3) -> Four3 {
        let up = components(&[up; 4]);
        let share = |along: f32| 0.5 + 0.5 * along;
        let normal = dot(&self.normal, &up);
        let viewer = dot(&self.to_viewer, &up);
        let mirrored = four(|k| share(2.0 * self.cosine[k] * normal[k] - viewer[k]));
        let normal = normal.map(share);
        let grazing = self.facing.map(|f| fifth((1.0 - f).max(0.0)));
        std::array::from_fn(|c| {
            let (ground, sky) = (ambient.ground[c], ambient.sky[c]);
            four(|k| {
                let from = |share: f32| ground + (sky - ground) * share;
                // A rough surface mirrors less where it is seen from the side.
                let straight = self.specular[c][k];
                let most = (1.0 - self.roughness[k]).max(straight);
                let specular = straight + (most - straight) * grazing[k];
                let given = self.diffuse[c][k] * from(normal[k]) + specular * from(mirrored[k]);
                given * self.occlusion[k]
            })
        })
    }
}

/// A power of the cosine, scaled so that no light is gained; the exponent is the one
/// whose highlight is as wide as that of the microfacets.
fn blinn(cosine: f32, width: f32) -> f32 {
    let exponent = (2.0 / width - 2.0).clamp(1.0, 2048.0) as u32;
    power(cosine, exponent) * (exponent as f32 + 8.0) * 0.125
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
                let answer = Answer::new(&[surface(roughness, metallic); 4], shading);
                let (steps, mut sum, mut count) = (300, 0.0, 0);
                for (i, j) in (0..steps * steps).map(|k| (k / steps, k % steps)) {
                    let at = |k: i32| (k as f32 + 0.5) / steps as f32 * 2.0 - 1.0;
                    let (x, y) = (at(i), at(j));
                    let rest = 1.0 - x * x - y * y;
                    if rest > 0.0 {
                        // Even over the disc is already weighted by the cosine.
                        let to_light = Vec3::new(x, y, rest.sqrt());
                        let radiance = Vec3::ONE / to_light.z;
                        let light = Incident::new(&[to_light; 4], &[radiance; 4]);
                        let mut given = Four3::default();
                        answer.add(&light, &mut given);
                        sum += given[0][3];
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
        let light = Incident::new(&[Vec3::Z; 4], &[Vec3::ONE; 4]);
        let mut given = Four3::default();
        Answer::new(&[matte; 4], Shading::Pbr).add(&light, &mut given);
        let found = given[2][1];
        assert!((found - (0.96 + 0.04 * 0.25)).abs() < 1e-4, "{found}");
    }

    #[test]
    fn powers_are_products() {
        assert_eq!(power(2.0, 10), 1024.0);
        assert_eq!(power(0.5, 0), 1.0);
        assert!((power(0.99, 2048) - 0.99f32.powi(2048)).abs() < 1e-12);
    }
}
