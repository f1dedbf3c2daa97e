//! Trees of a made-up forest, and how long they and their frames take:
//! `cargo run --release -p karui --example hlod -- [objects ...] [--grid | --duplicates] [--kato]`.
#![allow(clippy::print_stdout, reason = "an example shows what it does")]

use glam::DMat4;
use karui::geom::{Aabb, Camera, DVec3, Vec3};
use karui::hlod::{Assets, Levels, Object, Shape, Tree, TreeOptions, View, Walk};
use karui::{Result, mesh::shapes, render::Model};
use std::time::Instant;

const FRAMES: u32 = 300;

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let has = |name: &str| arguments.iter().any(|a| a == name);
    let mut counts: Vec<usize> = arguments.iter().filter_map(|a| a.parse().ok()).collect();
    if counts.is_empty() {
        counts = vec![1_000, 10_000, 100_000, 1_000_000];
    }
    let options = if has("--kato") {
        TreeOptions::kato1998()
    } else {
        TreeOptions::default()
    };
    for count in counts {
        let objects = match (has("--grid"), has("--duplicates")) {
            (true, _) => grid(count, 3.0)?,
            (_, true) => grid(count, 0.0)?,
            _ => forest(count)?,
        };
        let start = Instant::now();
        let mut tree = Tree::build(objects, &options)?;
        let seconds = start.elapsed().as_secs_f64();
        tree.validate()?;
        let by_n_log_n = 1e9 * seconds / (count as f64 * (count as f64).log2());
        println!(
            "{count} objects: {seconds:.3} s, {by_n_log_n:.1} ns by n log2 n, {} groups, {} roots, peak {} MB",
            tree.group_count(),
            tree.roots().len(),
            peak_memory() / 1000,
        );
        walk(&tree, count)?;
        update(&mut tree)?;
    }
    Ok(())
}

/// Trees of three kinds and four colours, about 3 apart.
fn forest(count: usize) -> Result<Vec<Object>> {
    let mut random = Random(7);
    let shape = Shape::of(&Model::of_mesh(&shapes::icosphere(2)), 0)?;
    let columns = (count as f64).sqrt().ceil() as usize;
    let colors = [
        [0.1, 0.4, 0.1],
        [0.2, 0.5, 0.1],
        [0.5, 0.1, 0.1],
        [0.4, 0.4, 0.1],
    ];
    let object = |i: usize| {
        let (x, z) = ((i % columns) as f64, (i / columns) as f64);
        let jitter = DVec3::new(random.next(), 0.0, random.next()) * 2.5;
        let place = DVec3::new(3.0 * x, 0.0, 3.0 * z) + jitter;
        let scale = DVec3::new(1.0, 1.0 + (random.next() * 3.0).floor(), 1.0);
        let turned = DMat4::from_rotation_y(6.0 * random.next());
        let color = colors[(random.next() * 4.0) as usize % 4];
        Object {
            color: Vec3::from(color),
            ..shape.placed(&(DMat4::from_translation(place) * turned * DMat4::from_scale(scale)))
        }
    };
    Ok((0..count).map(object).collect())
}

/// Equal balls at equal distances.
fn grid(count: usize, distance: f64) -> Result<Vec<Object>> {
    let shape = Shape::of(&Model::of_mesh(&shapes::icosphere(2)), 0)?;
    let columns = (count as f64).sqrt().ceil() as usize;
    let object = |i: usize| {
        let at = DVec3::new((i % columns) as f64, 0.0, (i / columns) as f64);
        shape.placed(&DMat4::from_translation(at * distance))
    };
    Ok((0..count).map(object).collect())
}

/// Once through the middle at the height of a man's eyes.
fn walk(tree: &Tree, count: usize) -> Result<()> {
    let side = 3.0 * (count as f32).sqrt();
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
    for (name, threshold, limit) in [
        ("0.02", 0.02, None),
        ("0.05", 0.05, None),
        ("limit", 0.001, Some(100_000)),
    ] {
        let mut walk = Walk::default();
        let (mut times, mut triangles, mut items) = (Vec::new(), 0, 0);
        for frame in 0..FRAMES {
            let t = frame as f32 / FRAMES as f32;
            let eye = Vec3::new(side * t, 1.7, side * (0.5 + 0.2 * t));
            let ahead = Vec3::new(1.0, -0.02, 0.6 - t);
            let view = View {
                threshold,
                triangles: limit,
                ..View::new(Camera {
                    eye,
                    target: eye + ahead,
                    ..Camera::looking_at(Aabb::of([Vec3::ZERO]), Vec3::Z, 0.9)
                })
            };
            let start = Instant::now();
            let list = walk.frame(tree, &view, &assets)?;
            times.push(start.elapsed().as_secs_f64() * 1e3);
            triangles += list.counts.triangles;
            items += list.items.len() as u64;
        }
        times.sort_unstable_by(f64::total_cmp);
        println!(
            "  threshold {name}: frame {:.3} ms in the middle, {:.3} ms at most, {} items, {} triangles",
            times[times.len() / 2],
            times[times.len() - 1],
            items / u64::from(FRAMES),
            triangles / u64::from(FRAMES),
        );
    }
    Ok(())
}

fn update(tree: &mut Tree) -> Result<()> {
    let count = tree.object_count() as u32;
    let start = Instant::now();
    let mut groups = 0;
    for i in 0..100 {
        let id = i * (count / 100);
        let Some(&object) = tree.object(id) else {
            continue;
        };
        let mut moved = object;
        moved.bounds.min.x += 5.0;
        moved.bounds.max.x += 5.0;
        groups += tree.move_object(id, moved)?.added.len();
    }
    let each = start.elapsed().as_secs_f64() * 1e3 / 100.0;
    println!(
        "  an object moved: {each:.3} ms, {} new groups",
        groups / 100
    );
    tree.validate()
}

/// Greatest memory of the process so far, kB; 0 where the system does not tell.
fn peak_memory() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    peak.and_then(|p| p.trim().trim_end_matches(" kB").parse().ok())
        .unwrap_or(0)
}

/// SplitMix64.
struct Random(u64);

impl Random {
    /// In 0..1.
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ mixed >> 31) >> 40) as f64 / (1u32 << 24) as f64
    }
}
