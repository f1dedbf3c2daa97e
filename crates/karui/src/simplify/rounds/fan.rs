//! The triangles around an edge that is to collapse, and whether they stay
//! what they are.

use super::block::{Block, Kind, others, range};
use super::lanes::{self, V};
use super::price::Offer;
use super::star::Star;
use crate::simplify::candidate::Refusal;
use glam::{Vec3, Vec4};

/// Least cosine between a triangle's normal and the mean of the input's
/// normals that the new point stands for.
const FACING: f32 = 0.2;
/// Least cosine between normals before and after for them to be the same.
const STEADY: f32 = 0.999;
/// Least share of the input's area around a point that its normals must add up
/// to for them to have a mean.
const COHERENT: f32 = 0.6;
/// A triangle thinner than this must not get much thinner; 1 would be a right
/// angle with equal sides.
pub(super) const THIN: f32 = 0.02;

/// A triangle as seen from one of its points.
#[derive(Debug, Clone, Copy)]
pub(super) struct Side {
    pub t: u32,
    /// The point after.
    pub q: u32,
    /// The point before.
    pub r: u32,
}

/// The triangles at both ends of an edge, each once.
#[derive(Debug, Default)]
pub(super) struct Fan {
    /// Those that stay: at the point that stays first, then at the other.
    pub sides: Vec<Side>,
    /// How many of them are at the point that stays.
    pub first: usize,
    /// Those that go, and their third corners.
    pub edge: Vec<(u32, u32)>,
    /// Those of them that are thin or were, by number: how they turn says
    /// little.
    pub doubtful: Vec<usize>,
    /// Whether all that change are small, as the block has it.
    pub small: bool,
    /// Whether one of these does not plainly face as the input does.
    pub unclear: bool,
    /// New roots of those that stay.
    pub roots: Vec<Vec4>,
}

impl Block {
    /// Fills the fan: the triangles at both ends, turned so that the end comes
    /// first.
    pub fn gather(&mut self, offer: &Offer) {
        let (a, b) = (offer.kept, offer.removed);
        let Fan {
            sides, edge, first, ..
        } = &mut self.fan;
        sides.clear();
        edge.clear();
        for &t in &self.list[range(self.span[a as usize])] {
            let (q, r) = others(self.triangle[t as usize], a);
            if q == b || r == b {
                edge.push((t, if q == b { r } else { q }));
            } else {
                sides.push(Side { t, q, r });
            }
        }
        *first = sides.len();
        for &t in &self.list[range(self.span[b as usize])] {
            let (q, r) = others(self.triangle[t as usize], b);
            if q != a && r != a {
                sides.push(Side { t, q, r });
            }
        }
    }

    /// The link condition (Dey et al. 1999): the ends have no neighbours in
    /// common but the third corners of the edge's triangles, and no triangle
    /// would lie on another. Next to another block, whose edges are not seen
    /// here, any two points shared with it count as neighbours.
    pub fn check_link(&mut self, offer: &Offer) -> Result<(), Refusal> {
        self.stamp += 2;
        let (near, third) = (self.stamp, self.stamp - 1);
        let (at_a, at_b) = self.fan.sides.split_at(self.fan.first);
        for side in at_a {
            self.mark[side.q as usize] = near;
            self.mark[side.r as usize] = near;
        }
        for &(_, point) in &self.fan.edge {
            self.mark[point as usize] = third;
        }
        if self.fan.edge.is_empty() || self.fan.sides.is_empty() {
            return Err(Refusal::Topology);
        }
        let is_shared = |p: u32| self.kind[p as usize] == Kind::Shared;
        let at_seam = is_shared(offer.kept);
        for &Side { q, r, .. } in at_b {
            let stamp = [self.mark[q as usize], self.mark[r as usize]];
            let covered = || stamp == [third; 2] && has_triangle(at_a, q, r);
            let unseen = |p: u32, stamp: u32| stamp != third && is_shared(p);
            if stamp.contains(&near)
                || covered()
                || (at_seam && (unseen(q, stamp[0]) || unseen(r, stamp[1])))
            {
                return Err(Refusal::Topology);
            }
        }
        Ok(())
    }

    /// Checks the triangles that change their shape and leaves their new roots
    /// in the fan.
    pub fn check_turns(&mut self, offer: &Offer) -> Result<(), Refusal> {
        let facing = self.facing[offer.kept as usize] + self.facing[offer.removed as usize];
        let sum = facing;
        let facing = facing_of(sum);
        let place = V::splat(offer.place);
        self.fan.roots.clear();
        self.fan.doubtful.clear();
        self.fan.unclear = false;
        let mut largest = Vec4::ZERO;
        let small = self.small;
        for (i, four) in self.fan.sides.chunks(4).enumerate() {
            let sides: [Side; 4] = std::array::from_fn(|k| four[k.min(four.len() - 1)]);
            let star = |p: u32| &self.star[p as usize];
            let ring = [sides.map(|s| star(s.q)), sides.map(|s| star(s.r))].map(Star::places);
            let old = Star::columns(sides.map(|s| self.root[s.t as usize]));
            let turn = lanes::turn(place, ring, old);
            if !turn.keeps_its_side(self.rules.least_turn, facing)
                || (turn.is_thin() && self.gets_thinner(offer, 4 * i, &turn))
            {
                return Err(Refusal::Flips);
            }
            let mut doubtful = turn.doubtful(small) & ((1 << four.len()) - 1);
            if doubtful != 0 {
                self.fan.unclear |= doubtful & turn.unclear(sum) != 0;
            }
            while doubtful != 0 {
                let at = 4 * i + doubtful.trailing_zeros() as usize;
                self.fan.doubtful.push(at);
                doubtful &= doubtful - 1;
            }
            largest = largest.max(turn.longest);
            self.fan.roots.extend(&turn.roots()[..four.len()]);
        }
        self.fan.small = largest.max_element() <= small;
        Ok(())
    }

    /// Whether one of up to four triangles of the fan, from the `first` on, is
    /// thin after the turn and was not before.
    fn gets_thinner(&self, offer: &Offer, first: usize, turn: &lanes::Turn) -> bool {
        let at = |p: u32| self.position[p as usize];
        let sides = self.fan.sides[first..].iter().take(4);
        sides.enumerate().any(|(k, side)| {
            let kept = first + k < self.fan.first;
            let end = at(if kept { offer.kept } else { offer.removed });
            let before = longest_squared(end, at(side.q), at(side.r));
            let root = self.root[side.t as usize].w;
            let thinnest = THIN.min(root * root / before);
            turn.length[k] <= thinnest * turn.longest[k]
        })
    }

    /// Corners of a triangle of the fan after the collapse.
    pub fn after(&self, offer: &Offer, side: Side) -> [Vec3; 3] {
        let [q, r] = [side.q, side.r].map(|p| self.position[p as usize]);
        [offer.place, q, r]
    }
}

impl lanes::Turn {
    /// Whether no triangle turns by more than allowed or comes to face away
    /// from the input. What opposes the input already may stay so but must not
    /// grow; beside a large face the mean says little of a small one, which may
    /// stay as it is.
    #[inline(always)]
    fn keeps_its_side(&self, least_turn: f32, facing: Option<Vec3>) -> bool {
        let (old, root) = (self.old_normal, self.old_root);
        let turn = self.normal.dot(old);
        let turned = turn.cmpge(root * self.length * least_turn);
        let Some(facing) = facing else {
            return turned.all();
        };
        let facing = V::splat(facing);
        let outward = self.normal.dot(facing);
        let smaller = self.length.cmple(root * root * 2.0)
            & (outward * root).cmpge(old.dot(facing) * self.length);
        let steady = turn.cmpge(root * self.length * STEADY) & outward.cmpgt(Vec4::ZERO);
        (turned & (outward.cmpge(self.length * FACING) | smaller | steady)).all()
    }

    /// Which are thin or were, of those whose longest side, squared, is more
    /// than `small`.
    #[inline(always)]
    fn doubtful(&self, small: f32) -> u32 {
        let least = self.length.min(self.old_root * self.old_root * 2.0);
        let thin = least.cmple(self.longest * DOUBTFUL);
        (thin & self.longest.cmpgt(Vec4::splat(small))).bitmask()
    }

    /// Which do not plainly face as the input does, by its area normals and
    /// areas.
    #[inline(always)]
    fn unclear(&self, facing: Vec4) -> u32 {
        let outward = self.normal.dot(V::splat(facing.truncate()));
        outward.cmplt(self.length * (PLAIN * facing.w)).bitmask()
    }

    #[inline(always)]
    fn is_thin(&self) -> bool {
        self.length.cmple(self.longest * THIN).any()
    }
}

/// A triangle thinner than this is doubtful.
const DOUBTFUL: f32 = 0.1;
/// Least cosine between the normal of such a triangle and the input's normals,
/// times the share of these that agree, for it to face plainly as they do.
const PLAIN: f32 = 0.0;

/// The direction in which the input faces, of a sum of area normals and areas;
/// none where they cancel out: on a shell whose two sides have become one,
/// either side is as good.
#[inline(always)]
fn facing_of(sum: Vec4) -> Option<Vec3> {
    let normal = sum.truncate();
    let length = normal.length();
    (length > COHERENT * sum.w).then(|| normal / length)
}

/// Whether one of the triangles has these two points besides.
fn has_triangle(fan: &[Side], q: u32, r: u32) -> bool {
    fan.iter()
        .any(|side| (side.q == q && side.r == r) || (side.q == r && side.r == q))
}

#[inline(always)]
fn longest_squared(p: Vec3, q: Vec3, r: Vec3) -> f32 {
    p.distance_squared(q)
        .max(p.distance_squared(r))
        .max(q.distance_squared(r))
}
