//! Speed of half-edge hierarchies: `cargo bench -p karui --bench hierarchy`.
#![allow(missing_docs, reason = "benches are named after what they time")]

use divan::Bencher;
use divan::counter::ItemsCount;
use karui::geom::{Camera, turntable_directions};
use karui::hierarchy::{Budget, Hierarchy, HierarchyOptions, ViewAndLight};
use karui::mesh::shapes;

fn main() {
    divan::main();
}

#[divan::bench(args = [187, 374, 660], sample_count = 3)]
fn build(bencher: Bencher<'_, '_>, n: u32) {
    let mesh = shapes::terrain(n, n, 7);
    bencher
        .counter(ItemsCount::new(mesh.triangles.len()))
        .bench(|| Hierarchy::build(&mesh, &HierarchyOptions::default()));
}

/// One frame of a walk once around in 1200: the same land, cut ever finer.
#[divan::bench(args = [187, 374, 660], sample_count = 100)]
fn frame(bencher: Bencher<'_, '_>, n: u32) {
    let mesh = shapes::terrain(n, n, 7);
    let Ok(hierarchy) = Hierarchy::build(&mesh, &HierarchyOptions::default()) else {
        return;
    };
    let mut cut = hierarchy.coarsest();
    let mut directions = turntable_directions(1200, 0.4).into_iter().cycle();
    let mut refine = || {
        let direction = directions.next().unwrap_or_default();
        let criteria = ViewAndLight {
            camera: Camera::looking_at(hierarchy.bounds(), direction, 0.6),
            ..ViewAndLight::default()
        };
        cut.refine(&criteria, Budget::UNLIMITED)
    };
    drop(refine());
    bencher.bench_local(refine);
}
