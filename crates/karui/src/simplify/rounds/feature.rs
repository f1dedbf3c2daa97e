//! Edges along which the surface may be simplified but not across: borders,
//! edges of more than two triangles, seams of attributes and of materials.

use super::block::{Block, Kind, Span, others};
use super::paint::Pairs;
use super::planes::Planes;
use super::star::Star;
use smallvec::SmallVec;
use std::collections::HashMap;

/// What makes an edge a feature: 1, a border; 3 and more, so many triangles;
/// or this, a seam.
const SEAM: u32 = 0;

/// A neighbour of a point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Neighbour {
    pub point: u32,
    /// Triangles of the edge.
    triangles: u32,
    /// The point's wedge and the material range in the first of them.
    look: (u32, u32),
    /// Whether another of them looks different.
    split: bool,
}

impl Neighbour {
    fn feature(&self) -> Option<u32> {
        match self.triangles {
            2 => self.split.then_some(SEAM),
            n => Some(n),
        }
    }
}

/// The triangles of an edge and how wedges pair up across its ends.
#[derive(Debug, Default)]
pub(super) struct Edge {
    triangles: u32,
    /// Each once; empty if there are no wedges.
    pub pairs: Pairs,
    mixed: bool,
}

impl Edge {
    /// What the edge is, seen from its first (0) or second (1) end. A seam
    /// that ends at a point is a seam for the other end only.
    fn feature(&self, end: usize) -> Option<u32> {
        let wedge = |pair: &(u32, u32)| if end == 0 { pair.0 } else { pair.1 };
        match self.triangles {
            2 => {
                let split = |p: &(u32, u32)| wedge(p) != wedge(&self.pairs[0]);
                (self.mixed || self.pairs.iter().any(split)).then_some(SEAM)
            }
            n => Some(n),
        }
    }
}

/// Which end of an edge may vanish.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Ends {
    Either,
    Second,
    First,
    None,
}

impl Block {
    /// Sorts the points by how they may move, and holds lines in place, which
    /// the points of the input remember. `gaps` are those of
    /// [`link`](Self::link) if every point has one fan and there are no wedges.
    pub fn classify(&mut self, is_input: bool, gaps: Option<&Vec<u32>>) {
        let mut lines = Vec::new();
        for p in 0..self.global.len() as u32 {
            if self.kind[p as usize] == Kind::Shared {
                continue;
            }
            let is_surrounded = match gaps {
                Some(gaps) => gaps[p as usize] == 0,
                None => self.is_surrounded(p),
            };
            if is_surrounded {
                continue;
            }
            let ring = self.ring(p);
            let features: SmallVec<[(u32, u32); 4]> = ring
                .iter()
                .filter_map(|n| n.feature().map(|f| (f, n.point)))
                .collect();
            let kind = match features[..] {
                _ if self.rules.lock_borders && features.iter().any(|f| f.0 == 1) => Kind::Locked,
                [] => Kind::Interior,
                [a, b] if a.0 == b.0 && a.0 == SEAM => Kind::Seam,
                [a, b] if a.0 == b.0 => Kind::Line,
                _ => Kind::Fixed,
            };
            self.kind[p as usize] = kind.max(self.kind[p as usize]);
            let held = features.iter().filter(|f| self.holds(f.0));
            lines.extend(held.map(|f| (p, f.1)));
        }
        for (p, n) in lines {
            let line = self.line(p, n);
            self.star[p as usize] += Star::of_line(line);
            if is_input {
                let memory = &mut self.memory[p as usize];
                *memory = memory.plus(&Planes::of_line(line, 0.5));
            }
        }
    }

    /// Whether an edge of this kind is held in place by its line.
    fn holds(&self, feature: u32) -> bool {
        feature != 1 || self.rules.hold_borders
    }

    /// Neighbours of `p` along edges that are held in place.
    pub fn held(&self, p: u32) -> SmallVec<[u32; 4]> {
        let ring = self.ring(p);
        let held = |n: &&Neighbour| n.feature().is_some_and(|f| self.holds(f));
        ring.iter().filter(held).map(|n| n.point).collect()
    }

    /// Whether every edge at `p` has one triangle on either side and all look
    /// alike, which is so nearly everywhere and quickly seen.
    fn is_surrounded(&mut self, p: u32) -> bool {
        self.stamp += 1;
        let Span { start, len } = self.span[p as usize];
        let triangles = &self.list[start as usize..(start + len) as usize];
        let sides = |t: &u32| others(self.triangle[*t as usize], p);
        let mut once = true;
        for (next, _) in triangles.iter().map(sides) {
            once &= self.mark[next as usize] != self.stamp;
            self.mark[next as usize] = self.stamp;
        }
        let look = triangles.first().map(|&t| self.aspect(t, p));
        once && triangles.iter().all(|t| {
            let (_, last) = sides(t);
            self.mark[last as usize] == self.stamp
                && (self.paint.is_none() || look == Some(self.aspect(*t, p)))
        })
    }

    /// Wedge of `p` in triangle `t`, and the triangle's material range.
    pub fn aspect(&self, t: u32, p: u32) -> (u32, u32) {
        match &self.paint {
            None => (0, 0),
            Some(paint) => (self.wedge_at(t, p), paint.range[t as usize]),
        }
    }

    /// Wedge of `p` in triangle `t`; 0 if there are no wedges.
    pub fn wedge_at(&self, t: u32, p: u32) -> u32 {
        let [a, b, _] = self.triangle[t as usize];
        let corner = if a == p {
            0
        } else if b == p {
            1
        } else {
            2
        };
        let paint = self.paint.as_ref();
        paint.map_or(0, |paint| paint.wedge[t as usize][corner])
    }

    /// Neighbours of `p`.
    fn ring(&self, p: u32) -> SmallVec<[Neighbour; 12]> {
        let mut ring = SmallVec::<[Neighbour; 12]>::new();
        let mut places = self.is_hub(p).then(HashMap::new);
        for &t in self.triangles_at(p) {
            let (q, r) = others(self.triangle[t as usize], p);
            let look = self.aspect(t, p);
            for point in [q, r] {
                let known = match &mut places {
                    Some(places) => Some(*places.entry(point).or_insert(ring.len())),
                    None => ring.iter().position(|n| n.point == point),
                };
                match known.and_then(|at| ring.get_mut(at)) {
                    Some(known) => {
                        known.triangles += 1;
                        known.split |= known.look != look;
                    }
                    None => ring.push(Neighbour {
                        point,
                        triangles: 1,
                        look,
                        split: false,
                    }),
                }
            }
        }
        ring
    }

    /// Number of triangles with both points.
    pub fn shared_triangles(&self, a: u32, b: u32) -> usize {
        // Through the shorter list: the other may be a hub's.
        let len = |p: u32| self.span[p as usize].len;
        let (a, b) = if len(b) < len(a) { (b, a) } else { (a, b) };
        let has_b = |&&t: &&u32| self.triangle[t as usize].contains(&b);
        self.triangles_at(a).iter().filter(has_b).count()
    }

    fn edge(&self, a: u32, b: u32) -> Edge {
        let mut edge = Edge::default();
        let mut first = None;
        for &t in self.triangles_at(a) {
            if !self.triangle[t as usize].contains(&b) {
                continue;
            }
            edge.triangles += 1;
            let (wedge, range) = self.aspect(t, a);
            let pair = (wedge, self.wedge_at(t, b));
            if !edge.pairs.contains(&pair) {
                edge.pairs.push(pair);
            }
            edge.mixed |= *first.get_or_insert(range) != range;
        }
        edge
    }

    /// Which end of the edge from `a` to `b` may vanish.
    #[inline]
    pub fn ends(&self, a: u32, b: u32) -> Ends {
        if self.is_hub(a) || self.is_hub(b) {
            return Ends::None;
        }
        if [a, b]
            .iter()
            .all(|&p| self.kind[p as usize] == Kind::Interior)
        {
            return Ends::Either;
        }
        let edge = self.edge(a, b);
        match (self.may_vanish(a, 0, &edge), self.may_vanish(b, 1, &edge)) {
            (true, true) => Ends::Either,
            (true, false) => Ends::First,
            (false, true) => Ends::Second,
            (false, false) => Ends::None,
        }
    }

    fn may_vanish(&self, p: u32, end: usize, edge: &Edge) -> bool {
        let free = match self.kind[p as usize] {
            Kind::Interior => true,
            Kind::Line => edge.feature(end).is_some_and(|f| f != SEAM),
            Kind::Seam => edge.feature(end) == Some(SEAM),
            _ => false,
        };
        free && (self.paint.is_none() || self.wedges_match(p, end, edge))
    }

    /// Whether every wedge of `p` has exactly one partner across the edge.
    fn wedges_match(&self, p: u32, end: usize, edge: &Edge) -> bool {
        let own = |pair: &(u32, u32)| if end == 0 { pair.0 } else { pair.1 };
        let other = |pair: &(u32, u32)| if end == 0 { pair.1 } else { pair.0 };
        let single = |x: &(u32, u32)| {
            let alike = |y: &&(u32, u32)| own(y) == own(x) || other(y) == other(x);
            edge.pairs.iter().filter(alike).count() == 1
        };
        edge.pairs.iter().all(single)
            && self.triangles_at(p).iter().all(|&t| {
                let wedge = self.wedge_at(t, p);
                edge.pairs.iter().any(|pair| own(pair) == wedge)
            })
    }
}
