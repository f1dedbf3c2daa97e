//! Speed of subdivision: `cargo bench -p karui --bench subdiv`.
#![allow(missing_docs, reason = "benches are named after what they time")]

mod cage;

use divan::Bencher;
use divan::counter::ItemsCount;
use karui::geom::Vec3;
use karui::subdiv::{Cage, Refinement, Scheme, SubdivOptions, Workspace};

fn main() {
    divan::main();
}

fn torus() -> (Cage, Vec<[f32; 3]>) {
    let (cage, positions) = cage::torus();
    (cage, positions.iter().map(Vec3::to_array).collect())
}

fn options(levels: u32) -> SubdivOptions {
    SubdivOptions {
        scheme: Scheme::CatmullClark,
        levels,
        ..SubdivOptions::default()
    }
}

#[divan::bench(args = [3, 4, 5], sample_count = 5)]
fn connectivity(bencher: Bencher<'_, '_>, levels: u32) {
    let (cage, _) = torus();
    bencher
        .counter(ItemsCount::new(cage.face_count() << (2 * levels)))
        .bench(|| Refinement::new(&cage, &options(levels)));
}

#[divan::bench(args = [3, 4, 5], sample_count = 20)]
fn positions(bencher: Bencher<'_, '_>, levels: u32) {
    let (cage, cage_positions) = torus();
    let Ok(refinement) = Refinement::new(&cage, &options(levels)) else {
        return;
    };
    let (mut workspace, mut to) = (Workspace::default(), Vec::new());
    bencher
        .counter(ItemsCount::new(refinement.faces().count()))
        .bench_local(|| refinement.evaluate_into(&cage_positions, &mut workspace, &mut to));
}
