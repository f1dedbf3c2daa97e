//! What the paper shows in its chapter 4, experiment by experiment.

use karui::geom::{Aabb, Camera, Vec3};
use karui::hlod::{Assets, Bounds, Counts, Levels, Member, Object, Tree, TreeOptions, View, Walk};

/// Edge of a tree's box, scene units. The paper does not tell the layout of its 32
/// trees; its pictures show a dense stand, and its constants tell the unit: to merge
/// below 0.1 at the reference distance of 5000, no more than a quarter of the box
/// around two equal things may be empty. That no grouping shows below 0.006 is a
/// matter of the least gap, chosen here accordingly; the rest is what comes of it.
const SIZE: f64 = 500.0;

/// 32 trees in 4 rows, the gaps growing along them; five of the mixed ones are red.
fn stand(mixed: bool) -> Vec<Object> {
    let red = [5, 11, 18, 22, 28];
    let object = |i: usize| {
        let gaps = [20.0, 26.0, 34.0, 44.0];
        let along = |k: usize| (0..k).map(|j| SIZE + gaps[j % 4]).sum::<f64>();
        let min = karui::geom::DVec3::new(along(i % 8), 0.0, along(i / 8));
        let bounds = Bounds {
            min,
            max: min + SIZE,
        };
        let is_red = mixed && red.contains(&i);
        Object {
            bounds,
            volume: bounds.volume(),
            area: 6.0 * SIZE * SIZE,
            color: if is_red {
                Vec3::new(0.7, 0.1, 0.2)
            } else {
                Vec3::new(0.1, 0.5, 0.1)
            },
            velocity: Vec3::ZERO,
        }
    };
    (0..32).map(object).collect()
}

/// Triangles drawn from a reference distance: 105 for a tree, 12 for its simplified
/// form beyond 1000, 12 for the box of a group.
fn drawn(tree: &Tree, threshold: f64) -> Counts {
    let levels = [Levels {
        switch: vec![1000.0],
        triangles: vec![105, 12],
    }];
    let proxies = vec![12; tree.group_capacity()];
    let assets = Assets {
        levels: &levels,
        levels_of_object: &[0; 32],
        proxies: &proxies,
    };
    let eye = Vec3::new(2000.0, 800.0, -5000.0);
    let camera = Camera {
        eye,
        target: Vec3::new(2000.0, 250.0, 1000.0),
        ..Camera::looking_at(Aabb::of([Vec3::ZERO]), Vec3::Z, 1.0)
    };
    let view = View {
        threshold,
        ..View::new(camera)
    };
    let mut walk = Walk::default();
    let list = walk.frame(tree, &view, &assets).expect("a frame");
    list.counts
}

fn tree(mixed: bool) -> Tree {
    Tree::build(stand(mixed), &TreeOptions::kato1998()).expect("a tree")
}

/// Figure 10.
#[test]
fn triangles_fall_with_the_threshold_and_less_so_where_colours_are_mixed() {
    let [single, mixed] = [false, true].map(tree);
    let curve = |tree: &Tree| -> Vec<u64> {
        let at = |k: u32| drawn(tree, f64::from(k) * 0.001).triangles;
        (0..=30).map(at).collect()
    };
    let [single, mixed] = [&single, &mixed].map(curve);
    println!("Omega_t  one colour  mixed");
    for (k, (s, m)) in single.iter().zip(&mixed).enumerate() {
        println!("{:.3}    {s:10}  {m:5}", k as f64 * 0.001);
    }
    let simplified_only = 32 * 12;
    assert!(
        single[..6]
            .iter()
            .chain(&mixed[..6])
            .all(|&t| t == simplified_only)
    );
    assert!(single[30] < simplified_only && mixed[30] < simplified_only);
    assert!(single.is_sorted_by(|a, b| a >= b) && mixed.is_sorted_by(|a, b| a >= b));
    assert!(single.iter().zip(&mixed).all(|(s, m)| s <= m));
    assert!(single[30] < mixed[30]);
}

/// Figure 9: "the red trees stay on their own even where grouping has gone far".
#[test]
fn red_trees_stay_apart() {
    let tree = tree(true);
    let red = |id: u32| tree.object(id).unwrap().color.x > 0.5;
    for id in tree.bottom_up() {
        let group = tree.group(id).unwrap();
        let count = group.objects().filter(|&o| red(o)).count();
        assert!(count == 0, "{count} of {}", group.object_count());
    }
    let alone = tree
        .roots()
        .filter(|r| matches!(r, Member::Object(id) if red(*id)));
    assert_eq!(alone.count(), 5);
}

/// Section 4.2: leaves and trunk touch but do not become one.
#[test]
fn leaves_and_trunk_stay_two() {
    let mut parts = stand(false);
    parts.truncate(2);
    let leaves = parts[0];
    let trunk = Object {
        bounds: Bounds {
            min: leaves.bounds.min - karui::geom::DVec3::Y * 300.0,
            max: leaves.bounds.min + 50.0,
        },
        volume: 2e5,
        color: Vec3::new(0.4, 0.25, 0.1),
        ..leaves
    };
    let tree = Tree::build(vec![leaves, parts[1], trunk], &TreeOptions::kato1998()).unwrap();
    let roots: Vec<Member> = tree.roots().collect();
    assert!(roots.contains(&Member::Object(2)), "{roots:?}");
    assert_eq!(tree.group_count(), 1);
}

/// Common fate: what moves with the others belongs to them, what does not leaves.
#[test]
fn what_moves_together_stays_together() {
    let flock = |speeds: [f32; 3]| {
        let mut birds = stand(false);
        birds.truncate(3);
        for (bird, speed) in birds.iter_mut().zip(speeds) {
            bird.velocity = Vec3::X * speed;
        }
        let options = TreeOptions::kato1998();
        Tree::build(birds, &options).unwrap().roots().count()
    };
    assert_eq!(flock([0.0; 3]), 1);
    assert_eq!(flock([9000.0; 3]), 1);
    assert_eq!(flock([9000.0, 9000.0, -9000.0]), 2);
}
