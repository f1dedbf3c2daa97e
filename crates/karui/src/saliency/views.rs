//! Image saliency of a model from all around, brought back to its vertices.

use super::{ImageSaliency, ImageSaliencyOptions};
use crate::error::{Error, Result};
use crate::geom::{Camera, DVec3, Light, Projection, Vec3, fibonacci_directions, sin_cos, tan};
use crate::progress::{Progress, step};
use crate::render::{Model, Outputs, RenderOptions, Renderer};
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Views held in memory at a time, one value a vertex each.
const BATCH: usize = 16;

/// Where a model is looked at from.
#[derive(Debug, Clone, PartialEq)]
pub enum Views {
    /// Directions (sin a cos b, sin a sin b, cos a), a = 2 pi k / `n1` and
    /// b = 2 pi l / `n2`, each direction once: 614 of 36 times 36.
    Grid {
        /// Steps of a, 1 or more.
        n1: u32,
        /// Steps of b, 1 or more.
        n2: u32,
    },
    /// This many directions spread evenly, 1 or more.
    Fibonacci(u32),
    /// These directions, from the centre of the model towards the eye.
    Directions(Vec<Vec3>),
}

impl Views {
    /// Unit directions from the centre towards the eye, no two the same.
    #[must_use]
    pub fn directions(&self) -> Vec<Vec3> {
        match *self {
            Self::Grid { n1, n2 } => grid(u64::from(n1), u64::from(n2)),
            Self::Fibonacci(count) => fibonacci_directions(count),
            Self::Directions(ref directions) => directions.clone(),
        }
    }
}

/// Going over a pole comes down on the other side: (a, b) and (2 pi - a, b + pi)
/// are one direction, and so are all b at a pole. Integers tell.
fn grid(n1: u64, n2: u64) -> Vec<Vec3> {
    let mut known = BTreeSet::new();
    let mut directions = Vec::new();
    for k in 0..n1 {
        for l in 0..n2 {
            let key = match (2 * k).cmp(&n1) {
                _ if k == 0 => (0, 0),
                std::cmp::Ordering::Equal => (k, 0),
                std::cmp::Ordering::Less => (k, 2 * l),
                std::cmp::Ordering::Greater => (n1 - k, (2 * l + n2) % (2 * n2)),
            };
            if known.insert(key) {
                let turn =
                    |at: u64, of: u64| sin_cos(std::f64::consts::TAU * at as f64 / of as f64);
                let ((sa, ca), (sb, cb)) = (turn(k, n1), turn(l, n2));
                directions.push(DVec3::new(sa * cb, sa * sb, ca).as_vec3());
            }
        }
    }
    directions
}

/// What shines in every view.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum ViewLights {
    /// [`Light::headlight`]: what is seen is lit, and no side is darker.
    #[default]
    Headlight,
    /// The same lights in the world for every view.
    Fixed(Vec<Light>),
}

/// What a view that does not see a vertex says about it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Unseen {
    /// Nothing: minimum and mean are over the views that see it.
    #[default]
    Ignored,
    /// That its saliency is 0, as in the thesis.
    Zero,
}

/// How a model is looked at.
#[derive(Debug, Clone, PartialEq)]
pub struct MultiViewOptions {
    /// Where from; the grid of 614 by default.
    pub views: Views,
    /// Lights besides the renderer's ambient one; a headlight by default.
    pub lights: ViewLights,
    /// Pixels a side of each view; 512 by default.
    pub size: u32,
    /// Distance of the eye by the diagonal of the bounding box; 1.4 by default.
    pub distance: f32,
    /// Field of view, radians; 0.75 by default, which holds the bounding sphere
    /// at the default distance.
    pub fov_y: f32,
    /// What views that do not see a vertex count as.
    pub unseen: Unseen,
    /// How the pictures are judged.
    pub image: ImageSaliencyOptions,
}

impl Default for MultiViewOptions {
    fn default() -> Self {
        Self {
            views: Views::Grid { n1: 36, n2: 36 },
            lights: ViewLights::default(),
            size: 512,
            distance: 1.4,
            fov_y: 0.75,
            unseen: Unseen::default(),
            image: ImageSaliencyOptions::default(),
        }
    }
}

/// Saliency of the vertices of one mesh over all views, 0..=1, and 0 where no
/// view sees a vertex. A mesh placed several times is seen once a place and view.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MultiView {
    /// Largest value of every vertex.
    pub maximum: Vec<f32>,
    /// Smallest value.
    pub minimum: Vec<f32>,
    /// Mean value.
    pub mean: Vec<f32>,
    /// How often it was seen.
    pub seen: Vec<u32>,
}

/// Saliency of pictures of a model from all around, for the vertices of each of
/// its meshes. `Model::of_mesh` and `Model::of_scene` make models.
///
/// A vertex is seen if its pixel shows something that is at most two pixels'
/// widths closer to the eye than the vertex is. The result is the same to the bit
/// for any number of threads.
///
/// # Errors
/// [`Error::BadOption`] for options out of range, [`Error::Cancelled`], and those
/// of [`Renderer::of_model`] and [`Renderer::frame`].
pub fn multi_view(
    model: &Model<'_>,
    options: &MultiViewOptions,
    progress: &dyn Progress,
) -> Result<Vec<MultiView>> {
    let directions = options.views.directions();
    if directions.is_empty() {
        return Err(Error::Empty { what: "views" });
    }
    if !(options.distance > 0.0 && options.distance.is_finite()) {
        return Err(Error::BadOption {
            option: "distance",
            found: options.distance.to_string(),
            expected: "positive",
        });
    }
    let judge = ImageSaliency::new(&options.image)?;
    let stage = Stage::new(model, options)?;
    let mut sums: Vec<Sums> = stage.places.iter().map(|p| Sums::of(p.len())).collect();
    for (batch, part) in directions.chunks(BATCH).enumerate() {
        let fraction = (batch * BATCH) as f32 / directions.len() as f32;
        step(progress, "views", fraction)?;
        let looks: Vec<_> = part
            .par_iter()
            .map_init(
                || judge.clone(),
                |judge, &d| match progress.cancelled() {
                    true => Err(Error::Cancelled),
                    false => stage.look(d, judge),
                },
            )
            .collect::<Result<_>>()?;
        // In the order of the views, whoever was first to be done.
        for look in &looks {
            sums.iter_mut().zip(look).for_each(|(s, l)| s.add(l));
        }
    }
    step(progress, "views", 1.0)?;
    Ok(stage.gather(&sums, directions.len()))
}

/// The model and the positions of every instance in the world.
struct Stage<'a> {
    model: &'a Model<'a>,
    renderer: Renderer<'a>,
    options: &'a MultiViewOptions,
    places: Vec<Vec<Vec3>>,
}

impl<'a> Stage<'a> {
    fn new(model: &'a Model<'a>, options: &'a MultiViewOptions) -> Result<Self> {
        let renderer = Renderer::of_model(model)?;
        let place = |i: &crate::render::Instance| {
            let mesh = model.meshes[i.mesh as usize];
            let points = mesh.positions.iter();
            points
                .map(|&p| i.world_from_mesh.transform_point3(p))
                .collect()
        };
        let places = model.instances.iter().map(place).collect();
        Ok(Self {
            model,
            renderer,
            options,
            places,
        })
    }

    fn camera(&self, direction: Vec3) -> Camera {
        let bounds = self.renderer.bounds();
        let fov_y = self.options.fov_y;
        let mut camera = Camera::looking_at(bounds, direction, fov_y);
        let diagonal = if bounds.diagonal() > 0.0 {
            bounds.diagonal()
        } else {
            1.0
        };
        let towards = direction.as_dvec3().normalize_or(DVec3::Z);
        let eye =
            camera.target.as_dvec3() + towards * (f64::from(self.options.distance) * diagonal);
        camera.eye = eye.as_vec3();
        camera.projection = Projection::Perspective { fov_y };
        camera
    }

    /// For every instance, its vertices' values in one view; NaN where unseen.
    fn look(&self, direction: Vec3, judge: &mut ImageSaliency) -> Result<Vec<Vec<f32>>> {
        let camera = self.camera(direction);
        let size = self.options.size;
        let render = RenderOptions {
            width: size,
            height: size,
            outputs: Outputs {
                color: true,
                depth: true,
                hits: false,
            },
            ..RenderOptions::default()
        };
        let lights = match &self.options.lights {
            ViewLights::Headlight => vec![Light::headlight(&camera)?],
            ViewLights::Fixed(lights) => lights.clone(),
        };
        let frame = self.renderer.frame(&camera, &lights, &render)?;
        let map = judge.map(&frame.color);
        let view = self.renderer.view(&camera, size, size)?;
        let pixel = 2.0 * tan(0.5 * f64::from(self.options.fov_y)) / f64::from(size);
        let value = |&position: &Vec3| {
            let seen = view.project(position).filter(|p| {
                let inside = p.x >= 0.0 && p.y >= 0.0;
                let shown = frame.depth_at(p.x as u32, p.y as u32).filter(|_| inside);
                shown.is_some_and(|d| p.z <= f64::from(d) + 2.0 * pixel * p.z)
            });
            seen.map_or(f32::NAN, |p| map.sample(p.x as f32, p.y as f32))
        };
        let places = self.places.iter();
        Ok(places.map(|p| p.iter().map(value).collect()).collect())
    }

    /// Instances of one mesh together.
    fn gather(&self, sums: &[Sums], views: usize) -> Vec<MultiView> {
        let meshes = self.model.meshes.iter().enumerate();
        let of_mesh = |(m, mesh): (usize, &&crate::mesh::TriMesh)| {
            let mut all = Sums::of(mesh.positions.len());
            let mut looks = 0;
            for (instance, sums) in self.model.instances.iter().zip(sums) {
                if instance.mesh as usize == m {
                    all.join(sums);
                    looks += views;
                }
            }
            all.finish(self.options.unseen, looks)
        };
        meshes.map(of_mesh).collect()
    }
}

#[derive(Clone, Copy)]
struct Sum {
    low: f32,
    high: f32,
    total: f64,
    seen: u32,
}

struct Sums(Vec<Sum>);

impl Sums {
    fn of(vertices: usize) -> Self {
        let none = Sum {
            low: f32::INFINITY,
            high: 0.0,
            total: 0.0,
            seen: 0,
        };
        Self(vec![none; vertices])
    }

    fn add(&mut self, look: &[f32]) {
        for (sum, &value) in self.0.iter_mut().zip(look) {
            if !value.is_nan() {
                sum.low = sum.low.min(value);
                sum.high = sum.high.max(value);
                sum.total += f64::from(value);
                sum.seen += 1;
            }
        }
    }

    fn join(&mut self, other: &Self) {
        for (sum, o) in self.0.iter_mut().zip(&other.0) {
            sum.low = sum.low.min(o.low);
            sum.high = sum.high.max(o.high);
            sum.total += o.total;
            sum.seen += o.seen;
        }
    }

    fn finish(&self, unseen: Unseen, looks: usize) -> MultiView {
        let each = |f: &dyn Fn(&Sum) -> f32| self.0.iter().map(f).collect();
        let zero = |s: &Sum| unseen == Unseen::Zero && (s.seen as usize) < looks;
        let count = |s: &Sum| {
            if zero(s) {
                looks as f64
            } else {
                f64::from(s.seen)
            }
        };
        MultiView {
            maximum: each(&|s| s.high),
            minimum: each(&|s| if s.seen == 0 || zero(s) { 0.0 } else { s.low }),
            mean: each(&|s| {
                if s.seen == 0 {
                    0.0
                } else {
                    (s.total / count(s)) as f32
                }
            }),
            seen: self.0.iter().map(|s| s.seen).collect(),
        }
    }
}
