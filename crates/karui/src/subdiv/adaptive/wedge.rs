//! Limits of vertices, found where they first have quads around them.

use super::limit::Fan;
use super::ring::Ring;
use super::store::{NONE, Origin, Store, Wedge};
use crate::subdiv::INFINITELY_SHARP;
use crate::subdiv::crease::Rule;
use glam::DVec3;
use smallvec::{SmallVec, smallvec};
use std::ops::Range;

impl Store {
    /// The wedge of a corner, with the limit of its vertex; found once.
    pub fn wedge(&mut self, t: usize, corner: u32) -> u32 {
        let known = self.tiers[t].wedges[corner as usize];
        if known != NONE {
            return known;
        }
        let wedge = match self.same_wedge(t, corner) {
            Some([t, corner]) => self.wedge(t as usize, corner),
            None => {
                self.find_wedges(t, corner);
                self.tiers[t].wedges[corner as usize]
            }
        };
        self.tiers[t].wedges[corner as usize] = wedge;
        wedge
    }

    /// Tier and corner that decide for this one: the first of quads at the same vertex.
    fn same_wedge(&mut self, t: usize, corner: u32) -> Option<[u32; 2]> {
        if t == 0 {
            self.children(0, self.tiers[0].face_of(corner));
            return Some([1, 4 * self.tiers[0].child(corner)]);
        }
        let v = self.tiers[t].corners[corner as usize];
        let old = matches!(self.tiers[t].vertices[v as usize].origin, Origin::Vertex(_));
        let parent = self.tiers[t].faces[corner as usize / 4].parent;
        (old && t > 1).then_some([t as u32 - 1, parent])
    }

    /// As [`Store::wedge`], of a corner whose vertex has had a wedge asked for.
    pub fn known_wedge(&self, mut t: usize, mut corner: u32) -> u32 {
        loop {
            let tier = &self.tiers[t];
            let known = tier.wedges[corner as usize];
            if known != NONE || t == 0 {
                return known;
            }
            (t, corner) = (t - 1, tier.faces[corner as usize / 4].parent);
        }
    }

    fn find_wedges(&mut self, t: usize, corner: u32) {
        let ring = self.ring(t, corner);
        let (mut deep, mut at) = (t, ring.clone());
        while self.fades(deep, &at) {
            let first = at.corners[0];
            for &c in &at.corners {
                self.children(deep, self.tiers[deep].face_of(c));
            }
            at = self.ring(deep + 1, 4 * self.tiers[deep].child(first));
            deep += 1;
        }
        let vertex = self.tiers[t].vertices[self.tiers[t].corners[corner as usize] as usize];
        let rule = match self.linear {
            true => Rule::Corner,
            false => Rule::of(vertex.sharpness_if_for_ever(), &self.around(deep, &at)),
        };
        let fan = self.fan(deep, &at);
        let sectors = self.sectors(deep, &at);
        let sharp = self.around(deep, &at).iter().position(|&s| s > 0.0);
        let dart = sharp
            .filter(|_| rule == Rule::Smooth)
            .map(|sharp| fan.dart(sharp));
        let limit = dart.map_or_else(|| limit(&fan, rule, &sectors), |d| d.0);
        let limit = limit.as_vec3();
        for sector in &sectors {
            let part = || normal(&fan.part(sector), rule, sectors.len(), at.is_open());
            let normal = dart.map_or_else(part, |d| d.1);
            let wedge = self.wedges.len() as u32;
            let (point, normal) = (vertex.point, normal.as_vec3());
            self.wedges.push(Wedge {
                point,
                limit,
                normal,
            });
            for i in sector.clone() {
                let corner = ring.corners[i % ring.corners.len()];
                self.tiers[t].wedges[corner as usize] = wedge;
            }
        }
    }

    /// Whether something around a vertex is sharp, but not for ever.
    fn fades(&self, t: usize, ring: &Ring) -> bool {
        let tier = &self.tiers[t];
        let vertex = &tier.vertices[tier.corners[ring.corners[0] as usize] as usize];
        let fades = |s: f32| s > 0.0 && s < INFINITELY_SHARP;
        fades(vertex.sharpness) || self.around(t, ring).into_iter().any(fades)
    }

    fn fan(&mut self, t: usize, ring: &Ring) -> Fan {
        let mut fan = Fan {
            center: self.corner_position(t, ring.corners[0]),
            ..Fan::default()
        };
        for &c in &ring.corners {
            fan.spokes
                .push(self.corner_position(t, c & !3 | (c + 1) & 3));
            fan.diagonals
                .push(self.corner_position(t, c & !3 | (c + 2) & 3));
        }
        let last = ring.corners[ring.corners.len() - 1];
        fan.spokes
            .push(self.corner_position(t, last & !3 | (last + 3) & 3));
        fan
    }

    /// Quads of a ring between sharp edges, as ranges that may go on past its end; all if
    /// fewer than two are sharp.
    fn sectors(&self, t: usize, ring: &Ring) -> SmallVec<[Range<usize>; 4]> {
        let n = ring.corners.len();
        let around = self.around(t, ring);
        let sharp: SmallVec<[usize; 8]> = (0..around.len()).filter(|&i| around[i] > 0.0).collect();
        if sharp.len() < 2 {
            return smallvec![0..n];
        }
        let mut sectors: SmallVec<[Range<usize>; 4]> =
            sharp.windows(2).map(|w| w[0]..w[1]).collect();
        if !ring.is_open() {
            sectors.push(sharp[sharp.len() - 1]..sharp[0] + n);
        }
        sectors
    }
}

impl super::store::Vertex {
    fn sharpness_if_for_ever(&self) -> f32 {
        if self.sharpness >= INFINITELY_SHARP {
            self.sharpness
        } else {
            0.0
        }
    }
}

impl Fan {
    /// The quads of a range that may go on past the end.
    fn part(&self, range: &Range<usize>) -> Self {
        let n = self.diagonals.len();
        let spoke = |i: usize| self.spokes[if i <= n { i } else { i - n }];
        Self {
            center: self.center,
            spokes: (range.start..=range.end).map(spoke).collect(),
            diagonals: range.clone().map(|i| self.diagonals[i % n]).collect(),
        }
    }
}

fn limit(fan: &Fan, rule: Rule, sectors: &[Range<usize>]) -> DVec3 {
    let spoke = |i: usize| fan.part(&(i..i)).spokes[0];
    match rule {
        Rule::Smooth => fan.smooth_limit(),
        Rule::Crease => fan.crease_limit(spoke(sectors[0].start), spoke(sectors[0].end)),
        Rule::Corner => fan.center,
    }
}

fn normal(fan: &Fan, rule: Rule, sectors: usize, open: bool) -> DVec3 {
    let whole = sectors == 1 && !open;
    match rule {
        Rule::Smooth => fan.smooth_normal(),
        Rule::Crease => fan.crease_normal(),
        Rule::Corner if whole => fan.mean_normal(),
        Rule::Corner => fan.corner_normal(),
    }
}
