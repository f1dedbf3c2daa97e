//! Speed of mesh saliency: `cargo bench -p karui --bench saliency`.
#![allow(missing_docs, reason = "benches are named after what they time")]

use divan::Bencher;
use divan::counter::ItemsCount;
use karui::mesh::shapes;
use karui::saliency::{MeshSaliencyOptions, mesh_saliency};

fn main() {
    divan::main();
}

/// Rough ground of n x n quads on two threads: the same land, cut ever finer.
#[divan::bench(args = [187, 374, 660, 1320], sample_count = 3)]
fn terrain(bencher: Bencher<'_, '_>, n: u32) {
    let mesh = shapes::terrain(n, n, 7);
    let options = MeshSaliencyOptions::default();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2);
    let Ok(pool) = pool.build() else { return };
    bencher
        .counter(ItemsCount::new(mesh.positions.len()))
        .bench(|| pool.install(|| mesh_saliency(&mesh, &options)));
}
