//! Search of the grid that meets a target.

use super::Trial;
use super::grid::{COARSEST, FINEST, Grid, differ, key};
use crate::mesh::TriMesh;
use crate::simplify::Stopped;
use rayon::prelude::*;

/// Triangles that the first guess is made with, at least, and the least share.
const SAMPLE: (usize, usize) = (4096, 48);
/// Triangles in a row of the sample.
const RUN: usize = 32;
/// Triangles a task counts.
const CHUNK: usize = 1 << 14;
/// Passes over the sample, and over all triangles.
const PASSES: [usize; 2] = [16, 8];
/// Share of the target that need not be used.
const NEAR: f64 = 0.005;
/// Share by which the sample's count may be off.
const ROUGH: f64 = 0.03;

/// Grids tried because duplicates have left too few triangles.
const TRIES: usize = 4;
/// Share of the target that is worth no other try.
const ENOUGH: f64 = 0.98;

/// What the finest grid found makes of the mesh that leaves at most `target`
/// triangles; the coarsest that leaves any if none does.
pub(super) fn by_target(
    mesh: &TriMesh,
    grid: &Grid,
    target: usize,
    trial: impl Fn(u32) -> Trial,
) -> (Trial, Stopped) {
    let mut best = trial(by_count(mesh, grid, target));
    if best.kept.len() > target {
        return (best, Stopped::Exhausted);
    }
    let [mut good, mut bad] = [target as f64, f64::INFINITY];
    for _ in 1..TRIES {
        let left = best.kept.len().max(1) as f64;
        if left >= ENOUGH * target as f64 - 1.0 {
            break;
        }
        let aim = (good * target as f64 / left).min((good * bad).sqrt());
        let next = trial(by_count(mesh, grid, aim as usize));
        if next.kept.len() > target {
            bad = aim;
        } else if next.kept.len() > best.kept.len() {
            (best, good) = (next, aim);
        } else {
            break;
        }
    }
    (best, Stopped::Target)
}

/// The finest grid found on which at most `target` triangles keep three
/// corners, duplicates included; the coarsest that leaves any if none does.
fn by_count(mesh: &TriMesh, grid: &Grid, target: usize) -> u32 {
    let total = mesh.triangles.len();
    let sample = sample(mesh, grid);
    let share = sample.len() as f64 / total as f64;
    let on_sample = |scale| {
        let alive = sample.iter().filter(|t| differ(&t.map(|p| key(p, scale))));
        alive.count()
    };
    let mut rough = Bracket::new(target as f64 * share, sample.len());
    rough.above = ROUGH;
    rough.narrow(COARSEST * 32, PASSES[0], on_sample);
    let mut keys = Vec::new();
    let mut bracket = Bracket::new(target as f64, total);
    bracket.narrow(rough.last, PASSES[1], |scale| {
        grid.keys(scale, &mut keys);
        count(mesh, &keys)
    });
    bracket.best()
}

/// Evenly spread runs of triangles.
fn sample(mesh: &TriMesh, grid: &Grid) -> Vec<[[u32; 3]; 3]> {
    let all = mesh.triangles.len();
    let stride = (all * RUN).div_ceil(SAMPLE.0.max(all / SAMPLE.1)).max(RUN);
    let runs = mesh.triangles.chunks(stride);
    runs.flat_map(|run| &run[..run.len().min(RUN)])
        .map(|&t| grid.triangle(t))
        .collect()
}

/// Triangles whose corners lie in three cells.
fn count(mesh: &TriMesh, keys: &[u64]) -> usize {
    let alive = |t: &&[u32; 3]| differ(&t.map(|v| keys[v as usize]));
    let chunks = mesh.triangles.par_chunks(CHUNK);
    chunks.map(|chunk| chunk.iter().filter(alive).count()).sum()
}

/// Scales on both sides of a target, with their counts.
struct Bracket {
    target: f64,
    /// Share of the target above it that is near enough.
    above: f64,
    /// The scale tried last.
    last: u32,
    /// Coarser: not above the target.
    low: (u32, usize),
    /// Finer: above the target.
    high: (u32, usize),
}

impl Bracket {
    fn new(target: f64, total: usize) -> Self {
        Self {
            target,
            above: 0.0,
            last: COARSEST,
            low: (COARSEST, 0),
            high: (FINEST, total),
        }
    }

    /// Interpolation search, from `guess`.
    fn narrow(&mut self, guess: u32, passes: usize, mut count: impl FnMut(u32) -> usize) {
        let mut next = f64::from(guess);
        for pass in 0..passes {
            let (low, high) = (self.low.0, self.high.0);
            if high - low < 2 {
                return;
            }
            let scale = (next.round() as u32).clamp(low + 1, high - 1);
            let found = (scale, count(scale));
            self.last = scale;
            if found.1 as f64 > self.target {
                self.high = found;
            } else {
                self.low = found;
            }
            let off = found.1 as f64 - self.target;
            let below = self.target * NEAR.max(self.above) + 1.0;
            if (-below..=self.target * self.above).contains(&off) && found.1 > 0 {
                return;
            }
            next = self.next(found, pass);
        }
    }

    /// Counts grow about with the square of the scale, between known ones with
    /// the power that joins them; every third step halves what is left.
    fn next(&self, found: (u32, usize), pass: usize) -> f64 {
        let [low, high] = [self.low.0, self.high.0].map(f64::from);
        let aim = (self.target * (1.0 - 0.5 * NEAR)).max(0.5);
        if pass % 3 == 2 {
            return (low * high).sqrt();
        }
        if self.low.1 == 0 || self.high.0 == FINEST {
            let power = (aim / found.1.max(1) as f64).sqrt().clamp(0.1, 10.0);
            return f64::from(found.0) * power;
        }
        let [a, b] = [self.low.1, self.high.1].map(|n| (n as f64).ln());
        let t = ((aim.ln() - a) / (b - a)).clamp(0.02, 0.98);
        low * (high / low).powf(t)
    }

    /// The finest grid not above the target, if it leaves anything; else the
    /// coarsest that does.
    fn best(&self) -> u32 {
        if self.low.1 > 0 {
            self.low.0
        } else {
            self.high.0
        }
    }
}

/// Steps of the search by error.
const STEPS: usize = 7;

/// Of the grids finer than that of `coarse`, the coarsest met whose error is
/// at most `error`.
pub(super) fn by_error(mut coarse: Trial, error: f64, trial: impl Fn(u32) -> Trial) -> Trial {
    let mut fine: Option<Trial> = None;
    for _ in 0..STEPS {
        let scale = match &fine {
            None => finer(&coarse, error),
            Some(fine) => between(&coarse, fine),
        };
        let next = trial(scale);
        if next.placed.error <= error {
            fine = Some(next);
        } else {
            coarse = next;
        }
    }
    fine.unwrap_or_else(|| trial(FINEST))
}

fn finer(coarse: &Trial, error: f64) -> u32 {
    let factor = (coarse.placed.error / error).clamp(1.5, 64.0);
    ((f64::from(coarse.scale) * factor) as u32).min(FINEST)
}

fn between(coarse: &Trial, fine: &Trial) -> u32 {
    (f64::from(coarse.scale) * f64::from(fine.scale)).sqrt() as u32
}
