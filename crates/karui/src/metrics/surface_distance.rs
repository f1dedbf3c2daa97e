//! Two-sided distance between surfaces, sampled as Metro does.
//!
//! P. Cignoni, C. Rocchini, R. Scopigno: Metro: measuring error on simplified
//! surfaces. Computer Graphics Forum 17(2), 1998. Sample kinds and averages
//! are those of its successor, MeshLab's Hausdorff distance filter.

use super::sampling::{Kind, Sampler};
use super::surface::Surface;
use super::tally::Tally;
use crate::error::{Error, Result};
use crate::mesh::TriMesh;
use crate::progress::{Progress, Silent, step};
use glam::Vec3;
use rayon::prelude::*;

/// How many face samples, and as many edge samples, each direction takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Samples {
    /// This many of either kind.
    Count(u64),
    /// This many face samples for every unit of area (model units squared) of
    /// the sampled surface, rounded up, and as many edge samples.
    Density(f64),
}

/// How to measure.
#[derive(Clone, Copy)]
pub struct SurfaceDistanceOptions<'a> {
    /// Number of samples; default 500,000 of either kind a direction.
    pub samples: Samples,
    /// Whether every vertex is a sample; default yes. Maxima often lie there.
    pub vertices: bool,
    /// Whether samples are spread over the edges by length; default yes.
    pub edges: bool,
    /// Whether samples are spread over the faces by area; default yes. With
    /// faces alone, mean and RMS are averages over the area.
    pub faces: bool,
    /// Places the samples; default 0.
    pub seed: u64,
    /// Importance of every vertex of `a`, 0 or more, interpolated over its
    /// triangles; vertices at one position share the largest. A sample of `a`
    /// counts with the weight where it lies, a sample of `b` with that of the
    /// nearest point of `a`; those of weight 0 do not count at all. Default:
    /// everything counts alike.
    pub weights: Option<&'a [f32]>,
    /// Told of stages `measuring a to b` and `measuring b to a`.
    pub progress: &'a dyn Progress,
}

impl Default for SurfaceDistanceOptions<'_> {
    fn default() -> Self {
        Self {
            samples: Samples::Count(500_000),
            vertices: true,
            edges: true,
            faces: true,
            seed: 0,
            weights: None,
            progress: &Silent,
        }
    }
}

/// Distance of the samples of one surface to another surface, model units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Distance {
    /// Largest distance of any sample.
    pub max: f64,
    /// Mean over all samples, of every kind alike but for their weights.
    pub mean: f64,
    /// Square root of the mean square, over the same samples.
    pub rms: f64,
    /// Number of samples with a weight above 0; if 0, so is everything else.
    pub samples: u64,
    /// The sample at distance `max`, and the point of the other surface
    /// nearest to it.
    pub farthest: [Vec3; 2],
}

/// Distance between two surfaces, model units. The two-sided figures are those
/// of the worse direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceDistance {
    /// From samples of `a` to surface `b`.
    pub a_to_b: Distance,
    /// From samples of `b` to surface `a`.
    pub b_to_a: Distance,
    /// Diagonal of the box around the triangles of `a`; `rms() / diagonal` is
    /// the usual relative error.
    pub diagonal: f64,
}

impl SurfaceDistance {
    /// Largest distance, a lower bound of the Hausdorff distance.
    #[must_use]
    pub fn max(&self) -> f64 {
        self.a_to_b.max.max(self.b_to_a.max)
    }

    /// Mean distance.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.a_to_b.mean.max(self.b_to_a.mean)
    }

    /// Root mean square distance.
    #[must_use]
    pub fn rms(&self) -> f64 {
        self.a_to_b.rms.max(self.b_to_a.rms)
    }
}

/// Distance between the surfaces of two meshes, in both directions. Runs on
/// all threads of the current pool; the result does not depend on how many.
///
/// # Errors
/// [`Error::Empty`] for a mesh without triangles, or if no kind of sample asked
/// for exists on it, or if all weights are 0; [`Error::IndexOutOfRange`] and
/// [`Error::NotFinite`] for damaged meshes; [`Error::LengthMismatch`],
/// [`Error::BadOption`] for the options; [`Error::Cancelled`].
pub fn surface_distance(
    a: &TriMesh,
    b: &TriMesh,
    options: &SurfaceDistanceOptions,
) -> Result<SurfaceDistance> {
    surface_distance_between(&Surface::new(a)?, &Surface::new(b)?, options)
}

/// As [`surface_distance`], for meshes that are measured more than once.
///
/// # Errors
/// As [`surface_distance`].
pub fn surface_distance_between(
    a: &Surface,
    b: &Surface,
    options: &SurfaceDistanceOptions,
) -> Result<SurfaceDistance> {
    let weights = options.weights.map(|w| checked_weights(a, w)).transpose()?;
    let weights = weights.as_deref();
    let to_b = weights.map_or(Mask::None, Mask::From);
    let to_a = weights.map_or(Mask::None, Mask::To);
    Ok(SurfaceDistance {
        a_to_b: one_way(a, b, to_b, "measuring a to b", options)?,
        b_to_a: one_way(b, a, to_a, "measuring b to a", options)?,
        diagonal: a.bounds().diagonal(),
    })
}

/// One direction only: from samples of `from`, which stands for `a` in the
/// options, to the surface `to`.
///
/// # Errors
/// As [`surface_distance`].
pub fn directed_distance(
    from: &Surface,
    to: &Surface,
    options: &SurfaceDistanceOptions,
) -> Result<Distance> {
    let weights = options
        .weights
        .map(|w| checked_weights(from, w))
        .transpose()?;
    let mask = weights.as_deref().map_or(Mask::None, Mask::From);
    one_way(from, to, mask, "measuring a to b", options)
}

/// Weights of the positions of `a`, from those of its vertices.
fn checked_weights(a: &Surface, weights: &[f32]) -> Result<Vec<f32>> {
    if weights.len() != a.vertex_count() {
        return Err(Error::LengthMismatch {
            what: "weights".into(),
            expected: a.vertex_count(),
            found: weights.len(),
        });
    }
    if let Some(bad) = weights.iter().find(|w| !(w.is_finite() && **w >= 0.0)) {
        return Err(Error::BadOption {
            option: "weights",
            found: bad.to_string(),
            expected: "finite and not negative",
        });
    }
    let weights = a.largest_at_positions(weights);
    if weights.iter().all(|&w| w == 0.0) {
        return Err(Error::Empty {
            what: "weight mask",
        });
    }
    Ok(weights)
}

/// Which surface has weights, one a position.
#[derive(Clone, Copy)]
enum Mask<'a> {
    None,
    From(&'a [f32]),
    To(&'a [f32]),
}

/// Samples a task takes, in a row so that one hit helps to find the next.
const CHUNK: u64 = 4096;
/// Tasks between two reports of progress.
const BATCH: u64 = 64;

fn one_way(
    from: &Surface,
    to: &Surface,
    mask: Mask,
    stage: &'static str,
    options: &SurfaceDistanceOptions,
) -> Result<Distance> {
    let samplers = samplers(from, options)?;
    let total: u64 = samplers.iter().fold(0, |n, s| n.saturating_add(s.count()));
    let mut tally = Tally::default();
    let mut done = 0u64;
    for sampler in samplers {
        let chunks = sampler.count().div_ceil(CHUNK);
        for batch in (0..chunks).step_by(BATCH as usize) {
            step(options.progress, stage, done as f32 / total as f32)?;
            let batch = batch..chunks.min(batch + BATCH);
            let tallies: Vec<Tally> = batch
                .into_par_iter()
                .map(|chunk| measure_chunk(&sampler, chunk, to, mask))
                .collect();
            tallies.iter().for_each(|t| tally.merge(t));
            done = done.saturating_add(BATCH * CHUNK).min(total);
        }
    }
    step(options.progress, stage, 1.0)?;
    Ok(tally.distance())
}

/// The samplers asked for that have samples.
fn samplers<'a>(from: &'a Surface, options: &SurfaceDistanceOptions) -> Result<Vec<Sampler<'a>>> {
    let wanted = wanted_samples(options.samples, from.area())?;
    let kinds = [
        (options.vertices, Kind::Vertices),
        (options.edges, Kind::Edges),
        (options.faces, Kind::Faces),
    ];
    let asked_for = kinds.into_iter().filter(|&(on, _)| on);
    let samplers: Vec<Sampler> = asked_for
        .map(|(_, kind)| Sampler::new(from, kind, wanted, options.seed))
        .filter(|sampler| sampler.count() > 0)
        .collect();
    if samplers.is_empty() {
        return Err(Error::Empty {
            what: "set of samples",
        });
    }
    Ok(samplers)
}

fn wanted_samples(samples: Samples, area: f64) -> Result<u64> {
    /// Up to here numbers of samples are exact in `f64`.
    const LIMIT: f64 = (1u64 << 53) as f64;
    let wanted = match samples {
        Samples::Count(count) => count as f64,
        Samples::Density(density) if density >= 0.0 => (density * area).ceil(),
        Samples::Density(_) => f64::NAN,
    };
    if !(0.0..=LIMIT).contains(&wanted) {
        return Err(Error::BadOption {
            option: "samples",
            found: format!("{samples:?}"),
            expected: "a density not below 0 and at most 2^53 samples",
        });
    }
    Ok(wanted as u64)
}

fn measure_chunk(sampler: &Sampler, chunk: u64, to: &Surface, mask: Mask) -> Tally {
    let mut tally = Tally::default();
    let mut near = None;
    let numbers = chunk * CHUNK..sampler.count().min((chunk + 1) * CHUNK);
    sampler.visit(numbers, |sample| {
        let mut weight = 1.0;
        if let Mask::From(weights) = mask {
            weight = mix(weights, sample.positions, sample.barycentric);
            if weight == 0.0 {
                return;
            }
        }
        let hit = match &near {
            Some(near) => to.bvh.closest_near(sample.point, near),
            None => to.bvh.closest(sample.point),
        };
        if let Mask::To(weights) = mask {
            let corners = to.triangles[hit.slot as usize];
            weight = mix(weights, corners, hit.barycentric);
        }
        tally.add(sample.point, hit.point, hit.distance_squared, weight);
        near = Some(hit);
    });
    tally
}

fn mix(weights: &[f32], positions: [u32; 3], barycentric: [f64; 3]) -> f64 {
    let weight = |i: usize| f64::from(weights[positions[i] as usize]) * barycentric[i];
    weight(0) + weight(1) + weight(2)
}
