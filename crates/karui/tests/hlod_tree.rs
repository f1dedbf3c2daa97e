//! Trees of groups against the plain algorithm of the paper, and what must hold
//! after every change.

use karui::geom::{DVec3, Vec3};
use karui::hlod::{
    Bounds, Group, Lengths, Member, Object, OmegaOptions, Thresholds, Tree, TreeOptions, omega0,
};
use karui::{Error, Progress};
use proptest::prelude::*;
use std::time::Instant;

/// A group or object as it is compared: objects by number, groups by what is in
/// them, in order.
#[derive(Debug, Clone, PartialEq)]
enum Plain {
    Object(u32),
    Group(f32, Object, Vec<Plain>),
}

/// A cluster of the plain algorithm.
#[derive(Clone)]
struct Cluster {
    number: usize,
    object: Object,
    omega: f64,
    level: Option<usize>,
    children: Vec<Plain>,
}

impl Cluster {
    fn node(self) -> Plain {
        match self.level {
            None => self.children[0].clone(),
            Some(_) => Plain::Group(self.omega as f32, self.object, self.children),
        }
    }
}

/// Figure 6 as it stands: for every threshold, of all pairs the one of least
/// Omega0, until none is below. O(n^3).
fn plain(objects: &[Object], options: &TreeOptions<'_>, thresholds: &[f64]) -> Vec<Plain> {
    let start = |(number, &object): (usize, &Object)| Cluster {
        number,
        object,
        omega: 0.0,
        level: None,
        children: vec![Plain::Object(number as u32)],
    };
    let mut list: Vec<Cluster> = objects.iter().enumerate().map(start).collect();
    let mut next = list.len();
    for (level, &threshold) in thresholds.iter().enumerate() {
        while let Some((omega, newer, older)) = least(&list, &options.omega) {
            if omega >= threshold {
                break;
            }
            let b = take(&mut list, newer);
            let a = take(&mut list, older);
            list.push(group(a, b, omega, level, next, options.children));
            next += 1;
        }
    }
    list.sort_by_key(|c| c.number);
    list.into_iter().map(Cluster::node).collect()
}

fn take(list: &mut Vec<Cluster>, number: usize) -> Cluster {
    let at = list.iter().position(|c| c.number == number).expect("there");
    list.remove(at)
}

fn least(list: &[Cluster], options: &OmegaOptions) -> Option<(f64, usize, usize)> {
    let mut best: Option<(f64, usize, usize)> = None;
    for a in list {
        for b in list.iter().filter(|b| b.number < a.number) {
            let omega = omega0(&a.object, &b.object, options);
            let pair = (omega, a.number, b.number);
            if best.is_none_or(|best| pair < best) {
                best = Some(pair);
            }
        }
    }
    best
}

fn group(a: Cluster, b: Cluster, omega: f64, level: usize, number: usize, most: usize) -> Cluster {
    let object = a.object.merged(&b.object);
    let omega = omega.max(a.omega).max(b.omega);
    let mut count = 2;
    let mut children = Vec::new();
    for member in [a, b] {
        let more = count - 1 + member.children.len();
        if member.level == Some(level) && more <= most {
            count = more;
            children.extend(member.children);
        } else {
            children.push(member.node());
        }
    }
    Cluster {
        number,
        object,
        omega,
        level: Some(level),
        children,
    }
}

fn found(tree: &Tree) -> Vec<Plain> {
    tree.roots().map(|root| node(tree, root)).collect()
}

fn node(tree: &Tree, member: Member) -> Plain {
    match member {
        Member::Object(id) => Plain::Object(id),
        Member::Group(id) => {
            let group = tree.group(id).expect("a group");
            let children = group.children().map(|child| node(tree, child));
            Plain::Group(group.omega0() as f32, *group.object(), children.collect())
        }
    }
}

/// Few different numbers, so that many pairs are equal.
fn coarse_object() -> impl Strategy<Value = Object> {
    let place = prop::array::uniform3(0u8..6);
    let size = prop::array::uniform3(0u8..3);
    (place, size, 0u8..3, 0u8..3, 0u8..2).prop_map(|(place, size, full, color, speed)| {
        let min = DVec3::from(place.map(f64::from));
        let bounds = Bounds {
            min,
            max: min + DVec3::from(size.map(f64::from)),
        };
        Object {
            bounds,
            volume: bounds.volume() * f64::from(full) / 2.0,
            area: f64::from(full),
            color: Vec3::new(f32::from(color) / 2.0, 0.5, 0.0),
            velocity: Vec3::X * f32::from(speed),
        }
    })
}

fn fine_object() -> impl Strategy<Value = Object> {
    let place = prop::array::uniform3(-50.0..50.0);
    let size = prop::array::uniform3(0.0..4.0);
    let color = prop::array::uniform3(0.0f32..1.0);
    (place, size, 0.0..1.0, color).prop_map(|(place, size, full, color)| {
        let min = DVec3::from(place) + 1e9;
        let bounds = Bounds {
            min,
            max: min + DVec3::from(size),
        };
        Object {
            bounds,
            volume: bounds.volume() * full,
            area: bounds.size().length_squared(),
            color: Vec3::from(color),
            velocity: Vec3::ZERO,
        }
    })
}

fn objects() -> impl Strategy<Value = Vec<Object>> {
    prop_oneof![
        prop::collection::vec(coarse_object(), 0..40),
        prop::collection::vec(fine_object(), 0..40),
        (coarse_object(), 0usize..40).prop_map(|(object, count)| vec![object; count]),
    ]
}

/// Options, and the thresholds they stand for.
fn options() -> impl Strategy<Value = (TreeOptions<'static>, Vec<f64>)> {
    let weights = prop::array::uniform4(prop_oneof![Just(0.0), 0.1..4.0]);
    (weights, any::<bool>(), any::<bool>(), 2usize..9).prop_map(|(weights, pair, all, children)| {
        let [proximity, shape, color, fate] = weights;
        let omega = OmegaOptions {
            proximity,
            shape,
            color,
            fate,
            lengths: if pair { Lengths::Pair } else { Lengths::World },
            ..OmegaOptions::default()
        };
        let doubled = (0..200).map(|k| 0.125 * 2f64.powi(k)).collect();
        let (thresholds, numbers) = match all {
            true => (
                Thresholds::Geometric {
                    first: Some(0.125),
                    ratio: 2.0,
                },
                doubled,
            ),
            false => (
                Thresholds::Arithmetic {
                    first: 0.25,
                    last: 4.0,
                    step: 0.25,
                },
                (1..=16).map(|k| 0.25 * f64::from(k)).collect::<Vec<_>>(),
            ),
        };
        let options = TreeOptions {
            omega,
            thresholds,
            children,
            ..TreeOptions::default()
        };
        (options, numbers)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn the_tree_is_that_of_the_plain_algorithm(
        objects in objects(),
        (options, thresholds) in options(),
    ) {
        let tree = Tree::build(objects.clone(), &options).expect("a tree");
        tree.validate().expect("valid");
        prop_assert_eq!(found(&tree), plain(&objects, &options, &thresholds));
    }

    #[test]
    fn a_changed_tree_holds_together_and_leaves_the_rest_alone(
        objects in objects(),
        (options, _) in options(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), 0u8..3, coarse_object()), 1..20),
    ) {
        let mut tree = Tree::build(objects, &options).expect("a tree");
        for (which, kind, object) in changes {
            let before = tree.clone();
            let there: Vec<u32> = (0..tree.object_capacity() as u32)
                .filter(|&id| tree.object(id).is_some())
                .collect();
            let updated = match kind {
                _ if there.is_empty() => tree.add_object(object),
                0 => tree.add_object(object),
                1 => tree.remove_object(*which.get(&there)),
                _ => tree.move_object(*which.get(&there), object),
            }
            .expect("a change");
            tree.validate().expect("valid");
            for id in before.bottom_up() {
                let (old, new) = (before.group(id), tree.group(id));
                if updated.removed.contains(&id) {
                    prop_assert!(new.is_none() || updated.added.contains(&id));
                } else {
                    let same = old.map(contents) == new.map(contents);
                    prop_assert!(same, "group {} is another", id);
                    prop_assert!(!updated.added.contains(&id));
                }
            }
            let known = |id: &u32| before.group(*id).is_some() || updated.added.contains(id);
            prop_assert!(tree.bottom_up().iter().all(known));
        }
    }

    #[test]
    fn any_number_of_threads_builds_the_same(objects in objects()) {
        let build = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| Tree::build(objects.clone(), &TreeOptions::default()))
        };
        let one = build(1);
        prop_assert!(one == build(2) && one == build(8));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(6))]

    #[test]
    fn larger_trees_are_those_of_the_plain_algorithm(
        objects in prop_oneof![
            prop::collection::vec(coarse_object(), 200..250),
            prop::collection::vec(fine_object(), 200..250),
        ],
        (options, thresholds) in options(),
    ) {
        let tree = Tree::build(objects.clone(), &options).expect("a tree");
        prop_assert_eq!(found(&tree), plain(&objects, &options, &thresholds));
    }
}

fn contents(group: Group<'_>) -> (f64, Object, Vec<Member>, Vec<u32>) {
    (
        group.omega0(),
        *group.object(),
        group.children().collect(),
        group.objects().collect(),
    )
}

fn cube(at: DVec3) -> Object {
    Object {
        bounds: Bounds {
            min: at,
            max: at + 1.0,
        },
        volume: 1.0,
        area: 6.0,
        color: Vec3::splat(0.5),
        velocity: Vec3::ZERO,
    }
}

/// Rows and columns of cubes 3 apart.
fn grid(side: u32) -> Vec<Object> {
    let at = |i: u32| DVec3::new(f64::from(i % side), 0.0, f64::from(i / side)) * 3.0;
    (0..side * side).map(|i| cube(at(i))).collect()
}

#[test]
fn what_hangs_on_a_group_is_told() {
    let tree = Tree::build(grid(10), &TreeOptions::default()).unwrap();
    let order = tree.bottom_up();
    assert_eq!(order.len(), tree.group_count());
    for (i, &id) in order.iter().enumerate() {
        let group = tree.group(id).unwrap();
        let mut count = 0;
        for child in group.children() {
            count += match child {
                Member::Object(object) => {
                    assert_eq!(tree.parent_of_object(object), Some(id));
                    1
                }
                Member::Group(child) => {
                    assert!(order[..i].contains(&child));
                    let child = tree.group(child).unwrap();
                    assert_eq!(child.parent(), Some(id));
                    assert!(child.omega0() <= group.omega0());
                    assert!(group.bounds().contains(&child.bounds()));
                    child.object_count()
                }
            };
        }
        assert!(group.children().len() <= 64);
        assert_eq!(
            (count, group.objects().count()),
            (group.object_count(), count)
        );
    }
    let root = tree.group(*order.last().unwrap()).unwrap();
    assert_eq!((root.parent(), root.object_count()), (None, 100));
    assert_eq!(tree.object(99), Some(&grid(10)[99]));
    assert!(tree.group(1000).is_none() && tree.object(100).is_none());
}

#[test]
fn nothing_and_one_are_trees_as_well() {
    let mut tree = Tree::build(Vec::new(), &TreeOptions::default()).unwrap();
    assert_eq!(tree.roots().count(), 0);
    let updated = tree.add_object(cube(DVec3::ZERO)).unwrap();
    assert_eq!((updated.object, updated.added.len()), (0, 0));
    assert_eq!(tree.roots().collect::<Vec<_>>(), [Member::Object(0)]);
    tree.remove_object(0).unwrap();
    assert_eq!((tree.object_count(), tree.roots().count()), (0, 0));
    assert!(matches!(
        tree.remove_object(0),
        Err(Error::BadReference { .. })
    ));
    tree.validate().unwrap();
}

#[test]
fn what_is_no_object_is_refused() {
    let mut objects = grid(3);
    objects[4].bounds.max.y = f64::NAN;
    let error = Tree::build(objects.clone(), &TreeOptions::default());
    assert!(matches!(error, Err(Error::NotFinite { index: 4, .. })));
    let mut tree = Tree::build(grid(3), &TreeOptions::default()).unwrap();
    let before = tree.clone();
    assert!(tree.move_object(4, objects[4]).is_err());
    assert!(tree.add_object(objects[4]).is_err());
    assert!(tree.move_object(9, grid(1)[0]).is_err());
    assert_eq!(tree, before);
    let one_child = TreeOptions {
        children: 1,
        ..TreeOptions::default()
    };
    assert!(Tree::build(grid(2), &one_child).is_err());
}

struct Stop;

impl Progress for Stop {
    fn report(&self, _: &'static str, _: f32) {}

    fn cancelled(&self) -> bool {
        true
    }
}

#[test]
fn work_can_be_stopped() {
    let options = TreeOptions {
        progress: &Stop,
        ..TreeOptions::default()
    };
    assert_eq!(Tree::build(grid(3), &options), Err(Error::Cancelled));
}

/// Scenes in which everything is equally far from everything, or nearly: whatever
/// looked at all pairs, or at all objects once a merge, would take minutes.
#[test]
fn degenerate_scenes_are_no_trap() {
    let count = 60_000;
    let line = |i: u32| cube(DVec3::new(f64::from(i), 0.0, 0.0));
    let spike = |i: u32| {
        cube(DVec3::new(
            1.1f64.powi((i % 600) as i32),
            f64::from(i / 600),
            0.0,
        ))
    };
    let mut one_white = grid(245);
    one_white[30_000].color = Vec3::ONE;
    let flat = |i: u32| Object {
        bounds: Bounds::point(DVec3::new(f64::from(i % 250), 0.0, f64::from(i / 250))),
        volume: 0.0,
        area: 0.0,
        ..cube(DVec3::ZERO)
    };
    let scenes: [(&str, Vec<Object>); 6] = [
        ("duplicates", vec![cube(DVec3::splat(1e9)); count as usize]),
        ("grid", grid(245)),
        ("line", (0..count).map(line).collect()),
        ("spike", (0..count).map(spike).collect()),
        ("one white", one_white),
        ("points", (0..count).map(flat).collect()),
    ];
    let kato = TreeOptions::kato1998();
    for (name, objects) in scenes {
        for (which, options) in [("default", &TreeOptions::default()), ("kato", &kato)] {
            let start = Instant::now();
            let tree = Tree::build(objects.clone(), options).unwrap();
            println!(
                "{name}, {which}: {:.2} s, {} groups, {} roots",
                start.elapsed().as_secs_f64(),
                tree.group_count(),
                tree.roots().len()
            );
            tree.validate().unwrap();
        }
    }
}

#[test]
fn a_move_far_away_costs_little_and_leaves_most_groups_alone() {
    let mut tree = Tree::build(grid(100), &TreeOptions::default()).unwrap();
    let groups = tree.group_count();
    let updated = tree
        .move_object(5050, cube(DVec3::new(20.5, 4.0, 20.5)))
        .unwrap();
    tree.validate().unwrap();
    assert!(
        updated.removed.len() < groups / 20,
        "{} of {groups}",
        updated.removed.len()
    );
    let parent = tree.parent_of_object(5050).unwrap();
    let near = tree.group(parent).unwrap().bounds();
    assert!(
        near.diagonal() < 40.0,
        "it is among its neighbours: {near:?}"
    );
}
