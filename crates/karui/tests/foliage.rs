//! Foliage mode: fewer leaves that cover as much.

#![allow(clippy::unwrap_used, reason = "a failed unwrap fails the test")]

use glam::Vec3;
use karui::geom::area;
use karui::mesh::{TriMesh, shapes};
use karui::simplify::{Foliage, FoliageOptions, SimplifyOptions, Stop, Stopped, foliage, simplify};
use karui::{Error, Progress};
use proptest::prelude::*;

fn options(stop: Stop) -> FoliageOptions<'static> {
    FoliageOptions {
        simplify: SimplifyOptions {
            stop,
            ..SimplifyOptions::default()
        },
        ..FoliageOptions::default()
    }
}

fn to(mesh: &TriMesh, stop: Stop) -> Foliage {
    let coarse = foliage(mesh, &options(stop)).unwrap();
    coarse.mesh.validate().unwrap();
    coarse
}

fn area_of(mesh: &TriMesh) -> f64 {
    (0..mesh.triangles.len())
        .map(|t| area(mesh.corners(t)))
        .sum()
}

/// Share of a square of 80 x 80 pixels around the tree that it covers, seen
/// along an axis.
fn silhouette(mesh: &TriMesh, axis: usize) -> f64 {
    const SIDE: usize = 80;
    let mut covered = vec![false; SIDE * SIDE];
    let flat = |v: u32| {
        let p = mesh.positions[v as usize] - Vec3::new(-1.6, -0.1, -1.6);
        let [x, y] = [p[(axis + 1) % 3], p[(axis + 2) % 3]];
        [x, y].map(|c| f64::from(c) / 3.2 * SIDE as f64)
    };
    let side = |[ax, ay]: [f64; 2], [bx, by]: [f64; 2], x: f64, y: f64| {
        (bx - ax) * (y - ay) - (by - ay) * (x - ax)
    };
    for &t in &mesh.triangles {
        let [a, b, c] = t.map(flat);
        let range = |k: usize| {
            let values = [a[k], b[k], c[k]];
            let least = values.iter().fold(f64::INFINITY, |m, v| m.min(*v)).max(0.0) as usize;
            let most = values
                .iter()
                .fold(0.0f64, |m, v| m.max(*v))
                .min(SIDE as f64 - 1.0) as usize;
            least..=most
        };
        for y in range(1) {
            for x in range(0) {
                let (px, py) = (x as f64 + 0.5, y as f64 + 0.5);
                let sides = [side(a, b, px, py), side(b, c, px, py), side(c, a, px, py)];
                let inside = sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0);
                covered[y * SIDE + x] |= inside;
            }
        }
    }
    covered.iter().filter(|c| **c).count() as f64 / (SIDE * SIDE) as f64
}

#[test]
fn the_area_stays_within_five_percent() {
    for (leaves, seed) in [(2000, 1), (5000, 2), (12_000, 3)] {
        let tree = shapes::tree(leaves, seed);
        for ratio in [0.5, 0.1, 0.05] {
            let target = (ratio * tree.triangles.len() as f64).round() as usize;
            let coarse = to(&tree, Stop::ratio(ratio));
            assert_eq!(coarse.stopped, Stopped::Target, "{leaves} {ratio}");
            let left = coarse.mesh.triangles.len();
            assert!(left <= target && left + 40 >= target, "{left} of {target}");
            let [before, after] = [area_of(&tree), area_of(&coarse.mesh)];
            assert!((after / before - 1.0).abs() < 0.05, "{before} {after}");
            assert_eq!(coarse.area, [before, after]);
        }
    }
}

#[test]
fn the_crown_does_not_thin_out() {
    let tree = shapes::tree(6000, 4);
    let coarse = to(&tree, Stop::ratio(0.1));
    // The same leaves as they were: what mere removal would leave.
    let thinned = foliage(&tree, &options(Stop::ratio(0.1))).unwrap().cards[1];
    for axis in 0..3 {
        let [before, after] = [silhouette(&tree, axis), silhouette(&coarse.mesh, axis)];
        let bare = silhouette(&shapes::tree(thinned as u32, 4), axis);
        println!("axis {axis}: {before:.3} -> {after:.3}, without enlarging {bare:.3}");
        assert!((after / before - 1.0).abs() < 0.15, "{before} {after}");
        assert!(bare < 0.75 * before, "{bare}");
    }
}

#[test]
fn what_stays_is_spread_evenly() {
    let tree = shapes::tree(8000, 5);
    for ratio in [0.3, 0.1, 0.03] {
        let coarse = to(&tree, Stop::ratio(ratio)).mesh;
        let octants = |mesh: &TriMesh| {
            let mut counts = [0usize; 8];
            for t in mesh.ranges[1].triangles() {
                let [a, b, c] = mesh.corners(t);
                let p = (a + b + c) / 3.0;
                let bit = |above: bool, bit: usize| usize::from(above) << bit;
                counts[bit(p.x > 0.0, 0) | bit(p.y > 2.0, 1) | bit(p.z > 0.0, 2)] += 1;
            }
            counts
        };
        let (before, after) = (octants(&tree), octants(&coarse));
        let share = after.iter().sum::<usize>() as f64 / before.iter().sum::<usize>() as f64;
        for (b, a) in before.iter().zip(after) {
            let expected = share * *b as f64;
            assert!(
                (a as f64 - expected).abs() < 0.2 * expected + 4.0,
                "{ratio}: {a} of {expected}"
            );
        }
    }
}

#[test]
fn materials_and_textures_are_kept() {
    let tree = shapes::tree(3000, 6);
    let coarse = to(&tree, Stop::ratio(0.1)).mesh;
    assert_eq!(coarse.ranges.len(), 2);
    assert_eq!(coarse.ranges[1].material, Some(1));
    let uvs = &coarse.attributes.uvs[0];
    for t in coarse.ranges[1].triangles() {
        for v in coarse.triangles[t] {
            let uv = uvs[v as usize];
            assert!(
                [0.0, 1.0].contains(&uv.x) && [0.0, 1.0].contains(&uv.y),
                "{uv}"
            );
        }
    }
    // The trunk gets its share of the triangles, not more.
    let bark = coarse.ranges[0].count as f64;
    assert!((120.0..=192.0).contains(&bark), "{bark}");
}

/// Quads that stand on a square floor of 200 triangles.
fn meadow() -> TriMesh {
    let mut mesh = shapes::grid(10, 10);
    mesh.attributes.uvs.clear();
    for i in 0..400u32 {
        let foot = Vec3::new((i % 20) as f32 + 0.5, 0.0, (i / 20) as f32 + 0.5) / 20.0;
        let first = mesh.positions.len() as u32;
        let corners = [[-1.0, 0.0], [1.0, 0.0], [1.0, 3.0], [-1.0, 3.0]];
        let lift = Vec3::Y * 1e-4;
        let place = |[x, y]: [f32; 2]| foot + Vec3::new(x, y, 0.0) * 0.01 + lift;
        mesh.positions.extend(corners.map(place));
        mesh.triangles
            .extend([[0, 1, 2], [0, 2, 3]].map(|t: [u32; 3]| t.map(|v| v + first)));
    }
    mesh
}

#[test]
fn what_stands_on_something_keeps_standing() {
    let coarse = to(&meadow(), Stop::triangles(100));
    assert_eq!(coarse.cards[0], 400);
    let mut standing = 0;
    for t in 0..coarse.mesh.triangles.len() {
        let lowest = coarse
            .mesh
            .corners(t)
            .iter()
            .map(|c| c.y)
            .fold(f64::INFINITY, f64::min);
        assert!(lowest > -1e-5, "{lowest}");
        let highest = coarse
            .mesh
            .corners(t)
            .iter()
            .map(|c| c.y)
            .fold(0.0, f64::max);
        standing += usize::from(highest > 0.01 && lowest < 1e-3);
    }
    assert_eq!(standing, 2 * coarse.cards[1]);
}

#[test]
fn only_leaves_and_no_leaves() {
    let mut leaves = shapes::tree(500, 7);
    leaves.retain_triangles(|t| t >= 1920);
    let coarse = to(&leaves, Stop::ratio(0.2));
    assert_eq!(
        (coarse.cards, coarse.mesh.triangles.len()),
        ([500, 100], 200)
    );
    assert!(
        (coarse.enlarged - 5f64.sqrt()).abs() < 0.2,
        "{}",
        coarse.enlarged
    );
    let last = to(&leaves, Stop::ratio(0.0));
    assert_eq!((last.cards[1], last.stopped), (1, Stopped::Exhausted));

    let torus = shapes::torus(1.0, 0.3, 40, 20);
    let alone = SimplifyOptions {
        stop: Stop::ratio(0.2),
        ..SimplifyOptions::default()
    };
    let coarse = to(&torus, Stop::ratio(0.2));
    assert!(coarse.mesh == simplify(&torus, &alone).unwrap().mesh);
    assert_eq!(coarse.cards, [0, 0]);
}

#[test]
fn an_error_alone_leaves_the_cards_as_they_are() {
    let tree = shapes::tree(200, 8);
    let coarse = to(&tree, Stop::error(0.01));
    assert_eq!((coarse.cards, coarse.enlarged), ([200, 200], 1.0));
    assert!(coarse.mesh.ranges[0].count < 1000);
    let unchanged = to(&tree, Stop::ratio(1.0));
    assert!(unchanged.mesh == tree);
}

#[test]
fn locked_cards_stay() {
    let tree = shapes::tree(300, 9);
    let mut locks = vec![false; tree.positions.len()];
    let first = tree.triangles[1920 + 17 * 2][0] as usize;
    locks[first] = true;
    let mut options = options(Stop::ratio(0.1));
    options.simplify.locks = Some(&locks);
    let coarse = foliage(&tree, &options).unwrap();
    assert_eq!(coarse.cards[0], 299);
    assert!(coarse.mesh.positions.contains(&tree.positions[first]));
}

#[test]
fn seeds_and_threads() {
    let tree = shapes::tree(2000, 10);
    let run = |threads, seed| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let options = FoliageOptions {
            seed,
            ..options(Stop::ratio(0.1))
        };
        let run = || foliage(&tree, &options).unwrap().mesh;
        pool.build().unwrap().install(run)
    };
    let one = run(1, 0);
    assert!(one == run(2, 0) && one == run(8, 0));
    assert!(one != run(1, 1));
}

#[test]
fn nonsense_is_refused() {
    let refused =
        |options: FoliageOptions<'_>| foliage(&shapes::tree(10, 1), &options).unwrap_err();
    let no_card = FoliageOptions {
        card: 0,
        ..FoliageOptions::default()
    };
    assert!(matches!(refused(no_card), Error::BadOption { .. }));
    assert!(matches!(
        refused(options(Stop::ratio(-1.0))),
        Error::BadOption { .. }
    ));

    struct Impatient;
    impl Progress for Impatient {
        fn report(&self, _: &'static str, _: f32) {}
        fn cancelled(&self) -> bool {
            true
        }
    }
    let mut cancelled = options(Stop::ratio(0.1));
    cancelled.simplify.progress = &Impatient;
    assert_eq!(refused(cancelled), Error::Cancelled);
}

proptest! {
    #[test]
    fn any_soup_stays_valid(
        places in prop::collection::vec((0u8..12, 0u8..12, 0u8..12), 3..80),
        corners in prop::collection::vec((0usize..80, 0usize..80, 0usize..80), 1..120),
        card in 1usize..8,
        target in 0usize..80,
        scale in prop::sample::select(vec![1.0f32, 1e-30, 1e18, 1e37]),
    ) {
        let place = |&(x, y, z): &(u8, u8, u8)| Vec3::new(f32::from(x), f32::from(y), f32::from(z)) * 0.25 * scale;
        let n = places.len();
        let triangles = corners.iter().map(|&(a, b, c)| [a, b, c].map(|v| (v % n) as u32));
        let mesh = TriMesh::new(places.iter().map(place).collect(), triangles.collect());
        let options = FoliageOptions { card, ..options(Stop::triangles(target)) };
        let coarse = foliage(&mesh, &options).unwrap();
        prop_assert!(coarse.mesh.validate().is_ok());
        prop_assert!(coarse.mesh.triangles.len() <= mesh.triangles.len());
        if coarse.stopped == Stopped::Target {
            prop_assert!(coarse.mesh.triangles.len() <= target);
        }
    }
}
