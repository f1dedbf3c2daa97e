//! Speed of adaptive subdivision: `cargo bench -p karui --bench adaptive`; real cages: `karui
//! bench adaptive`.
#![allow(missing_docs, reason = "benches are named after what they time")]

mod cage;

use divan::Bencher;
use divan::counter::ItemsCount;
use karui::geom::{Aabb, Camera, Vec3};
use karui::subdiv::SubdivOptions;
use karui::subdiv::adaptive::{Adaptive, AdaptiveMesh, AdaptiveOptions, View};

fn main() {
    divan::main();
}

/// A torus of 8,192 quads, and where it is looked at from.
fn torus() -> (Adaptive, View) {
    let (cage, positions) = cage::torus();
    let bounds = Aabb::of(positions.iter().copied());
    let view = View {
        camera: Camera::looking_at(bounds, Vec3::new(0.3, 1.0, 0.5), 0.6),
        size: [1920, 1080],
        lights: Vec::new(),
    };
    let adaptive = Adaptive::new(&cage, &positions, &SubdivOptions::default());
    (adaptive.expect("a torus is a cage"), view)
}

/// The published depths, from the cage alone and with what other frames have left.
#[divan::bench(args = [false, true], sample_count = 20)]
fn published(bencher: Bencher<'_, '_>, kept: bool) {
    let (mut adaptive, view) = torus();
    let options = AdaptiveOptions::default();
    let empty = adaptive.clone();
    let mut mesh = AdaptiveMesh::default();
    adaptive
        .refine_into(&view, &options, &mut mesh)
        .expect("a good view");
    bencher
        .counter(ItemsCount::new(mesh.mesh.face_count()))
        .bench_local(|| {
            if !kept {
                adaptive = empty.clone();
            }
            adaptive.refine_into(&view, &options, &mut mesh)
        });
}
