//! As much detail as a number of triangles allows.
//!
//! The group of greatest Omega is taken apart first, until the next would cost too
//! much. No child has a greater Omega than its parent, so what is left is what a
//! higher threshold gives.

use super::super::slots::Slot;
use super::view::{Open, View};
use super::{Sight, Walk};
use crate::error::Result;
use std::cmp::Ordering;

/// A group that may be taken apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Candidate {
    omega: f64,
    /// Where it lies; of equals, the first is taken apart first.
    slot: u32,
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

impl Walk {
    pub(super) fn within(&mut self, sight: &Sight<'_>, view: &View, limit: u64) -> Result<()> {
        self.candidates.clear();
        let planes = sight.eye.all_planes();
        let mut total = self.cost(sight, sight.roots(), planes)?;
        self.add(sight, sight.roots(), planes)?;
        while let Some(next) = self.candidates.pop() {
            let group = &sight.tree.slots[next.slot as usize];
            let is_one = next.omega < self.threshold(group, view);
            let rest = total - u64::from(sight.proxy(group));
            let apart = if is_one {
                rest
            } else {
                rest + self.cost(sight, group.children(), next.open)?
            };
            let inside = next.omega == f64::INFINITY;
            if !is_one && !inside && apart > limit {
                self.list.threshold = next.omega.next_up();
                self.candidates.push(next);
                break;
            }
            if is_one {
                self.list.group(group.id, sight.proxy(group));
                continue;
            }
            total = apart;
            self.note_apart(group);
            self.add(sight, group.children(), next.open)?;
        }
        while let Some(left) = self.candidates.pop() {
            let group = &sight.tree.slots[left.slot as usize];
            self.list.group(group.id, sight.proxy(group));
        }
        self.list.within_limit = self.list.counts.triangles <= limit;
        Ok(())
    }

    /// Triangles of what is seen of `slots`, groups as one.
    fn cost(&self, sight: &Sight<'_>, slots: std::ops::Range<usize>, open: Open) -> Result<u64> {
        let triangles = |slot: &Slot| {
            if sight.eye.crossed(&slot.bounds, open).is_none() {
                return Ok(0);
            }
            if slot.count > 0 {
                return Ok(u64::from(sight.proxy(slot)));
            }
            let distance = sight.eye.distance(&slot.bounds);
            let (_, triangles) = sight.assets.level(slot.id, distance)?;
            Ok(u64::from(triangles))
        };
        sight.tree.slots[slots].iter().map(triangles).sum()
    }

    /// Draws the objects among `slots`; the groups may be taken apart.
    fn add(&mut self, sight: &Sight<'_>, slots: std::ops::Range<usize>, open: Open) -> Result<()> {
        for (slot, at) in sight.tree.slots[slots.clone()].iter().zip(slots) {
            self.list.counts.visited += 1;
            let Some(crossed) = sight.eye.crossed(&slot.bounds, open) else {
                continue;
            };
            let distance = sight.eye.distance(&slot.bounds);
            if slot.count == 0 {
                let level = sight.assets.level(slot.id, distance)?;
                self.list.object(slot.id, level);
            } else {
                self.candidates.push(Candidate {
                    omega: sight.omega(slot, distance),
                    slot: at as u32,
                    open: crossed,
                });
            }
        }
        Ok(())
    }
}
