//! Speed of surface distance on a mesh of 350 thousand triangles:
//! `cargo bench -p karui --bench surface_distance`

use divan::{Bencher, black_box, counter::ItemsCount};
use karui::TriMesh;
use karui::geom::DVec3;
use karui::mesh::shapes;
use karui::metrics::{
    Samples, Surface, SurfaceDistanceOptions, directed_distance, surface_distance_between,
    vertex_distances_to,
};
use karui::spatial::Bvh;

fn main() {
    divan::main();
}

/// 349,448 triangles.
fn fine() -> TriMesh {
    shapes::terrain(418, 418, 7)
}

/// The same surface with a tenth of the triangles.
fn coarse() -> TriMesh {
    shapes::terrain(132, 132, 7)
}

#[divan::bench(sample_count = 10)]
fn build_bvh(bencher: Bencher) {
    let mesh = fine();
    let items = ItemsCount::new(mesh.triangles.len());
    bencher
        .counter(items)
        .bench(|| Bvh::build(black_box(&mesh)));
}

#[divan::bench(sample_count = 10)]
fn build_bvh_quick(bencher: Bencher) {
    let mesh = fine();
    let items = ItemsCount::new(mesh.triangles.len());
    bencher
        .counter(items)
        .bench(|| Bvh::build_quick(black_box(&mesh)));
}

/// The centres of the coarse faces on the fine mesh, each with the one before
/// it as a hint; one thread.
fn closest(bencher: Bencher, build: fn(&TriMesh) -> karui::error::Result<Bvh>) {
    let (coarse, fine) = (coarse(), build(&fine()).expect("a sound mesh"));
    let centre = |t| coarse.corners(t).iter().sum::<DVec3>() / 3.0;
    let points: Vec<DVec3> = (0..coarse.triangles.len()).map(centre).collect();
    bencher.counter(ItemsCount::new(points.len())).bench(|| {
        let mut hit = fine.closest(points[0]);
        for &point in &points {
            hit = fine.closest_near(point, &hit);
        }
        hit
    });
}

#[divan::bench(sample_count = 10)]
fn closest_to_centres(bencher: Bencher) {
    closest(bencher, Bvh::build);
}

#[divan::bench(sample_count = 10)]
fn closest_to_centres_quick(bencher: Bencher) {
    closest(bencher, Bvh::build_quick);
}

#[divan::bench(sample_count = 10)]
fn build_surface(bencher: Bencher) {
    let mesh = fine();
    let items = ItemsCount::new(mesh.triangles.len());
    bencher
        .counter(items)
        .bench(|| Surface::new(black_box(&mesh)));
}

/// Samples of all kinds, both ways.
#[divan::bench(sample_count = 10)]
fn two_sided(bencher: Bencher) {
    let [fine, coarse] = [fine(), coarse()].map(|mesh| Surface::new(&mesh).expect("a sound mesh"));
    let options = SurfaceDistanceOptions::default();
    let measure = || surface_distance_between(&fine, &coarse, &options).expect("a sound mesh");
    let d = measure();
    let items = ItemsCount::new(d.a_to_b.samples + d.b_to_a.samples);
    bencher.counter(items).bench(measure);
}

/// Samples of the coarse faces against the fine mesh.
#[divan::bench(sample_count = 10)]
fn faces_to_fine(bencher: Bencher) {
    let [coarse, fine] = [coarse(), fine()].map(|mesh| Surface::new(&mesh).expect("a sound mesh"));
    let options = SurfaceDistanceOptions {
        samples: Samples::Count(1_000_000),
        vertices: false,
        edges: false,
        ..Default::default()
    };
    let items = ItemsCount::new(1_000_000u64);
    bencher
        .counter(items)
        .bench(|| directed_distance(&coarse, &fine, &options));
}

#[divan::bench(sample_count = 10)]
fn vertex_map(bencher: Bencher) {
    let (points, to) = (
        fine().positions,
        Bvh::build(&coarse()).expect("a sound mesh"),
    );
    let items = ItemsCount::new(points.len());
    bencher
        .counter(items)
        .bench(|| vertex_distances_to(&points, &to));
}
