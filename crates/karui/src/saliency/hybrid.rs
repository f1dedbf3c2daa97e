//! Which kind of saliency decides at a vertex, and how much it is worth.
//!
//! An Guangming, master's thesis, Tokyo University of Technology, 2014, 3.4.2
//! and 3.4.3. The thesis gives no thresholds: they are quantiles here.

use super::MultiView;
use super::quantile::quantile;
use crate::error::{Error, Result};
use std::ops::Range;

/// What decides at a vertex; the first that applies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Class {
    /// Large curvature (A).
    Curvature,
    /// Large mesh saliency (B).
    Mesh,
    /// Salient from wherever it is seen (C).
    AlwaysSeen,
    /// Salient from nowhere (D).
    NeverSeen,
    /// The rest (E): half mean of the views, half mesh saliency.
    Between,
}

/// Where classes begin and which part of `0..1` each is mapped to.
#[derive(Debug, Clone, PartialEq)]
pub struct HybridOptions {
    /// Share of the vertices whose curvature counts as large, 0 to 1.
    pub large_curvature: f32,
    /// Share of the vertices whose mesh saliency counts as large.
    pub large_mesh: f32,
    /// Share of the vertices whose least view counts as large.
    pub large_minimum: f32,
    /// Share of the vertices whose best view counts as small.
    pub small_maximum: f32,
    /// Where each class goes, in the order of [`Class`].
    pub ranges: [Range<f32>; 5],
}

impl Default for HybridOptions {
    fn default() -> Self {
        Self {
            large_curvature: 0.1,
            large_mesh: 0.1,
            large_minimum: 0.1,
            small_maximum: 0.3,
            ranges: [0.7..1.0, 0.7..1.0, 0.6..0.9, 0.0..0.3, 0.3..0.7],
        }
    }
}

/// Saliency of every vertex and what has decided it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Hybrid {
    /// One value a vertex, 0 to 1.
    pub values: Vec<f32>,
    /// One class a vertex.
    pub classes: Vec<Class>,
}

/// Combines mean curvature (1 / length, either sign), mesh saliency and what many views
/// found, one value a vertex each.
///
/// A class whose vertices all have one value is mapped to the middle of its range.
///
/// # Errors
/// [`Error::LengthMismatch`] if there are not as many values of each,
/// [`Error::NotFinite`] for one that is no number, [`Error::BadOption`] for shares and
/// ranges that are not within 0 to 1.
///
/// ```
/// use karui::saliency::{Class, HybridOptions, MultiView, hybrid};
///
/// # fn main() -> karui::Result<()> {
/// let views = MultiView {
///     maximum: vec![0.5, 0.5, 0.5, 0.1],
///     minimum: vec![0.2, 0.2, 0.2, 0.0],
///     mean: vec![0.3, 0.3, 0.3, 0.0],
///     ..MultiView::default()
/// };
/// let shares = HybridOptions { large_curvature: 0.25, ..HybridOptions::default() };
/// let found = hybrid(&[9.0, 0.1, 0.1, 0.1], &[0.0; 4], &views, &shares)?;
/// assert_eq!(found.classes[0], Class::Curvature);
/// assert_eq!(found.classes[3], Class::NeverSeen);
/// # Ok(())
/// # }
/// ```
pub fn hybrid(
    curvature: &[f32],
    mesh: &[f32],
    views: &MultiView,
    options: &HybridOptions,
) -> Result<Hybrid> {
    check(curvature, mesh, views, options)?;
    let curvature: Vec<f32> = curvature.iter().map(|c| c.abs()).collect();
    let least = |values: &[f32], share: f32| quantile(values, 1.0 - share);
    let (bent, odd) = (
        least(&curvature, options.large_curvature),
        least(mesh, options.large_mesh),
    );
    let always = least(&views.minimum, options.large_minimum);
    let dull: Vec<f32> = views.maximum.iter().map(|m| -m).collect();
    let never = least(&dull, options.small_maximum);
    let class = |v: usize| match () {
        () if curvature[v] > bent => (Class::Curvature, curvature[v]),
        () if mesh[v] > odd => (Class::Mesh, mesh[v]),
        () if views.minimum[v] > always => (Class::AlwaysSeen, views.minimum[v]),
        () if dull[v] > never => (Class::NeverSeen, views.maximum[v]),
        () => (Class::Between, 0.5 * (views.mean[v] + mesh[v])),
    };
    let (classes, mut values): (Vec<Class>, Vec<f32>) = (0..mesh.len()).map(class).unzip();
    spread(&mut values, &classes, &options.ranges);
    Ok(Hybrid { values, classes })
}

/// Maps the values of each class onto its range.
fn spread(values: &mut [f32], classes: &[Class], ranges: &[Range<f32>; 5]) {
    let mut ends = [(f32::INFINITY, f32::NEG_INFINITY); 5];
    for (&value, &class) in values.iter().zip(classes) {
        let (low, high) = &mut ends[class as usize];
        (*low, *high) = (low.min(value), high.max(value));
    }
    for (value, &class) in values.iter_mut().zip(classes) {
        let (low, high) = ends[class as usize];
        let share = if high > low {
            (*value - low) / (high - low)
        } else {
            0.5
        };
        let range = &ranges[class as usize];
        *value = range.start + (range.end - range.start) * share;
    }
}

fn check(
    curvature: &[f32],
    mesh: &[f32],
    views: &MultiView,
    options: &HybridOptions,
) -> Result<()> {
    let lists = [
        ("mesh saliency", mesh),
        ("curvature", curvature),
        ("least of the views", &views.minimum),
        ("best of the views", &views.maximum),
        ("mean of the views", &views.mean),
    ];
    for (what, list) in lists {
        let what = || what.to_owned();
        if list.len() != mesh.len() {
            let (what, expected, found) = (what(), mesh.len(), list.len());
            return Err(Error::LengthMismatch {
                what,
                expected,
                found,
            });
        }
        if let Some(index) = list.iter().position(|v| !v.is_finite()) {
            return Err(Error::NotFinite {
                what: what(),
                index,
            });
        }
    }
    let shares = [
        options.large_curvature,
        options.large_mesh,
        options.large_minimum,
        options.small_maximum,
    ];
    let ends = options.ranges.iter().flat_map(|r| [r.start, r.end]);
    match shares
        .into_iter()
        .chain(ends)
        .find(|s| !(0.0..=1.0).contains(s))
    {
        Some(value) => Err(Error::BadOption {
            option: "hybrid",
            found: value.to_string(),
            expected: "0 to 1",
        }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn views(n: usize, maximum: f32, minimum: f32) -> MultiView {
        MultiView {
            maximum: vec![maximum; n],
            minimum: vec![minimum; n],
            mean: vec![0.5 * (maximum + minimum); n],
            seen: vec![1; n],
        }
    }

    #[test]
    fn classes_are_taken_in_order() {
        let n = 10;
        let mut seen = views(n, 0.5, 0.2);
        seen.minimum[2] = 0.4;
        seen.maximum[3] = 0.1;
        let mut curvature = vec![1.0; n];
        curvature[0] = -5.0;
        let mut mesh = vec![0.1; n];
        (mesh[0], mesh[1]) = (1.0, 0.9);
        let options = HybridOptions {
            large_mesh: 0.2,
            ..HybridOptions::default()
        };
        let found = hybrid(&curvature, &mesh, &seen, &options).unwrap();
        let expected = [
            Class::Curvature,
            Class::Mesh,
            Class::AlwaysSeen,
            Class::NeverSeen,
            Class::Between,
        ];
        assert_eq!(found.classes[..5], expected);
        // Alone in its class each is in the middle of its range.
        let middle = |r: &Range<f32>| 0.5 * (r.start + r.end);
        for (value, range) in found.values.iter().zip(&options.ranges) {
            assert!((value - middle(range)).abs() < 1e-6);
        }
    }

    #[test]
    fn a_class_fills_its_range() {
        let n = 100;
        let curvature: Vec<f32> = (0..n).map(|i| i as f32).collect();
        let found = hybrid(
            &curvature,
            &vec![0.0; n],
            &views(n, 0.5, 0.2),
            &HybridOptions::default(),
        );
        let found = found.unwrap();
        assert_eq!(found.values[99], 1.0);
        assert_eq!(found.values[90], 0.7);
        assert!(found.values[..90].iter().all(|&v| v == 0.5));
    }

    #[test]
    fn what_does_not_fit_is_told() {
        let options = HybridOptions::default();
        let of = |c: &[f32], m: &[f32], o: &HybridOptions| hybrid(c, m, &views(2, 0.5, 0.2), o);
        assert!(of(&[0.0; 3], &[0.0; 2], &options).is_err());
        assert!(of(&[f32::NAN; 2], &[0.0; 2], &options).is_err());
        let shares = HybridOptions {
            large_mesh: 1.5,
            ..options
        };
        assert!(of(&[0.0; 2], &[0.0; 2], &shares).is_err());
        let none = hybrid(&[], &[], &MultiView::default(), &HybridOptions::default());
        assert_eq!(none, Ok(Hybrid::default()));
    }
}
