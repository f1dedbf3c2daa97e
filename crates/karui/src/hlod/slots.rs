//! How the tree lies in memory: the children of a group one after the other, in
//! the order in which a walk meets them.

use super::NONE;
use super::bounds::Bounds;
use super::group::Member;
use super::tree::Tree;
use std::ops::Range;

/// A group or object where its parent has it: all that a walk reads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Slot {
    pub bounds: Bounds,
    pub omega: f32,
    /// First slot of the children.
    pub first: u32,
    /// Number of the children; 0 for an object.
    pub count: u32,
    /// Number of the group or object.
    pub id: u32,
}

impl Slot {
    pub fn member(&self) -> Member {
        match self.count {
            0 => Member::Object(self.id),
            _ => Member::Group(self.id),
        }
    }

    pub fn children(&self) -> Range<usize> {
        self.first as usize..self.first as usize + self.count as usize
    }
}

impl Tree {
    /// Lays the tree out anew, root by root and level by level, without gaps.
    pub(super) fn lay_out(&mut self) {
        let roots = self.root_slots().to_vec();
        let mut slots = Vec::with_capacity(self.slots.len());
        slots.extend(&roots);
        let mut next = 0;
        while next < slots.len() {
            let slot: Slot = slots[next];
            if slot.count > 0 {
                slots[next].first = slots.len() as u32;
                slots.extend_from_slice(&self.slots[slot.children()]);
            }
            next += 1;
        }
        self.slots = slots;
        self.roots = 0..roots.len() as u32;
        self.garbage = 0;
        for slot in 0..self.slots.len() {
            self.note_place(slot);
        }
    }

    /// Writes `slots` one after the other to where nothing lies, and tells where.
    pub(super) fn append(&mut self, slots: &[Slot]) -> Range<u32> {
        let first = self.slots.len();
        self.slots.extend_from_slice(slots);
        (first..self.slots.len()).for_each(|slot| self.note_place(slot));
        first as u32..self.slots.len() as u32
    }

    fn note_place(&mut self, slot: usize) {
        let Slot { count, id, .. } = self.slots[slot];
        let place = match count {
            0 => &mut self.object_slots[id as usize],
            _ => &mut self.groups[id as usize].slot,
        };
        *place = slot as u32;
    }

    pub(super) fn root_slots(&self) -> &[Slot] {
        &self.slots[self.roots.start as usize..self.roots.end as usize]
    }

    pub(super) fn slot_of(&self, member: Member) -> Option<&Slot> {
        let slot = match member {
            Member::Object(id) => *self.object_slots.get(id as usize)?,
            Member::Group(id) => self.groups.get(id as usize)?.slot,
        };
        (slot != NONE).then(|| &self.slots[slot as usize])
    }
}
