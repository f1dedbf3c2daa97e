//! Saliency of every vertex from the shape alone.

use super::curvature::{self, Estimator};
use super::gauss::Tree;
use super::stars::Stars;
use crate::error::{Error, Result};
use crate::mesh::TriMesh;
use crate::progress::{Progress, Silent, step};
use glam::DVec3;
use rayon::prelude::*;

/// How a scale on which many places stand out is held back. With the scale's
/// maximum M = 1 and m the mean of its other local maxima:
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Suppression {
    /// Times `(M - m)^2` (Lee et al. 2005, after Itti et al. 1998).
    #[default]
    Squared,
    /// Times `M - m` (thesis, eq. 3.14).
    Linear,
    /// Not at all.
    Off,
}

/// What [`mesh_saliency`] looks for.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshSaliencyOptions {
    /// The unit of `scales`, as a part of the diagonal of the bounding box of
    /// all triangles; default 0.003.
    pub epsilon: f64,
    /// Widths of the finer Gaussians, in `epsilon`; the coarser ones are twice
    /// as wide. Default 2, 3, 4, 5, 6. None may be narrower than 1e-5 of the
    /// diagonal.
    pub scales: Vec<f64>,
    /// How curvature is found. Default [`Estimator::Corrected`].
    pub estimator: Estimator,
    /// Default [`Suppression::Squared`].
    pub suppression: Suppression,
    /// A scale whose largest difference is below this part of the level of
    /// curvature, the mean of its magnitude plus 1 / diagonal, shows nothing:
    /// what is there comes from how the surface is cut into triangles, and
    /// would be blown up to 1. Default 0.01; 0 keeps all.
    pub flat: f64,
    /// Whether the sum over the scales is scaled to have the maximum 1 (the
    /// default). Otherwise it is at most the number of scales, and meshes can
    /// be compared.
    pub stretch: bool,
}

impl MeshSaliencyOptions {
    /// As Lee, Varshney and Jacobs published it; the default.
    #[must_use]
    pub fn lee2005() -> Self {
        Self {
            epsilon: 0.003,
            scales: vec![2.0, 3.0, 4.0, 5.0, 6.0],
            estimator: Estimator::Corrected,
            suppression: Suppression::Squared,
            flat: 0.01,
            stretch: true,
        }
    }

    /// As in An's thesis: [`Suppression::Linear`].
    #[must_use]
    pub fn thesis2014() -> Self {
        Self {
            suppression: Suppression::Linear,
            ..Self::lee2005()
        }
    }

    fn check(&self) -> Result<()> {
        let bad = |option, found: String, expected| {
            Err(Error::BadOption {
                option,
                found,
                expected,
            })
        };
        if !(self.epsilon > 0.0 && self.epsilon.is_finite()) {
            return bad("epsilon", self.epsilon.to_string(), "positive");
        }
        if !(self.flat >= 0.0 && self.flat.is_finite()) {
            return bad("flat", self.flat.to_string(), "0 or more");
        }
        let fits = |s: &f64| s.is_finite() && s * self.epsilon >= 1e-5;
        if self.scales.is_empty() || !self.scales.iter().all(fits) {
            let expected = "at least one, none below 1e-5 / epsilon";
            return bad("scales", format!("{:?}", self.scales), expected);
        }
        Ok(())
    }
}

impl Default for MeshSaliencyOptions {
    fn default() -> Self {
        Self::lee2005()
    }
}

/// Saliency of every vertex, 0 to 1: how much mean curvature differs between
/// a narrow and a wide neighbourhood (Lee et al. 2005; thesis, eq. 3.12-3.15).
///
/// With `G(v, s)` the mean curvature of the points within 2 s of v, weighted
/// by a Gaussian of width s, a scale has `|G(v, s) - G(v, 2 s)|`, scaled to
/// the maximum 1 and suppressed; the sum over the scales is scaled to the
/// maximum 1. Vertices at one position are one point. Vertices of no triangle
/// take no part and have 0, and so has everything if nothing stands out.
///
/// It is within 1 % of the maximum of the plain sums over all pairs of points, and takes
/// a time that hardly grows faster than the number of points. Same bits for any number of
/// threads.
///
/// # Errors
/// [`Error::BadOption`], [`Error::IndexOutOfRange`], [`Error::TooLarge`], and
/// [`Error::NotFinite`] for a position that is not.
pub fn mesh_saliency(mesh: &TriMesh, options: &MeshSaliencyOptions) -> Result<Vec<f32>> {
    mesh_saliency_observed(mesh, options, &Silent)
}

/// As [`mesh_saliency`], with an observer.
///
/// # Errors
/// Those of [`mesh_saliency`]; [`Error::Cancelled`].
pub fn mesh_saliency_observed(
    mesh: &TriMesh,
    options: &MeshSaliencyOptions,
    progress: &dyn Progress,
) -> Result<Vec<f32>> {
    options.check()?;
    step(progress, "mesh saliency", 0.0)?;
    let stars = Stars::of(mesh)?;
    let mut total = vec![0.0; stars.points.len()];
    let samples = Samples::of(&stars, options.estimator);
    for scale in samples.differences(options, progress)? {
        let factor = options.suppression.factor(&stars, &scale);
        let sum = |(t, s): (&mut f64, &f64)| *t += s * factor;
        total.par_iter_mut().zip(&scale).for_each(sum);
    }
    if options.stretch {
        stretch(&mut total);
    }
    let single: Vec<f32> = total.iter().map(|&s| s as f32).collect();
    Ok(stars.spread(&single))
}

/// The points that have triangles, with their mean curvature.
struct Samples {
    /// Indices of the points, of which there are `all`.
    of_points: Vec<u32>,
    all: usize,
    places: Vec<DVec3>,
    /// Mean curvature as a part of `largest`.
    bends: Vec<f64>,
    largest: f64,
    diagonal: f64,
}

impl Samples {
    fn of(stars: &Stars, estimator: Estimator) -> Self {
        let all = stars.points.len();
        let has_triangle = |&p: &u32| !stars.around(p as usize).is_empty();
        let of_points: Vec<u32> = (0..all as u32).filter(has_triangle).collect();
        let place = |&p: &u32| stars.points[p as usize];
        let places: Vec<DVec3> = of_points.iter().map(place).collect();
        let origin = places.iter().copied().reduce(DVec3::min);
        let end = places.iter().copied().reduce(DVec3::max);
        let (origin, end) = (origin.unwrap_or_default(), end.unwrap_or_default());
        let curved = curvature::of_points(stars, estimator);
        let bend = |&p: &u32| curved[p as usize].mean();
        let mut bends: Vec<f64> = of_points.iter().map(bend).collect();
        let largest = bends.iter().fold(0.0, |l: f64, b| l.max(b.abs()));
        if largest > 0.0 {
            bends.iter_mut().for_each(|b| *b /= largest);
        }
        Self {
            of_points,
            all,
            places,
            bends,
            largest,
            diagonal: origin.distance(end),
        }
    }

    /// `|G(s) - G(2 s)|` of every point, with the maximum 1, for every scale
    /// that shows something.
    fn differences(
        &self,
        options: &MeshSaliencyOptions,
        progress: &dyn Progress,
    ) -> Result<Vec<Vec<f64>>> {
        if self.largest <= 0.0 {
            return Ok(Vec::new());
        }
        let magnitude: f64 = self.bends.iter().map(|b| b.abs()).sum();
        let level = magnitude / self.bends.len() as f64 + 1.0 / self.diagonal / self.largest;
        let widths = options.scales.iter().flat_map(|&s| [s, 2.0 * s]);
        let mut widths: Vec<f64> = widths.collect();
        widths.sort_by(f64::total_cmp);
        widths.dedup();
        let tree = Tree::new(&self.places, &self.bends, self.diagonal);
        let unit = options.epsilon * self.diagonal;
        let mean = |(i, width): (usize, &f64)| {
            let done = (1 + i) as f32 / (1 + widths.len()) as f32;
            step(progress, "mesh saliency", done)?;
            Ok(tree.means(width * unit))
        };
        let means: Vec<Vec<f64>> = widths.iter().enumerate().map(mean).collect::<Result<_>>()?;
        let of_width = |w: f64| &means[widths.partition_point(|x| *x < w)];
        let least = options.flat * level;
        let difference = |&s: &f64| self.difference(of_width(s), of_width(2.0 * s), least);
        Ok(options.scales.iter().filter_map(difference).collect())
    }

    /// Nothing if the maximum is not above `least`.
    fn difference(&self, fine: &[f64], coarse: &[f64], least: f64) -> Option<Vec<f64>> {
        let mut all = vec![0.0; self.all];
        for (&p, (f, c)) in self.of_points.iter().zip(fine.iter().zip(coarse)) {
            all[p as usize] = f64::abs(f - c);
        }
        (stretch(&mut all) > least).then_some(all)
    }
}

/// Scales to the maximum 1 and returns what the maximum was.
fn stretch(values: &mut [f64]) -> f64 {
    let largest = values.iter().copied().fold(0.0, f64::max);
    if largest > 0.0 {
        values.iter_mut().for_each(|v| *v /= largest);
    }
    largest
}

impl Suppression {
    /// For values with the maximum 1.
    fn factor(self, stars: &Stars, values: &[f64]) -> f64 {
        let apart = 1.0 - mean_of_other_maxima(stars, values);
        match self {
            Self::Squared => apart * apart,
            Self::Linear => apart,
            Self::Off => 1.0,
        }
    }
}

/// Mean of all local maxima, points above all their neighbours, but for one of
/// the value 1; 0 if there is no other.
fn mean_of_other_maxima(stars: &Stars, values: &[f64]) -> f64 {
    let is_maximum = |&p: &usize| {
        let mut others = stars.around(p).iter().flatten();
        values[p] > 0.0 && others.all(|&o| values[p] > values[o as usize])
    };
    let maxima: Vec<usize> = (0..values.len())
        .into_par_iter()
        .filter(is_maximum)
        .collect();
    let top = maxima.iter().position(|&p| values[p] >= 1.0);
    let count = maxima.len() - usize::from(top.is_some());
    let sum: f64 = maxima.iter().map(|&p| values[p]).sum();
    let own = if top.is_some() { 1.0 } else { 0.0 };
    if count == 0 {
        0.0
    } else {
        (sum - own) / count as f64
    }
}
