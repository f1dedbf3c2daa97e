//! The mean colour of a surface.

use crate::error::{Error, Result};
use crate::geom::{DVec3, Vec2, Vec3, Vec4, area, sin_cos};
use crate::mesh::{AlphaMode, Material, TextureRef, TriMesh, Wrap};
use crate::render::{Model, Picture, linear_of_codes};

/// Colour of surfaces without material, that of the renderer.
const CLAY: Vec4 = Vec4::new(0.6, 0.6, 0.6, 1.0);
/// Most samples along each side of a triangle.
const MOST: f64 = 32.0;

/// Area that is seen, and its mean colour.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seen {
    pub area: f64,
    pub color: Vec3,
}

/// Samples lie at the middles of equal parts of every triangle, as many as it has
/// texels.
pub(super) fn seen(model: &Model<'_>, mesh: &TriMesh) -> Result<Seen> {
    let (mut covered, mut sum) = (0.0, DVec3::ZERO);
    let mut fallback = CLAY;
    for (index, range) in mesh.ranges_or_whole().iter().enumerate() {
        let paint = Paint::new(model, mesh, index, range.material)?;
        if index == 0 {
            fallback = paint.factor;
        }
        for t in range.triangles() {
            let area = area(mesh.corners(t));
            let (alpha, color) = paint.mean(mesh.triangles[t]);
            covered += area * alpha;
            sum += color * area;
        }
    }
    let color = if covered > 0.0 {
        sum / covered
    } else {
        fallback.truncate().as_dvec3()
    };
    Ok(Seen {
        area: covered,
        color: color.clamp(DVec3::ZERO, DVec3::ONE).as_vec3(),
    })
}

/// What gives the triangles of a range their colour.
struct Paint<'a> {
    factor: Vec4,
    alpha: AlphaMode,
    texture: Option<Lookup<'a>>,
    colors: Option<&'a [Vec4]>,
}

impl<'a> Paint<'a> {
    fn new(
        model: &Model<'a>,
        mesh: &'a TriMesh,
        range: usize,
        material: Option<u32>,
    ) -> Result<Self> {
        let mut paint = Self {
            factor: CLAY,
            alpha: AlphaMode::Opaque,
            texture: None,
            colors: mesh.attributes.colors.first().map(Vec::as_slice),
        };
        if let Some(material) = material.filter(|_| !model.materials.is_empty()) {
            let material: &Material =
                (model.materials.get(material as usize)).ok_or(Error::BadReference {
                    what: "range",
                    index: range,
                    target: "material",
                    to: material as usize,
                    problem: "does not exist",
                })?;
            paint.factor = material.base_color;
            paint.alpha = material.alpha_mode;
            let used = material.base_color_texture;
            paint.texture = used.and_then(|used| Lookup::new(model, mesh, &used));
        }
        Ok(paint)
    }

    /// Share of a triangle that covers what is behind, and its colour times that.
    fn mean(&self, triangle: [u32; 3]) -> (f64, DVec3) {
        let side = self.texture.as_ref().map_or(1.0, |t| t.texels(triangle));
        let side = side.sqrt().ceil().clamp(1.0, MOST) as u32;
        let (mut covered, mut sum) = (0.0, DVec3::ZERO);
        for weights in middles(side) {
            let color = self.at(triangle, weights);
            let alpha = match self.alpha {
                AlphaMode::Opaque => 1.0,
                AlphaMode::Mask(cutoff) => f64::from(u8::from(color.w >= cutoff)),
                AlphaMode::Blend => f64::from(color.w).clamp(0.0, 1.0),
            };
            covered += alpha;
            sum += color.truncate().as_dvec3() * alpha;
        }
        let count = f64::from(side * side);
        match sum.is_finite() && covered.is_finite() {
            true => (covered / count, sum / count),
            false => (0.0, DVec3::ZERO),
        }
    }

    fn at(&self, triangle: [u32; 3], weights: [f32; 3]) -> Vec4 {
        let texel = self.texture.as_ref().map(|t| t.at(triangle, weights));
        let vertex = self.colors.map(|colors| {
            let [a, b, c] = triangle.map(|v| colors[v as usize]);
            a * weights[0] + b * weights[1] + c * weights[2]
        });
        self.factor * texel.unwrap_or(Vec4::ONE) * vertex.unwrap_or(Vec4::ONE)
    }
}

/// Weights of the middles of `side` x `side` equal parts of a triangle.
fn middles(side: u32) -> impl Iterator<Item = [f32; 3]> {
    let middle = move |i: u32, j: u32, part: f32| {
        let by_side = 1.0 / side as f32;
        let (b, c) = ((i as f32 + part) * by_side, (j as f32 + part) * by_side);
        [1.0 - b - c, b, c]
    };
    let upright = move |j: u32| (0..side - j).map(move |i| middle(i, j, 1.0 / 3.0));
    let turned = move |j: u32| (0..side - j - 1).map(move |i| middle(i, j, 2.0 / 3.0));
    (0..side).flat_map(move |j| upright(j).chain(turned(j)))
}

/// A texture as a range looks it up.
struct Lookup<'a> {
    picture: &'a Picture,
    uvs: &'a [Vec2],
    wrap: [Wrap; 2],
    used: TextureRef,
}

impl<'a> Lookup<'a> {
    /// `None` if the texture, its picture or the UVs are missing: the material does
    /// without.
    fn new(model: &Model<'a>, mesh: &'a TriMesh, used: &TextureRef) -> Option<Self> {
        let texture = model.textures.get(used.texture as usize)?;
        let picture = model.images.get(texture.image? as usize)?.as_ref()?;
        let uvs = mesh.attributes.uvs.get(used.uv_set as usize)?;
        (!picture.pixels().is_empty()).then_some(Self {
            picture,
            uvs,
            wrap: texture.wrap,
            used: *used,
        })
    }

    /// Texels that a triangle covers.
    fn texels(&self, triangle: [u32; 3]) -> f64 {
        let size = Vec2::new(self.picture.width() as f32, self.picture.height() as f32);
        let [a, b, c] = triangle.map(|v| (self.turned(self.uvs[v as usize]) * size).as_dvec2());
        0.5 * (b - a).perp_dot(c - a).abs()
    }

    fn at(&self, triangle: [u32; 3], weights: [f32; 3]) -> Vec4 {
        let [a, b, c] = triangle.map(|v| self.uvs[v as usize]);
        let uv = self.turned(a * weights[0] + b * weights[1] + c * weights[2]);
        let [u, v] = self.wrap;
        let x = texel(uv.x, u, self.picture.width());
        let y = texel(uv.y, v, self.picture.height());
        let [r, g, b, a] = self.picture.get(x, y).unwrap_or_default();
        let linear = |code: u8| linear_of_codes()[usize::from(code)];
        Vec4::new(linear(r), linear(g), linear(b), f32::from(a) / 255.0)
    }

    /// `KHR_texture_transform`, turning as the renderer does.
    fn turned(&self, uv: Vec2) -> Vec2 {
        let Some(t) = self.used.transform else {
            return uv;
        };
        let (s, c) = sin_cos(f64::from(t.rotation));
        let (s, c) = (s as f32, c as f32);
        let scaled = uv * t.scale;
        Vec2::new(c * scaled.x + s * scaled.y, c * scaled.y - s * scaled.x) + t.offset
    }
}

/// Number of the texel at `at`; what is not a number is looked up at the start.
fn texel(at: f32, wrap: Wrap, size: u32) -> u32 {
    let unit = match wrap {
        Wrap::Clamp => at,
        Wrap::Repeat => at - at.floor(),
        Wrap::Mirror => 1.0 - (at - 2.0 * (0.5 * at).floor() - 1.0).abs(),
    };
    ((unit * size as f32) as u32).min(size - 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{MaterialRange, Texture};

    /// A unit square with the whole texture.
    fn square() -> TriMesh {
        let uvs = [Vec2::Y, Vec2::ONE, Vec2::X, Vec2::ZERO];
        let positions = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let positions = positions.map(|[x, y]| Vec3::new(x, y, 0.0));
        let mut mesh = TriMesh::new(positions.into(), vec![[0, 1, 2], [0, 2, 3]]);
        mesh.attributes.uvs = vec![uvs.into()];
        mesh.ranges = vec![MaterialRange {
            count: 2,
            material: Some(0),
            ..MaterialRange::default()
        }];
        mesh
    }

    fn textured(alpha: AlphaMode) -> Material {
        Material {
            base_color: Vec4::new(1.0, 0.5, 1.0, 1.0),
            alpha_mode: alpha,
            base_color_texture: Some(TextureRef {
                texture: 0,
                uv_set: 0,
                transform: None,
            }),
            ..Material::default()
        }
    }

    fn seen_with(alpha: AlphaMode, mesh: &TriMesh) -> Seen {
        // Left half white, right half transparent red.
        let texel = |i: u32| match i % 16 {
            0..8 => [255, 255, 255, 255],
            _ => [255, 0, 0, 0],
        };
        let picture = Picture::new(16, 16, (0..256).map(texel).collect()).unwrap();
        let model = Model {
            meshes: vec![mesh],
            materials: &[textured(alpha)],
            textures: &[Texture {
                image: Some(0),
                wrap: [Wrap::Repeat; 2],
                nearest: false,
            }],
            images: &[Some(picture)],
            ..Model::default()
        };
        seen(&model, mesh).unwrap()
    }

    #[test]
    fn the_mean_is_over_what_is_seen() {
        let opaque = seen_with(AlphaMode::Opaque, &square());
        assert!((opaque.area - 1.0).abs() < 1e-9);
        let expected = Vec3::new(1.0, 0.25, 0.5);
        assert!(opaque.color.distance(expected) < 0.02, "{}", opaque.color);
        for alpha in [AlphaMode::Mask(0.5), AlphaMode::Blend] {
            let cut = seen_with(alpha, &square());
            assert!((cut.area - 0.5).abs() < 0.02, "{}", cut.area);
            assert!(cut.color.distance(Vec3::new(1.0, 0.5, 1.0)) < 1e-6);
        }
    }

    #[test]
    fn vertex_colours_count_and_missing_textures_do_not() {
        let mut mesh = square();
        mesh.attributes.uvs.clear();
        mesh.attributes.colors = vec![vec![Vec4::new(0.5, 1.0, 0.0, 1.0); 4]];
        let plain = seen_with(AlphaMode::Opaque, &mesh);
        assert_eq!(plain.color, Vec3::new(0.5, 0.5, 0.0));
        let model = Model::of_mesh(&mesh);
        let clay = seen(&model, &mesh).unwrap().color;
        assert!(clay.distance(Vec3::new(0.3, 0.6, 0.0)) < 1e-6);
    }

    #[test]
    fn parts_are_equal_and_fill_the_triangle() {
        for side in [1, 2, 7] {
            let all: Vec<_> = middles(side).collect();
            assert_eq!(all.len() as u32, side * side);
            for k in 0..3 {
                let mean = all.iter().map(|w| w[k]).sum::<f32>() / all.len() as f32;
                assert!((mean - 1.0 / 3.0).abs() < 1e-5);
                assert!(all.iter().all(|w| w[k] > 0.0));
            }
        }
    }

    #[test]
    fn outside_is_as_wrapped() {
        for (wrap, left, right) in [
            (Wrap::Repeat, 3, 0),
            (Wrap::Mirror, 0, 3),
            (Wrap::Clamp, 0, 3),
        ] {
            let at = |u| texel(u, wrap, 4);
            assert_eq!((at(-0.1), at(1.1), at(0.6)), (left, right, 2), "{wrap:?}");
            assert!(at(f32::NAN) < 4 && at(1e30) < 4 && at(f32::NEG_INFINITY) < 4);
        }
    }
}
