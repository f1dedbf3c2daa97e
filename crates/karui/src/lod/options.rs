//! What a caller may ask of a chain.

use super::screen::positive;
use super::{Method, Screen};
use crate::error::{Error, Result};
use crate::progress::{Progress, Silent};
use crate::simplify::{SimplifyOptions, Stop, Stopped};
use std::fmt;

/// Which levels a chain has, the original not among them.
#[derive(Debug, Clone, PartialEq)]
pub enum Levels {
    /// Each with half the triangles of the one before.
    Halving {
        /// No level of a mesh has fewer triangles than this.
        min_triangles: usize,
        /// No more levels than this.
        max_levels: usize,
    },
    /// By share of the original's triangles, each in `0..=1`.
    Ratios(Vec<f64>),
    /// By number of triangles of the whole scene, each mesh keeping the same
    /// share of its own.
    Triangles(Vec<usize>),
    /// By any stop each, in the order given. Triangles are those of the whole
    /// scene as in [`Levels::Triangles`], errors are in the world's unit, and
    /// relative ones are shares of the diagonal of the whole scene's box.
    Stops(Vec<Stop>),
    /// By largest measured error, in the world's unit.
    Errors(Vec<f64>),
    /// By the height in pixels that the whole model has on the screen, taken
    /// as the diagonal of its box; the error then looks no larger than
    /// [`Screen::tolerance_px`].
    Pixels(Vec<f64>),
}

impl Default for Levels {
    fn default() -> Self {
        Self::Halving {
            min_triangles: 32,
            max_levels: 5,
        }
    }
}

/// Options of [`chain_mesh`](super::chain_mesh) and
/// [`chain_scene`](super::chain_scene).
#[derive(Clone)]
pub struct LodOptions<'a> {
    /// The levels to make. Default: five, by halving, down to 32 triangles.
    pub levels: Levels,
    /// What switch distances are for.
    pub screen: Screen,
    /// How to simplify. Its `stop`, `weights` and `progress` are not used; its
    /// `locks` only for a single mesh.
    pub simplify: SimplifyOptions<'a>,
    /// What makes the levels. Default: [`Method::Collapse`].
    pub method: Method,
    /// Size in the world, at the largest instance, up to which connected parts
    /// are removed before any level is made
    /// ([`prune`](crate::simplify::prune())). Default: `None`.
    pub prune: Option<f64>,
    /// Simplification weights of every mesh; none for meshes beyond its end.
    pub weights: &'a [Option<Vec<f32>>],
    /// Face samples, and as many edge samples, each direction of a measurement
    /// takes at most; small meshes take 20 a triangle. Default: 200,000.
    pub samples: u64,
    /// Places the samples; default 0.
    pub seed: u64,
    /// Told about the work, possibly from several threads in turn, and asked
    /// whether to go on.
    pub progress: &'a dyn Progress,
}

impl Default for LodOptions<'_> {
    fn default() -> Self {
        Self {
            levels: Levels::default(),
            screen: Screen::default(),
            simplify: SimplifyOptions::default(),
            method: Method::default(),
            prune: None,
            weights: &[],
            samples: 200_000,
            seed: 0,
            progress: &Silent,
        }
    }
}

impl fmt::Debug for LodOptions<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("LodOptions")
            .field("levels", &self.levels)
            .field("screen", &self.screen)
            .field("simplify", &self.simplify)
            .field("method", &self.method)
            .field("prune", &self.prune)
            .field("weights", &self.weights.len())
            .field("samples", &self.samples)
            .field("seed", &self.seed)
            .finish_non_exhaustive()
    }
}

/// What the levels of one mesh have to know of the scene around it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Surroundings {
    /// Triangles of the whole scene.
    pub triangles: usize,
    /// Diagonal of the whole scene's box, in the world's unit.
    pub diagonal: f64,
    /// Length in the world of a length of 1 in the mesh, at most.
    pub scale: f64,
}

impl Levels {
    /// Stops of a mesh of `triangles`, finest first, in the mesh's unit.
    pub(super) fn stops(
        &self,
        triangles: usize,
        around: Surroundings,
        screen: &Screen,
    ) -> Vec<Stop> {
        let of_error = |error: f64| Stop::error(error / around.scale);
        match self {
            &Self::Halving {
                min_triangles,
                max_levels,
            } => halves(triangles, min_triangles)
                .take(max_levels)
                .map(Stop::triangles)
                .collect(),
            Self::Ratios(ratios) => descending(ratios).into_iter().map(Stop::ratio).collect(),
            Self::Triangles(counts) => {
                let mut counts = counts.clone();
                counts.sort_unstable_by(|a, b| b.cmp(a));
                let stop = |&n: &usize| Stop::triangles(share(n, triangles, around.triangles));
                counts.iter().map(stop).collect()
            }
            Self::Stops(stops) => {
                let local = |stop: &Stop| in_mesh(*stop, triangles, around);
                stops.iter().map(local).collect()
            }
            Self::Errors(errors) => descending(errors).into_iter().rev().map(of_error).collect(),
            Self::Pixels(pixels) => descending(pixels)
                .into_iter()
                .map(|p| of_error(screen.error_at_size(p, around.diagonal)))
                .collect(),
        }
    }

    pub(super) fn check(&self) -> Result<()> {
        match self {
            Self::Halving { .. } | Self::Triangles(_) | Self::Stops(_) => Ok(()),
            Self::Errors(errors) => {
                let mut errors = errors.iter();
                errors.try_for_each(|&e| positive("levels.errors", e))
            }
            Self::Pixels(pixels) => {
                let mut pixels = pixels.iter();
                pixels.try_for_each(|&p| positive("levels.pixels", p))
            }
            Self::Ratios(ratios) => match ratios.iter().find(|r| !(0.0..=1.0).contains(*r)) {
                None => Ok(()),
                Some(ratio) => Err(Error::BadOption {
                    option: "levels.ratios",
                    found: ratio.to_string(),
                    expected: "between 0 and 1",
                }),
            },
        }
    }

    /// Largest share of the triangles of the level before that a level may
    /// keep and still be worth having.
    pub(super) fn worthwhile(&self) -> f64 {
        match self {
            Self::Halving { .. } => 0.9,
            _ => 1.0,
        }
    }

    /// Whether a level that ended like this is one. Halving goes on as long as
    /// the mesh lets it; what is left after every collapse that seams and
    /// topology allow, whatever it cost, is not a level to look at.
    pub(super) fn accepts(&self, stopped: Stopped) -> bool {
        match self {
            Self::Halving { .. } => matches!(stopped, Stopped::Target | Stopped::ErrorBound),
            _ => true,
        }
    }
}

/// Triangles that a mesh of `triangles` out of `total` keeps of `kept`; one at
/// least.
fn share(kept: usize, triangles: usize, total: usize) -> usize {
    let share = kept as u128 * triangles as u128 / total.max(1) as u128;
    usize::try_from(share).unwrap_or(usize::MAX).max(1)
}

/// A stop for the whole scene as one for a mesh of it.
fn in_mesh(stop: Stop, triangles: usize, around: Surroundings) -> Stop {
    let relative = stop.relative_error.map(|e| e * around.diagonal);
    let error = [stop.error, relative]
        .into_iter()
        .flatten()
        .reduce(f64::min);
    Stop {
        triangles: stop
            .triangles
            .map(|n| share(n, triangles, around.triangles)),
        ratio: stop.ratio,
        error: error.map(|e| e / around.scale),
        relative_error: None,
    }
}

fn halves(triangles: usize, min: usize) -> impl Iterator<Item = usize> {
    let halves = std::iter::successors(Some(triangles / 2), |n| Some(n / 2));
    halves.take_while(move |&n| n >= min.max(1))
}

fn descending(values: &[f64]) -> Vec<f64> {
    let mut values = values.to_vec();
    values.sort_by(|a, b| b.total_cmp(a));
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    const AROUND: Surroundings = Surroundings {
        triangles: 1000,
        diagonal: 8.0,
        scale: 2.0,
    };

    fn stops(levels: &Levels) -> Vec<Stop> {
        levels.stops(100, AROUND, &Screen::default())
    }

    #[test]
    fn halving_stops_at_the_least_count_or_the_most_levels() {
        let halving = |min_triangles, max_levels| Levels::Halving {
            min_triangles,
            max_levels,
        };
        let [a, b, c] = [50, 25, 12].map(Stop::triangles);
        assert_eq!(stops(&halving(12, 9)), [a, b, c]);
        assert_eq!(stops(&halving(12, 2)), [a, b]);
        assert_eq!(stops(&halving(0, 99)).len(), 6, "50 25 12 6 3 1");
        assert_eq!(stops(&halving(51, 9)), []);
    }

    #[test]
    fn targets_go_from_fine_to_coarse_in_the_unit_of_the_mesh() {
        let [half, tenth] = [0.5, 0.1].map(Stop::ratio);
        assert_eq!(stops(&Levels::Ratios(vec![0.1, 0.5])), [half, tenth]);
        let [fifty, ten, one] = [50, 10, 1].map(Stop::triangles);
        assert_eq!(
            stops(&Levels::Triangles(vec![100, 1, 500])),
            [fifty, ten, one]
        );
        let [fine, coarse] = [0.5, 1.0].map(Stop::error);
        assert_eq!(stops(&Levels::Errors(vec![2.0, 1.0])), [fine, coarse]);
        // 8 units over 4 pixels are 2 units a pixel, 1 in the mesh.
        assert_eq!(stops(&Levels::Pixels(vec![4.0, 8.0])), [fine, coarse]);
    }

    #[test]
    fn a_stop_of_the_scene_becomes_one_of_the_mesh() {
        // 1/4 of the diagonal of 8 is 2 units, 1 in the mesh.
        let both = Stop::triangles(300).or_error(3.0).or_relative_error(0.25);
        let expected = Stop::triangles(30).or_error(1.0);
        assert_eq!(stops(&Levels::Stops(vec![both])), [expected]);
    }

    #[test]
    fn nonsense_is_refused() {
        assert!(Levels::Ratios(vec![0.5, 1.5]).check().is_err());
        assert!(Levels::Ratios(vec![f64::NAN]).check().is_err());
        assert!(Levels::Errors(vec![-1.0]).check().is_err());
        assert!(Levels::Pixels(vec![0.0]).check().is_err());
        assert!(Levels::Ratios(vec![0.0, 1.0]).check().is_ok());
    }
}
