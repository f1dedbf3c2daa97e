//! The tree of groups.

use super::NONE;
use super::agglomerate::agglomerate;
use super::group::Member;
use super::levels::{Family, families};
use super::object::Object;
use super::omega::OmegaOptions;
use super::slots::Slot;
use super::thresholds::{Steps, Thresholds};
use crate::error::{Error, Result};
use crate::progress::{Progress, Silent};
use std::fmt;
use std::ops::Range;

/// How a [`Tree`] is built.
#[derive(Clone, Copy)]
pub struct TreeOptions<'a> {
    /// What makes two things alike.
    pub omega: OmegaOptions,
    /// At which thresholds groups form.
    pub thresholds: Thresholds,
    /// Most children of a group, at least 2. What merges at one threshold is one
    /// group as long as it has no more; beyond, groups of one threshold lie in each
    /// other. Default: 64. `usize::MAX` is the paper's.
    pub children: usize,
    /// Told how far the work is. Default: nobody.
    pub progress: &'a dyn Progress,
}

impl Default for TreeOptions<'_> {
    fn default() -> Self {
        Self {
            omega: OmegaOptions::default(),
            thresholds: Thresholds::default(),
            children: 64,
            progress: &Silent,
        }
    }
}

impl TreeOptions<'_> {
    /// The paper's: its weights, its thresholds, groups of any size.
    #[must_use]
    pub fn kato1998() -> Self {
        Self {
            omega: OmegaOptions::kato1998(),
            thresholds: Thresholds::kato1998(),
            children: usize::MAX,
            ..Self::default()
        }
    }
}

impl fmt::Debug for TreeOptions<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("TreeOptions")
            .field("omega", &self.omega)
            .field("thresholds", &self.thresholds)
            .field("children", &self.children)
            .finish_non_exhaustive()
    }
}

/// Objects in groups in groups. Every object and every group is a child of one
/// group, or a root.
#[derive(Debug, Clone, PartialEq)]
pub struct Tree {
    pub(super) omega: OmegaOptions,
    pub(super) steps: Steps,
    pub(super) most_children: usize,
    pub(super) objects: Vec<Object>,
    /// [`NONE`] for objects that were removed.
    pub(super) object_slots: Vec<u32>,
    /// [`NONE`] for roots.
    pub(super) object_parents: Vec<u32>,
    pub(super) object_count: usize,
    pub(super) groups: Vec<Node>,
    /// Numbers of groups that are not in use.
    pub(super) free: Vec<u32>,
    pub(super) slots: Vec<Slot>,
    /// Slots of the roots.
    pub(super) roots: Range<u32>,
    /// Slots not in use.
    pub(super) garbage: usize,
}

/// A group.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Node {
    pub object: Object,
    /// [`NONE`] for numbers not in use.
    pub slot: u32,
    /// [`NONE`] for roots.
    pub parent: u32,
    /// Objects below.
    pub objects: u32,
}

impl Tree {
    /// Groups `objects`: while the threshold rises, the pair of least Omega0 is
    /// merged as long as it is below. Of several such pairs that comes first whose
    /// newer member is oldest, then that whose older member is. Takes time
    /// proportional to n log n for n objects that lie about evenly.
    ///
    /// # Errors
    /// [`Error::NotFinite`] or [`Error::Broken`] for an object whose numbers are
    /// none, negative or beyond 1e30; [`Error::BadOption`];
    /// [`Error::TooLarge`] for more than 2^30 objects; [`Error::Cancelled`].
    pub fn build(objects: Vec<Object>, options: &TreeOptions<'_>) -> Result<Self> {
        let mut tree = Self::unbuilt(objects, options)?;
        let pieces: Vec<Slot> = tree.root_slots().to_vec();
        tree.regroup(&pieces, options.progress)?;
        tree.lay_out();
        Ok(tree)
    }

    /// Every object on its own, once all is checked.
    pub(super) fn unbuilt(objects: Vec<Object>, options: &TreeOptions<'_>) -> Result<Self> {
        within_limit(objects.len())?;
        let mut checked = objects.iter().enumerate();
        checked.try_for_each(|(i, object)| object.check(i))?;
        options.omega.check()?;
        if options.children < 2 {
            return Err(Error::BadOption {
                option: "children",
                found: options.children.to_string(),
                expected: "at least 2",
            });
        }
        let steps = options
            .thresholds
            .resolved(&objects, options.omega.distance)?;
        Ok(Self::of_roots(objects, options, steps))
    }

    /// Every object on its own.
    fn of_roots(objects: Vec<Object>, options: &TreeOptions<'_>, steps: Steps) -> Self {
        let count = objects.len() as u32;
        let slots = objects.iter().zip(0..).map(|(o, id)| object_slot(o, id));
        Self {
            omega: options.omega,
            steps,
            most_children: options.children,
            slots: slots.collect(),
            object_slots: (0..count).collect(),
            object_parents: vec![NONE; objects.len()],
            object_count: objects.len(),
            objects,
            groups: Vec::new(),
            free: Vec::new(),
            roots: 0..count,
            garbage: 0,
        }
    }

    /// Groups `pieces`, which have no parents, and makes what comes of them the
    /// roots. Tells the numbers of the groups made.
    pub(super) fn regroup(&mut self, pieces: &[Slot], progress: &dyn Progress) -> Result<Vec<u32>> {
        let objects: Vec<Object> = pieces.iter().map(|p| *self.perceived(p)).collect();
        let merges = agglomerate(&objects, &self.omega, self.steps, progress)?;
        drop(objects);
        let below = |piece: usize| f64::from(pieces[piece].omega);
        let families = families(&merges, pieces.len(), self.most_children, below);
        let mut made = Vec::with_capacity(families.len());
        // Where what every merge made came to lie.
        let mut slot_of_merge: Vec<Option<Slot>> = vec![None; merges.len()];
        let mut is_root = vec![true; pieces.len() + merges.len()];
        for family in &families {
            let slot_of = |&cluster: &u32| match (cluster as usize).checked_sub(pieces.len()) {
                None => Some(pieces[cluster as usize]),
                Some(merge) => slot_of_merge[merge],
            };
            let children: Vec<Slot> = family.children.iter().filter_map(slot_of).collect();
            for &child in &family.children {
                is_root[child as usize] = false;
            }
            let object = merges[family.merge as usize].object;
            let slot = self.add_group(object, family, &children);
            made.push(slot.id);
            slot_of_merge[family.merge as usize] = Some(slot);
        }
        let merged = slot_of_merge.into_iter();
        let roots: Vec<Slot> = (pieces.iter().copied().map(Some))
            .chain(merged)
            .zip(is_root)
            .filter_map(|(slot, is_root)| slot.filter(|_| is_root))
            .collect();
        for root in &roots {
            self.set_parent(root.member(), NONE);
        }
        self.roots = self.append(&roots);
        Ok(made)
    }

    pub(super) fn add_group(&mut self, object: Object, family: &Family, children: &[Slot]) -> Slot {
        let range = self.append(children);
        let id = self.free.pop().unwrap_or(self.groups.len() as u32);
        let objects = children.iter().map(|c| self.objects_below(c)).sum();
        let node = Node {
            object,
            slot: NONE,
            parent: NONE,
            objects,
        };
        match self.groups.get_mut(id as usize) {
            Some(group) => *group = node,
            None => self.groups.push(node),
        }
        for child in children {
            self.set_parent(child.member(), id);
        }
        Slot {
            bounds: object.bounds,
            // Rounded the same way everywhere: what does not decrease, still does not.
            omega: (family.omega as f32).min(f32::MAX),
            first: range.start,
            count: children.len() as u32,
            id,
        }
    }

    pub(super) fn set_parent(&mut self, member: Member, parent: u32) {
        match member {
            Member::Object(id) => self.object_parents[id as usize] = parent,
            Member::Group(id) => self.groups[id as usize].parent = parent,
        }
    }

    pub(super) fn perceived(&self, slot: &Slot) -> &Object {
        match slot.member() {
            Member::Object(id) => &self.objects[id as usize],
            Member::Group(id) => &self.groups[id as usize].object,
        }
    }

    fn objects_below(&self, slot: &Slot) -> u32 {
        match slot.member() {
            Member::Object(_) => 1,
            Member::Group(id) => self.groups[id as usize].objects,
        }
    }
}

/// Objects and all merges of them are numbered in 32 bits.
pub(super) fn within_limit(objects: usize) -> Result<()> {
    let limit = 1 << 30;
    if objects > limit {
        let (what, found) = ("objects", objects);
        return Err(Error::TooLarge { what, found, limit });
    }
    Ok(())
}

pub(super) fn object_slot(object: &Object, id: u32) -> Slot {
    Slot {
        bounds: object.bounds,
        omega: 0.0,
        first: 0,
        count: 0,
        id,
    }
}
