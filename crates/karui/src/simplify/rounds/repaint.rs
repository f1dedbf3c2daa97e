//! What a collapse does to the attributes.

use super::block::{Block, Kind};
use super::fan::Side;
use super::paint::{Pair, Pairs};
use super::price::Offer;
use crate::geom::{closest_barycentric, interpolate};
use crate::simplify::blend::Mix;
use crate::simplify::candidate::Refusal;
use glam::Vec3;
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
        for &(t, _) in &self.fan.edge {
            let pair = (self.wedge_at(t, a), self.wedge_at(t, b));
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
        let kept = i < self.fan.first;
        let end = if kept { offer.kept } else { offer.removed };
        (end, self.wedge_at(self.fan.sides[i].t, end))
    }

    /// The mixture that the surface shows nearest to the new place, among the
    /// triangles of one pair of wedges.
    fn mix(&self, offer: &Offer, pair: Pair) -> Option<Mix> {
        let at_edge = |&&(t, _): &&(u32, u32)| self.wedge_at(t, offer.kept) == pair.0;
        let beside = |&i: &usize| {
            let (_, wedge) = self.end_of(offer, i);
            wedge == if i < self.fan.first { pair.0 } else { pair.1 }
        };
        let edge = self.fan.edge.iter().filter(at_edge).map(|e| e.0);
        let sides = (0..self.fan.sides.len()).filter(beside);
        self.nearest_mix(offer.place, edge.chain(sides.map(|i| self.fan.sides[i].t)))
    }

    /// The mixture that the surface shows nearest to a place, among these
    /// triangles; of equally near ones, the first.
    pub fn nearest_mix(&self, place: Vec3, triangles: impl Iterator<Item = u32>) -> Option<Mix> {
        let paint = self.paint.as_ref()?;
        let place = place.as_dvec3();
        let mixes = triangles.map(|t| {
            let corners = self.corners(t).map(|p| p.as_dvec3());
            let shares = closest_barycentric(place, corners);
            let distance = place.distance_squared(interpolate(corners, shares));
            let sources = paint.wedge[t as usize];
            (distance, Mix { sources, shares })
        });
        mixes.min_by(|a, b| a.0.total_cmp(&b.0)).map(|best| best.1)
    }

    fn turns_uvs(&self, offer: &Offer, repaint: &Repaint) -> bool {
        let Some(paint) = &self.paint else {
            return false;
        };
        paint.uvs.iter().any(|&set| {
            self.fan.sides.iter().enumerate().any(|(i, side)| {
                let (end, wedge) = self.end_of(offer, i);
                let kept = repaint.kept(wedge);
                let pair = repaint.pairs.iter().position(|pair| pair.0 == kept);
                let new = match pair.and_then(|at| repaint.mixes.get(at)) {
                    Some(mix) => paint.mixed_uv(set, mix),
                    None => paint.uv(set, kept),
                };
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
        let edge = self.fan.edge.iter().map(|e| e.0);
        for t in edge.chain(self.fan.sides.iter().map(|side| side.t)) {
            let points = self.triangle[t as usize];
            let which = points.map(|p| p != a && p != b);
            let wedges = paint.wedge[t as usize];
            paint.add(wedges, self.corners(t), which, -1.0);
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
        for (&Side { t, .. }, &[wedge, q, r]) in self.fan.sides.iter().zip(wedges) {
            let wedges = [repaint.kept(wedge), q, r];
            paint.wedge[t as usize] = wedges;
            paint.add(wedges, self.corners(t), [true; 3], 1.0);
        }
        self.paint = Some(paint);
        self.vary(a);
        self.stamp += 1;
        for i in 0..self.fan.edge.len() {
            self.vary_once(self.fan.edge[i].1);
        }
        for i in 0..self.fan.sides.len() {
            self.vary_once(self.fan.sides[i].q);
            self.vary_once(self.fan.sides[i].r);
        }
    }

    fn vary_once(&mut self, p: u32) {
        if self.mark[p as usize] != self.stamp {
            self.mark[p as usize] = self.stamp;
            self.vary(p);
        }
    }

    /// Wedges of the triangles that stay, turned so that the end that
    /// collapses comes first.
    pub fn wedges_of_fan(&self, offer: &Offer) -> SmallVec<[[u32; 3]; 16]> {
        if self.paint.is_none() {
            return SmallVec::new();
        }
        let wedges = |(i, side): (usize, &Side)| {
            let (end, _) = self.end_of(offer, i);
            [end, side.q, side.r].map(|p| self.wedge_at(side.t, p))
        };
        self.fan.sides.iter().enumerate().map(wedges).collect()
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
