//! Speed of grouping: `cargo bench -p karui --bench hlod`; from 1,000 to 1,000,000
//! objects: the example `hlod`.
#![allow(missing_docs, reason = "benches are named after what they time")]

use divan::Bencher;
use divan::counter::ItemsCount;
use karui::geom::{Aabb, Camera, DVec3, Vec3};
use karui::hlod::{Assets, Bounds, Levels, Object, Tree, TreeOptions, View, Walk};

fn main() {
    divan::main();
}

/// Things of four colours, about 3 apart, on a square of so many a side.
fn forest(side: u32) -> Vec<Object> {
    let mixed = |i: u32, k: u32| (i.wrapping_mul(0x9e37_79b9).wrapping_add(k * 77_777) >> 7) % 97;
    let object = |i: u32| {
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| f64::from(mixed(i, k)) / 97.0);
        let min = DVec3::new(
            3.0 * f64::from(i % side) + a,
            0.0,
            3.0 * f64::from(i / side) + b,
        );
        Object {
            bounds: Bounds {
                min,
                max: min + DVec3::new(1.0, 1.0 + 2.0 * c, 1.0),
            },
            volume: 0.5,
            area: 3.0,
            color: Vec3::new((4.0 * d).floor() as f32 / 4.0, 0.4, 0.1),
            velocity: Vec3::ZERO,
        }
    };
    (0..side * side).map(object).collect()
}

#[divan::bench(args = [32, 100, 316], sample_count = 5)]
fn build(bencher: Bencher<'_, '_>, side: u32) {
    let objects = forest(side);
    bencher
        .counter(ItemsCount::new(objects.len()))
        .with_inputs(|| objects.clone())
        .bench_values(|objects| Tree::build(objects, &TreeOptions::default()));
}

/// A frame from within, with a threshold alone and with a limit of triangles.
#[divan::bench(args = [None, Some(50_000)])]
fn frame(bencher: Bencher<'_, '_>, limit: Option<u64>) {
    let Ok(tree) = Tree::build(forest(316), &TreeOptions::default()) else {
        return;
    };
    let levels = [Levels {
        switch: vec![20.0, 60.0],
        triangles: vec![720, 105, 12],
    }];
    let of_object = vec![0; tree.object_capacity()];
    let proxies = vec![12; tree.group_capacity()];
    let assets = Assets {
        levels: &levels,
        levels_of_object: &of_object,
        proxies: &proxies,
    };
    let eye = Vec3::new(300.0, 1.7, 500.0);
    let camera = Camera {
        eye,
        target: eye + Vec3::X,
        ..Camera::looking_at(Aabb::of([Vec3::ZERO]), Vec3::Z, 0.9)
    };
    let view = View {
        triangles: limit,
        ..View::new(camera)
    };
    let mut walk = Walk::default();
    bencher.bench_local(|| {
        walk.frame(&tree, &view, &assets)
            .map(|list| list.items.len())
    });
}

/// One of 100,000 objects moves there and back.
#[divan::bench]
fn move_object(bencher: Bencher<'_, '_>) {
    let Ok(mut tree) = Tree::build(forest(316), &TreeOptions::default()) else {
        return;
    };
    let Some(&object) = tree.object(50_000) else {
        return;
    };
    let mut moved = object;
    moved.bounds.min.x += 5.0;
    moved.bounds.max.x += 5.0;
    let mut places = [moved, object].into_iter().cycle();
    bencher.bench_local(|| tree.move_object(50_000, places.next().unwrap_or(object)));
}
