//! Collapses that were written down, done again: where they were done, or on a
//! surface of other shape.

use super::block::{Block, DEAD, Kind, Rules, root_of};
use super::fan::Side;
use super::level::{Joint, Level};
use super::paint::Blend;
use super::partition::Cut;
use super::price::Offer;
use super::record::{Collapse, Place};
use glam::Vec3;

/// No heir.
pub(crate) const NONE: u32 = u32::MAX;

/// A surface on which collapses are repeated.
pub(crate) struct Repeat<'a> {
    level: Level<'a>,
    block: Block,
    /// Numbers of the level's points in the block.
    local: Vec<u32>,
    /// Of every point that is gone the one it went into.
    pub point_heir: Vec<u32>,
    /// Likewise of every wedge; empty if there are none.
    pub wedge_heir: Vec<u32>,
    scale: f32,
}

impl<'a> Repeat<'a> {
    /// A surface on which nothing has been done; none if it has no triangles.
    pub fn new(level: Level<'a>, wedges: usize) -> Option<Self> {
        let rules = Rules {
            least_turn: 1.2f32.cos(),
            hold_borders: true,
            lock_borders: false,
            subset: false,
            even: 0.0,
            max_error: f32::INFINITY,
            log: false,
            ease: false,
        };
        let block = Cut::whole(&level).into_blocks(&level, rules).pop()?;
        let mut local = vec![DEAD; level.position.len()];
        for (i, &p) in block.global.iter().enumerate() {
            local[p as usize] = i as u32;
        }
        Some(Self {
            block,
            local,
            point_heir: vec![NONE; level.position.len()],
            wedge_heir: vec![NONE; wedges],
            scale: level.scale,
            level,
        })
    }

    /// Triangles that are left.
    pub fn alive(&self) -> usize {
        self.block.alive
    }

    /// Largest error so far, scaled units.
    pub fn error(&self) -> f32 {
        self.block.error
    }

    /// Wedges that have become mixtures since this was last asked.
    pub fn blends(&mut self) -> Vec<Blend> {
        let paint = self.block.paint.as_mut();
        paint.map_or(Vec::new(), |paint| std::mem::take(&mut paint.log))
    }

    /// The surface as it is now.
    pub fn level(&mut self) -> Level<'static> {
        let mut joint = Joint::of(&self.level);
        joint.add(&mut self.level, std::slice::from_ref(&self.block));
        joint.done(Level::default())
    }

    /// Repeats a collapse, with its new place found `anew` if asked for; not
    /// if the error would pass `most`, scaled units. Returns whether it did.
    ///
    /// # Errors
    /// What is wrong with the collapse.
    pub fn take(&mut self, c: &Collapse, anew: bool, most: f32) -> Result<bool, &'static str> {
        let local = |p: u32| self.local.get(p as usize).copied().unwrap_or(DEAD);
        let (kept, removed) = (local(c.kept), local(c.removed));
        let is_there = |p: u32| p != DEAD && self.block.is_there(p);
        if kept == removed || !is_there(kept) || !is_there(removed) {
            return Err("a vertex is not there, or no longer");
        }
        let mut offer = Offer {
            kept,
            removed,
            place: self.block.position[kept as usize],
            cost: 0.0,
        };
        self.block.gather(&offer);
        if self.block.fan.edge.is_empty() {
            return Err("two vertices have no edge");
        }
        match c.place {
            Place::Kept => {}
            Place::Removed => offer.place = self.block.position[removed as usize],
            Place::New(_) if anew => offer.place = self.block.refit(&offer),
            Place::New(place) => offer.place = place * self.scale,
        }
        if !offer.place.is_finite() {
            return Err("a place is not finite");
        }
        let memory = self.block.memory_at(&offer);
        let error = memory.distance();
        if error > most {
            return Ok(false);
        }
        self.block.error = self.block.error.max(error);
        self.block.turn_fan(&offer);
        let repaint = self.block.plan(&offer).unwrap_or_default();
        if let Some(paint) = &self.block.paint {
            for &(to, from) in repaint.pairs.iter().filter(|pair| pair.0 != pair.1) {
                self.wedge_heir[paint.global[from as usize] as usize] = paint.global[to as usize];
            }
        }
        self.block.collapse(&offer, memory, &repaint);
        self.bequeath(&offer);
        Ok(true)
    }

    /// Notes which points are gone: the one removed, and those that have lost
    /// their last triangle by it.
    fn bequeath(&mut self, offer: &Offer) {
        let block = &self.block;
        let thirds = block.fan.edge.iter().map(|edge| edge.1);
        for p in thirds.chain([offer.removed]) {
            if p != offer.kept && block.span[p as usize].len == 0 {
                self.point_heir[block.global[p as usize] as usize] =
                    block.global[offer.kept as usize];
            }
        }
    }
}

impl Block {
    fn is_there(&self, p: u32) -> bool {
        self.kind[p as usize] != Kind::Gone && self.span[p as usize].len > 0
    }

    /// Where joining two points costs least, unless that would turn a triangle
    /// over that the middle or an end would not. (Counting in the height over
    /// the edge, as prices do, or a stronger pull to its middle left bent and
    /// twisted bars farther off.)
    fn refit(&mut self, offer: &Offer) -> Vec3 {
        let [a, b] = [offer.kept, offer.removed];
        let best = self.free(a, b).place;
        let [pa, pb] = [a, b].map(|p| self.position[p as usize]);
        let choices = [best, 0.5 * (pa + pb), pa, pb];
        let is_sound = |&place: &Vec3| self.check_turns(&Offer { place, ..*offer }).is_ok();
        if let Some(sound) = choices.into_iter().find(is_sound) {
            return sound;
        }
        let turned = |place: &Vec3| {
            self.turned(&Offer {
                place: *place,
                ..*offer
            })
        };
        choices.into_iter().min_by_key(turned).unwrap_or(pa)
    }

    /// Triangles of the fan that would turn by more than allowed.
    fn turned(&self, offer: &Offer) -> usize {
        let sides = self.fan.sides.iter();
        let turns = |side: &&Side| {
            let [p, q, r] = self.after(offer, **side);
            let (old, new) = (self.root[side.t as usize], (q - p).cross(r - p));
            let least = self.rules.least_turn * old.w * new.length();
            new.dot(old.truncate()) < least || !new.is_finite()
        };
        sides.filter(turns).count()
    }

    /// Leaves the roots of the triangles that change their shape in the fan,
    /// whatever becomes of them.
    fn turn_fan(&mut self, offer: &Offer) {
        self.fan.roots.clear();
        for i in 0..self.fan.sides.len() {
            let [p, q, r] = self.after(offer, self.fan.sides[i]);
            let cross = (q - p).cross(r - p);
            self.fan.roots.push(root_of(cross, cross.length()));
        }
    }
}
