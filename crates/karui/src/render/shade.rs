//! From what is seen to what colour it has.

use super::brdf::{Answer, Incident, Surface};
use super::options::{RenderOptions, Shading, Wireframe};
use super::pass::Pass;
use super::place::Place;
use super::renderer::Renderer;
use super::srgb::{Srgb, plain_code, unit};
use super::surface::Sample;
use crate::geom::{Light, Vec3, Vec4};
use crate::mesh::AlphaMode;

/// Everything that colours depend on.
pub(super) struct Shader<'a> {
    pub renderer: &'a Renderer<'a>,
    pub pass: &'a Pass<'a>,
    pub options: &'a RenderOptions<'a>,
    pub srgb: Srgb,
    /// Those from far away, and those from nearby.
    distant: Vec<Incident>,
    nearby: Vec<Nearby>,
    up: Vec3,
    /// Linear, premultiplied.
    background: Vec4,
}

/// A triangle, and where on it a sample lies.
pub(super) struct Seen {
    pub triangle: u32,
    pub place: Place,
    column: i32,
    row: i32,
}

impl Seen {
    #[inline]
    pub(super) fn new(pass: &Pass<'_>, triangle: u32, column: i32, row: i32) -> Self {
        Self {
            triangle,
            place: pass.place(triangle, column, row),
            column,
            row,
        }
    }

    /// Position of the sample.
    #[inline]
    fn middle(&self) -> (f32, f32) {
        (self.column as f32 + 0.5, self.row as f32 + 0.5)
    }
}

struct Nearby {
    position: Vec3,
    radiance: Vec3,
}

impl<'a> Shader<'a> {
    pub(super) fn new(
        renderer: &'a Renderer<'a>,
        pass: &'a Pass<'a>,
        lights: &[Light],
        options: &'a RenderOptions<'a>,
    ) -> Self {
        let srgb = Srgb::new();
        Self {
            renderer,
            pass,
            options,
            srgb,
            distant: lights.iter().filter_map(directional).collect(),
            nearby: lights.iter().filter_map(nearby).collect(),
            up: pass.view.up(),
            background: premultiplied(linear(srgb, options.background)),
        }
    }

    /// Whether a masked triangle is there at a sample.
    pub(super) fn is_solid(&self, triangle: u32, column: i32, row: i32) -> bool {
        let seen = Seen::new(self.pass, triangle, column, row);
        let sample = Sample::new(self, &seen);
        match sample.material.alpha_mode {
            AlphaMode::Mask(cutoff) => sample.base_color().w >= cutoff,
            _ => true,
        }
    }

    /// Colour where surfaces are blended, linear and premultiplied: layers from front
    /// to back, then what is solid, if anything is.
    pub(super) fn blended(&self, layers: &[Seen], solid: Option<&Seen>) -> Vec4 {
        let mut color = Vec4::ZERO;
        for layers in layers.chunks(4) {
            for layer in &self.layers(layers)[..layers.len()] {
                color += *layer * (1.0 - color.w);
            }
        }
        let behind = match solid {
            Some(seen) => self.layers(std::slice::from_ref(seen))[0],
            None => self.background,
        };
        color + behind * (1.0 - color.w)
    }

    /// Colours of up to four surfaces, linear and premultiplied. The rest is filled
    /// up.
    #[inline]
    pub(super) fn layers(&self, seen: &[Seen]) -> [Vec4; 4] {
        let at = |k: usize| &seen[k.min(seen.len() - 1)];
        let surface = |k: usize| self.surface(at(k));
        let first = surface(0);
        let other = |k: usize| if k < seen.len() { surface(k) } else { first };
        let points = [first, other(1), other(2), other(3)];
        let light = match self.options.shading {
            Shading::Unlit => points.map(|p| p.base.truncate()),
            shading => self.lit(&Answer::new(&points, shading), at),
        };
        std::array::from_fn(|k| {
            let alpha = points[k].base.w;
            let light = (light[k] + points[k].emissive).min(Vec3::splat(1e4));
            let color = (light * alpha).extend(alpha);
            match &self.options.wireframe {
                Some(lines) => self.lined(color, lines, at(k)),
                None => color,
            }
        })
    }

    /// Surface at a sample; its alpha is 1 unless it is blended.
    #[inline]
    fn surface(&self, seen: &Seen) -> Surface {
        let sample = Sample::new(self, seen);
        let (x, y) = seen.middle();
        let mut surface = sample.surface(self.pass.view.viewer_from(x, y));
        surface.base.w = match sample.material.alpha_mode {
            AlphaMode::Blend => unit(surface.base.w),
            _ => 1.0,
        };
        surface
    }

    #[inline]
    fn lit<'s>(&self, answer: &Answer, seen: impl Fn(usize) -> &'s Seen) -> [Vec3; 4] {
        let mut sum = answer.ambient(&self.options.ambient, self.up);
        for light in &self.distant {
            answer.add(light, &mut sum);
        }
        for light in &self.nearby {
            let lights: [_; 4] = std::array::from_fn(|k| {
                let ((x, y), depth) = (seen(k).middle(), seen(k).place.depth);
                light.at(self.pass.view.unproject(x, y, depth))
            });
            answer.add(
                &Incident::new(&lights.map(|l| l.0), &lights.map(|l| l.1)),
                &mut sum,
            );
        }
        std::array::from_fn(|k| Vec3::new(sum[0][k], sum[1][k], sum[2][k]))
    }

    /// With the triangle's half of the lines it shares.
    fn lined(&self, color: Vec4, lines: &Wireframe, seen: &Seen) -> Vec4 {
        let samples = self.options.samples as f32;
        let distance = seen.place.edge_distance(&self.pass.steps(seen.triangle));
        let share = unit(0.5 * lines.width * samples + 0.5 - distance);
        let line = premultiplied(linear(self.srgb, lines.color)) * share;
        line + color * (1.0 - line.w)
    }

    /// What is stored where there is nothing.
    pub(super) fn encoded_background(&self) -> [u8; 4] {
        self.encoded(self.background)
    }

    /// A linear, premultiplied colour as it is stored.
    #[inline]
    pub(super) fn encoded(&self, color: Vec4) -> [u8; 4] {
        if color.w <= 0.0 {
            return [0; 4];
        }
        let by_alpha = 1.0 / color.w;
        let code = |c: f32| self.srgb.code(c * by_alpha);
        [
            code(color.x),
            code(color.y),
            code(color.z),
            plain_code(color.w),
        ]
    }
}

/// `None` for a light that shines nowhere.
fn directional(light: &Light) -> Option<Incident> {
    let Light::Directional {
        direction,
        color,
        intensity,
    } = *light
    else {
        return None;
    };
    let direction = direction.as_dvec3().try_normalize()?;
    Some(Incident::new(
        &[-direction.as_vec3(); 4],
        &[color * intensity; 4],
    ))
}

fn nearby(light: &Light) -> Option<Nearby> {
    match *light {
        Light::Directional { .. } => None,
        Light::Point {
            position,
            color,
            intensity,
        } => Some(Nearby {
            position,
            radiance: color * intensity,
        }),
    }
}

impl Nearby {
    /// Unit vector to the light from a position, and radiance there.
    fn at(&self, position: Vec3) -> (Vec3, Vec3) {
        let way = self.position - position;
        let squared = way.length_squared().max(f32::MIN_POSITIVE);
        (
            way * (1.0 / squared.sqrt()),
            self.radiance * (1.0 / squared),
        )
    }
}

fn linear(srgb: Srgb, [r, g, b, a]: [u8; 4]) -> Vec4 {
    let [r, g, b] = [r, g, b].map(|code| srgb.linear(code));
    Vec4::new(r, g, b, f32::from(a) / 255.0)
}

fn premultiplied(color: Vec4) -> Vec4 {
    (color.truncate() * color.w).extend(color.w)
}
