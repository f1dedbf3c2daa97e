//! The exact driver: always the cheapest collapse next, its neighbourhood
//! priced anew after each.

use super::candidate::{Candidate, Refusal};
use super::guard::Guard;
use super::options::{Blocked, Stopped};
use super::pairs::Pairs;
use super::refused::Refused;
use super::rounds::{Collapse, Place};
use super::state::State;
use crate::error::Result;
use crate::progress::step;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Triangles at a point from which on its edges are not all priced anew when
/// one of them changes: at the middle of a fan that would be cubic in the
/// number of its triangles. Prices are checked again before they are paid.
const HUB: usize = 256;

/// When the driver stops.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Target {
    /// At most this many triangles.
    pub triangles: usize,
    /// Largest error, model units.
    pub error: f64,
}

/// How far the driver came.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reached {
    pub error: f64,
    pub stopped: Stopped,
    pub collapses: usize,
    pub blocked: Blocked,
}

/// A price in the queue; it holds while neither point has changed since.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Entry {
    cost: f64,
    points: [u32; 2],
    versions: [u32; 2],
}

impl Eq for Entry {}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Entry {
    /// Greatest is what comes first: least cost, then least points.
    fn cmp(&self, other: &Self) -> Ordering {
        let by_cost = other.cost.total_cmp(&self.cost);
        by_cost.then_with(|| other.points.cmp(&self.points))
    }
}

/// The queue over a surface; it may be driven to one target after another.
pub(crate) struct Driver<'a, 'g> {
    state: State<'a>,
    guard: &'g Guard<'g>,
    target: Target,
    queue: BinaryHeap<Entry>,
    version: Vec<u32>,
    pairs: Option<Pairs>,
    ring: Vec<u32>,
    second_ring: Vec<u32>,
    refused: Refused,
    error: f64,
    collapses: usize,
    /// The collapses, if asked for.
    record: Vec<Collapse>,
}

impl<'a, 'g> Driver<'a, 'g> {
    /// A driver that has not done anything yet.
    pub fn new(state: State<'a>, guard: &'g Guard<'g>) -> Self {
        let pairs = state.options.pairs.map(|t| Pairs::near(&state.surface, t));
        Self {
            version: vec![0; state.surface.position.len()],
            queue: BinaryHeap::new(),
            ring: Vec::new(),
            second_ring: Vec::new(),
            refused: Refused::default(),
            error: 0.0,
            collapses: 0,
            record: Vec::new(),
            pairs,
            target: Target {
                triangles: usize::MAX,
                error: f64::INFINITY,
            },
            guard,
            state,
        }
    }

    /// The surface as it is now.
    pub fn state(&self) -> &State<'a> {
        &self.state
    }

    /// Collapses until the target is met or nothing more can be.
    ///
    /// # Errors
    /// [`Error::Cancelled`](crate::Error::Cancelled).
    pub fn advance(&mut self, target: Target) -> Result<Reached> {
        self.target = target;
        let stopped = self.collapse_all()?;
        Ok(Reached {
            error: self.error,
            stopped,
            collapses: self.collapses,
            blocked: self.refused.blocked,
        })
    }

    fn collapse_all(&mut self) -> Result<Stopped> {
        let start = self.state.surface.alive;
        loop {
            // What was refused once may be allowed after its neighbourhood
            // has changed, so a queue that ran dry is filled again.
            if self.queue.is_empty() {
                self.fill()?;
            }
            let before = self.collapses;
            if self.drain(start)? {
                return Ok(Stopped::Target);
            }
            if self.collapses == before {
                return Ok(self.reason());
            }
        }
    }

    fn reason(&self) -> Stopped {
        let b = self.refused.blocked;
        if self.refused.by_error >= b.flips.max(b.locked).max(b.seams).max(b.topology).max(1) {
            return Stopped::ErrorBound;
        }
        b.reason()
    }

    fn fill(&mut self) -> Result<()> {
        self.refused = Refused::default();
        let points = self.version.len() as u32;
        for p in 0..points {
            if p % 8192 == 0 {
                step(
                    self.state.options.progress,
                    "price",
                    p as f32 / points as f32,
                )?;
            }
            self.around(p, false);
            for i in 0..self.ring.len() {
                if self.ring[i] > p {
                    self.push(p, self.ring[i]);
                }
            }
        }
        Ok(())
    }

    /// Puts the neighbours of `p` (and, in `second`, of a neighbour) and its
    /// pairs into the scratch ring.
    fn around(&mut self, p: u32, second: bool) {
        let ring = if second {
            &mut self.second_ring
        } else {
            &mut self.ring
        };
        self.state
            .surface
            .neighbours(p, &mut self.state.marks, ring);
        if let Some(pairs) = &self.pairs {
            ring.extend(pairs.of(p).iter().filter(|&&q| !self.state.marks.has(q)));
        }
    }

    fn push(&mut self, p: u32, q: u32) {
        let points = [p.min(q), p.max(q)];
        match self.state.candidate(points[0], points[1]) {
            Ok(candidate) => self.queue.push(Entry {
                cost: candidate.cost,
                points,
                versions: points.map(|p| self.version[p as usize]),
            }),
            Err(refusal) => self.refused.count(refusal),
        }
    }

    /// Works the queue off; whether the target was reached.
    fn drain(&mut self, start: usize) -> Result<bool> {
        let progress = self.state.options.progress;
        let span = start.saturating_sub(self.target.triangles).max(1);
        let mut looked_at = 0usize;
        while self.state.surface.alive > self.target.triangles {
            let Some(entry) = self.queue.pop() else {
                return Ok(false);
            };
            looked_at += 1;
            if looked_at.is_multiple_of(1024) {
                let done = start - self.state.surface.alive;
                step(progress, "collapse", done as f32 / span as f32)?;
            }
            if entry.points.map(|p| self.version[p as usize]) == entry.versions
                && let Err(refusal) = self.attempt(&entry)
            {
                self.refused.count(refusal);
            }
        }
        Ok(true)
    }

    fn attempt(&mut self, entry: &Entry) -> Result<(), Refusal> {
        let [a, b] = entry.points;
        let candidate = self.state.candidate(a, b)?;
        self.try_candidate(&candidate)
    }

    fn try_candidate(&mut self, c: &Candidate) -> Result<(), Refusal> {
        let planes = self.state.plane_error(c);
        if planes > self.target.error {
            return Err(Refusal::Error);
        }
        let mixes = self.state.mixes(c);
        self.state.check(c, &mixes)?;
        let error = self.guard.check(&self.state, c)?.max(planes);
        if error > self.target.error {
            return Err(Refusal::Error);
        }
        self.error = self.error.max(error);
        self.collapses += 1;
        if self.state.options.log {
            self.record.push(self.noted(c));
        }
        self.around(c.removed, true);
        let former = std::mem::take(&mut self.second_ring);
        self.state.collapse(c, &mixes);
        self.after(c, former);
        Ok(())
    }

    fn noted(&self, c: &Candidate) -> Collapse {
        let is_at = |p: u32| c.place == self.state.surface.position[p as usize];
        Collapse {
            kept: c.kept,
            removed: c.removed,
            place: match (is_at(c.kept), is_at(c.removed)) {
                (true, _) => Place::Kept,
                (_, true) => Place::Removed,
                _ => Place::New(c.place.as_vec3()),
            },
        }
    }

    /// What collapsed, if it was asked for.
    pub fn into_record(self) -> Vec<Collapse> {
        self.record
    }

    /// Prices the edges whose cost the collapse has changed; `former` are the
    /// neighbours of the point that vanished.
    fn after(&mut self, c: &Candidate, mut former: Vec<u32>) {
        self.version[c.removed as usize] += 1;
        if let Some(pairs) = &mut self.pairs {
            pairs.merge(c.kept, c.removed);
        }
        self.around(c.kept, false);
        if self.pairs.is_some() {
            self.classify_ring(c.kept);
            self.around(c.kept, false);
        }
        if self.is_hub(c.kept) {
            former.retain(|&p| p != c.kept && self.state.marks.has(p));
            self.ring = former;
        } else {
            self.version[c.kept as usize] += 1;
        }
        self.state.renew_star(c.kept);
        for i in 0..self.ring.len() {
            let p = self.ring[i];
            self.version[p as usize] += u32::from(!self.is_hub(p));
            self.state.renew_star(p);
        }
        for i in 0..self.ring.len() {
            let p = self.ring[i];
            self.push(c.kept, p);
            if self.is_hub(p) {
                continue;
            }
            self.around(p, true);
            for k in 0..self.second_ring.len() {
                let q = self.second_ring[k];
                if q != c.kept && (q > p || !self.ring.contains(&q)) {
                    self.push(p, q);
                }
            }
        }
    }

    fn is_hub(&self, p: u32) -> bool {
        self.state.surface.corners(p).nth(HUB).is_some()
    }

    fn classify_ring(&mut self, kept: u32) {
        let ring = std::mem::take(&mut self.ring);
        for &p in ring.iter().chain([&kept]) {
            self.state.classify(p, &mut self.second_ring);
        }
        self.ring = ring;
    }
}

#[cfg(test)]
mod tests {
    use crate::mesh::TriMesh;
    use crate::simplify::{SimplifyOptions, Stop, simplify};
    use glam::Vec3;

    /// Two fans of `n` triangles over a circle. Was cubic in `n`.
    fn double_cone(n: u32) -> TriMesh {
        let rim = |i: u32| {
            let (y, x) = (i as f32 / n as f32 * std::f32::consts::TAU).sin_cos();
            Vec3::new(x, y, 0.0)
        };
        let positions = [Vec3::Z, Vec3::NEG_Z].into_iter().chain((0..n).map(rim));
        let fans = |i| {
            let (p, q) = (2 + i, 2 + (i + 1) % n);
            [[0, p, q], [1, q, p]]
        };
        TriMesh::new(positions.collect(), (0..n).flat_map(fans).collect())
    }

    #[test]
    fn hubs_of_large_fans_are_kept() {
        let options = SimplifyOptions {
            stop: Stop::ratio(0.1),
            ..SimplifyOptions::default()
        };
        let coarse = simplify(&double_cone(1000), &options).unwrap();
        assert!(coarse.mesh.triangles.len() <= 200);
        assert!(coarse.error < 0.01, "error {}", coarse.error);
        coarse.mesh.validate().unwrap();
    }
}
