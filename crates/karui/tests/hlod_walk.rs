//! Frames of a walk against the plain recursive definition.

use karui::geom::{Aabb, Camera, DVec3, Vec3};
use karui::hlod::{
    Assets, Bounds, DrawList, Item, Levels, Member, Object, Tree, TreeOptions, View, Walk,
};
use proptest::prelude::*;

/// Objects spread over a field far from the origin.
fn forest(count: u32, origin: DVec3) -> Tree {
    let mut random = 1u64;
    let mut next = || {
        random = random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (random >> 40) as f64 / (1u64 << 24) as f64
    };
    let object = |_| {
        let min = origin + DVec3::new(next() * 200.0, next() * 3.0, next() * 200.0);
        Object {
            bounds: Bounds {
                min,
                max: min + DVec3::new(1.0, 2.0 + next(), 1.0),
            },
            volume: 1.0,
            area: 5.0,
            color: Vec3::new(next() as f32, 0.5, 0.1),
            velocity: Vec3::ZERO,
        }
    };
    Tree::build((0..count).map(object).collect(), &TreeOptions::default()).expect("a tree")
}

struct Scene {
    tree: Tree,
    levels: Vec<Levels>,
    levels_of_object: Vec<u32>,
    proxies: Vec<u32>,
}

impl Scene {
    fn new(tree: Tree) -> Self {
        let levels = |switch: &[f32], triangles: &[u32]| Levels {
            switch: switch.to_vec(),
            triangles: triangles.to_vec(),
        };
        Self {
            levels: vec![levels(&[10.0, 40.0], &[720, 105, 12]), levels(&[], &[40])],
            levels_of_object: (0..tree.object_capacity() as u32).map(|i| i % 2).collect(),
            proxies: (0..tree.group_capacity() as u32)
                .map(|i| 8 + i % 5)
                .collect(),
            tree,
        }
    }

    fn assets(&self) -> Assets<'_> {
        Assets {
            levels: &self.levels,
            levels_of_object: &self.levels_of_object,
            proxies: &self.proxies,
        }
    }

    fn frame(&self, walk: &mut Walk, view: &View) -> DrawList {
        let list = walk
            .frame(&self.tree, view, &self.assets())
            .expect("a frame");
        list.clone()
    }
}

/// The rule, word by word.
fn definition(scene: &Scene, view: &View, member: Member, list: &mut Vec<Item>) {
    let group = match member {
        Member::Group(id) => scene.tree.group(id),
        Member::Object(_) => None,
    };
    let bounds = match member {
        Member::Group(_) => group.expect("a group").bounds(),
        Member::Object(id) => scene.tree.object(id).expect("an object").bounds,
    };
    if view.frustum && outside(view, &bounds) {
        return;
    }
    let eye = view.origin + view.camera.eye.as_dvec3();
    let distance = bounds.distance(eye);
    match (member, group) {
        (Member::Group(id), Some(group)) => {
            let extent = group.omega0().max(view.size * bounds.diagonal());
            if distance > 0.0 && extent / distance < view.threshold {
                list.push(Item::Group(id));
            } else {
                group
                    .children()
                    .for_each(|child| definition(scene, view, child, list));
            }
        }
        (Member::Object(object), _) | (Member::Group(object), None) => {
            let switch = &scene.levels[object as usize % 2].switch;
            let level = switch.iter().filter(|&&s| f64::from(s) <= distance).count() as u32;
            list.push(Item::Object { object, level });
        }
    }
}

/// All corners beyond one plane of clip space, in the camera's coordinates.
fn outside(view: &View, bounds: &Bounds) -> bool {
    let world = view.camera.view_from_world().expect("a view");
    let karui::geom::Projection::Perspective { fov_y } = view.camera.projection else {
        panic!("perspective");
    };
    let up = karui::geom::tan(0.5 * f64::from(fov_y));
    let corners = (0..8).map(|i| {
        let pick = |k: usize| {
            if i >> k & 1 == 1 {
                bounds.max[k]
            } else {
                bounds.min[k]
            }
        };
        world.transform_point3(DVec3::new(pick(0), pick(1), pick(2)) - view.origin)
    });
    let corners: Vec<DVec3> = corners.collect();
    let sides: [&dyn Fn(&DVec3) -> f64; 5] = [
        &|p| up * view.aspect * -p.z - p.x,
        &|p| up * view.aspect * -p.z + p.x,
        &|p| up * -p.z - p.y,
        &|p| up * -p.z + p.y,
        &|p| -p.z,
    ];
    sides
        .iter()
        .any(|side| corners.iter().all(|p| side(p) < 0.0))
}

fn defined(scene: &Scene, view: &View) -> Vec<Item> {
    let mut list = Vec::new();
    scene
        .tree
        .roots()
        .for_each(|root| definition(scene, view, root, &mut list));
    list.sort_unstable();
    list
}

fn sorted(list: &DrawList) -> Vec<Item> {
    let mut items = list.items.clone();
    items.sort_unstable();
    items
}

fn view(eye: [f32; 3], target: [f32; 3]) -> View {
    View::new(Camera {
        eye: Vec3::from(eye),
        target: Vec3::from(target),
        ..Camera::looking_at(Aabb::of([Vec3::ZERO]), Vec3::Z, 0.8)
    })
}

fn place() -> impl Strategy<Value = [f32; 3]> {
    (-50.0f32..250.0, -2.0f32..60.0, -50.0f32..250.0).prop_map(|(x, y, z)| [x, y, z])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn a_frame_is_as_defined(
        count in 0u32..400,
        far in any::<bool>(),
        size in prop::sample::select(vec![0.0, 0.3, 1.0]),
        views in prop::collection::vec((place(), place(), 0.001f64..0.5, any::<bool>()), 1..8),
    ) {
        let origin = if far { DVec3::splat(1e9) } else { DVec3::ZERO };
        let scene = Scene::new(forest(count, origin));
        let mut walk = Walk::default();
        for (eye, target, threshold, frustum) in views {
            let view = View { threshold, frustum, origin, size, ..view(eye, target) };
            let list = scene.frame(&mut walk, &view);
            prop_assert_eq!(sorted(&list), defined(&scene, &view));
            let fresh = scene.frame(&mut Walk::default(), &view);
            prop_assert_eq!(&list, &fresh);
            check_counts(&scene, &list);
        }
    }

    #[test]
    fn a_limit_is_a_higher_threshold(
        eye in place(),
        target in place(),
        limit in 0u64..20_000,
        size in prop::sample::select(vec![0.0, 0.7]),
    ) {
        let scene = Scene::new(forest(300, DVec3::ZERO));
        let limited = View { triangles: Some(limit), threshold: 0.001, size, ..view(eye, target) };
        let mut walk = Walk::default();
        let list = scene.frame(&mut walk, &limited);
        check_counts(&scene, &list);
        let same = View { triangles: None, threshold: list.threshold, ..limited };
        prop_assert_eq!(sorted(&list), sorted(&scene.frame(&mut walk, &same)));
        prop_assert_eq!(list.within_limit, list.counts.triangles <= limit);
        if list.threshold > limited.threshold {
            // A little less, and it would be too much.
            let finer = View { threshold: list.threshold * (1.0 - 1e-12), ..same };
            prop_assert!(scene.frame(&mut walk, &finer).counts.triangles > limit);
        } else {
            let free = View { triangles: None, ..limited };
            prop_assert_eq!(sorted(&list), sorted(&scene.frame(&mut walk, &free)));
        }
    }
}

fn check_counts(scene: &Scene, list: &DrawList) {
    let triangles = list.items.iter().map(|item| match *item {
        Item::Group(id) => u64::from(scene.proxies[id as usize]),
        Item::Object { object, level } => {
            u64::from(scene.levels[object as usize % 2].triangles[level as usize])
        }
    });
    assert_eq!(triangles.sum::<u64>(), list.counts.triangles);
    assert_eq!(list.items.len(), list.counts.groups + list.counts.objects);
}

#[test]
fn hysteresis_keeps_groups_apart_for_a_while() {
    let scene = Scene::new(forest(300, DVec3::ZERO));
    let at = |threshold, hysteresis| View {
        threshold,
        hysteresis,
        frustum: false,
        ..view([-50.0, 10.0, 100.0], [100.0, 0.0, 100.0])
    };
    let mut walk = Walk::default();
    let fine = scene.frame(&mut walk, &at(0.02, 0.2));
    let kept = scene.frame(&mut walk, &at(0.022, 0.2));
    assert_eq!(
        kept,
        DrawList {
            threshold: 0.022,
            ..fine.clone()
        }
    );
    let without = scene.frame(&mut Walk::default(), &at(0.022, 0.0));
    assert!(without.counts.groups + without.counts.objects < fine.items.len());
    let coarse = scene.frame(&mut walk, &at(0.05, 0.2));
    assert!(coarse.items.len() < kept.items.len());
    let never_more = scene.frame(&mut walk, &at(0.05, 0.0));
    let fresh = scene.frame(&mut Walk::default(), &at(0.05, 0.0));
    assert_eq!(never_more, fresh);
}

#[test]
fn what_does_not_fit_is_refused() {
    let scene = Scene::new(forest(20, DVec3::ZERO));
    let good = view([-50.0, 10.0, 100.0], [100.0, 0.0, 100.0]);
    let mut walk = Walk::default();
    let assets = scene.assets();
    for bad in [
        View {
            threshold: f64::NAN,
            ..good
        },
        View {
            hysteresis: 1.0,
            ..good
        },
        View {
            aspect: 0.0,
            ..good
        },
        View {
            origin: DVec3::NAN,
            ..good
        },
        view([0.0; 3], [0.0; 3]),
    ] {
        assert!(walk.frame(&scene.tree, &bad, &assets).is_err(), "{bad:?}");
    }
    let short = Assets {
        proxies: &[],
        ..assets
    };
    assert!(walk.frame(&scene.tree, &good, &short).is_err());
    let short = Assets {
        levels_of_object: &[],
        ..assets
    };
    assert!(walk.frame(&scene.tree, &good, &short).is_err());
    let none = View {
        threshold: 0.0,
        frustum: false,
        ..good
    };
    let missing = Assets {
        levels: &scene.levels[..1],
        ..assets
    };
    assert!(walk.frame(&scene.tree, &none, &missing).is_err());
    let all = walk.frame(&scene.tree, &none, &assets).unwrap();
    assert_eq!((all.counts.objects, all.counts.groups), (20, 0));
}

#[test]
fn a_walk_goes_on_while_the_tree_changes() {
    let mut scene = Scene::new(forest(100, DVec3::ZERO));
    let view = view([-50.0, 10.0, 100.0], [100.0, 0.0, 100.0]);
    let mut walk = Walk::default();
    for i in 0..50 {
        let mut object = *scene.tree.object(i).unwrap();
        object.bounds.min.y += 20.0;
        object.bounds.max.y += 20.0;
        scene.tree.move_object(i, object).unwrap();
        scene = Scene::new(scene.tree);
        let list = scene.frame(&mut walk, &view);
        assert_eq!(sorted(&list), defined(&scene, &view));
    }
}
