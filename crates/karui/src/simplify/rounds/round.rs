//! One round: every edge is priced, then those under a threshold collapse,
//! cheapest first, each point at most once.

use super::block::{Block, DEAD, Kind};
use super::lanes;
use super::repair::Guard;
use crate::simplify::candidate::Refusal;
use crate::simplify::refused::Refused;

/// Prices fall into one bin for every 1/16 of an octave.
const SHIFT: u32 = 19;
/// Bins of a histogram of prices.
pub(super) const BINS: usize = (f32::INFINITY.to_bits() >> SHIFT) as usize;
/// How much dearer than the threshold an edge may have become during a round.
const SLACK: f32 = 1.3;

/// The price at which a bin ends.
pub(super) fn upper_end(bin: usize) -> f32 {
    f32::from_bits(((bin as u32 + 1) << SHIFT) - 1)
}

/// State of a point that may vanish into any neighbour.
const FREE: u8 = 1;
/// State of a point whose surroundings the last round has changed.
const FRESH: u8 = 2;

/// A price that is not a number is one that nobody pays.
#[inline(always)]
fn payable(price: f32) -> f32 {
    if price >= 0.0 { price } else { f32::INFINITY }
}

#[inline(always)]
fn count(bins: &mut [u32], price: f32) {
    if let Some(count) = bins.get_mut((price.to_bits() >> SHIFT) as usize) {
        *count += 1;
    }
}

impl Block {
    /// Prices the half-edges whose surroundings the last round has changed and
    /// counts all prices into `bins`.
    pub fn look(&mut self, bins: &mut [u32]) {
        self.refused = Refused::default();
        let state = self.states();
        let mut plain = std::mem::take(&mut self.plain);
        for t in 0..self.triangle.len() {
            let points = self.triangle[t];
            if points[0] == DEAD {
                continue;
            }
            let states = points.map(|p| state[p as usize]);
            let mut prices = self.price[t];
            for (k, n) in [(0, 1), (1, 2), (2, 0)] {
                let (p, q) = (points[k], points[n]);
                if states[k] & states[n] & FREE == 0 || self.rules.subset {
                    prices[k] = self.odd_price(p, q, prices[k], states[k] | states[n]);
                    count(bins, prices[k]);
                } else if p > q {
                    prices[k] = f32::INFINITY;
                } else if (states[k] | states[n]) & FRESH == 0 && prices[k].is_finite() {
                    count(bins, prices[k]);
                } else {
                    plain.push(((3 * t + k) as u32, p, q));
                }
            }
            self.price[t] = prices;
        }
        for four in plain.chunks(4) {
            self.price_four(four, bins);
        }
        plain.clear();
        self.plain = plain;
        self.round += 1;
    }

    /// How many triangles there are if none of their edges may collapse: around a hub a cut can
    /// leave a block of spokes whose other ends are all shared.
    pub fn stuck(&self) -> usize {
        let may_collapse = |&[a, b, c]: &[u32; 3]| {
            let mut edges = [(a, b), (b, c), (c, a)].into_iter();
            edges.any(|(p, q)| self.offer(p.min(q), p.max(q)).is_some())
        };
        let mut alive = self.triangle.iter().filter(|points| points[0] != DEAD);
        if alive.any(may_collapse) {
            0
        } else {
            self.alive
        }
    }

    /// What decides how the edges of every point are looked at.
    fn states(&self) -> Vec<u8> {
        let state = |(p, (kind, changed)): (u32, (&Kind, &u32))| {
            let is_free = *kind == Kind::Interior && !self.is_hub(p);
            let free = if is_free { FREE } else { 0 };
            let fresh = if *changed >= self.round { FRESH } else { 0 };
            free | fresh
        };
        let both = self.kind.iter().zip(&self.changed);
        (0..).zip(both).map(state).collect()
    }

    /// Price of a half-edge whose ends are not both free, or may not move:
    /// `known` if nothing has changed; infinite if its other half has one.
    fn odd_price(&mut self, p: u32, q: u32, known: f32, state: u8) -> f32 {
        if p > q && !self.stands_for_edge(p, q) {
            f32::INFINITY
        } else if state & FRESH == 0 && known.is_finite() {
            known
        } else {
            self.price_of(p, q)
        }
    }

    fn price_four(&mut self, four: &[(u32, u32, u32)], bins: &mut [u32]) {
        let last = four.len() - 1;
        let four_edges = [four[0], four[1.min(last)], four[2.min(last)], four[last]];
        let star = |p: u32| &self.star[p as usize];
        let a = four_edges.map(|(_, p, _)| star(p));
        let b = four_edges.map(|(_, _, q)| star(q));
        let facing = |p: u32| self.facing[p as usize];
        let facing = four_edges.map(|(_, p, q)| facing(p) + facing(q));
        let mut prices = lanes::prices(a, b, facing, self.rules.even).to_array();
        if !self.weight.is_empty() {
            let weight = |p: u32| self.weight[p as usize];
            let both = prices.iter_mut().zip(four_edges);
            both.for_each(|(price, (_, p, q))| *price *= 0.5 * (weight(p) + weight(q)));
        }
        for (&(slot, ..), price) in four.iter().zip(prices) {
            let price = payable(price);
            self.price.as_flattened_mut()[slot as usize] = price;
            count(bins, price);
        }
    }

    /// Of the two halves of an edge one is looked at; that of a border is the
    /// only one.
    #[inline(always)]
    fn stands_for_edge(&self, p: u32, q: u32) -> bool {
        let may_be_border = |p: u32| {
            self.kind[p as usize] != Kind::Interior && self.kind[p as usize] != Kind::Shared
        };
        p < q || (may_be_border(p) && may_be_border(q) && self.shared_triangles(p, q) != 2)
    }

    fn price_of(&mut self, p: u32, q: u32) -> f32 {
        match self.offer(p.min(q), p.max(q)) {
            Some(offer) => payable(offer.cost),
            None => {
                let kinds = [p, q].map(|p| self.kind[p as usize]);
                if kinds.contains(&Kind::Seam) {
                    self.refused.count(Refusal::Seams);
                } else if kinds.contains(&Kind::Locked) || self.is_hub(p) || self.is_hub(q) {
                    self.refused.count(Refusal::Locked);
                } else if !kinds.contains(&Kind::Shared) {
                    self.refused.count(Refusal::Topology);
                }
                f32::INFINITY
            }
        }
    }

    /// Half-edges at `threshold` or under, as (bits of the price, half-edge),
    /// cheapest first to within 3 %.
    pub fn under(&self, threshold: f32) -> Vec<(u32, u32)> {
        let mut found: Vec<(u32, u32)> = Vec::with_capacity(self.alive / 4);
        for (t, points) in self.triangle.iter().enumerate() {
            if points[0] == DEAD {
                continue;
            }
            for (k, price) in self.price[t].iter().enumerate() {
                if *price <= threshold {
                    found.push((price.to_bits(), (3 * t + k) as u32));
                }
            }
        }
        by_price(&found)
    }

    /// Collapses what is under the threshold, `most` edges at most.
    pub fn collapse_under(&mut self, threshold: f32, most: usize, guard: Option<Guard<'_>>) {
        let enough = self.collapses + most;
        for (_, half_edge) in self.under(threshold) {
            if self.collapses >= enough {
                break;
            }
            self.attempt(half_edge, threshold, guard);
        }
    }

    /// Collapses the edge of this half-edge if neither of its points has been
    /// touched in this round and its price still is about the threshold.
    pub fn attempt(&mut self, half_edge: u32, threshold: f32, guard: Option<Guard<'_>>) {
        let (t, k) = (half_edge as usize / 3, half_edge as usize % 3);
        let points = self.triangle[t];
        if points[0] == DEAD {
            return;
        }
        let (p, q) = (points[k], points[(k + 1) % 3]);
        if [p, q]
            .iter()
            .any(|&p| self.touched[p as usize] == self.round)
        {
            return;
        }
        let Some(offer) = self.offer(p.min(q), p.max(q)) else {
            return;
        };
        if offer.cost <= SLACK * threshold
            && let Err(refusal) = self.accept(&offer, guard)
        {
            self.refused.count(refusal);
            // Until its surroundings change it stands behind edges of twice
            // its price, so as not to crowd them out.
            self.price[t][k] = 2.0 * threshold.max(f32::MIN_POSITIVE);
        }
    }
}

/// Sorted by price, to within 3 %, in linear time; equals keep their order.
fn by_price(found: &[(u32, u32)]) -> Vec<(u32, u32)> {
    const FINE: u32 = 18;
    let bin = |price: u32| (price >> FINE) as usize;
    let least = found.iter().map(|f| bin(f.0)).min().unwrap_or(0);
    let most = found.iter().map(|f| bin(f.0)).max().unwrap_or(0);
    let mut start = vec![0u32; most - least + 2];
    for f in found {
        start[bin(f.0) - least + 1] += 1;
    }
    for i in 1..start.len() {
        start[i] += start[i - 1];
    }
    let mut sorted = vec![(0, 0); found.len()];
    for &f in found {
        let at = &mut start[bin(f.0) - least];
        sorted[*at as usize] = f;
        *at += 1;
    }
    sorted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prices_come_out_in_order() {
        let prices = [3.0f32, 0.0, 1e-20, 7.5, 0.25, 1e9, 0.25];
        let found: Vec<(u32, u32)> = (0..).zip(prices).map(|(i, p)| (p.to_bits(), i)).collect();
        let order: Vec<u32> = by_price(&found).iter().map(|f| f.1).collect();
        assert_eq!(order, [1, 2, 4, 6, 0, 3, 5]);
        assert!(by_price(&[]).is_empty());
    }
}
