//! Which groups and objects to draw, frame by frame (section 3.6, figures 7 and 8).

mod assets;
mod limit;
mod list;
mod view;

pub use assets::{Assets, Levels};
pub use list::{Counts, DrawList, Item};
pub use view::View;

use super::slots::Slot;
use super::tree::Tree;
use crate::error::Result;
use limit::Groups;
use std::ops::Range;
use view::{Eye, Open};

/// State of one view of a [`Tree`]: its draw list, and room to work in.
#[derive(Debug, Clone, Default)]
pub struct Walk {
    list: DrawList,
    open: Vec<(Range<usize>, Open)>,
    groups: Groups,
    /// Number of the frame in which every group was taken apart last.
    taken_apart: Vec<u32>,
    frame: u32,
}

impl Walk {
    /// What to draw: outside the picture nothing; a group whose Omega, seen from
    /// the distance of the eye to its box, is below the threshold as one; of any
    /// other its children. Objects are drawn at the level for their distance. Inside
    /// the box of a group its children are drawn in any case.
    ///
    /// # Errors
    /// [`Error::BadOption`](crate::Error::BadOption) for a view that sees nothing;
    /// [`Error::LengthMismatch`](crate::Error::LengthMismatch) for assets that are
    /// not those of the tree; [`Error::BadReference`](crate::Error::BadReference) for
    /// an object to be drawn whose levels do not exist.
    pub fn frame(&mut self, tree: &Tree, view: &View, assets: &Assets<'_>) -> Result<&DrawList> {
        assets.check(tree)?;
        let sight = Sight {
            eye: Eye::new(view)?,
            tree,
            assets,
            distance: tree.omega.distance,
            size: view.size,
        };
        self.list.restart(view.threshold);
        self.start_frame(tree, view);
        match view.triangles {
            None => self.all(&sight, view)?,
            Some(limit) => self.within(&sight, view, limit)?,
        }
        Ok(&self.list)
    }

    /// What the last frame draws.
    #[must_use]
    pub fn list(&self) -> &DrawList {
        &self.list
    }

    fn start_frame(&mut self, tree: &Tree, view: &View) {
        self.frame = self.frame.wrapping_add(1);
        if view.hysteresis == 0.0 {
            self.taken_apart.clear();
        } else {
            let never = self.frame.wrapping_sub(2);
            self.taken_apart.resize(tree.group_capacity(), never);
        }
    }

    /// Level by level, as the tree lies in memory.
    fn all(&mut self, sight: &Sight<'_>, view: &View) -> Result<()> {
        self.open.clear();
        self.open.push((sight.roots(), sight.eye.all_planes()));
        let mut next = 0;
        while let Some((slots, open)) = self.open.get(next).cloned() {
            next += 1;
            for slot in &sight.tree.slots[slots] {
                self.list.counts.visited += 1;
                let Some(crossed) = sight.eye.crossed(&slot.bounds, open) else {
                    continue;
                };
                let distance = sight.eye.distance(&slot.bounds);
                if slot.count == 0 {
                    let level = sight.assets.level(slot.id, distance)?;
                    self.list.object(slot.id, level);
                } else if sight.omega(slot, distance) < self.threshold(slot, view) {
                    self.list.group(slot.id, sight.proxy(slot));
                } else {
                    self.note_apart(slot);
                    self.open.push((slot.children(), crossed));
                }
            }
        }
        Ok(())
    }

    /// Below what a group is drawn as one.
    fn threshold(&self, group: &Slot, view: &View) -> f64 {
        let last = self.taken_apart.get(group.id as usize);
        if last.is_some_and(|&last| last == self.frame.wrapping_sub(1)) {
            view.threshold * (1.0 - view.hysteresis)
        } else {
            view.threshold
        }
    }

    fn note_apart(&mut self, group: &Slot) {
        if let Some(last) = self.taken_apart.get_mut(group.id as usize) {
            *last = self.frame;
        }
    }
}

/// A tree as it is seen.
struct Sight<'a> {
    eye: Eye,
    tree: &'a Tree,
    assets: &'a Assets<'a>,
    /// L0.
    distance: f64,
    /// [`View::size`].
    size: f64,
}

impl Sight<'_> {
    fn roots(&self) -> Range<usize> {
        self.tree.roots.start as usize..self.tree.roots.end as usize
    }

    /// Omega from this far (equation 11), or the box's share of the view if that is to
    /// count and is more; infinite inside the box.
    #[inline]
    fn omega(&self, group: &Slot, distance: f64) -> f64 {
        if distance <= 0.0 {
            return f64::INFINITY;
        }
        let mut omega = f64::from(group.omega) * self.distance;
        if self.size > 0.0 {
            omega = omega.max(self.size * group.bounds.diagonal());
        }
        omega / distance
    }

    #[inline]
    fn proxy(&self, group: &Slot) -> u32 {
        self.assets.proxies[group.id as usize]
    }
}
