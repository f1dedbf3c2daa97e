//! What it costs to let a vertex go, and into which neighbour.
//!
//! R. Pajarola, C. DeCoro: Efficient Implementation of Real-Time View-Dependent
//! Multiresolution Meshing, 2004; D. Dong et al.: one-sided quadrics, 2000; after
//! Miyamura and Imai: the one-sided quadric error times the flatness of what
//! changes.

use super::lanes::{Lanes, is_hidden};
use super::points::Points;
use super::queue::Price;
use crate::hierarchy::surface::{MOST_FACES, Moves, NONE, REVERSED, next, prev};
use glam::DVec3;

/// A half-edge collapse and its price.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Offer {
    pub half_edge: u32,
    pub price: Price,
}

/// The neighbourhood of a vertex; kept for the next, to save its memory.
#[derive(Debug, Default)]
pub(super) struct Ring {
    corners: Vec<u32>,
    closed: bool,
    /// The points around, one more than corners; the last is the first again
    /// if they go all around.
    points: Vec<u32>,
    /// Where they are, seen from the vertex.
    places: Vec<DVec3>,
    lanes: Lanes,
    offers: Vec<(Offer, usize)>,
    /// Stamps of the points around; for the link condition.
    seen: Vec<u32>,
    stamp: u32,
    other: Vec<u32>,
}

/// Whether seams let a vertex go, and along which edges.
enum Seams {
    /// There are none at it.
    None,
    /// One runs through it.
    Through,
    /// It is an end or a meeting of some.
    Held,
}

impl Ring {
    pub fn new(points: usize) -> Self {
        Self {
            seen: vec![0; points],
            ..Self::default()
        }
    }

    /// The cheapest collapse of `point`, allowed by its topology or not: few are
    /// not, so that is looked at when its turn has come.
    pub fn offer(&mut self, all: &Points, point: u32) -> Option<Offer> {
        self.price_all(all, point)?;
        self.take_turnable()
    }

    /// The cheapest collapse of `point` that is allowed.
    pub fn allowed_offer(&mut self, all: &Points, point: u32) -> Option<Offer> {
        self.price_all(all, point)?;
        self.mark(point);
        loop {
            let best = self.take_turnable()?;
            if self.is_allowed(all, point, best.half_edge) {
                return Some(best);
            }
        }
    }

    /// Whether a collapse that was offered is allowed.
    pub fn allows(&mut self, all: &Points, point: u32, half_edge: u32) -> bool {
        self.gather_points(all, point);
        self.mark(point);
        self.is_allowed(all, point, half_edge)
    }

    /// The points around the vertex looked at last.
    pub fn points(&self) -> &[u32] {
        &self.points
    }

    /// The same, every one once.
    pub fn neighbors(&self) -> &[u32] {
        &self.points[..self.points.len() - usize::from(self.closed)]
    }

    /// The corners at it.
    pub fn corners(&self) -> &[u32] {
        &self.corners
    }

    /// Looks at the corners and points around a vertex.
    pub fn gather_points(&mut self, all: &Points, point: u32) {
        self.closed = all.around(all.points[point as usize].corner, &mut self.corners);
        self.points.clear();
        let at = |c: u32| all.surface.start(c);
        self.points
            .extend(self.corners.iter().map(|&c| at(next(c))));
        self.points
            .extend(self.corners.last().map(|&c| at(prev(c))));
    }

    fn gather(&mut self, all: &Points, point: u32) {
        self.gather_points(all, point);
        let center = all.points[point as usize].position();
        self.places.clear();
        let seen = self
            .points
            .iter()
            .map(|&p| all.points[p as usize].position() - center);
        self.places.extend(seen);
        self.lanes.fill(&self.places, all.scale);
    }

    fn seams(&self, all: &Points, point: u32) -> Seams {
        if !all.points[point as usize].on_edge {
            return Seams::None;
        }
        let inner = &self.corners[usize::from(!self.closed)..];
        let seams = inner.iter().filter(|&&c| !all.is_inner(c)).count();
        match (self.closed, seams) {
            (_, 0) => Seams::None,
            (true, 2) => Seams::Through,
            _ => Seams::Held,
        }
    }

    /// Prices all collapses of a point; nothing if it is held.
    fn price_all(&mut self, all: &Points, point: u32) -> Option<()> {
        let of = &all.points[point as usize];
        // A face must be left to tell where the vertex was.
        let least = if of.border { 2 } else { 3 };
        if of.locked || of.corner == NONE || !(least..=MOST_FACES).contains(&of.degree) {
            return None;
        }
        self.gather(all, point);
        self.offers.clear();
        let seams = self.seams(all, point);
        if matches!(seams, Seams::Held) {
            return None;
        }
        let faces = self.corners.len();
        if !self.closed {
            self.push_offer(all, point, 0, self.corners[0]);
            if let Some(&last) = self.corners.last() {
                self.push_offer(all, point, faces, prev(last) | REVERSED);
            }
            return Some(());
        }
        for k in 0..faces {
            let half_edge = self.corners[k];
            if !of.on_edge || runs_along(all, half_edge, &seams) {
                self.push_offer(all, point, k, half_edge);
            }
        }
        Some(())
    }

    /// Prices the collapse into the `k`th point around.
    fn push_offer(&mut self, all: &Points, point: u32, k: usize, half_edge: u32) {
        let Some(flatness) = self.lanes.flatness(k, self.closed) else {
            return;
        };
        let kept = &all.points[self.points[k] as usize];
        let of = &all.points[point as usize];
        let crowd = kept.degree.saturating_sub(2).max(1);
        let error = all.planes[point as usize].sum(kept.position()) / f64::from(crowd).sqrt();
        let aside = match of.on_edge {
            true => all.edges[point as usize].sum(kept.position()),
            false => 0.0,
        };
        let weight = f64::from(of.weight);
        let bounded = |x: f64| (x as f32).min(f32::MAX);
        let price = Price {
            cost: bounded(weight * (error * f64::from(flatness) + aside)),
            error: bounded(error),
            length: bounded(self.places[k].length_squared()),
        };
        self.offers.push((Offer { half_edge, price }, k));
    }

    /// Takes the cheapest offer whose faces turn by less than a right angle, in
    /// the precision that decides.
    fn take_turnable(&mut self) -> Option<Offer> {
        loop {
            let (best, k) = self.take_cheapest()?;
            if self.turns_little(k) {
                return Some(best);
            }
        }
    }

    fn turns_little(&self, to: usize) -> bool {
        let faces = self.corners.len();
        let place = self.places[to];
        (0..faces).all(|f| {
            let [a, b] = [self.places[f], self.places[f + 1]];
            if is_hidden(f, to, faces, self.closed) {
                return true;
            }
            let (before, after) = (a.cross(b), (a - place).cross(b - place));
            let along = before.dot(after);
            // A face that had no area may get one anywhere.
            along > 0.0 || (before == DVec3::ZERO && after != DVec3::ZERO)
        })
    }

    fn take_cheapest(&mut self) -> Option<(Offer, usize)> {
        let key = |o: &Offer| [o.price.cost, o.price.error, o.price.length].map(f32::to_bits);
        let best = (0..self.offers.len())
            .min_by_key(|&i| (key(&self.offers[i].0), self.offers[i].0.half_edge))?;
        Some(self.offers.swap_remove(best))
    }

    fn mark(&mut self, point: u32) {
        self.stamp += 1;
        for &p in &self.points {
            self.seen[p as usize] = self.stamp;
        }
        self.seen[point as usize] = 0;
    }

    /// The link condition (Dey et al. 1999), and that no vertex is left with
    /// fewer faces than a surface has around it.
    fn is_allowed(&mut self, all: &Points, point: u32, half_edge: u32) -> bool {
        let sides = all.surface.sides(half_edge);
        let kept_corner = match sides.left {
            NONE => sides.right,
            left => next(left),
        };
        let kept = all.at(kept_corner);
        let is_border_edge = sides.left == NONE || sides.right == NONE;
        let shared = if is_border_edge { 1 } else { 2 };
        let faces = all.points[point as usize].degree + kept.degree - 2 * shared;
        let least = if kept.border { 1 } else { 3 };
        if faces < least || faces > MOST_FACES.max(kept.degree) {
            return false;
        }
        let apex_stays = |h: u32| {
            let apex = all.at(prev(h));
            apex.degree > if apex.border { 1 } else { 3 }
        };
        [sides.left, sides.right]
            .into_iter()
            .all(|h| h == NONE || apex_stays(h))
            && self.common(all, kept_corner) == shared
    }

    /// How many of the points around are also around the point of a corner.
    fn common(&mut self, all: &Points, corner: u32) -> u32 {
        let mut other = std::mem::take(&mut self.other);
        let closed = all.around(corner, &mut other);
        let at = |c: u32| self.seen[all.surface.start(c) as usize] == self.stamp;
        let mut common = other.iter().filter(|&&c| at(next(c))).count();
        if !closed {
            common += other.last().iter().filter(|&&&c| at(prev(c))).count();
        }
        self.other = other;
        common as u32
    }
}

/// Whether a collapse of this half-edge leaves the seams where they are: a
/// vertex on one moves along it, one beside it not across.
fn runs_along(all: &Points, half_edge: u32, seams: &Seams) -> bool {
    match seams {
        Seams::Through => !all.is_inner(half_edge) && keeps_sides(all, half_edge),
        _ => all.is_inner(half_edge),
    }
}

/// Whether a seam has two vertices at the end of an edge just if it has two at
/// its start: then either tells the sides apart.
fn keeps_sides(all: &Points, half_edge: u32) -> bool {
    let moves = Moves::new(all.surface.sides(half_edge), |h| all.vertex[h as usize]);
    (moves.left[0] == moves.right[0]) == (moves.left[1] == moves.right[1])
}
