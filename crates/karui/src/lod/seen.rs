//! From where on a level may be shown, by what is seen of it rather than by how
//! far its surface is off.
//!
//! The picture of a level beside that of the original is judged by FLIP:
//! P. Andersson, J. Nilsson, T. Akenine-Möller, M. Oskarsson, K. Åström,
//! M. D. Fairchild: FLIP: A Difference Evaluator for Alternating Images.
//! Proc. ACM Comput. Graph. Interact. Tech. 3(2) (HPG), 2020. Its mean is taken
//! over what either model covers: over the whole picture, any difference would
//! vanish by empty background alone.

use super::{SceneChain, Screen};
use crate::error::{Error, Result};
use crate::geom::{Camera, DVec3, Light, Projection, Vec3, fibonacci_directions};
use crate::mesh::Scene;
use crate::metrics::image::{PIXELS_PER_DEGREE, flip};
use crate::progress::{Progress, Silent, step};
use crate::render::{Model, Outputs, Picture, RenderOptions, Renderer};
use rayon::prelude::*;

/// Farthest that is looked from, in diagonals of the original's box.
const FARTHEST: f64 = 4096.0;
/// The distance found is at most this factor beyond one that is too near.
const PRECISION: f64 = 1.05;
/// Sides of the pictures are no shorter, pixels.
const LEAST_SIDE: f64 = 16.0;
/// Views drawn between two reports.
const BATCH: usize = 8;

/// How levels are looked at, and what may be seen.
#[derive(Clone, Copy)]
pub struct SeenOptions<'a> {
    /// Largest mean FLIP, 0 (no difference) to 1. Default: 0.05.
    pub bound: f64,
    /// Directions looked from, those of [`fibonacci_directions`]; 1 or more,
    /// 24 by default.
    pub views: u32,
    /// Samples a pixel along each side, as in [`RenderOptions::samples`]: 1, 2
    /// or 4. Default: 4; with fewer, what samples happen to hit differs more
    /// between two fine meshes far away than what they look like.
    pub samples: u32,
    /// The screen: its height and field of view; its tolerance is not used.
    pub screen: Screen,
    /// Told about the work and asked whether to go on.
    pub progress: &'a dyn Progress,
}

impl Default for SeenOptions<'_> {
    fn default() -> Self {
        Self {
            bound: 0.05,
            views: 24,
            samples: 4,
            screen: Screen::default(),
            progress: &Silent,
        }
    }
}

/// From where on a level may be shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// Distance of the eye from the middle of the original's box, in the
    /// world's unit.
    pub distance: f64,
    /// Mean FLIP there, rendered anew once the distance was found.
    pub flip: f64,
    /// Why the distance is not another one.
    pub reached: Reached,
}

/// Why a distance is not another one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reached {
    /// The bound holds as near as the search goes: where the sphere around the
    /// box just fits the screen, or where the next finer level is switched to.
    Nearest,
    /// Up to 5 % nearer, the bound does not hold.
    Bound,
    /// The bound does not hold 4096 diagonals of the box away: the distance is
    /// that, and the level differs more than was asked for.
    Never,
}

/// The smallest distance from which on `level` looks like `original`: where its
/// mean FLIP ([`seen_flip`]) is at most the bound. Searched from `start`, in
/// the world's unit, by doubling or halving and then by bisection of the
/// logarithm to within 5 %. The same bits for any number of threads.
///
/// FLIP need not fall everywhere as the distance grows; nothing is said about
/// distances that were not looked from. A larger bound gives no larger distance.
///
/// ```
/// use karui::lod::{SeenOptions, seen_distance, seen_flip};
/// use karui::mesh::shapes;
/// use karui::render::Model;
///
/// let (fine, coarse) = (shapes::icosphere(3), shapes::icosphere(1));
/// let (fine, coarse) = (Model::of_mesh(&fine), Model::of_mesh(&coarse));
/// let options = SeenOptions { views: 2, ..SeenOptions::default() };
/// let seen = seen_distance(&fine, &coarse, 100.0, &options)?;
/// assert!(seen.flip <= options.bound);
/// assert_eq!(seen.flip, seen_flip(&fine, &coarse, seen.distance, &options)?);
/// # Ok::<(), karui::Error>(())
/// ```
///
/// # Errors
/// As [`seen_flip`]; `start` that is not finite is taken as 0.
pub fn seen_distance(
    original: &Model<'_>,
    level: &Model<'_>,
    start: f64,
    options: &SeenOptions<'_>,
) -> Result<Seen> {
    let look = Look::new(original, options)?;
    let level = Renderer::of_model(level)?;
    look.search(&level, look.nearest(), start, &mut Steps::of(0, 1))
}

/// Mean FLIP of `level` against `original`, both seen from `distance` in the
/// world's unit, 0 (no difference is seen) to 1.
///
/// The eye stands `distance` away from the middle of the original's box, but
/// never so near that the sphere around the box is larger than the screen. The
/// pictures have the screen's pixels an angle and are squares just large enough
/// for that sphere, with sides of 16 pixels at least, on a transparent
/// background; lights are [`Light::three_points`]. FLIP is that of
/// [`flip()`] at [`PIXELS_PER_DEGREE`], averaged over the pixels that either
/// model covers, then over the views. A view in which neither is seen, as when the
/// model is smaller than the samples are apart, counts as 0.
///
/// # Errors
/// [`Error::BadOption`] for options out of range, [`Error::Empty`] if the
/// original has no triangles, [`Error::Cancelled`], and those of
/// [`Renderer::of_model`] and [`Renderer::frame`].
pub fn seen_flip(
    original: &Model<'_>,
    level: &Model<'_>,
    distance: f64,
    options: &SeenOptions<'_>,
) -> Result<f64> {
    let look = Look::new(original, options)?;
    let level = Renderer::of_model(level)?;
    let distance = distance.max(look.nearest());
    look.flip(&level, distance, &mut Steps::of(0, 1))
}

/// Sets the switch distances of a chain to those from which on each level looks
/// like the original ([`seen_distance`], `images` being the decoded images of
/// the scene); returns what was found for every level but the original.
///
/// Level `k` is the whole scene with every mesh at its level `k`, and all these
/// switch at one distance. The search starts at the switch distance the chain
/// has and never goes nearer than that of the next finer level.
///
/// # Errors
/// As [`seen_flip`]; the chain is left as it was then.
pub fn chain_seen(
    scene: &Scene,
    images: &[Option<Picture>],
    chain: &mut SceneChain,
    options: &SeenOptions<'_>,
) -> Result<Vec<Seen>> {
    let levels = chain.level_count() - 1;
    if levels == 0 {
        options.check()?;
        return Ok(Vec::new());
    }
    let original = Model::of_scene(scene, images);
    let look = Look::new(&original, options)?;
    let mut nearest = look.nearest();
    let mut found = Vec::with_capacity(levels);
    for level in 1..=levels {
        let coarse = Renderer::of_model(&at_level(&original, chain, level))?;
        let start = chain.summary(scene, level).switch_distance;
        let mut steps = Steps::of(level - 1, levels);
        let seen = look.search(&coarse, nearest, start, &mut steps)?;
        nearest = seen.distance;
        found.push(seen);
    }
    step(options.progress, STAGE, 1.0)?;
    for chain in chain.chains.iter_mut().flatten() {
        for (level, seen) in chain.levels.iter_mut().zip(&found) {
            level.switch_distance = seen.distance;
        }
    }
    Ok(found)
}

/// What [`SceneChain::scene_at`] shows, without a copy.
fn at_level<'a>(original: &Model<'a>, chain: &'a SceneChain, level: usize) -> Model<'a> {
    let mut model = original.clone();
    for (mesh, chain) in model.meshes.iter_mut().zip(&chain.chains) {
        if let Some(coarse) = chain.as_ref().and_then(|c| c.level(level)) {
            *mesh = &coarse.mesh;
        }
    }
    model
}

impl SeenOptions<'_> {
    fn check(&self) -> Result<()> {
        self.screen.check()?;
        let wrong = |option, found: String, expected| Error::BadOption {
            option,
            found,
            expected,
        };
        if !(0.0..=1.0).contains(&self.bound) {
            return Err(wrong("seen.bound", self.bound.to_string(), "0 to 1"));
        }
        if self.views == 0 {
            return Err(wrong("seen.views", "0".into(), "1 or more"));
        }
        Ok(())
    }
}

/// Name of the stage in reports of progress.
const STAGE: &str = "looking";

/// How far the work on one of several levels is. How often a level is drawn is
/// not known before: every time takes a fifth of what is left of its share.
struct Steps {
    first: f32,
    share: f32,
    left: f32,
}

impl Steps {
    fn of(level: usize, levels: usize) -> Self {
        Self {
            first: level as f32 / levels as f32,
            share: 1.0 / levels as f32,
            left: 1.0,
        }
    }

    fn next(&mut self) {
        self.left *= 0.8;
    }

    fn fraction(&self) -> f32 {
        self.first + self.share * (1.0 - self.left)
    }
}

/// The original, and how it and its levels are looked at.
struct Look<'a> {
    original: Renderer<'a>,
    options: &'a SeenOptions<'a>,
    directions: Vec<Vec3>,
    middle: Vec3,
    radius: f64,
    diagonal: f64,
}

impl<'a> Look<'a> {
    fn new(original: &Model<'a>, options: &'a SeenOptions<'a>) -> Result<Self> {
        options.check()?;
        let original = Renderer::of_model(original)?;
        let bounds = original.bounds();
        if bounds.is_empty() {
            return Err(Error::Empty { what: "original" });
        }
        let middle = bounds.center();
        // A point is looked at from where `f32` tells the eye from it.
        let least = (1e-3 * middle.as_dvec3().length()).max(1e-18);
        let radius = (0.5 * bounds.diagonal()).max(least);
        Ok(Self {
            original,
            options,
            directions: fibonacci_directions(options.views),
            middle,
            radius,
            diagonal: 2.0 * radius,
        })
    }

    /// Where the sphere around the box just fits the screen.
    fn nearest(&self) -> f64 {
        let half = self.options.screen.half_height();
        self.radius * half.hypot(1.0) / half
    }

    /// The search of [`seen_distance`], not nearer than `nearest`.
    fn search(
        &self,
        level: &Renderer<'_>,
        nearest: f64,
        start: f64,
        steps: &mut Steps,
    ) -> Result<Seen> {
        let farthest = (FARTHEST * self.diagonal).max(nearest);
        let start = if start.is_finite() { start } else { 0.0 };
        let start = start.clamp(nearest, farthest);
        let (distance, reached) = self.bracketed(level, [nearest, start, farthest], steps)?;
        let flip = self.flip(level, distance, steps)?;
        Ok(Seen {
            distance,
            flip,
            reached,
        })
    }

    fn bracketed(
        &self,
        level: &Renderer<'_>,
        [nearest, start, farthest]: [f64; 3],
        steps: &mut Steps,
    ) -> Result<(f64, Reached)> {
        let mut holds =
            |distance| Ok::<_, Error>(self.flip(level, distance, steps)? <= self.options.bound);
        let (mut bad, mut good) = (start, start);
        if holds(start)? {
            loop {
                if good <= nearest {
                    return Ok((nearest, Reached::Nearest));
                }
                bad = (0.5 * good).max(nearest);
                if !holds(bad)? {
                    break;
                }
                good = bad;
            }
        } else {
            loop {
                if bad >= farthest {
                    return Ok((farthest, Reached::Never));
                }
                good = (2.0 * bad).min(farthest);
                if holds(good)? {
                    break;
                }
                bad = good;
            }
        }
        while good > PRECISION * bad {
            let middle = (good * bad).sqrt();
            if holds(middle)? {
                good = middle;
            } else {
                bad = middle;
            }
        }
        Ok((good, Reached::Bound))
    }

    /// Mean over the views, summed up in their order.
    fn flip(&self, level: &Renderer<'_>, distance: f64, steps: &mut Steps) -> Result<f64> {
        let mut sum = 0.0;
        for part in self.directions.chunks(BATCH) {
            step(self.options.progress, STAGE, steps.fraction())?;
            let views = part.par_iter().map(|&d| self.view(level, d, distance));
            let views: Vec<f64> = views.collect::<Result<_>>()?;
            sum += views.iter().sum::<f64>();
        }
        steps.next();
        Ok(sum / self.directions.len() as f64)
    }

    fn view(&self, level: &Renderer<'_>, direction: Vec3, distance: f64) -> Result<f64> {
        let side = self.side(distance);
        let camera = self.camera(direction, distance, side);
        let lights = Light::three_points(&camera)?;
        let options = RenderOptions {
            width: side,
            height: side,
            samples: self.options.samples,
            outputs: Outputs::COLOR,
            ..RenderOptions::default()
        };
        let before = self.original.frame(&camera, &lights, &options)?.color;
        let after = level.frame(&camera, &lights, &options)?.color;
        let map = flip(&before, &after, PIXELS_PER_DEGREE)?.map;
        Ok(mean_where_covered(&map, &before, &after))
    }

    /// Pixels that the sphere around the box takes on the screen.
    fn side(&self, distance: f64) -> u32 {
        let screen = &self.options.screen;
        // The tangent of the angle at which it is seen; far away, of none.
        let away = (distance.powi(2) - self.radius.powi(2)).max(0.0).sqrt();
        let pixels = self.radius / away * screen.height_px / screen.half_height();
        let most = screen.height_px.floor().max(LEAST_SIDE);
        pixels.ceil().clamp(LEAST_SIDE, most) as u32
    }

    fn camera(&self, direction: Vec3, distance: f64, side: u32) -> Camera {
        let screen = &self.options.screen;
        let half = screen.half_height() * f64::from(side) / screen.height_px;
        let towards: DVec3 = direction.as_dvec3().normalize_or(DVec3::Z);
        Camera {
            eye: (self.middle.as_dvec3() + towards * distance).as_vec3(),
            target: self.middle,
            up: Vec3::Y,
            projection: Projection::Perspective {
                fov_y: (2.0 * half.atan()) as f32,
            },
            near: None,
            far: None,
        }
    }
}

fn mean_where_covered(map: &[f32], before: &Picture, after: &Picture) -> f64 {
    let pairs = before.pixels().iter().zip(after.pixels());
    let covered = pairs.map(|(a, b)| a[3] > 0 || b[3] > 0);
    let (mut sum, mut count) = (0.0, 0u64);
    for (&error, covered) in map.iter().zip(covered) {
        if covered {
            sum += f64::from(error);
            count += 1;
        }
    }
    sum / count.max(1) as f64
}
