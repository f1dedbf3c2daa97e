//! Trees of groups that were found by something else than Omega.

use super::group::Member;
use super::levels::Family;
use super::object::Object;
use super::slots::Slot;
use super::tree::{Tree, TreeOptions, within_limit};
use crate::error::{Error, Result};

/// A group that is given; see [`Tree::of_nesting`].
#[derive(Debug, Clone, PartialEq)]
pub struct Nest {
    /// Groups and objects it consists of, at least two; groups by their index in
    /// the list of nests.
    pub children: Vec<Member>,
    /// Its Omega0: 0 or more. What is less than that of a group below counts as
    /// much as that.
    pub omega0: f64,
}

impl Tree {
    /// A tree of groups that are given, children before their parents: an octree,
    /// the storeys of a house. What no group has is a root. Numbers of groups are
    /// their indices.
    ///
    /// Changes of the tree ([`Tree::move_object`] and the like) go by the measure
    /// and the thresholds of `options`.
    ///
    /// # Errors
    /// Those of [`Tree::build`] for objects and options; [`Error::BadReference`] for
    /// a child that does not exist, comes after its parent or already has one;
    /// [`Error::Broken`] for fewer than two children; [`Error::BadOption`] for an
    /// Omega0 that is none; [`Error::TooLarge`] for more than 2^30 groups.
    pub fn of_nesting(
        objects: Vec<Object>,
        nests: &[Nest],
        options: &TreeOptions<'_>,
    ) -> Result<Self> {
        within_limit(nests.len())?;
        let mut tree = Self::unbuilt(objects, options)?;
        let alone: Vec<Slot> = tree.root_slots().to_vec();
        let mut inside = Inside {
            objects: vec![false; alone.len()],
            groups: vec![false; nests.len()],
        };
        let mut groups: Vec<Slot> = Vec::with_capacity(nests.len());
        for (index, nest) in nests.iter().enumerate() {
            check(index, nest)?;
            let mut children = Vec::with_capacity(nest.children.len());
            for &child in &nest.children {
                inside.take(index, child)?;
                children.push(match child {
                    Member::Object(id) => alone[id as usize],
                    Member::Group(id) => groups[id as usize],
                });
            }
            groups.push(tree.nest(index, nest.omega0, &children));
        }
        let objects = alone.iter().zip(&inside.objects);
        let roots = objects.chain(groups.iter().zip(&inside.groups));
        let roots = roots.filter_map(|(slot, taken)| (!taken).then_some(*slot));
        let roots: Vec<Slot> = roots.collect();
        tree.roots = tree.append(&roots);
        tree.lay_out();
        Ok(tree)
    }

    fn nest(&mut self, index: usize, omega0: f64, children: &[Slot]) -> Slot {
        let below = children.iter().map(|c| f64::from(c.omega));
        let family = Family {
            merge: index as u32,
            omega: below.fold(omega0, f64::max),
            children: Vec::new(),
        };
        let mut object = *self.perceived(&children[0]);
        for child in &children[1..] {
            object = object.merged(self.perceived(child));
        }
        self.add_group(object, &family, children)
    }
}

/// What already is in a group.
struct Inside {
    objects: Vec<bool>,
    /// As many as there will be.
    groups: Vec<bool>,
}

impl Inside {
    fn take(&mut self, nest: usize, child: Member) -> Result<()> {
        let (target, id, known) = match child {
            Member::Object(id) => ("object", id, self.objects.get_mut(id as usize)),
            Member::Group(id) => {
                let known = self.groups[..nest].get_mut(id as usize);
                ("group before it", id, known)
            }
        };
        let problem = match known {
            None => "does not exist",
            Some(true) => "is in a group already",
            Some(taken) => {
                *taken = true;
                return Ok(());
            }
        };
        Err(Error::BadReference {
            what: "group",
            index: nest,
            target,
            to: id as usize,
            problem,
        })
    }
}

fn check(index: usize, nest: &Nest) -> Result<()> {
    if nest.children.len() < 2 {
        let rule = "a group has two children at least";
        return Err(Error::Broken { rule, index });
    }
    if !(0.0..=f64::from(f32::MAX)).contains(&nest.omega0) {
        return Err(Error::BadOption {
            option: "omega0",
            found: nest.omega0.to_string(),
            expected: "0 or more, and finite",
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{DVec3, Vec3};
    use crate::hlod::Bounds;

    fn row(count: u32) -> Vec<Object> {
        let object = |i| Object {
            bounds: Bounds {
                min: DVec3::X * f64::from(2 * i),
                max: DVec3::X * f64::from(2 * i) + 1.0,
            },
            volume: 1.0,
            area: 6.0,
            color: Vec3::splat(0.1),
            velocity: Vec3::ZERO,
        };
        (0..count).map(object).collect()
    }

    fn nest(children: &[Member], omega0: f64) -> Nest {
        let children = children.to_vec();
        Nest { children, omega0 }
    }

    fn of(objects: u32, nests: &[Nest]) -> Result<Tree> {
        Tree::of_nesting(row(objects), nests, &TreeOptions::default())
    }

    use Member::{Group as G, Object as O};

    #[test]
    fn groups_are_as_given_and_hold_together() {
        let nests = [
            nest(&[O(3), O(1)], 5.0),
            nest(&[O(0), G(0)], 2.0),
            nest(&[O(4), O(5)], 1.0),
        ];
        let tree = of(7, &nests).unwrap();
        tree.validate().unwrap();
        let roots: Vec<Member> = tree.roots().collect();
        assert_eq!(roots, [O(2), O(6), G(1), G(2)]);
        let group = tree.group(1).unwrap();
        assert_eq!(group.objects().collect::<Vec<_>>(), [0, 3, 1]);
        assert_eq!(group.omega0(), 5.0, "no less than below");
        assert_eq!(group.bounds().max.x, 7.0);
        assert_eq!(tree.group(0).unwrap().parent(), Some(1));
        assert_eq!(tree.bottom_up().len(), 3);
    }

    #[test]
    fn the_tree_that_was_built_comes_out_of_its_own_groups() {
        let tree = Tree::build(row(40), &TreeOptions::default()).unwrap();
        let nest = |id: u32| {
            let group = tree.group(id).unwrap();
            Nest {
                children: group.children().collect(),
                omega0: group.omega0(),
            }
        };
        let count = tree.group_count() as u32;
        let nests: Vec<Nest> = (0..count).map(nest).collect();
        let again = of(40, &nests).unwrap();
        again.validate().unwrap();
        for id in 0..count {
            let [a, b] = [&tree, &again].map(|t| t.group(id).unwrap());
            assert!(a.children().eq(b.children()) && a.omega0() == b.omega0());
            assert_eq!(a.bounds(), b.bounds());
        }
    }

    #[test]
    fn it_can_change_like_any_other() {
        let mut tree = of(4, &[nest(&[O(0), O(1)], 1.0)]).unwrap();
        tree.remove_object(1).unwrap();
        tree.add_object(row(1)[0]).unwrap();
        tree.validate().unwrap();
    }

    #[test]
    fn what_is_no_nesting_is_refused() {
        let good = nest(&[O(0), O(1)], 1.0);
        for bad in [
            nest(&[O(2)], 1.0),
            nest(&[], 1.0),
            nest(&[O(2), O(2)], 1.0),
            nest(&[O(1), O(2)], 1.0),
            nest(&[O(2), O(9)], 1.0),
            nest(&[O(2), G(1)], 1.0),
            nest(&[O(2), G(7)], 1.0),
            nest(&[O(2), O(3)], f64::NAN),
            nest(&[O(2), O(3)], -1.0),
            nest(&[O(2), O(3)], f64::INFINITY),
        ] {
            let found = of(5, &[good.clone(), bad.clone()]);
            assert!(found.is_err(), "{bad:?}");
        }
        assert_eq!(of(0, &[]).unwrap().roots().len(), 0);
    }
}
