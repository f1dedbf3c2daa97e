//! What a collapse does to the attributes.

use super::block::{Block, Kind};
use super::paint::{Pair, Pairs};
use super::price::Offer;
use crate::geom::{closest_barycentric, interpolate};
use crate::simplify::blend::Mix;
use crate::simplify::candidate::Refusal;
use smallvec::SmallVec;

/// What the wedges of the new point will be.
#[derive(Debug, Default)]
pub(super) struct Repaint {
    pub pairs: Pairs,
    /// What the first of every pair becomes; none where the point stays in
    /// place and its wedges stay as they are.
    mixes: SmallVec<[Mix; 2]>,
}

impl Repaint {
    /// The wedge of the new point that takes the place of `wedge`.
    fn kept(&self, wedge: u32) -> u32 {
        let pair = self.pairs.iter().find(|pair| pair.1 == wedge);
        pair.map_or(wedge, |pair| pair.0)
    }
}

impl Block {
    /// Plans the wedges of the new point; refused if UVs would turn over.
    pub fn plan(&self, offer: &Offer) -> Result<Repaint, Refusal> {
        let mut repaint = Repaint::default();
        if self.paint.is_none() {
            return Ok(repaint);
        }
        let (a, b) = (offer.kept, offer.removed);
        for side in self.fan.iter().filter(|side| side.edge) {
            let pair = (self.wedge_at(side.t, a), self.wedge_at(side.t, b));
            if !repaint.pairs.contains(&pair) {
                repaint.pairs.push(pair);
            }
        }
        if offer.place != self.position[a as usize] {
            let mix = |&pair: &Pair| self.mix(offer, pair);
            repaint.mixes = repaint.pairs.iter().filter_map(mix).collect();
        }
        if self.turns_uvs(offer, &repaint) {
            return Err(Refusal::Flips);
        }
        Ok(repaint)
    }

    /// Which end of the offer a triangle of the fan is at, and its wedge
    /// there.
    fn end_of(&self, offer: &Offer, i: usize) -> (u32, u32) {
        let end = if i < self.first {
            offer.kept
        } else {
            offer.removed
        };
        (end, self.wedge_at(self.fan[i].t, end))
    }

    /// The mixture that the surface shows nearest to the new place, among the
    /// triangles of one pair of wedges.
    fn mix(&self, offer: &Offer, pair: Pair) -> Option<Mix> {
        let paint = self.paint.as_ref()?;
        let place = offer.place.as_dvec3();
        let mut best: Option<(f64, Mix)> = None;
        for (i, side) in self.fan.iter().enumerate() {
            let (_, wedge) = self.end_of(offer, i);
            if wedge != if i < self.first { pair.0 } else { pair.1 } {
                continue;
            }
            let corners = self.corners(side.t).map(|p| p.as_dvec3());
            let shares = closest_barycentric(place, corners);
            let distance = place.distance_squared(interpolate(corners, shares));
            if best.as_ref().is_none_or(|(known, _)| distance < *known) {
                let sources = paint.wedge[side.t as usize];
                best = Some((distance, Mix { sources, shares }));
            }
        }
        best.map(|(_, mix)| mix)
    }

    fn turns_uvs(&self, offer: &Offer, repaint: &Repaint) -> bool {
        let Some(paint) = &self.paint else {
            return false;
        };
        paint.uvs.iter().any(|&set| {
            self.turned.iter().any(|&(i, _)| {
                let (end, wedge) = self.end_of(offer, i as usize);
                let kept = repaint.kept(wedge);
                let pair = repaint.pairs.iter().position(|pair| pair.0 == kept);
                let new = match pair.and_then(|at| repaint.mixes.get(at)) {
                    Some(mix) => paint.mixed_uv(set, mix),
                    None => paint.uv(set, kept),
                };
                let side = self.fan[i as usize];
                let [q, r] = [side.q, side.r].map(|p| paint.uv(set, self.wedge_at(side.t, p)));
                let old = paint.uv(set, self.wedge_at(side.t, end));
                let before = (q - old).perp_dot(r - old);
                let after = (q - new).perp_dot(r - new);
                // A chart may have triangles without area; they may stay so.
                before != 0.0 && before.signum() * after <= 0.0
            })
        })
    }

    /// Takes the triangles of the fan out of the sums of the points around.
    pub fn strip(&mut self, a: u32, b: u32) {
        let Some(mut paint) = self.paint.take() else {
            return;
        };
        for side in &self.fan {
            let points = self.triangle[side.t as usize];
            let which = points.map(|p| p != a && p != b);
            let wedges = paint.wedge[side.t as usize];
            paint.add(wedges, self.corners(side.t), which, -1.0);
        }
        self.paint = Some(paint);
    }

    /// Gives the triangles that stay their new wedges and sums. Triangles have
    /// been turned so that the new point `a` comes first.
    pub fn coat(&mut self, a: u32, repaint: &Repaint, wedges: &[[u32; 3]]) {
        let Some(mut paint) = self.paint.take() else {
            return;
        };
        for (pair, mix) in repaint.pairs.iter().zip(&repaint.mixes) {
            paint.blend(pair.0, mix);
        }
        for &[wedge, _, _] in wedges {
            paint.clear(repaint.kept(wedge));
        }
        for (&(i, _), &[wedge, q, r]) in self.turned.iter().zip(wedges) {
            let t = self.fan[i as usize].t;
            let wedges = [repaint.kept(wedge), q, r];
            paint.wedge[t as usize] = wedges;
            paint.add(wedges, self.corners(t), [true; 3], 1.0);
        }
        self.paint = Some(paint);
        self.vary(a);
        self.stamp += 1;
        for i in 0..self.fan.len() {
            let side = self.fan[i];
            for p in [side.q, side.r] {
                if self.mark[p as usize] != self.stamp {
                    self.mark[p as usize] = self.stamp;
                    self.vary(p);
                }
            }
        }
    }

    /// Wedges of the triangles that stay, turned so that the end that
    /// collapses comes first.
    pub fn wedges_of_fan(&self, offer: &Offer) -> SmallVec<[[u32; 3]; 16]> {
        if self.paint.is_none() {
            return SmallVec::new();
        }
        let wedges = |&(i, _): &(u32, _)| {
            let side = self.fan[i as usize];
            let (end, _) = self.end_of(offer, i as usize);
            [end, side.q, side.r].map(|p| self.wedge_at(side.t, p))
        };
        self.turned.iter().map(wedges).collect()
    }

    /// Brings what the attributes around `p` add to its star up to date.
    pub fn vary(&mut self, p: u32) {
        let kind = self.kind[p as usize];
        if kind > Kind::Seam {
            return;
        }
        let Some(mut paint) = self.paint.take() else {
            return;
        };
        let mut seen = SmallVec::<[u32; 4]>::new();
        let mut sum = super::sym3::Sym3::default();
        for &t in self.triangles_at(p) {
            let points = self.triangle[t as usize];
            let corner = points.iter().position(|&q| q == p).unwrap_or(0);
            let wedge = paint.wedge[t as usize][corner];
            if !seen.contains(&wedge) {
                seen.push(wedge);
                sum += paint.variance(wedge);
            }
            if kind == Kind::Interior {
                break;
            }
        }
        let change = sum - paint.varies[p as usize];
        paint.varies[p as usize] = sum;
        self.paint = Some(paint);
        self.star[p as usize] += super::star::Star::of_line(change);
    }
}
