//! Handles that have come down to a ring of three edges are cut there, and
//! both ends closed with a triangle. A ring that separates its part is none of
//! a handle: there is an arm or a neck of three sides, and it stays on.

use super::Limits;
use super::net::{Net, next};
use crate::simplify::blend::Mix;
use crate::simplify::rounds::level::Level;
use crate::simplify::rounds::paint::Blend;
use glam::Vec3;
use smallvec::SmallVec;

/// How far the ends of a handle that has been cut move apart, as a share of the
/// way to the points around.
const GAP: f32 = 0.01;

/// Three edges that close a ring, by the half-edges on its left.
#[derive(Debug, Clone, Copy)]
struct Cycle {
    price: f32,
    halves: [u32; 3],
}

impl Level<'_> {
    /// Cuts handles, the thinnest first; returns how many.
    pub(super) fn cut_handles(&mut self, net: &Net, limits: &Limits) -> usize {
        let mut cycles = self.cycles(net, limits);
        cycles.sort_unstable_by(|a, b| {
            let by_price = a.price.total_cmp(&b.price);
            by_price.then(a.halves.cmp(&b.halves))
        });
        let mut search = Search::new(net);
        let mut touched = vec![false; self.position.len()];
        let mut cut = 0;
        for cycle in cycles {
            let points = cycle.halves.map(|h| net.ends(h)[0]);
            if points.iter().any(|&p| touched[p as usize]) || search.separates(&cycle) {
                continue;
            }
            let Some(arcs) = arcs(net, &cycle) else {
                continue;
            };
            // What shares a point with it waits for the next time.
            points.iter().for_each(|&p| touched[p as usize] = true);
            search.set(&cycle, true);
            self.cut(net, &cycle, &arcs);
            cut += 1;
        }
        cut
    }

    /// Rings of three edges, each of two triangles, that no triangle fills.
    fn cycles(&self, net: &Net, limits: &Limits) -> Vec<Cycle> {
        let mut out: Vec<SmallVec<[(u32, u32); 8]>> = vec![SmallVec::new(); self.position.len()];
        for h in 0..net.mate.len() as u32 {
            if net.mate(h).is_some() {
                let [p, q] = net.ends(h);
                out[p as usize].push((q, h));
            }
        }
        let mut cycles = Vec::new();
        for a in 0..out.len() as u32 {
            if self.is_locked(a) {
                continue;
            }
            for &(b, first) in out[a as usize].iter().filter(|o| o.0 > a) {
                // Either way round it is one ring.
                for &(c, second) in out[b as usize].iter().filter(|o| o.0 > b) {
                    let back = out[c as usize].iter().find(|o| o.0 == a);
                    let Some(&(_, third)) = back.filter(|_| !net.is_side(first, c)) else {
                        continue;
                    };
                    let (area, size) = self.extent([a, b, c], limits);
                    let is_free = !self.is_locked(b) && !self.is_locked(c);
                    if is_free && limits.allow(area, size) {
                        let price = area * size * size;
                        let halves = [first, second, third];
                        cycles.push(Cycle { price, halves });
                    }
                }
            }
        }
        cycles
    }

    /// Gives what lies right of the ring points of its own and closes both
    /// sides.
    fn cut(&mut self, net: &Net, cycle: &Cycle, arcs: &[Arc; 3]) {
        let left = cycle.halves;
        let right = left.map(|h| net.mate(h).unwrap_or(h));
        let old = left.map(|h| net.ends(h)[0]);
        let wedges = |level: &Self, points: [u32; 3], of: [u32; 3]| {
            [0, 1, 2].map(|k| level.wedge_of(of[k], points[k]))
        };
        let mut copied: Vec<(u32, u32)> = Vec::new();
        let new = [0, 1, 2].map(|k| {
            let p = self.double(old[k]);
            for &h in &arcs[k] {
                let corner = (0..3).find(|&i| net.triangle[h as usize / 3][i] == old[k]);
                let Some(corner) = corner else { continue };
                let t = h as usize / 3;
                self.triangle.to_mut()[t][corner] = p;
                if !self.wedge.is_empty() {
                    let wedge = self.wedge[t][corner];
                    let known = copied.iter().find(|c| c.0 == wedge).map(|c| c.1);
                    self.wedge[t][corner] = known.unwrap_or_else(|| {
                        let copy = self.copy_wedge(wedge);
                        copied.push((wedge, copy));
                        copy
                    });
                }
            }
            p
        });
        self.part(net, old, new, arcs);
        // Left of the ring runs a, b, c; right of it the other way.
        let [a, b, c] = old;
        let cap = wedges(self, [a, c, b], [left[0] / 3, left[2] / 3, left[1] / 3]);
        self.add_triangle([a, c, b], left[0] / 3, cap);
        let cap = wedges(self, new, [right[0] / 3, right[1] / 3, right[2] / 3]);
        self.add_triangle(new, right[0] / 3, cap);
    }

    /// Moves the points of both sides apart, by next to nothing, so that what
    /// is linked by positions alone does not join them again.
    fn part(&mut self, net: &Net, old: [u32; 3], new: [u32; 3], arcs: &[Arc; 3]) {
        for k in 0..3 {
            let place = self.place(old[k]);
            let mut way = Vec3::ZERO;
            for &h in &arcs[k] {
                let far = net.ends(h)[1];
                // Those of the ring lie on neither side.
                if !old.contains(&far) {
                    way += (self.place(far) - place) * (GAP / arcs[k].len() as f32);
                }
            }
            for (p, way) in [(old[k], -way), (new[k], way)] {
                let i = p as usize;
                self.position.to_mut()[i] += way / self.scale;
                self.memory[i] = self.memory[i].moved(way);
            }
        }
    }

    /// A second point where `p` is, which shares what it stands for.
    fn double(&mut self, p: u32) -> u32 {
        let i = p as usize;
        let new = self.position.len() as u32;
        let place = self.position[i];
        self.position.to_mut().push(place);
        self.origin.push(self.origin[i]);
        self.facing[i] *= 0.5;
        self.facing.push(self.facing[i]);
        self.memory[i] = self.memory[i].halved();
        self.memory.push(self.memory[i]);
        if !self.weight.is_empty() {
            self.weight.push(self.weight[i]);
        }
        if !self.locked.is_empty() {
            self.locked.push(self.locked[i]);
        }
        new
    }

    /// A wedge that shows what this one does.
    fn copy_wedge(&mut self, wedge: u32) -> u32 {
        let copy = (self.wedges + self.copies.len()) as u32;
        let width = self.values.width;
        let values = wedge as usize * width..(wedge as usize + 1) * width;
        self.values.value.extend_from_within(values);
        let first = (wedge as usize).checked_sub(self.wedges);
        self.copies.push(first.map_or(wedge, |i| self.copies[i]));
        self.log.push(Blend {
            wedge: copy,
            mix: Mix {
                sources: [wedge; 3],
                shares: [1.0, 0.0, 0.0],
            },
        });
        copy
    }
}

/// Half-edges that leave a point of a ring, on its right.
type Arc = SmallVec<[u32; 8]>;

/// The triangles at every point of the ring that lie right of it, by the
/// half-edges from there; none if a border comes between.
fn arcs(net: &Net, cycle: &Cycle) -> Option<[Arc; 3]> {
    let arc = |into: u32, out: u32| {
        let last = net.mate(into)?;
        let mut h = next(net.mate(out)?);
        let mut arc = Arc::from_slice(&[h]);
        while h != last {
            h = next(net.mate(h)?);
            arc.push(h);
        }
        Some(arc)
    };
    let [first, second, third] = cycle.halves;
    Some([arc(third, first)?, arc(first, second)?, arc(second, third)?])
}

/// Triangles of both sides of a ring that are looked at before it is taken for
/// one that separates.
const FAR: usize = 4096;

/// Tells whether a ring separates.
struct Search<'a> {
    net: &'a Net,
    /// Half-edges that may not be crossed.
    closed: Vec<bool>,
    /// The search, and its side, that saw a triangle last.
    seen: Vec<(u32, bool)>,
    count: u32,
}

impl<'a> Search<'a> {
    fn new(net: &'a Net) -> Self {
        Self {
            net,
            closed: vec![false; net.mate.len()],
            seen: vec![(0, false); net.triangle.len()],
            count: 0,
        }
    }

    /// Closes the ring's edges, or opens them.
    fn set(&mut self, cycle: &Cycle, closed: bool) {
        for h in cycle.halves {
            self.closed[h as usize] = closed;
            if let Some(mate) = self.net.mate(h) {
                self.closed[mate as usize] = closed;
            }
        }
    }

    /// Whether no way leads from one side of the ring to the other: looks from
    /// both, a triangle at a time, until they meet or one has seen all.
    fn separates(&mut self, cycle: &Cycle) -> bool {
        let first = cycle.halves[0];
        let Some(mate) = self.net.mate(first) else {
            return true;
        };
        self.set(cycle, true);
        self.count += 1;
        let mut fronts = [first / 3, mate / 3].map(|t| vec![t]);
        for side in [false, true] {
            self.seen[fronts[usize::from(side)][0] as usize] = (self.count, side);
        }
        let mut separates = true;
        'search: for i in 0..FAR {
            for side in [false, true] {
                let front = &mut fronts[usize::from(side)];
                let Some(&t) = front.get(i) else {
                    break 'search;
                };
                for h in 3 * t..3 * t + 3 {
                    let Some(mate) = self.net.mate(h).filter(|_| !self.closed[h as usize]) else {
                        continue;
                    };
                    let seen = &mut self.seen[mate as usize / 3];
                    if *seen == (self.count, !side) {
                        separates = false;
                        break 'search;
                    }
                    if *seen != (self.count, side) {
                        *seen = (self.count, side);
                        front.push(mate / 3);
                    }
                }
            }
        }
        self.set(cycle, false);
        separates
    }
}
