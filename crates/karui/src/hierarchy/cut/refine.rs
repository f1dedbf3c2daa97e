//! The front moves to where the criteria want it.

use super::{Budget, Change, Cut, Done};
use crate::error::Result;
use crate::hierarchy::criteria::{Criteria, Keep};
use crate::hierarchy::node::Node;
use crate::hierarchy::surface::NONE;
use crate::hierarchy::{Vantage, Way};
use std::time::Instant;

/// Changed triangles closer together than this are uploaded in one go.
const GAP: u32 = 32;

/// Frames after which lights that have not moved are taken to stand still.
const AT_REST: u32 = 2;

/// Frames' ways after which all are asked again.
const FAR: f64 = 1e9;

impl Cut<'_> {
    /// Makes this the cut that `criteria` ask for: every node is split that they
    /// want kept, with all that wait for it, and no other. Visits the front only.
    ///
    /// Unless time is short or the criteria ask for hysteresis, the result does not
    /// depend on what the cut was before.
    ///
    /// # Errors
    /// [`Error::BadOption`](crate::Error::BadOption) if the criteria are out of
    /// range; the cut is then what it was.
    pub fn refine<C: Criteria>(&mut self, criteria: &C, budget: Budget) -> Result<Change> {
        self.refine_but(criteria, budget, |_| false)
    }

    /// The same, but that of what is not to be kept that stays to which `stays` says
    /// yes; it is asked about it again next time. Not under a budget.
    pub(super) fn refine_but<C: Criteria>(
        &mut self,
        criteria: &C,
        budget: Budget,
        stays: impl FnMut(u32) -> bool,
    ) -> Result<Change> {
        let started = Instant::now();
        let frame = criteria.frame(self.hierarchy.bounds)?;
        self.fresh.clear();
        self.done = Done::default();
        self.travel(frame.vantage());
        let mut change = match budget {
            Budget::UNLIMITED => self.refine_freely(&frame, stays),
            budget => self.refine_within(&frame, budget, started),
        };
        change.ranges = self.triangles.take_changed(GAP);
        change.triangles = self.triangles.indices.len();
        change.splits = self.done.splits;
        change.collapses = self.done.collapses;
        change.time = started.elapsed();
        Ok(change)
    }

    /// Reads off how far eye and lights have gone since the last frame.
    fn travel(&mut self, vantage: Option<Vantage>) {
        let way = match (&vantage, &self.vantage) {
            (Some(now), Some(before)) => now.way_from(before),
            _ => Way {
                eye: f64::INFINITY,
                lights: f64::INFINITY,
            },
        };
        self.vantage = vantage;
        self.rest = if way.lights > 0.0 {
            0
        } else {
            self.rest.saturating_add(1)
        };
        let was_wrong = self.still && way.lights > 0.0;
        self.still = self.rest >= AT_REST;
        let way = way.eye + way.lights;
        self.odometer += way;
        // Also before the sum has lost what a short way adds to it.
        let lost = !self.odometer.is_finite() || (way > 0.0 && self.odometer > FAR * way);
        if lost || was_wrong {
            self.odometer = 0.0;
            self.splittable.ask_all();
            self.collapsible.ask_all();
        }
    }

    fn refine_freely(&mut self, frame: &impl Keep, stays: impl FnMut(u32) -> bool) -> Change {
        let mut change = Change {
            complete: true,
            ..Change::default()
        };
        self.split_kept(frame, &mut change);
        self.collapse_coarse(frame, stays, &mut change);
        change
    }

    /// Splits all that is to be kept. As what is kept within bounds is kept within
    /// any around them, below a node of the front that is not there is none.
    fn split_kept(&mut self, frame: &impl Keep, change: &mut Change) {
        let still = self.still;
        let answers = self
            .splittable
            .ask(self.odometer, |b| frame.keep_for(b, still));
        change.tests += answers.len();
        for (node, (keep, way)) in answers {
            self.split_if(node, keep, way);
            while let Some(node) = self.fresh.pop() {
                if !self.is_active(node) {
                    change.tests += 1;
                    let (keep, way) = frame.keep_for(&self.node(node).cover.bounds(), still);
                    self.split_if(node, keep, way);
                }
            }
        }
    }

    fn split_if(&mut self, node: u32, keep: bool, way: f64) {
        let at = self.place[node as usize];
        if self.is_active(node) || at == NONE {
            return;
        }
        if keep {
            self.split(node);
        } else {
            self.splittable.put_off(at, self.odometer + way);
        }
    }

    /// Collapses all that is not to be kept and that nothing kept waits for.
    fn collapse_coarse(
        &mut self,
        frame: &impl Keep,
        mut stays: impl FnMut(u32) -> bool,
        change: &mut Change,
    ) {
        let still = self.still;
        let mut collapse = |cut: &mut Self, node: u32, keep: bool, way: f64| {
            // What stays for now is due again as it is.
            let stays = !keep && cut.is_collapsible(node) && stays(node);
            change.complete &= !stays;
            if !stays {
                cut.collapse_unless(node, keep, way);
            }
        };
        let answers = self
            .collapsible
            .ask(self.odometer, |b| frame.stay_for(b, still));
        let mut tests = answers.len();
        for (node, (keep, way)) in answers {
            collapse(self, node, keep, way);
            while let Some(node) = self.fresh.pop() {
                if self.is_collapsible(node) {
                    tests += 1;
                    let (keep, way) = frame.stay_for(&self.node(node).cover.bounds(), still);
                    collapse(self, node, keep, way);
                }
            }
        }
        change.tests += tests;
    }

    fn collapse_unless(&mut self, node: u32, keep: bool, way: f64) {
        if !self.is_collapsible(node) {
            return;
        }
        if !keep {
            self.collapse(node);
        }
        let at = self.place[node as usize];
        let due = self.odometer + way;
        match keep {
            true => self.collapsible.put_off(at, due),
            false => self.splittable.put_off(at, due),
        }
    }

    #[inline]
    pub(super) fn node(&self, node: u32) -> &Node {
        &self.hierarchy.nodes[node as usize]
    }
}
