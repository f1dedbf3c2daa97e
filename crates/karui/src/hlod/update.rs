//! Objects that move, come and go (section 3.4, item 4).
//!
//! The branch of an object are the groups that it is in. A change takes the groups
//! of its branch apart and groups what hung on them anew, by the rule by which the
//! whole tree was built; groups that hung there stay as they are, with numbers and
//! all. Where a new place is concerned, the branch is that of a neighbour: from the
//! roots down, the child of least Omega0 to the object (the first of several).
//! Where roots stay apart because the thresholds end, roots join in whose gap to
//! the branch alone does not keep them apart.
//!
//! The cost grows with the children of the groups in the branch, and with the roots.

use super::NONE;
use super::bounds::Bounds;
use super::group::Member;
use super::object::Object;
use super::omega::{Seen, between};
use super::slots::Slot;
use super::tree::{Tree, object_slot, within_limit};
use crate::error::{Error, Result};
use crate::progress::Silent;

/// Groups that a change took apart and made. A number may be in both lists: it has
/// been given to a new group.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Updated {
    /// Number of the object.
    pub object: u32,
    /// Numbers of groups that are no more, ascending.
    pub removed: Vec<u32>,
    /// Numbers of groups that are new, ascending.
    pub added: Vec<u32>,
}

impl Tree {
    /// Gives an object another place, shape, colour or velocity; it keeps its
    /// number.
    ///
    /// # Errors
    /// [`Error::BadReference`] if there is no such object; errors of
    /// [`Tree::add_object`]. The tree is unchanged then.
    pub fn move_object(&mut self, id: u32, object: Object) -> Result<Updated> {
        object.check(id as usize)?;
        let taken = self.remove_object(id)?;
        self.objects[id as usize] = object;
        let placed = self.insert(id)?;
        // What was made and taken apart again was never seen.
        let removed = placed.removed.iter().filter(|g| !taken.added.contains(g));
        let removed = removed.chain(&taken.removed).copied().collect();
        let added = taken.added.iter().filter(|g| !placed.removed.contains(g));
        let added = added.chain(&placed.added).copied().collect();
        Ok(Updated::new(id, removed, added))
    }

    /// Adds an object and tells its number: one more than the greatest so far.
    ///
    /// # Errors
    /// [`Error::NotFinite`] or [`Error::Broken`] as for [`Tree::build`];
    /// [`Error::TooLarge`].
    pub fn add_object(&mut self, object: Object) -> Result<Updated> {
        let id = self.objects.len();
        object.check(id)?;
        within_limit(id + 1)?;
        self.objects.push(object);
        self.object_slots.push(NONE);
        self.object_parents.push(NONE);
        self.insert(id as u32)
    }

    /// Removes an object. Its number is not given again.
    ///
    /// # Errors
    /// [`Error::BadReference`] if there is no such object.
    pub fn remove_object(&mut self, id: u32) -> Result<Updated> {
        if self.object(id).is_none() {
            return Err(Error::BadReference {
                what: "change of a tree",
                index: 0,
                target: "object",
                to: id as usize,
                problem: "does not exist",
            });
        }
        let path = self.path(self.object_parents[id as usize]);
        let mut apart = self.take_apart(&path, Member::Object(id));
        apart.pieces.retain(|p| p.member() != Member::Object(id));
        self.object_slots[id as usize] = NONE;
        self.object_parents[id as usize] = NONE;
        self.object_count -= 1;
        self.put_together(id, path, apart)
    }

    fn insert(&mut self, id: u32) -> Result<Updated> {
        let object = self.objects[id as usize];
        let neighbour = self.neighbour(&object);
        let path = match neighbour {
            Some(near) => self.path(self.object_parents[near as usize]),
            None => Vec::new(),
        };
        let mut apart = match neighbour {
            Some(near) => self.take_apart(&path, Member::Object(near)),
            None => Apart::default(),
        };
        apart.pieces.push(object_slot(&object, id));
        self.object_count += 1;
        self.put_together(id, path, apart)
    }

    /// The object at the end of the way down along the least Omega0.
    fn neighbour(&self, object: &Object) -> Option<u32> {
        let seen = Seen::new(*object, &self.omega);
        let omega = |slot: &Slot| {
            let other = Seen::new(*self.perceived(slot), &self.omega);
            between(&seen, &other, &self.omega)
        };
        let mut level = self.root_slots();
        loop {
            let least = level.iter().map(|slot| (omega(slot), slot));
            let (_, slot) = least.min_by(|a, b| a.0.total_cmp(&b.0))?;
            if slot.count == 0 {
                return Some(slot.id);
            }
            level = &self.slots[slot.children()];
        }
    }

    /// A group and all it is in, the root last.
    fn path(&self, group: u32) -> Vec<u32> {
        let is_group = |&group: &u32| group != NONE;
        let parent = |&group: &u32| Some(self.groups[group as usize].parent).filter(is_group);
        std::iter::successors(Some(group).filter(is_group), parent).collect()
    }

    /// What hangs on the groups of `path`, or `alone` if there are none; and the
    /// roots, but for that of the path and those that the pieces may reach.
    fn take_apart(&self, path: &[u32], alone: Member) -> Apart {
        let root = path.last().map_or(alone, |&root| Member::Group(root));
        let mut pieces: Vec<Slot> = Vec::new();
        for (i, &group) in path.iter().enumerate() {
            let inner = i.checked_sub(1).map(|i| Member::Group(path[i]));
            let slot = &self.slots[self.groups[group as usize].slot as usize];
            let children = self.slots[slot.children()].iter();
            pieces.extend(children.filter(|c| Some(c.member()) != inner));
        }
        if path.is_empty() {
            pieces.extend(self.slot_of(alone));
        }
        let roots = self.root_slots().iter();
        let roots = roots.filter(|r| r.member() != root).copied().collect();
        Apart { pieces, roots }
    }

    fn put_together(&mut self, id: u32, path: Vec<u32>, apart: Apart) -> Result<Updated> {
        let Apart { mut pieces, roots } = apart;
        let before = pieces.len();
        let around = pieces.iter().map(|p| p.bounds).reduce(|a, b| a.union(&b));
        let (near, far): (Vec<_>, Vec<_>) = roots
            .into_iter()
            .partition(|root| around.is_some_and(|a| self.may_reach(&a, &root.bounds)));
        pieces.extend(near);
        let left: usize = path.len() + before + self.roots.len();
        for &group in &path {
            self.groups[group as usize].slot = NONE;
        }
        self.free.extend(path.iter().rev());
        let added = self.regroup(&pieces, &Silent)?;
        let made = self.root_slots().to_vec();
        self.garbage += left + made.len();
        let roots: Vec<Slot> = far.into_iter().chain(made).collect();
        self.roots = self.append(&roots);
        if 2 * self.garbage > self.slots.len() {
            self.lay_out();
        }
        Ok(Updated::new(id, path, added))
    }

    /// Whether the gap alone does not keep two roots apart.
    fn may_reach(&self, a: &Bounds, b: &Bounds) -> bool {
        let least = self.omega.proximity * a.gap(b) / self.omega.distance;
        self.steps.limit().is_none_or(|limit| least < limit)
    }
}

impl Updated {
    fn new(object: u32, mut removed: Vec<u32>, mut added: Vec<u32>) -> Self {
        removed.sort_unstable();
        removed.dedup();
        added.sort_unstable();
        added.dedup();
        Self {
            object,
            removed,
            added,
        }
    }
}

/// What is left of a branch.
#[derive(Default)]
struct Apart {
    pieces: Vec<Slot>,
    /// Other roots.
    roots: Vec<Slot>,
}
