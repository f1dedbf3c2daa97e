//! The points along every edge, step by step.

use super::rings::Rings;
use super::{Patches, after};
use rayon::prelude::*;

/// Points along an edge after all steps before `step`: those steps take 2^k + 1 each.
pub(super) fn offset(step: u32) -> usize {
    (1usize << step) - 1 + step as usize
}

impl Patches {
    /// Values along every edge from its first end to its second, ends included, step after
    /// step.
    pub(super) fn fill_curves<const N: usize>(&self, rings: &Rings<N>, to: &mut Vec<[f32; N]>) {
        let size = self.curve_size();
        to.resize(size * self.start.edges.len(), [0.0; N]);
        let edges = to.par_chunks_exact_mut(size).with_min_len(16).enumerate();
        edges.for_each_init(Strip::default, |strip, (e, curve)| {
            self.fill_curve(e as u32, rings, strip, curve);
        });
    }

    /// Values kept of one edge.
    pub(super) fn curve_size(&self) -> usize {
        offset(self.layout.depth + 1)
    }

    fn fill_curve<const N: usize>(
        &self,
        e: u32,
        rings: &Rings<N>,
        strip: &mut Strip<N>,
        curve: &mut [[f32; N]],
    ) {
        let ends = self.start.edge(e);
        let sharpness = self.start.edge_sharpness(e);
        let has_sides = self.start.edge_corners(e).len() == 2;
        for step in 0..=self.layout.depth {
            let n = 1usize << step;
            let (before, rest) = curve.split_at_mut(offset(step));
            let row = &mut rest[..=n];
            row[0] = rings.vertex(ends[0], step);
            row[n] = rings.vertex(ends[1], step);
            if step > 0 {
                let before = &before[offset(step - 1)..];
                strip.refine_row(before, row, after(sharpness, step - 1));
            }
            // Of a curve that is sharp for ever nobody asks what is beside it.
            if has_sides && sharpness < super::INFINITELY_SHARP && step < self.layout.depth {
                let above = step.checked_sub(1).map(|s| &before[offset(s)..]);
                self.fill_sides(e, rings, above, strip, step);
            }
        }
    }

    /// The rows on both sides of an edge.
    fn fill_sides<const N: usize>(
        &self,
        e: u32,
        rings: &Rings<N>,
        curve: Option<&[[f32; N]]>,
        strip: &mut Strip<N>,
        step: u32,
    ) {
        let n = 1usize << step;
        let ends = self.start.edge(e);
        let places = self.places[e as usize].map(|place| place as usize);
        // From the first end the left side is the next edge of the ring, from the second
        // the one before.
        let beside = |end: usize, next: bool| {
            let ring = self.start.vertex_edges(ends[end]).len();
            let place = if next {
                places[end] + 1
            } else {
                places[end] + ring - 1
            };
            rings.neighbour(self, ends[end], place, step)
        };
        for (side, left) in [(0, true), (1, false)] {
            let [before, after] = &mut strip.sides[side];
            std::mem::swap(before, after);
            after.clear();
            after.resize(n + 1, [0.0; N]);
            if let Some(curve) = curve {
                refine_side(curve, before, after);
            }
            after[0] = beside(0, left);
            after[n] = beside(1, !left);
        }
    }
}

/// The rows beside a curve, before and after the last step.
struct Strip<const N: usize> {
    sides: [[Vec<[f32; N]>; 2]; 2],
}

impl<const N: usize> Default for Strip<N> {
    fn default() -> Self {
        Self {
            sides: Default::default(),
        }
    }
}

impl<const N: usize> Strip<N> {
    /// New points of a curve between its ends.
    fn refine_row(&self, curve: &[[f32; N]], to: &mut [[f32; N]], sharpness: f32) {
        let n = to.len() / 2;
        let [left, right] = &self.sides.each_ref().map(|side| &side[1]);
        let share = sharpness.min(1.0);
        for c in 0..N {
            let at = |t: usize| curve[t][c];
            for t in 0..n {
                let sharp = 0.5 * (at(t) + at(t + 1));
                to[2 * t + 1][c] = if share >= 1.0 {
                    sharp
                } else {
                    let outer = left[t][c] + left[t + 1][c] + right[t][c] + right[t + 1][c];
                    let smooth = 0.0625 * outer + 0.375 * (at(t) + at(t + 1));
                    share * sharp + (1.0 - share) * smooth
                };
            }
            for t in 1..n {
                let sharp = 0.125 * (at(t - 1) + at(t + 1)) + 0.75 * at(t);
                to[2 * t][c] = if share >= 1.0 {
                    sharp
                } else {
                    let beside = |row: &[[f32; N]]| row[t - 1][c] + 6.0 * row[t][c] + row[t + 1][c];
                    let own = at(t - 1) + 6.0 * at(t) + at(t + 1);
                    let smooth = (beside(left) + beside(right) + 6.0 * own) / 64.0;
                    share * sharp + (1.0 - share) * smooth
                };
            }
        }
    }
}

/// New points of a row beside a curve: face points, and points of the edges that cross.
fn refine_side<const N: usize>(curve: &[[f32; N]], side: &[[f32; N]], to: &mut [[f32; N]]) {
    let n = to.len() / 2;
    for c in 0..N {
        let both = |t: usize| curve[t][c] + side[t][c];
        for t in 0..n {
            to[2 * t + 1][c] = 0.25 * (both(t) + both(t + 1));
        }
        for t in 1..n {
            to[2 * t][c] = 0.0625 * (both(t - 1) + both(t + 1)) + 0.375 * both(t);
        }
    }
}
