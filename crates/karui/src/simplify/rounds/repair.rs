//! Turns back what shows its back: triangles that oppose the input's triangle
//! nearest to them, by collapses or else by [`super::mend`]. They are few, and
//! appear where the surface is thin or folded more finely than the simplified
//! one can follow.

use super::block::{Block, Rules};
use super::level::Level;
use super::partition::Cut;
use super::price::Offer;
use crate::geom::normal_times_two_areas;
use crate::spatial::{Bvh, Facings};
use glam::Vec3;
use rayon::prelude::*;

/// The input, to look back at.
#[derive(Clone, Copy)]
pub(crate) struct Guard<'a> {
    /// Index over the input.
    pub index: &'a Bvh,
    /// Which ways it faces.
    pub facings: &'a Facings,
    /// Scaled units in a model unit.
    pub scale: f32,
}

impl Guard<'_> {
    /// Whether a triangle, in scaled units, faces the other way than the
    /// input's triangle nearest to its centre.
    pub fn opposes(&self, corners: [Vec3; 3]) -> bool {
        self.opposes_from(corners.map(|p| p / self.scale), 0)
    }

    /// As [`opposes`](Self::opposes), of a triangle in model units, faster if
    /// the input's triangle at `slot` is close.
    pub fn opposes_from(&self, corners: [Vec3; 3], slot: u32) -> bool {
        let [a, b, c] = corners.map(|p| p.as_dvec3());
        let hit = self.index.closest_from((a + b + c) / 3.0, slot);
        let theirs = normal_times_two_areas(self.index.corners(hit.slot));
        normal_times_two_areas([a, b, c]).dot(theirs) < 0.0
    }

    /// The place on the input nearest to one, both in scaled units.
    pub fn nearest(&self, place: Vec3) -> Vec3 {
        let hit = self.index.closest((place / self.scale).as_dvec3());
        hit.point.as_vec3() * self.scale
    }
}

/// Passes over what is left to be repaired.
const PASSES: usize = 6;

/// Collapses an edge of every triangle that opposes the input, swaps one or
/// moves a corner, if that leaves fewer of them.
pub(crate) fn repair<'a>(level: Level<'a>, rules: Rules, guard: Guard<'_>) -> Level<'a> {
    let bad: Vec<u32> = (0..level.triangle.len() as u32)
        .into_par_iter()
        .filter(|&t| guard.opposes(level.triangle[t as usize].map(|p| level.place(p))))
        .collect();
    if bad.is_empty() {
        return level;
    }
    let mut blocks = Cut::whole(&level).into_blocks(&level, rules);
    // Uncut, there is one, whose triangles have the level's numbers.
    blocks.iter_mut().for_each(|b| b.repair(bad.clone(), guard));
    level.join(&blocks)
}

impl Block {
    pub(super) fn corners(&self, t: u32) -> [Vec3; 3] {
        self.triangle[t as usize].map(|p| self.position[p as usize])
    }

    /// Cures these triangles, and those that come to oppose the input for
    /// fewer of them to do so.
    fn repair(&mut self, mut bad: Vec<u32>, guard: Guard<'_>) {
        for _ in 0..PASSES {
            let mut next = Vec::new();
            let mut changes = false;
            for t in bad {
                if !self.is_bad(t, guard) {
                    continue;
                }
                let mut changed = self.turn_back(t, guard);
                // A log holds nothing but collapses.
                if changed.is_empty() && !self.rules.log {
                    changed = self.mend(t, guard);
                }
                changes |= !changed.is_empty();
                next.push(t);
                next.extend(changed);
            }
            if !changes {
                break;
            }
            next.sort_unstable();
            next.dedup();
            bad = next;
        }
    }

    /// Collapses an edge of triangle `t` if that leaves fewer that oppose the
    /// input; returns the triangles that have changed.
    fn turn_back(&mut self, t: u32, guard: Guard<'_>) -> Vec<u32> {
        let points = self.triangle[t as usize];
        for k in 0..3 {
            let (p, q) = (points[k], points[(k + 1) % 3]);
            for offer in self.choices(p, q) {
                if self.improves(&offer, guard) && self.accept(&offer, None).is_ok() {
                    return self.triangles_at(offer.kept).to_vec();
                }
            }
        }
        Vec::new()
    }

    /// Ways to join two points: where it costs least, and at either end.
    fn choices(&self, p: u32, q: u32) -> Vec<Offer> {
        let Some(offer) = self.offer(p.min(q), p.max(q)) else {
            return Vec::new();
        };
        let end = |kept: u32, removed: u32| Offer {
            kept,
            removed,
            place: self.position[kept as usize],
            ..offer
        };
        let mut choices = vec![offer, end(offer.kept, offer.removed)];
        // The other way round only if either end might have vanished.
        if offer.place != self.position[offer.kept as usize] {
            choices.push(end(offer.removed, offer.kept));
        }
        choices
    }

    /// Whether fewer triangles oppose the input after the collapse.
    fn improves(&self, offer: &Offer, guard: Guard<'_>) -> bool {
        let (mut before, mut after) = (0, 0);
        for (p, other) in [(offer.kept, offer.removed), (offer.removed, offer.kept)] {
            for &t in self.triangles_at(p) {
                let points = self.triangle[t as usize];
                let both = points.contains(&other);
                if both && p == offer.removed {
                    continue;
                }
                let corners = self.corners(t);
                before += usize::from(guard.opposes(corners));
                if !both {
                    let moved = |k: usize| {
                        if points[k] == p {
                            offer.place
                        } else {
                            corners[k]
                        }
                    };
                    after += usize::from(guard.opposes([moved(0), moved(1), moved(2)]));
                }
            }
        }
        after < before
    }
}
