//! Doing a collapse.

use super::block::{Block, DEAD, Kind, Span, range};
use super::fan::Side;
use super::hub::place_of;
use super::planes::Planes;
use super::price::Offer;
use super::repaint::Repaint;
use super::repair::Guard;
use super::star::Star;
use super::sym3::Sym3;
use crate::simplify::candidate::Refusal;

impl Block {
    /// Does what is offered unless the surface forbids it, or the input where
    /// it is asked.
    pub fn accept(&mut self, offer: &Offer, guard: Option<Guard<'_>>) -> Result<(), Refusal> {
        self.gather(offer);
        self.check_link(offer)?;
        self.check_turns(offer)?;
        let repaint = self.plan(offer)?;
        let memory = self.memory_at(offer);
        let error = memory.distance();
        if error > self.rules.max_error {
            return Err(Refusal::Error);
        }
        if self.turns_against(offer, guard) {
            return Err(Refusal::Flips);
        }
        self.error = self.error.max(error);
        self.collapse(offer, memory, &repaint);
        Ok(())
    }

    pub(super) fn memory_at(&self, offer: &Offer) -> Planes {
        let moved = |p: u32| {
            let by = offer.place - self.position[p as usize];
            self.memory[p as usize].moved(by)
        };
        moved(offer.kept).plus(&moved(offer.removed))
    }

    /// Joins the offer's points.
    pub(super) fn collapse(&mut self, offer: &Offer, memory: Planes, repaint: &Repaint) {
        self.note(offer);
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
        self.remove_triangles();
        self.memory[a as usize] = memory;
        self.move_points(offer);
        self.take_triangles(a, b);
        self.coat(a, repaint, &wedges);
        if lines {
            self.change_lines(a, 1.0);
        }
        self.collapses += 1;
    }

    /// Takes the triangles of the edge out.
    fn remove_triangles(&mut self) {
        for i in 0..self.fan.edge.len() {
            let (t, third) = self.fan.edge[i];
            self.star[third as usize] -= Star::of(self.root[t as usize]);
            self.changed[third as usize] = self.round;
            self.take_from(third, t);
            self.triangle[t as usize] = [DEAD; 3];
            self.alive -= 1;
        }
    }

    /// Takes a triangle out of a point's list.
    pub(super) fn take_from(&mut self, p: u32, t: u32) {
        let span = &mut self.span[p as usize];
        let list = &mut self.list[range(*span)];
        if let Some(at) = place_of(t, list) {
            list.swap(at, list.len() - 1);
            span.len -= 1;
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

    /// Gives the triangles that stay to `a` and their new planes to the stars.
    fn take_triangles(&mut self, a: u32, b: u32) {
        let place = self.room_for(self.fan.sides.len() as u32, a, b);
        let mut star = Star::default();
        let list = &mut self.list[range(place)];
        let turned = self.fan.sides.iter().zip(&self.fan.roots);
        for (slot, (&Side { t, q, r }, &root)) in list.iter_mut().zip(turned) {
            *slot = t;
            self.triangle[t as usize] = [a, q, r];
            let old = std::mem::replace(&mut self.root[t as usize], root);
            let part = Star::of(root);
            star += part;
            let change = part - Star::of(old);
            for n in [q, r] {
                self.star[n as usize] += change;
                self.changed[n as usize] = self.round;
            }
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
