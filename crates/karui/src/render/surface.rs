//! What a surface is like at a sample: attributes mixed, textures looked up.

use super::brdf::Surface;
use super::geometry::Part;
use super::material::Prepared;
use super::options::{Normals, Paint, Scalar};
use super::place::Place;
use super::shade::{Seen, Shader};
use super::texture::Lookup;
use crate::geom::{Vec2, Vec3, Vec4};
use std::cell::OnceCell;

/// A sample on a triangle.
pub(super) struct Sample<'s> {
    shader: &'s Shader<'s>,
    triangle: u32,
    part: &'s Part<'s>,
    pub material: &'s Prepared,
    place: &'s Place,
    weights: [f32; 3],
    /// See [`Place::slopes`]; what has no texture does not need them.
    slopes: OnceCell<[[f32; 3]; 2]>,
}

impl<'s> Sample<'s> {
    #[inline]
    pub(super) fn new(shader: &'s Shader<'s>, seen: &'s Seen) -> Self {
        let Seen {
            triangle, place, ..
        } = seen;
        let triangle = *triangle;
        let renderer = shader.renderer;
        let part = renderer.part_of(triangle);
        Self {
            shader,
            triangle,
            part,
            material: renderer.material(part),
            place,
            weights: place.weights(),
            slopes: OnceCell::new(),
        }
    }

    #[inline]
    pub(super) fn surface(&self, to_viewer: Vec3) -> Surface {
        let (base, m) = match &self.shader.options.paint {
            Paint::Material => (self.base_color(), self.material),
            Paint::Clay => (Prepared::CLAY.base_color, &Prepared::CLAY),
            Paint::Scalar(scalar) => (self.scalar_color(scalar), &Prepared::CLAY),
        };
        let mut surface = Surface {
            base,
            metallic: m.metallic,
            roughness: m.roughness,
            emissive: m.emissive,
            occlusion: 1.0,
            normal: self.normal(m),
            to_viewer,
        };
        if m.textured {
            self.look_up(m, &mut surface);
        }
        surface
    }

    /// What textures say besides colour and normal.
    fn look_up(&self, m: &Prepared, surface: &mut Surface) {
        if let Some([_, rough, metal, _]) = self.texel(&m.metallic_roughness_lookup) {
            surface.roughness *= rough;
            surface.metallic *= metal;
        }
        if let Some([occluded, ..]) = self.texel(&m.occlusion_lookup) {
            surface.occlusion += m.occlusion_strength * (occluded - 1.0);
        }
        if let Some([r, g, b, _]) = self.texel(&m.emissive_lookup) {
            surface.emissive *= Vec3::new(r, g, b);
        }
    }

    /// Colour of the material, its texture and the vertices, linear.
    pub(super) fn base_color(&self) -> Vec4 {
        let mut color = self.material.base_color;
        if let Some([r, g, b, a]) = self.texel(&self.material.base_color_lookup) {
            color *= Vec4::new(r, g, b, a);
        }
        if let Some(colors) = self.part.mesh.attributes.colors.first() {
            let [a, b, c] = self.vertices().map(|v| colors[v]);
            color *= a * self.weights[0] + b * self.weights[1] + c * self.weights[2];
        }
        color
    }

    fn scalar_color(&self, scalar: &Scalar<'_>) -> Vec4 {
        let values = scalar.values[self.part.mesh_index as usize];
        let [a, b, c] = self.vertices().map(|v| values[v]);
        let value = a * self.weights[0] + b * self.weights[1] + c * self.weights[2];
        let share = (value - scalar.low) / (scalar.high - scalar.low);
        if !share.is_finite() {
            return Prepared::CLAY.base_color;
        }
        let color = scalar.map[(share.clamp(0.0, 1.0) * 255.0 + 0.5) as usize];
        let [r, g, b] = color.map(|code| self.shader.srgb.linear(code));
        Vec4::new(r, g, b, 1.0)
    }

    /// Vertices in the part's mesh.
    #[inline]
    fn vertices(&self) -> [usize; 3] {
        self.part.triangle(self.triangle).map(|v| v as usize)
    }

    /// What a texture holds here; `None` without texture or without UVs for it.
    #[inline]
    fn texel(&self, lookup: &Option<Lookup>) -> Option<[f32; 4]> {
        self.looked_up(lookup.as_ref()?)
    }

    fn looked_up(&self, lookup: &Lookup) -> Option<[f32; 4]> {
        let uvs = self.uvs(lookup)?;
        let mixed = |[a, b, c]: [f32; 3]| uvs[0] * a + uvs[1] * b + uvs[2] * c;
        let slopes = self.slopes.get_or_init(|| {
            let steps = self.shader.pass.steps(self.triangle);
            self.place.slopes(&steps)
        });
        let slopes = slopes.map(mixed);
        let chain = &self.shader.renderer.materials.chains[lookup.chain];
        Some(lookup.at(chain, self.shader.srgb, mixed(self.weights), slopes))
    }

    fn uvs(&self, lookup: &Lookup) -> Option<[Vec2; 3]> {
        let uvs = self.part.mesh.attributes.uvs.get(lookup.uv_set)?;
        Some(self.vertices().map(|v| uvs[v]))
    }

    /// Whether the front is seen.
    fn front(&self) -> bool {
        self.place.counter_clockwise != self.part.mirrored
    }

    /// Of length 1, on the side that is seen.
    fn normal(&self, m: &Prepared) -> Vec3 {
        let mut normal = self.smooth_normal().unwrap_or_else(|| self.face_normal());
        if let Some(texel) = self.texel(&m.normal_lookup) {
            normal = self.bumped(normal, m, texel).unwrap_or(normal);
        }
        if self.front() { normal } else { -normal }
    }

    #[inline]
    fn smooth_normal(&self) -> Option<Vec3> {
        if self.shader.options.normals == Normals::Flat {
            return None;
        }
        let geometry = &self.shader.renderer.geometry;
        let [a, b, c] = geometry.normals_of(self.triangle);
        unit(a * self.weights[0] + b * self.weights[1] + c * self.weights[2])
    }

    /// Towards the front; up for a triangle without area.
    fn face_normal(&self) -> Vec3 {
        let [a, b, c] = self.corners().map(Vec3::as_dvec3);
        let normal = (b - a).cross(c - a).try_normalize().unwrap_or_default();
        let normal = unit(normal.as_vec3()).unwrap_or(Vec3::Y);
        if self.part.mirrored { -normal } else { normal }
    }

    fn corners(&self) -> [Vec3; 3] {
        let geometry = &self.shader.renderer.geometry;
        geometry.positions_of(self.triangle)
    }

    /// The normal of a normal map.
    fn bumped(&self, normal: Vec3, m: &Prepared, [x, y, z, _]: [f32; 4]) -> Option<Vec3> {
        let (tangent, sign) = self.tangent(m)?;
        let tangent = unit(tangent - normal * normal.dot(tangent))?;
        let bitangent = normal.cross(tangent) * sign;
        let signed = |value: f32| value * 2.0 - 1.0;
        let (x, y) = (signed(x) * m.normal_scale, signed(y) * m.normal_scale);
        unit(tangent * x + bitangent * y + normal * signed(z))
    }

    /// Direction in which u grows, and handedness: from how UVs lie on the
    /// triangle. Those of the file, where there are any, agree up to smoothing.
    fn tangent(&self, m: &Prepared) -> Option<(Vec3, f32)> {
        let [a, b, c] = self.corners();
        let [s, t, r] = self.uvs(m.normal_lookup.as_ref()?)?;
        let ((p, q), (d, e)) = ((b - a, c - a), (t - s, r - s));
        let turn = d.x * e.y - d.y * e.x;
        let along_u = (p * e.y - q * d.y) * turn.signum();
        let along_v = (q * d.x - p * e.x) * turn.signum();
        let normal = self.face_normal();
        // v grows downwards, and a map's y upwards.
        let sign = if normal.cross(along_u).dot(along_v) > 0.0 {
            -1.0
        } else {
            1.0
        };
        Some((unit(along_u)?, sign))
    }
}

/// `None` for what has no direction.
#[inline]
fn unit(v: Vec3) -> Option<Vec3> {
    let length = v.length();
    let unit = v * (1.0 / length);
    (length > 1e-12 && unit.is_finite()).then_some(unit)
}
