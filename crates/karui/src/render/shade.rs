//! From what is seen to what colour it has.

use super::brdf::{Answer, Incident};
use super::options::{RenderOptions, Shading, Wireframe};
use super::pass::Pass;
use super::place::Place;
use super::renderer::Renderer;
use super::srgb::{Srgb, plain_code, unit};
use super::surface::Sample;
use crate::geom::{Light, Vec3, Vec4};
use crate::mesh::AlphaMode;
use smallvec::SmallVec;

/// Everything that colours depend on.
pub(super) struct Shader<'a> {
    pub renderer: &'a Renderer<'a>,
    pub pass: &'a Pass<'a>,
    pub options: &'a RenderOptions<'a>,
    pub srgb: Srgb,
    /// Those from far away, four by four, and those from nearby.
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
}

impl Seen {
    #[inline]
    pub(super) fn new(pass: &Pass<'_>, triangle: u32, column: i32, row: i32) -> Self {
        Self {
            triangle,
            place: pass.place(triangle, column, row),
        }
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
        let directional: Vec<_> = lights.iter().filter_map(directional).collect();
        Self {
            renderer,
            pass,
            options,
            srgb,
            distant: directional.chunks(4).map(Incident::new).collect(),
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

    /// Colour at a sample, linear and premultiplied: layers from front to back,
    /// then what is solid, if anything is.
    #[inline]
    pub(super) fn color(
        &self,
        column: i32,
        row: i32,
        layers: impl Iterator<Item = u32>,
        solid: Option<&Seen>,
    ) -> Vec4 {
        let mut color = Vec4::ZERO;
        for triangle in layers {
            let seen = Seen::new(self.pass, triangle, column, row);
            color += self.layer(&seen, column, row) * (1.0 - color.w);
        }
        let behind = match solid {
            Some(seen) => self.layer(seen, column, row),
            None => self.background,
        };
        color + behind * (1.0 - color.w)
    }

    /// Colour of one surface, linear and premultiplied.
    pub(super) fn layer(&self, seen: &Seen, column: i32, row: i32) -> Vec4 {
        let sample = Sample::new(self, seen);
        let (x, y) = (column as f32 + 0.5, row as f32 + 0.5);
        let surface = sample.surface(self.pass.view.viewer_from(x, y));
        let alpha = match sample.material.alpha_mode {
            AlphaMode::Blend => unit(surface.base.w),
            _ => 1.0,
        };
        let light = match self.options.shading {
            Shading::Unlit => surface.base + surface.emissive,
            shading => {
                let position = || self.pass.view.unproject(x, y, seen.place.depth);
                self.lit(&Answer::new(&surface, shading), position) + surface.emissive
            }
        };
        let color = (light.min(Vec4::splat(1e4)) * alpha).with_w(alpha);
        match &self.options.wireframe {
            Some(lines) => self.lined(color, lines, seen),
            None => color,
        }
    }

    #[inline]
    fn lit(&self, answer: &Answer, position: impl Fn() -> Vec3) -> Vec4 {
        let mut sum = answer.to_ambient(&self.options.ambient, self.up);
        for lights in &self.distant {
            sum += answer.to(lights);
        }
        if !self.nearby.is_empty() {
            let position = position();
            for lights in self.nearby.chunks(4) {
                let lights = lights.iter().map(|light| light.at(position));
                sum += answer.to(&Incident::new(&lights.collect::<SmallVec<[_; 4]>>()));
            }
        }
        sum
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

/// Unit vector to the light, and radiance; `None` for one that shines nowhere.
fn directional(light: &Light) -> Option<(Vec3, Vec3)> {
    let Light::Directional {
        direction,
        color,
        intensity,
    } = *light
    else {
        return None;
    };
    let direction = direction.as_dvec3().try_normalize()?;
    Some((-direction.as_vec3(), color * intensity))
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
