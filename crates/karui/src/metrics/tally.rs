//! Sums over samples.

use super::surface_distance::Distance;
use glam::DVec3;

/// Sums over some samples, to be merged in a fixed order so that rounding does
/// not depend on threads.
#[derive(Clone, Copy, Default)]
pub(super) struct Tally {
    samples: u64,
    weight: f64,
    sum: f64,
    sum_of_squares: f64,
    largest_squared: f64,
    farthest: Option<(DVec3, DVec3)>,
}

impl Tally {
    /// Adds a sample at `from` whose nearest point is `to`; nothing if it has
    /// no weight.
    pub(super) fn add(&mut self, from: DVec3, to: DVec3, distance_squared: f64, weight: f64) {
        if weight <= 0.0 {
            return;
        }
        self.samples += 1;
        self.weight += weight;
        self.sum += weight * distance_squared.sqrt();
        self.sum_of_squares += weight * distance_squared;
        if self.farthest.is_none() || distance_squared > self.largest_squared {
            self.largest_squared = distance_squared;
            self.farthest = Some((from, to));
        }
    }

    /// Adds the samples of `later`; of two equally far ones the earlier stays.
    pub(super) fn merge(&mut self, later: &Self) {
        self.samples += later.samples;
        self.weight += later.weight;
        self.sum += later.sum;
        self.sum_of_squares += later.sum_of_squares;
        if self.farthest.is_none() || later.largest_squared > self.largest_squared {
            self.largest_squared = later.largest_squared;
            self.farthest = later.farthest;
        }
    }

    /// The figures; all zero without samples.
    pub(super) fn distance(&self) -> Distance {
        let mean_of = |sum: f64| {
            if self.weight > 0.0 {
                sum / self.weight
            } else {
                0.0
            }
        };
        let (from, to) = self.farthest.unwrap_or_default();
        Distance {
            max: self.largest_squared.sqrt(),
            mean: mean_of(self.sum),
            rms: mean_of(self.sum_of_squares).sqrt(),
            samples: self.samples,
            farthest: [from, to].map(|p| p.as_vec3()),
        }
    }
}
