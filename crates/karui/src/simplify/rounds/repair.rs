//! Turns back what shows its back: triangles that oppose the input's triangle
//! nearest to them, by collapses or else by [`super::mend`]. They are few, and
//! appear where the surface is thin or folded more finely than the simplified
//! one can follow.

use super::block::{Block, DEAD, Rules, others, root_of};
use super::fan::THIN;
use super::level::Level;
use super::mend::{normal, shape};
use super::partition::Cut;
use super::price::Offer;
use crate::geom::normal_times_two_areas;
use crate::simplify::candidate::Refusal;
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
    /// Whether all triangles are checked, not just those that a collapse leaves
    /// doubtful.
    pub all: bool,
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

    /// The triangles of a level that oppose the input.
    pub fn all_against(&self, level: &Level) -> Vec<u32> {
        let all = (0..level.triangle.len() as u32).into_par_iter();
        all.filter(|&t| {
            let corners = level.triangle[t as usize].map(|p| level.place(p));
            self.finds_against(corners, level.source_of(t))
        })
        .collect()
    }

    /// The place on the input nearest to one, both in scaled units.
    pub fn nearest(&self, place: Vec3) -> Vec3 {
        let hit = self.index.closest((place / self.scale).as_dvec3());
        hit.point.as_vec3() * self.scale
    }
}

/// What opposes the input, of a block that is being repaired.
pub(super) struct Patient<'a> {
    pub guard: Guard<'a>,
    opposed: Vec<bool>,
    /// Collapses to be tried, in this order.
    cares: &'static [Care],
}

impl<'a> Patient<'a> {
    /// A block of which these triangles oppose the input.
    pub fn new(block: &Block, guard: Guard<'a>, bad: &[u32]) -> Self {
        let mut opposed = vec![false; block.triangle.len()];
        bad.iter().for_each(|&t| opposed[t as usize] = true);
        // Of many, the cure would be worse.
        let few = bad.len() * FEW <= block.alive;
        let all = [Care::Shapes(1), Care::Shapes(0), Care::Sides].as_slice();
        Self {
            guard,
            opposed,
            cares: if few { all } else { &all[..1] },
        }
    }

    /// Whether a triangle opposes the input as it is.
    pub fn opposes(&self, t: u32) -> bool {
        self.opposed[t as usize]
    }

    /// Whether a triangle of the block would, with these corners.
    pub fn would_oppose(&self, block: &Block, t: u32, corners: [Vec3; 3]) -> bool {
        let source = block.source[t as usize];
        self.guard.finds_against(corners, source)
    }

    /// Looks at triangles that have changed.
    pub fn look_again(&mut self, block: &Block, changed: &[u32]) {
        for &t in changed {
            self.opposed[t as usize] = self.would_oppose(block, t, block.corners(t));
        }
    }
}

/// What a collapse that repairs must keep.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Care {
    /// No triangle gets thin or turns far, and so many fewer oppose the input.
    Shapes(i32),
    /// Fewer oppose the input.
    Sides,
}

impl Care {
    fn least(self) -> i32 {
        match self {
            Self::Shapes(least) => least,
            Self::Sides => 1,
        }
    }
}

/// If more than one in so many triangles oppose the input, no triangles are
/// given for one to come right by a later collapse.
const FEW: usize = 100;
/// Thinner than this no triangle comes out of a repair.
const THINNEST: f32 = 1e-3;
/// Passes over what is left to be repaired.
const PASSES: usize = 8;

/// Cures these triangles, which oppose the input, and others that come to:
/// collapses an edge nearby, swaps one or moves a corner, if that leaves fewer
/// of them.
pub(crate) fn repair<'a>(
    level: Level<'a>,
    rules: Rules,
    guard: Guard<'_>,
    bad: &[u32],
) -> Level<'a> {
    if bad.is_empty() {
        return level;
    }
    let mut blocks = Cut::whole(&level).into_blocks(&level, rules);
    // Uncut, there is one, whose triangles have the level's numbers.
    blocks.iter_mut().for_each(|b| b.repair(bad, guard));
    level.join(&blocks)
}

impl Block {
    pub(super) fn corners(&self, t: u32) -> [Vec3; 3] {
        self.triangle[t as usize].map(|p| self.position[p as usize])
    }

    fn repair(&mut self, bad: &[u32], guard: Guard<'_>) {
        let mut patient = Patient::new(self, guard, bad);
        let mut bad = bad.to_vec();
        let mut stuck = Vec::new();
        for _ in 0..PASSES {
            if bad.is_empty() {
                break;
            }
            self.round += 1;
            let mut next = Vec::new();
            for t in bad {
                if self.is_gone(t) || !patient.opposes(t) {
                    continue;
                }
                let changed = self.treat(t, &patient);
                patient.look_again(self, &changed);
                if changed.is_empty() {
                    stuck.push(t);
                } else {
                    next.push(t);
                }
                for &t in &changed {
                    let points = self.triangle[t as usize];
                    for p in points {
                        self.touched[p as usize] = self.round;
                    }
                }
                next.extend(changed);
            }
            // What was in vain is tried again where something has changed.
            let (again, rest) = stuck.into_iter().partition(|&t| self.is_touched(t));
            stuck = rest;
            next.extend::<Vec<u32>>(again);
            next.sort_unstable();
            next.dedup();
            bad = next;
        }
    }

    /// Does something about a triangle; returns those that have changed.
    fn treat(&mut self, t: u32, patient: &Patient<'_>) -> Vec<u32> {
        // A log holds nothing but collapses.
        let mut changed = match self.rules.log {
            true => Vec::new(),
            false => self.mend(t, patient),
        };
        for &care in patient.cares {
            if changed.is_empty() {
                changed = self.turn_back(t, care, patient);
            }
        }
        changed
    }

    /// Whether something at one of its corners has changed in this pass.
    fn is_touched(&self, t: u32) -> bool {
        let points = self.triangle[t as usize];
        !self.is_gone(t)
            && points
                .iter()
                .any(|&p| self.touched[p as usize] == self.round)
    }

    fn is_gone(&self, t: u32) -> bool {
        self.triangle[t as usize][0] == DEAD
    }

    /// Collapses an edge at a corner of triangle `t` if that leaves fewer that
    /// oppose the input; returns the triangles that have changed.
    fn turn_back(&mut self, t: u32, care: Care, patient: &Patient<'_>) -> Vec<u32> {
        for (p, q) in self.edges_around(t) {
            for offer in self.choices(p, q) {
                if self.retract(&offer, care, patient).is_ok() {
                    return self.triangles_at(offer.kept).to_vec();
                }
            }
        }
        Vec::new()
    }

    /// The edges of a triangle, then the others at its corners.
    fn edges_around(&self, t: u32) -> Vec<(u32, u32)> {
        let points = self.triangle[t as usize];
        let [a, b, c] = points;
        let mut edges = vec![(a, b), (b, c), (c, a)];
        // No edge of a hub may collapse.
        for p in points.into_iter().filter(|&p| !self.is_hub(p)) {
            for &near in self.triangles_at(p) {
                let (q, r) = others(self.triangle[near as usize], p);
                let both = [q, r].into_iter().filter(|n| !points.contains(n));
                edges.extend(both.map(|n| (p, n)));
            }
        }
        edges.dedup();
        edges
    }

    /// Does what is offered if fewer triangles oppose the input then.
    fn retract(&mut self, offer: &Offer, care: Care, patient: &Patient<'_>) -> Result<(), Refusal> {
        self.gather(offer);
        self.check_link(offer)?;
        if !self.turns_well(offer, care, patient) || !self.gains(offer, care.least(), patient) {
            return Err(Refusal::Flips);
        }
        let repaint = self.plan(offer)?;
        let memory = self.memory_at(offer);
        let error = memory.distance();
        if error > self.rules.max_error {
            return Err(Refusal::Error);
        }
        self.error = self.error.max(error);
        self.collapse(offer, memory, &repaint);
        Ok(())
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

    /// Whether none gets thin nor turns far that faces as the input does.
    /// Leaves the new roots in the fan.
    fn turns_well(&mut self, offer: &Offer, care: Care, patient: &Patient<'_>) -> bool {
        let shapes = self.fan.sides.iter().map(|s| shape(self.corners(s.t)));
        let thinnest = match care {
            Care::Shapes(_) => shapes.fold(THIN, f32::min),
            Care::Sides => THINNEST,
        };
        let mut roots = std::mem::take(&mut self.fan.roots);
        roots.clear();
        let fits = self.fan.sides.iter().all(|&side| {
            let (old, new) = (self.corners(side.t), self.after(offer, side));
            let (before, cross) = (normal(old), normal(new));
            roots.push(root_of(cross, cross.length()));
            let least_turn = self.rules.least_turn * before.length() * cross.length();
            let turns = before.dot(cross) < least_turn;
            shape(new) > thinnest && (!turns || patient.opposes(side.t) || care == Care::Sides)
        });
        self.fan.roots = roots;
        fits
    }

    /// Whether `least` fewer triangles oppose the input after a collapse.
    fn gains(&self, offer: &Offer, least: i32, patient: &Patient<'_>) -> bool {
        let (edge, sides) = (&self.fan.edge, &self.fan.sides);
        let before = edge.iter().map(|e| e.0).chain(sides.iter().map(|s| s.t));
        let mut gain = before.filter(|&t| patient.opposes(t)).count() as i32;
        for &side in sides {
            if gain < least {
                break;
            }
            let after = self.after(offer, side);
            gain -= i32::from(patient.would_oppose(self, side.t, after));
        }
        gain >= least
    }
}
