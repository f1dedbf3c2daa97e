//! What a tree tells of its groups.

use super::NONE;
use super::bounds::Bounds;
use super::object::Object;
use super::omega::OmegaOptions;
use super::slots::Slot;
use super::tree::Tree;

/// A group or an object, by number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Member {
    /// A group of the tree.
    Group(u32),
    /// An object, numbered in the order in which they came into the tree.
    Object(u32),
}

/// A group of a [`Tree`].
#[derive(Debug, Clone, Copy)]
pub struct Group<'a> {
    tree: &'a Tree,
    id: u32,
}

impl<'a> Group<'a> {
    fn slot(&self) -> &'a Slot {
        &self.tree.slots[self.tree.groups[self.id as usize].slot as usize]
    }

    /// Its number, which it keeps until an update lists it as removed.
    #[must_use]
    pub fn id(&self) -> u32 {
        self.id
    }

    /// Greatest Omega0 of a merge in it or in a group below: from the distance
    /// [`OmegaOptions::distance`](super::OmegaOptions::distance) it is one thing
    /// to whoever takes no note of less. Never less than that of a group below.
    #[must_use]
    pub fn omega0(&self) -> f64 {
        f64::from(self.slot().omega)
    }

    /// What is perceived of it as a whole.
    #[must_use]
    pub fn object(&self) -> &'a Object {
        &self.tree.groups[self.id as usize].object
    }

    /// Box around all that is in it.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        self.object().bounds
    }

    /// The group that it is a child of; `None` for a root.
    #[must_use]
    pub fn parent(&self) -> Option<u32> {
        let parent = self.tree.groups[self.id as usize].parent;
        (parent != NONE).then_some(parent)
    }

    /// Groups and objects it consists of, at least two.
    pub fn children(&self) -> impl ExactSizeIterator<Item = Member> + 'a {
        let children = &self.tree.slots[self.slot().children()];
        children.iter().map(Slot::member)
    }

    /// Number of objects in it and in all groups below.
    #[must_use]
    pub fn object_count(&self) -> usize {
        self.tree.groups[self.id as usize].objects as usize
    }

    /// The objects in it and in all groups below, in the order of the tree.
    pub fn objects(&self) -> impl Iterator<Item = u32> + 'a {
        let tree = self.tree;
        let mut open = vec![self.slot()];
        std::iter::from_fn(move || {
            loop {
                let slot = open.pop()?;
                if slot.count == 0 {
                    return Some(slot.id);
                }
                open.extend(tree.slots[slot.children()].iter().rev());
            }
        })
    }
}

impl Tree {
    /// A group by number; `None` if there is none of this number (any more).
    #[must_use]
    pub fn group(&self, id: u32) -> Option<Group<'_>> {
        let found = self.groups.get(id as usize)?;
        (found.slot != NONE).then_some(Group { tree: self, id })
    }

    /// An object by number; `None` if there is none of this number (any more).
    #[must_use]
    pub fn object(&self, id: u32) -> Option<&Object> {
        let slot = *self.object_slots.get(id as usize)?;
        (slot != NONE).then(|| &self.objects[id as usize])
    }

    /// The group that an object is a child of.
    #[must_use]
    pub fn parent_of_object(&self, id: u32) -> Option<u32> {
        let parent = *self.object_parents.get(id as usize)?;
        (parent != NONE).then_some(parent)
    }

    /// The measure by which it was built.
    #[must_use]
    pub fn omega(&self) -> &OmegaOptions {
        &self.omega
    }

    /// Box around everything; `None` around nothing.
    #[must_use]
    pub fn bounds(&self) -> Option<Bounds> {
        let roots = self.root_slots().iter().map(|slot| slot.bounds);
        roots.reduce(|a, b| a.union(&b))
    }

    /// Groups and objects that are in no group.
    pub fn roots(&self) -> impl ExactSizeIterator<Item = Member> {
        self.root_slots().iter().map(Slot::member)
    }

    /// Numbers of all groups, children before their parents.
    #[must_use]
    pub fn bottom_up(&self) -> Vec<u32> {
        let mut found = Vec::new();
        let mut open: Vec<&Slot> = self.root_slots().iter().collect();
        while let Some(slot) = open.pop() {
            if slot.count > 0 {
                found.push(slot.id);
                open.extend(&self.slots[slot.children()]);
            }
        }
        found.reverse();
        found
    }

    /// One more than the greatest number of a group: the length of a table that
    /// has an entry for every group.
    #[must_use]
    pub fn group_capacity(&self) -> usize {
        self.groups.len()
    }

    /// Number of groups.
    #[must_use]
    pub fn group_count(&self) -> usize {
        self.groups.len() - self.free.len()
    }

    /// One more than the greatest number of an object.
    #[must_use]
    pub fn object_capacity(&self) -> usize {
        self.objects.len()
    }

    /// Number of objects.
    #[must_use]
    pub fn object_count(&self) -> usize {
        self.object_count
    }
}
