//! Whether a collapse keeps the surface what it is, and doing it.

use super::block::{Block, DEAD, Kind, Side, Span, root_of, turned};
use super::planes::Planes;
use super::price::Offer;
use super::repaint::Repaint;
use super::repair::Guard;
use super::star::Star;
use super::sym3::Sym3;
use crate::simplify::candidate::Refusal;
use glam::{Vec3, Vec4};

/// Least cosine between a triangle's normal and the mean of the input's
/// normals that the new point stands for.
const FACING: f32 = 0.2;
/// Least share of the input's area around a point that its normals must add up
/// to for them to have a mean.
const COHERENT: f32 = 0.6;

/// A triangle thinner than this must not get much thinner; 1 would be a right
/// angle with equal sides.
const THIN: f32 = 0.02;

impl Block {
    /// Does what is offered unless the surface forbids it, or the input where
    /// it is asked.
    pub fn accept(&mut self, offer: &Offer, guard: Option<Guard<'_>>) -> Result<(), Refusal> {
        self.gather(offer);
        self.check_link(offer)?;
        self.check_turns(offer)?;
        if guard.is_some_and(|guard| self.turns_against(offer, guard)) {
            return Err(Refusal::Flips);
        }
        let repaint = self.plan(offer)?;
        let memory = self.memory_at(offer);
        let error = memory.distance();
        if error > self.rules.max_error {
            return Err(Refusal::Error);
        }
        self.error = self.error.max(error);
        self.collapse(offer, memory, &repaint);
        Ok(())
    }

    fn memory_at(&self, offer: &Offer) -> Planes {
        let moved = |p: u32| {
            let by = offer.place - self.position[p as usize];
            self.memory[p as usize].moved(by)
        };
        moved(offer.kept).plus(&moved(offer.removed))
    }

    /// The triangles at both ends, turned so that the end comes first.
    fn gather(&mut self, offer: &Offer) {
        let (a, b) = (offer.kept, offer.removed);
        self.fan.clear();
        for &t in &self.list[range(self.span[a as usize])] {
            let [_, q, r] = turned(self.triangle[t as usize], a);
            let edge = q == b || r == b;
            self.fan.push(Side { t, q, r, edge });
        }
        self.first = self.fan.len();
        for &t in &self.list[range(self.span[b as usize])] {
            let [_, q, r] = turned(self.triangle[t as usize], b);
            if q != a && r != a {
                self.fan.push(Side {
                    t,
                    q,
                    r,
                    edge: false,
                });
            }
        }
    }

    /// The link condition (Dey et al. 1999): the ends have no neighbours in
    /// common but the third corners of the edge's triangles, and no triangle
    /// would lie on another. Next to another block, whose edges are not seen
    /// here, any two points shared with it count as neighbours.
    fn check_link(&mut self, offer: &Offer) -> Result<(), Refusal> {
        let (a, b) = (offer.kept, offer.removed);
        self.stamp += 2;
        let (near, third) = (self.stamp, self.stamp - 1);
        let (at_a, at_b) = self.fan.split_at(self.first);
        for side in at_a {
            self.mark[side.q as usize] = near;
            self.mark[side.r as usize] = near;
        }
        let mut thirds = 0;
        for side in at_a.iter().filter(|side| side.edge) {
            self.mark[if side.q == b { side.r } else { side.q } as usize] = third;
            thirds += 1;
        }
        if thirds == 0 || self.fan.len() == thirds {
            return Err(Refusal::Topology);
        }
        let is_shared = |p: u32| self.kind[p as usize] == Kind::Shared;
        let at_seam = is_shared(a);
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

    /// Checks the triangles that change their shape and leaves them in
    /// `turned`.
    fn check_turns(&mut self, offer: &Offer) -> Result<(), Refusal> {
        let ends = [offer.kept, offer.removed].map(|p| self.position[p as usize]);
        let facing = self.facing[offer.kept as usize] + self.facing[offer.removed as usize];
        let facing = facing_of(facing);
        self.turned.clear();
        for (i, side) in self.fan.iter().enumerate() {
            if side.edge {
                continue;
            }
            let ring = [side.q, side.r].map(|p| self.position[p as usize]);
            let cross = (ring[0] - offer.place).cross(ring[1] - offer.place);
            let corners = [ends[usize::from(i >= self.first)], offer.place];
            let length = cross.length();
            let normal = cross.extend(length);
            if !self.keeps_its_side(side, normal, ring, corners, facing) {
                return Err(Refusal::Flips);
            }
            self.turned.push((i as u32, root_of(cross, length)));
        }
        Ok(())
    }

    /// Whether one of the triangles in `turned` comes to oppose the input.
    fn turns_against(&self, offer: &Offer, guard: Guard<'_>) -> bool {
        self.turned.iter().any(|&(i, _)| {
            let side = self.fan[i as usize];
            let ring = [side.q, side.r].map(|p| self.position[p as usize]);
            guard.opposes([offer.place, ring[0], ring[1]]) && !guard.opposes(self.corners(side.t))
        })
    }

    /// Whether a triangle, between the two points of `ring` and a point that
    /// goes from `corners[0]` to `corners[1]`, stays as it is turned; `normal`
    /// is its doubled area normal then, and its length; `facing` the input's
    /// normal.
    #[inline(always)]
    fn keeps_its_side(
        &self,
        side: &Side,
        normal: Vec4,
        ring: [Vec3; 2],
        corners: [Vec3; 2],
        facing: Option<Vec3>,
    ) -> bool {
        let root = self.root[side.t as usize];
        let (cross, length) = (normal.truncate(), normal.w);
        let (root, root_length) = (root.truncate(), root.w);
        if cross.dot(root) < self.rules.least_turn * length * root_length {
            return false;
        }
        let doubled_area = 2.0 * root_length * root_length;
        let longest = longest_squared(corners[1], ring);
        if length <= THIN * longest {
            let before = longest_squared(corners[0], ring);
            if length <= THIN.min(0.5 * doubled_area / before) * longest {
                return false;
            }
        }
        let Some(facing) = facing else {
            return true;
        };
        let outward = cross.dot(facing);
        // What opposes the input already may stay so but must not grow.
        outward >= FACING * length
            || (length <= doubled_area && outward * root_length >= root.dot(facing) * length)
    }

    /// Joins the offer's points; `turned` holds the triangles that stay.
    fn collapse(&mut self, offer: &Offer, memory: Planes, repaint: &Repaint) {
        let (a, b) = (offer.kept, offer.removed);
        let lines = [a, b]
            .iter()
            .any(|&p| self.kind[p as usize] != Kind::Interior);
        if lines {
            self.change_lines(a, -1.0);
            self.change_lines(b, -1.0);
        }
        let wedges = self.wedges_of_fan(offer);
        self.strip(a, b);
        self.leave_stars(a, b);
        self.remove_triangles(b);
        self.memory[a as usize] = memory;
        self.move_points(offer);
        self.take_triangles(a, b);
        self.coat(a, repaint, &wedges);
        if lines {
            self.change_lines(a, 1.0);
        }
        self.collapses += 1;
    }

    /// Takes the planes of all triangles at `a` and `b` out of the stars of
    /// the points around.
    fn leave_stars(&mut self, a: u32, b: u32) {
        for side in &self.fan {
            let part = Star::of(self.root[side.t as usize]);
            for n in [side.q, side.r] {
                if n != a && n != b {
                    self.star[n as usize] -= part;
                    self.changed[n as usize] = self.round;
                }
            }
        }
    }

    /// Takes the triangles of the edge out.
    fn remove_triangles(&mut self, b: u32) {
        for side in &self.fan[..self.first] {
            if !side.edge {
                continue;
            }
            let third = if side.q == b { side.r } else { side.q };
            let span = &mut self.span[third as usize];
            let list = &mut self.list[range(*span)];
            if let Some(at) = list.iter().position(|&other| other == side.t) {
                list.swap(at, list.len() - 1);
                span.len -= 1;
            }
            self.triangle[side.t as usize] = [DEAD; 3];
            self.alive -= 1;
        }
    }

    fn move_points(&mut self, offer: &Offer) {
        let (a, b) = (offer.kept as usize, offer.removed as usize);
        let facing = self.facing[b];
        self.facing[a] += facing;
        if !self.weight.is_empty() {
            self.weight[a] = 0.5 * (self.weight[a] + self.weight[b]);
        }
        self.position[a] = offer.place;
        self.kind[b] = Kind::Gone;
        self.touched[a] = self.round;
        self.touched[b] = self.round;
        self.changed[a] = self.round;
    }

    /// Gives the triangles in `turned` to `a` and their planes to the stars.
    fn take_triangles(&mut self, a: u32, b: u32) {
        let place = self.room_for(self.turned.len() as u32, a, b);
        let mut star = Star::default();
        let list = &mut self.list[range(place)];
        for (slot, &(i, root)) in list.iter_mut().zip(&self.turned) {
            let Side { t, q, r, .. } = self.fan[i as usize];
            *slot = t;
            self.root[t as usize] = root;
            self.triangle[t as usize] = [a, q, r];
            let part = Star::of(root);
            star += part;
            self.star[q as usize] += part;
            self.star[r as usize] += part;
        }
        star.set_place(self.position[a as usize]);
        self.star[a as usize] = star;
        if let Some(paint) = &mut self.paint {
            paint.varies[a as usize] = Sym3::default();
        }
        self.span[a as usize] = place;
        self.span[b as usize].len = 0;
    }

    /// Room in the list for `len` triangles: that of either point if it will
    /// do.
    fn room_for(&mut self, len: u32, a: u32, b: u32) -> Span {
        let old = [a, b].map(|p| self.span[p as usize]);
        let start = match old.iter().find(|span| span.len >= len) {
            Some(span) => span.start,
            None => {
                let end = self.list.len();
                self.list.resize(end + len as usize, 0);
                end as u32
            }
        };
        Span { start, len }
    }

    /// Adds the lines of the features at `p` to the stars of both their ends,
    /// or takes them out.
    fn change_lines(&mut self, p: u32, sign: f32) {
        if self.kind[p as usize] == Kind::Interior || self.kind[p as usize] == Kind::Gone {
            return;
        }
        for n in self.held(p) {
            let line = self.line(p, n).0.map(|v| v * sign);
            let line = Star::of_line(Sym3(line));
            self.star[n as usize] += line;
            self.changed[n as usize] = self.round;
            if sign > 0.0 {
                self.star[p as usize] += line;
            }
        }
    }
}

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

fn range(span: Span) -> std::ops::Range<usize> {
    span.start as usize..(span.start + span.len) as usize
}

#[inline(always)]
fn longest_squared(p: Vec3, [q, r]: [Vec3; 2]) -> f32 {
    p.distance_squared(q)
        .max(p.distance_squared(r))
        .max(q.distance_squared(r))
}
