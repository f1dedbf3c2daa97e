//! As much detail as a number of triangles allows.
//!
//! The group of greatest Omega is taken apart first, until the next would cost too
//! much; groups of one Omega are taken apart together or not at all. No child has
//! a greater Omega than its parent, so what is left is what a higher threshold
//! gives.

use super::view::{Open, View};
use super::{Sight, Walk};
use crate::error::Result;
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::ops::Range;

/// A group that may be taken apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Candidate {
    omega: f64,
    /// Where it lies; of equals, the first is taken apart first.
    slot: u32,
    /// Planes that its box crosses.
    open: Open,
}

impl Eq for Candidate {}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> Ordering {
        let by_omega = self.omega.total_cmp(&other.omega);
        by_omega.then_with(|| other.slot.cmp(&self.slot))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Groups that are still one.
#[derive(Debug, Clone, Default)]
pub(super) struct Groups {
    waiting: BinaryHeap<Candidate>,
    /// Those of one Omega that are tried.
    tried: Vec<Candidate>,
    /// Groups that would wait if that succeeds.
    later: Vec<Candidate>,
    /// Triangles of all of them.
    triangles: u64,
}

impl Groups {
    fn restart(&mut self) {
        self.waiting.clear();
        self.tried.clear();
        self.later.clear();
        self.triangles = 0;
    }

    fn take_greatest(&mut self) -> Option<f64> {
        self.tried.clear();
        self.later.clear();
        let greatest = self.waiting.peek()?.omega;
        while let Some(next) = self.waiting.peek().filter(|c| c.omega == greatest) {
            self.tried.push(*next);
            self.waiting.pop();
        }
        Some(greatest)
    }
}

impl Walk {
    pub(super) fn within(&mut self, sight: &Sight<'_>, view: &View, limit: u64) -> Result<()> {
        self.groups.restart();
        self.add(sight, sight.roots(), sight.eye.all_planes(), f64::NAN)?;
        self.groups.waiting.extend(self.groups.later.drain(..));
        while let Some(omega) = self.groups.take_greatest() {
            let (before, items) = (self.list.counts, self.list.items.len());
            let (triangles, count) = (self.groups.triangles, self.groups.tried.len());
            self.try_apart(sight, view, omega)?;
            let total = self.list.counts.triangles + self.groups.triangles;
            if total > limit && omega < f64::INFINITY {
                self.list.items.truncate(items);
                self.list.counts = before;
                self.list.threshold = omega.next_up().max(view.threshold);
                self.groups.triangles = triangles;
                self.groups.tried.truncate(count);
                self.groups.waiting.extend(&self.groups.tried);
                break;
            }
            self.groups.waiting.extend(self.groups.later.drain(..));
            for i in 0..self.groups.tried.len() {
                let group = &sight.tree.slots[self.groups.tried[i].slot as usize];
                if omega >= self.threshold(group, view) {
                    self.note_apart(group);
                }
            }
        }
        while let Some(left) = self.groups.waiting.pop() {
            let group = &sight.tree.slots[left.slot as usize];
            self.list.group(group.id, sight.proxy(group));
        }
        self.list.within_limit = self.list.counts.triangles <= limit;
        Ok(())
    }

    /// Takes apart what is tried, as far as the threshold asks for it.
    fn try_apart(&mut self, sight: &Sight<'_>, view: &View, omega: f64) -> Result<()> {
        let mut next = 0;
        while let Some(&candidate) = self.groups.tried.get(next) {
            next += 1;
            let group = &sight.tree.slots[candidate.slot as usize];
            self.groups.triangles -= u64::from(sight.proxy(group));
            if omega < self.threshold(group, view) {
                self.list.group(group.id, sight.proxy(group));
            } else {
                self.add(sight, group.children(), candidate.open, omega)?;
            }
        }
        Ok(())
    }

    /// Draws the objects among `slots`; the groups may be taken apart, those of
    /// `omega` at once.
    fn add(
        &mut self,
        sight: &Sight<'_>,
        slots: Range<usize>,
        open: Open,
        omega: f64,
    ) -> Result<()> {
        for (slot, at) in sight.tree.slots[slots.clone()].iter().zip(slots) {
            self.list.counts.visited += 1;
            let Some(crossed) = sight.eye.crossed(&slot.bounds, open) else {
                continue;
            };
            let distance = sight.eye.distance(&slot.bounds);
            if slot.count == 0 {
                let level = sight.assets.level(slot.id, distance)?;
                self.list.object(slot.id, level);
                continue;
            }
            self.groups.triangles += u64::from(sight.proxy(slot));
            let candidate = Candidate {
                omega: sight.omega(slot, distance),
                slot: at as u32,
                open: crossed,
            };
            if candidate.omega == omega {
                self.groups.tried.push(candidate);
            } else {
                self.groups.later.push(candidate);
            }
        }
        Ok(())
    }
}
