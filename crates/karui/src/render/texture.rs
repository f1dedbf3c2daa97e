//! Looking up images.

use super::Picture;
use super::mips::{Encoding, mips};
use super::srgb::Srgb;
use crate::geom::{Vec2, sin_cos};
use crate::mesh::{Texture, TextureRef, Wrap};

/// An image with its smaller copies.
#[derive(Debug, Clone)]
pub(super) struct Chain<'a> {
    image: &'a Picture,
    mips: Vec<Picture>,
    pub encoding: Encoding,
    /// Index of the image.
    pub index: u32,
}

impl<'a> Chain<'a> {
    /// `None` for an image without pixels.
    pub(super) fn new(image: &'a Picture, index: u32, encoding: Encoding) -> Option<Self> {
        if image.pixels().is_empty() {
            return None;
        }
        Some(Self {
            image,
            mips: mips(image, encoding),
            encoding,
            index,
        })
    }

    fn level(&self, level: usize) -> &Picture {
        match level {
            0 => self.image,
            _ => self
                .mips
                .get(level - 1)
                .or(self.mips.last())
                .unwrap_or(self.image),
        }
    }
}

/// How a material uses a chain.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lookup {
    /// Index of the chain.
    pub chain: usize,
    pub uv_set: usize,
    wrap: [Wrap; 2],
    nearest: bool,
    /// Rows of the transform of UVs.
    rows: [[f32; 3]; 2],
}

impl Lookup {
    pub(super) fn new(chain: usize, texture: &Texture, used: &TextureRef) -> Self {
        Self {
            chain,
            uv_set: used.uv_set as usize,
            wrap: texture.wrap,
            nearest: texture.nearest,
            rows: rows(used),
        }
    }

    /// Colour or values at `uv`; `slopes` are the changes of `uv` over a step to
    /// the right and downwards.
    pub(super) fn at(
        &self,
        chain: &Chain<'_>,
        srgb: Srgb,
        uv: Vec2,
        slopes: [Vec2; 2],
    ) -> [f32; 4] {
        let [[a, b, dx], [c, d, dy]] = self.rows;
        let turned = |v: Vec2| Vec2::new(a * v.x + b * v.y, c * v.x + d * v.y);
        let uv = turned(uv) + Vec2::new(dx, dy);
        let size = Vec2::new(chain.image.width() as f32, chain.image.height() as f32);
        let square = |v: Vec2| (turned(v) * size).length_squared();
        let steps = square(slopes[0]).max(square(slopes[1]));
        let level = 0.5 * log2(steps).clamp(0.0, 64.0);
        let texels = |level: usize| Texels {
            picture: chain.level(level),
            srgb: (chain.encoding == Encoding::Srgb).then_some(srgb),
            wrap: self.wrap,
        };
        if self.nearest {
            return texels((level + 0.5) as usize).nearest(uv);
        }
        let (whole, part) = (level as usize, level - level.trunc());
        let fine = texels(whole).linear(uv);
        if part == 0.0 {
            return fine;
        }
        mix(fine, texels(whole + 1).linear(uv), part)
    }
}

/// Rows of translation * rotation * scale (`KHR_texture_transform`). Counter-clockwise
/// is meant as seen, with v downwards: so says its text and do the sample viewer and
/// three.js; the code in it turns the other way.
fn rows(used: &TextureRef) -> [[f32; 3]; 2] {
    let Some(t) = used.transform else {
        return [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    };
    let (s, c) = sin_cos(f64::from(t.rotation));
    let (s, c) = (s as f32, c as f32);
    [
        [c * t.scale.x, s * t.scale.y, t.offset.x],
        [-s * t.scale.x, c * t.scale.y, t.offset.y],
    ]
}

/// Logarithm to base 2 within 0.09, exact at powers of two: exponent plus
/// mantissa, read off the bits.
fn log2(x: f32) -> f32 {
    let bits = x.max(f32::MIN_POSITIVE).to_bits();
    let mantissa = f32::from_bits(bits & 0x007f_ffff | 0x3f80_0000);
    ((bits >> 23) as f32 - 127.0) + (mantissa - 1.0)
}

fn mix(a: [f32; 4], b: [f32; 4], t: f32) -> [f32; 4] {
    std::array::from_fn(|k| a[k] + (b[k] - a[k]) * t)
}

/// Largest integer not above `x`; no call into libm, which plain `floor` is
/// without SSE 4.1.
fn floor(x: f32) -> i32 {
    let whole = x as i32;
    whole.saturating_sub(i32::from(whole as f32 > x))
}

struct Texels<'a> {
    picture: &'a Picture,
    /// For images of colours.
    srgb: Option<Srgb>,
    wrap: [Wrap; 2],
}

impl Texels<'_> {
    fn nearest(&self, uv: Vec2) -> [f32; 4] {
        let (x, y) = self.place(uv);
        self.texel(floor(x), floor(y))
    }

    fn linear(&self, uv: Vec2) -> [f32; 4] {
        let (x, y) = self.place(uv);
        let (x, y) = (x - 0.5, y - 0.5);
        let (i, j) = (floor(x), floor(y));
        let (s, t) = (x - i as f32, y - j as f32);
        let row = |j: i32| mix(self.texel(i, j), self.texel(i.saturating_add(1), j), s);
        mix(row(j), row(j.saturating_add(1)), t)
    }

    fn place(&self, uv: Vec2) -> (f32, f32) {
        let axis = |at: f32, wrap: Wrap, size: u32| match wrap {
            // Nothing but the fraction counts; it is finer near 0.
            Wrap::Repeat => (at - floor(at) as f32) * size as f32,
            Wrap::Mirror | Wrap::Clamp => at * size as f32,
        };
        let [u, v] = self.wrap;
        let (x, y) = (
            axis(uv.x, u, self.picture.width()),
            axis(uv.y, v, self.picture.height()),
        );
        // What is not a number is looked up at the corner.
        (
            if x.is_finite() { x } else { 0.0 },
            if y.is_finite() { y } else { 0.0 },
        )
    }

    fn texel(&self, x: i32, y: i32) -> [f32; 4] {
        let [u, v] = self.wrap;
        let column = wrapped(x, u, self.picture.width());
        let row = wrapped(y, v, self.picture.height());
        let [r, g, b, a] = self.picture.pixels()[row * self.picture.width() as usize + column];
        let plain = |code: u8| f32::from(code) / 255.0;
        match self.srgb {
            Some(srgb) => [srgb.linear(r), srgb.linear(g), srgb.linear(b), plain(a)],
            None => [r, g, b, a].map(plain),
        }
    }
}

fn wrapped(i: i32, wrap: Wrap, size: u32) -> usize {
    let size = size as i32;
    let i = match wrap {
        Wrap::Clamp => i.clamp(0, size - 1),
        Wrap::Repeat if (0..size).contains(&i) => i,
        Wrap::Repeat => i.rem_euclid(size),
        Wrap::Mirror => {
            let i = i.rem_euclid(2 * size);
            i.min(2 * size - 1 - i)
        }
    };
    i as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::UvTransform;

    const FLAT: [Vec2; 2] = [Vec2::ZERO; 2];

    fn used(transform: Option<UvTransform>) -> TextureRef {
        TextureRef {
            texture: 0,
            uv_set: 0,
            transform,
        }
    }

    fn lookup(wrap: Wrap, nearest: bool) -> Lookup {
        let texture = Texture {
            image: Some(0),
            wrap: [wrap; 2],
            nearest,
        };
        Lookup::new(0, &texture, &used(None))
    }

    /// Four columns whose values are 0, 51, 102 and 255.
    fn ramp() -> Picture {
        let pixels = [0, 51, 102, 255].map(|v| [v, v, v, 255]);
        Picture::new(4, 1, pixels.to_vec()).unwrap()
    }

    fn red(lookup: &Lookup, picture: &Picture, u: f32, slopes: [Vec2; 2]) -> f32 {
        let chain = Chain::new(picture, 0, Encoding::Plain).unwrap();
        lookup.at(&chain, Srgb::new(), Vec2::new(u, 0.5), slopes)[0]
    }

    #[test]
    fn centres_of_texels_are_exact_and_between_them_is_linear() {
        let (image, lookup) = (ramp(), lookup(Wrap::Clamp, false));
        for (u, expected) in [(0.125, 0.0), (0.375, 0.2), (0.25, 0.1), (0.75, 0.7)] {
            assert!(
                (red(&lookup, &image, u, FLAT) - expected).abs() < 1e-6,
                "{u}"
            );
        }
    }

    #[test]
    fn outside_is_as_wrapped() {
        let image = ramp();
        for (wrap, left, right) in [
            (Wrap::Repeat, 1.0, 0.0),
            (Wrap::Mirror, 0.0, 1.0),
            (Wrap::Clamp, 0.0, 1.0),
        ] {
            let at = |u| red(&lookup(wrap, true), &image, u, FLAT);
            assert_eq!((at(-0.1), at(1.1)), (left, right), "{wrap:?}");
            assert!(at(f32::NAN).is_finite() && at(1e30).is_finite() && at(-1e30).is_finite());
        }
        let mirrored = red(&lookup(Wrap::Mirror, true), &image, 1.375, FLAT);
        assert_eq!(mirrored, 102.0 / 255.0);
    }

    #[test]
    fn far_away_a_texture_is_its_mean() {
        let wide = [Vec2::new(4.0, 0.0), Vec2::ZERO];
        let mean = red(&lookup(Wrap::Repeat, false), &ramp(), 0.125, wide);
        assert!((mean - 102.0 / 255.0).abs() < 0.005, "{mean}");
        // Between the whole and half of it: half of either.
        let between = [Vec2::new(0.25 * 2f32.sqrt(), 0.0), Vec2::ZERO];
        let found = red(&lookup(Wrap::Clamp, false), &ramp(), 0.25, between);
        assert!((found - 0.1).abs() < 0.01, "{found}");
    }

    #[test]
    fn transforms_scale_then_rotate_then_shift() {
        let transform = UvTransform {
            offset: Vec2::new(0.5, 0.25),
            rotation: std::f32::consts::FRAC_PI_2,
            scale: Vec2::new(2.0, 3.0),
        };
        let [[a, b, dx], [c, d, dy]] = rows(&used(Some(transform)));
        assert_eq!([dx, dy], [0.5, 0.25]);
        // A quarter turn counter-clockwise as seen: (u, v) to (v, -u).
        for (found, expected) in [(a, 0.0), (b, 3.0), (c, -2.0), (d, 0.0)] {
            assert!((found - expected).abs() < 1e-6, "{found} {expected}");
        }
    }

    #[test]
    fn logarithms_are_close() {
        for i in 1..1000 {
            let x = i as f32 * 0.37;
            assert!((log2(x) - x.log2()).abs() < 0.09);
        }
        assert!(log2(f32::NAN) < 0.0 && log2(f32::INFINITY) > 64.0);
    }
}
