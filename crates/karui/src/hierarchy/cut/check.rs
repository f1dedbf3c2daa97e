//! Whether a cut is what it should be.

use super::{ACTIVE, Cut};
use crate::error::{Error, Result};
use crate::hierarchy::surface::{NONE, next};

impl Cut<'_> {
    /// Checks the invariants: the visible faces are neighbours of visible faces,
    /// a face has three different corners, every node knows how many it waits for,
    /// and what is not active waits for nothing. Slow; for tests.
    ///
    /// # Errors
    /// [`Error::Broken`] naming the half-edge or node.
    pub fn validate(&self) -> Result<()> {
        self.triangles
            .faces()
            .iter()
            .try_for_each(|&f| self.check_face(f))?;
        let mut waits = vec![0u16; self.state.len()];
        for node in (0..self.state.len() as u32).filter(|&n| self.is_active(n)) {
            for later in self.hierarchy.waiting(node) {
                waits[later as usize] += 1;
            }
        }
        for (id, (&state, &waits)) in self.state.iter().zip(&waits).enumerate() {
            ensure(
                state & !ACTIVE == waits,
                "a node counts what it waits for",
                id,
            )?;
            ensure(
                state & ACTIVE != 0 || waits == 0,
                "a collapse comes after what it waits for",
                id,
            )?;
            ensure(self.is_listed(id as u32), "the front is listed", id)?;
        }
        Ok(())
    }

    /// Whether a node is in the list that it belongs to.
    fn is_listed(&self, id: u32) -> bool {
        let parent = self.hierarchy.nodes[id as usize].parent;
        let exposed = parent == NONE || self.is_active(parent);
        let place = self.place[id as usize] as usize;
        match (self.is_active(id), self.is_collapsible(id), exposed) {
            (true, true, _) => self.collapsible.nodes().get(place) == Some(&id),
            (false, _, true) => self.splittable.nodes().get(place) == Some(&id),
            _ => place == NONE as usize,
        }
    }

    fn check_face(&self, face: u32) -> Result<()> {
        let corner = |h: u32| self.surface.start(h);
        for h in 3 * face..3 * face + 3 {
            ensure(corner(h) != corner(next(h)), "corners differ", h as usize)?;
            let other = self.surface.opposite(h);
            if other == NONE {
                continue;
            }
            let back = self.surface.opposite(other);
            ensure(back == h, "halves know each other", h as usize)?;
            ensure(
                self.triangles.is_visible(other / 3),
                "neighbours are visible",
                h as usize,
            )?;
        }
        Ok(())
    }
}

fn ensure(holds: bool, rule: &'static str, index: usize) -> Result<()> {
    if holds {
        return Ok(());
    }
    Err(Error::Broken { rule, index })
}
