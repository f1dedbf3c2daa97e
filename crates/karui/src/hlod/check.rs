//! Whether a tree holds together.

use super::NONE;
use super::group::Member;
use super::slots::Slot;
use super::tree::Tree;
use crate::error::{Error, Result};

impl Tree {
    /// Checks that every object is in the tree once, children lie inside their
    /// parents, Omega0 does not decrease towards the roots, and parents, counts and
    /// places are right.
    ///
    /// # Errors
    /// [`Error::Broken`] with the number of the object or group.
    pub fn validate(&self) -> Result<()> {
        let mut is_seen = vec![false; self.objects.len()];
        let mut groups = 0;
        let mut open: Vec<(u32, Slot)> = self.root_slots().iter().map(|&s| (NONE, s)).collect();
        while let Some((parent, slot)) = open.pop() {
            self.validate_slot(parent, &slot)?;
            match slot.member() {
                Member::Object(id) => {
                    holds("an object is in the tree once", id, !is_seen[id as usize])?;
                    is_seen[id as usize] = true;
                }
                Member::Group(id) => {
                    groups += 1;
                    let children = &self.slots[slot.children()];
                    open.extend(children.iter().map(|&child| (id, child)));
                }
            }
        }
        for (id, (&slot, &seen)) in (0..).zip(self.object_slots.iter().zip(&is_seen)) {
            holds("every object is in the tree", id, (slot != NONE) == seen)?;
        }
        holds(
            "groups are counted",
            groups,
            groups as usize == self.group_count(),
        )
    }

    fn validate_slot(&self, parent: u32, slot: &Slot) -> Result<()> {
        let id = slot.id;
        let at = self.slot_of(slot.member());
        holds("places are right", id, at == Some(slot))?;
        let object = self.perceived(slot);
        holds("boxes are right", id, slot.bounds == object.bounds)?;
        let noted = match slot.member() {
            Member::Object(id) => self.object_parents[id as usize],
            Member::Group(id) => self.groups[id as usize].parent,
        };
        holds("parents are right", id, noted == parent)?;
        if let Member::Group(id) = slot.member() {
            let counts = self.slots[slot.children()]
                .iter()
                .map(|c| match c.member() {
                    Member::Object(_) => 1,
                    Member::Group(id) => self.groups[id as usize].objects,
                });
            let right = counts.sum::<u32>() == self.groups[id as usize].objects;
            holds("objects below are counted", id, right && slot.count > 1)?;
        }
        let Some(above) = self.slot_of(Member::Group(parent)) else {
            return Ok(());
        };
        let inside = above.bounds.contains(&slot.bounds);
        holds("children lie inside", id, inside)?;
        let rises = above.omega >= slot.omega;
        holds("Omega0 does not decrease towards the roots", id, rises)
    }
}

fn holds(rule: &'static str, id: u32, holds: bool) -> Result<()> {
    let index = id as usize;
    if holds {
        Ok(())
    } else {
        Err(Error::Broken { rule, index })
    }
}
