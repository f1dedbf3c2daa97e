//! What is written down of collapses, so that they can be done again.

use super::block::Block;
use super::level::Level;
use super::price::Offer;
use glam::Vec3;
use rayon::prelude::*;

/// Where the point that stays comes to lie.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Place {
    /// Where it was.
    Kept,
    /// Where the one that goes was.
    Removed,
    /// Elsewhere.
    New(Vec3),
}

impl Place {
    /// Multiplies a place by a power of two.
    pub fn scale(&mut self, factor: f32) {
        if let Self::New(place) = self {
            *place *= factor;
        }
    }
}

/// A collapse that was done.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Collapse {
    /// Point that stays.
    pub kept: u32,
    /// Point that goes.
    pub removed: u32,
    pub place: Place,
}

/// A collapse within a block, and when it was done.
#[derive(Debug, Clone, Copy)]
pub(super) struct Note {
    round: u32,
    cost: f32,
    collapse: Collapse,
}

impl Block {
    /// Writes a collapse down, if asked for, before it is done.
    #[inline(always)]
    pub fn note(&mut self, offer: &Offer) {
        if self.rules.log {
            let note = self.noted(offer);
            self.notes.push(note);
        }
    }

    fn noted(&self, offer: &Offer) -> Note {
        let is_at = |p: u32| offer.place == self.position[p as usize];
        let place = match (is_at(offer.kept), is_at(offer.removed)) {
            (true, _) => Place::Kept,
            (_, true) => Place::Removed,
            _ => Place::New(offer.place),
        };
        Note {
            round: self.round,
            cost: offer.cost.max(0.0),
            collapse: Collapse {
                kept: offer.kept,
                removed: offer.removed,
                place,
            },
        }
    }
}

/// The notes of all blocks of one phase.
#[derive(Debug, Default)]
pub(super) struct Notes(Vec<Note>);

impl Notes {
    /// Adds those of a block of this level.
    pub fn add(&mut self, block: &Block, from: &Level) {
        let origin = |p: u32| {
            let global = block.global[p as usize];
            let origin = from.origin.get(global as usize);
            origin.copied().unwrap_or(global)
        };
        let mut last = (0, 0.0f32);
        for note in &block.notes {
            // Within a round no cheaper than the one before: sorted by cost,
            // the collapses of a block then stay in their order.
            let least = if note.round == last.0 { last.1 } else { 0.0 };
            last = (note.round, note.cost.max(least));
            self.0.push(Note {
                cost: last.1,
                collapse: Collapse {
                    kept: origin(note.collapse.kept),
                    removed: origin(note.collapse.removed),
                    ..note.collapse
                },
                ..*note
            });
        }
    }

    /// Appends the collapses to those of the phases before: round by round,
    /// and as if every round had been one queue over all blocks. Those of
    /// different blocks do not touch each other, so that any order between
    /// them will do.
    pub fn after(mut self, mut before: Vec<Collapse>) -> Vec<Collapse> {
        let key = |note: &Note| (note.round, note.cost.to_bits());
        self.0.par_sort_by_key(key);
        before.extend(self.0.iter().map(|note| note.collapse));
        before
    }
}
