//! Saliency of a picture (Itti, Koch and Niebur, "A model of saliency-based
//! visual attention for rapid scene analysis", 1998).

mod channels;
mod gabor;
mod normalise;
mod plane;

use crate::error::{Error, Result};
use crate::render::Picture;
use normalise::normalise;
use plane::{Plane, coarser};

/// Finer and coarser level of every centre-surround difference.
const PAIRS: [(usize, usize); 6] = [(2, 5), (2, 6), (3, 6), (3, 7), (4, 7), (4, 8)];
const LEVELS: usize = 9;
/// Level of the pyramid that maps are added at.
const MAP_LEVEL: u32 = 4;

/// How colours of a place and of its surroundings are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Opponency {
    /// `|RG(c) - RG(s)|` with `RG = R - G`, as intensity and orientation are, and
    /// likewise for `BY`: a red disc among green ones stands out.
    #[default]
    Difference,
    /// As printed by Itti, Koch and Niebur (1998, equations 2 and 3):
    /// `|(R(c) - G(c)) - (G(s) - R(s))|`, which is `|RG(c) + RG(s)|`: a colour counts
    /// more among its own kind, and a red disc among green ones does not stand out.
    Printed,
}

/// How much each part of image saliency counts; 1/3 each by default.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImageSaliencyOptions {
    /// Factor to N of the intensity map, zero or more.
    pub intensity: f32,
    /// Factor to N of the colour map, zero or more.
    pub color: f32,
    /// Factor to N of the orientation map, zero or more.
    pub orientation: f32,
    /// How colours are compared; by their difference by default.
    pub opponency: Opponency,
}

impl Default for ImageSaliencyOptions {
    fn default() -> Self {
        let third = 1.0 / 3.0;
        Self {
            intensity: third,
            color: third,
            orientation: third,
            opponency: Opponency::default(),
        }
    }
}

/// Saliency of a picture at a sixteenth of its resolution, sides rounded up.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SaliencyMap {
    /// Values a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Values in 0..=1, row by row from the top left; the largest is 1 unless
    /// all are 0.
    pub values: Vec<f32>,
}

impl SaliencyMap {
    /// Value at a point of the picture in its pixels (the centre of the first one
    /// is at 0.5, 0.5), bilinear between centres of the map; 0 for an empty map.
    #[must_use]
    pub fn sample(&self, x: f32, y: f32) -> f32 {
        if self.values.is_empty() {
            return 0.0;
        }
        let size = [self.width, self.height].map(|n| (n - 1) as f32);
        let [x, y] = [(x, size[0]), (y, size[1])]
            .map(|(at, most)| coarser(at - 0.5, MAP_LEVEL).clamp(0.0, most));
        let (x0, y0) = (x as usize, y as usize);
        let x1 = (x0 + 1).min(self.width as usize - 1);
        let y1 = (y0 + 1).min(self.height as usize - 1);
        let at = |x: usize, y: usize| self.values[y * self.width as usize + x];
        let (u, v) = (x - x0 as f32, y - y0 as f32);
        let across = |y: usize| at(x0, y) + (at(x1, y) - at(x0, y)) * u;
        across(y0) + (across(y1) - across(y0)) * v
    }
}

/// Image saliency of many pictures: keeps the memory of the largest planes.
#[derive(Debug, Clone, Default)]
pub struct ImageSaliency {
    options: ImageSaliencyOptions,
    full: [Plane; 3],
}

impl ImageSaliency {
    /// With these options.
    ///
    /// # Errors
    /// [`Error::BadOption`] if a factor is negative or not finite.
    pub fn new(options: &ImageSaliencyOptions) -> Result<Self> {
        for (option, factor) in [
            ("intensity", options.intensity),
            ("color", options.color),
            ("orientation", options.orientation),
        ] {
            if !(factor >= 0.0 && factor.is_finite()) {
                return Err(Error::BadOption {
                    option,
                    found: factor.to_string(),
                    expected: "zero or more",
                });
            }
        }
        Ok(Self {
            options: *options,
            ..Self::default()
        })
    }

    /// Saliency of one picture; see [`image_saliency`].
    pub fn map(&mut self, picture: &Picture) -> SaliencyMap {
        if picture.pixels().is_empty() {
            return SaliencyMap::default();
        }
        channels::channels(picture, &mut self.full);
        let [intensity, rg, by] = [0, 1, 2].map(|k| pyramid(&self.full[k]));
        let sign = match self.options.opponency {
            Opponency::Difference => -1.0,
            Opponency::Printed => 1.0,
        };
        let opposed = |c: f32, s: f32| (c + sign * s).abs();
        let mut color = across_scales(&rg, opposed);
        color.add(&across_scales(&by, opposed));
        let parts = [
            (
                across_scales(&intensity, |c, s| (c - s).abs()),
                self.options.intensity,
            ),
            (color, self.options.color),
            (orientation(&intensity), self.options.orientation),
        ];
        finish(parts)
    }
}

/// Saliency of one picture: how much every place differs from its surroundings
/// in intensity, colour and orientation.
///
/// Alpha is composited over black. Pictures below 512 pixels a side have levels
/// that stop at one pixel. An even picture, and one of a single pixel, gives 0.
///
/// # Errors
/// Those of [`ImageSaliency::new`].
pub fn image_saliency(picture: &Picture, options: &ImageSaliencyOptions) -> Result<SaliencyMap> {
    Ok(ImageSaliency::new(options)?.map(picture))
}

/// Levels 2 to 8, by level; the first two are empty, as nothing asks for them.
fn pyramid(full: &Plane) -> [Plane; LEVELS] {
    let mut levels: [Plane; LEVELS] = Default::default();
    levels[2] = full.halved().halved();
    for level in 3..LEVELS {
        levels[level] = levels[level - 1].halved();
    }
    levels
}

/// Sum of N of all centre-surround differences, at the map's level.
fn across_scales(levels: &[Plane; LEVELS], difference: impl Fn(f32, f32) -> f32) -> Plane {
    let mut sum = Plane::zero(levels[4].width, levels[4].height);
    for (c, s) in PAIRS {
        let center = &levels[c];
        let mut map = levels[s].enlarged(center.width, center.height, (s - c) as u32);
        for (to, from) in map.values.iter_mut().zip(&center.values) {
            *to = difference(*from, *to);
        }
        normalise(&mut map);
        for _ in c..MAP_LEVEL as usize {
            map = map.halved();
        }
        sum.add(&map);
    }
    sum
}

/// Sum over the four angles of N of the sum over scales.
fn orientation(intensity: &[Plane; LEVELS]) -> Plane {
    let mut angles: [[Plane; LEVELS]; 4] = Default::default();
    for level in 2..LEVELS {
        for (angle, plane) in gabor::orientations(&intensity[level])
            .into_iter()
            .enumerate()
        {
            angles[angle][level] = plane;
        }
    }
    let mut sum = Plane::zero(intensity[4].width, intensity[4].height);
    for levels in &angles {
        let mut map = across_scales(levels, |c, s| (c - s).abs());
        normalise(&mut map);
        sum.add(&map);
    }
    sum
}

fn finish(parts: [(Plane, f32); 3]) -> SaliencyMap {
    let mut sum = Plane::zero(parts[0].0.width, parts[0].0.height);
    for (mut map, factor) in parts {
        normalise(&mut map);
        map.values.iter_mut().for_each(|v| *v *= factor);
        sum.add(&map);
    }
    let most = sum.values.iter().copied().fold(0.0, f32::max);
    if most > 0.0 {
        sum.values.iter_mut().for_each(|v| *v /= most);
    }
    SaliencyMap {
        width: sum.width as u32,
        height: sum.height as u32,
        values: sum.values,
    }
}
