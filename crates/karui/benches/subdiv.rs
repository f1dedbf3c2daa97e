//! Speed of subdivision: `cargo bench -p karui --bench subdiv`.
#![allow(missing_docs, reason = "benches are named after what they time")]

use divan::Bencher;
use divan::counter::ItemsCount;
use karui::mesh::shapes;
use karui::subdiv::{Cage, Refinement, Scheme, SubdivOptions, Workspace};

fn main() {
    divan::main();
}

/// A torus of 8,192 quads.
fn torus() -> (Cage, Vec<[f32; 3]>) {
    let (around, across) = (128, 64);
    let mesh = shapes::torus(1.0, 0.4, around, across);
    let at = |i: u32, j: u32| j % across * around + i % around;
    let quads = (0..across).flat_map(|j| {
        (0..around).flat_map(move |i| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)])
    });
    let cage = Cage {
        vertices: mesh.positions.len(),
        offsets: (0..=around * across).map(|f| 4 * f).collect(),
        indices: quads.collect(),
        ..Cage::default()
    };
    (cage, mesh.positions.iter().map(|p| p.to_array()).collect())
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
