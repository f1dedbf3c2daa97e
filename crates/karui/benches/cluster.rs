//! Speed of vertex clustering: `cargo bench -p karui --bench cluster`.
#![allow(missing_docs, reason = "benches are named after what they time")]

use divan::Bencher;
use divan::counter::ItemsCount;
use karui::mesh::{Attributes, TriMesh, shapes};
use karui::simplify::{ClusterOptions, Stop, cluster};

fn main() {
    divan::main();
}

fn run(bencher: Bencher<'_, '_>, threads: usize, mesh: &TriMesh, ratio: f64) {
    let options = ClusterOptions {
        stop: Stop::ratio(ratio),
        ..ClusterOptions::default()
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    let Ok(pool) = pool.build() else { return };
    bencher
        .counter(ItemsCount::new(mesh.triangles.len()))
        .bench(|| pool.install(|| cluster(mesh, &options)));
}

/// 2,097,152 triangles without attributes.
#[divan::bench(args = [(1, 0.5), (1, 0.1), (1, 0.01), (2, 0.5), (2, 0.1), (2, 0.01)], sample_count = 5)]
fn terrain(bencher: Bencher<'_, '_>, (threads, ratio): (usize, f64)) {
    let mut mesh = shapes::terrain(1024, 1024, 7);
    mesh.attributes = Attributes::default();
    run(bencher, threads, &mesh, ratio);
}

/// 130,560 triangles with everything a mesh can carry, to 10 %.
#[divan::bench(args = [1, 2], sample_count = 5)]
fn loaded_sphere(bencher: Bencher<'_, '_>, threads: usize) {
    run(bencher, threads, &shapes::loaded_sphere(256, 256), 0.1);
}
