//! Speed of simplification: `cargo bench -p karui --bench simplify`.
#![allow(missing_docs, reason = "benches are named after what they time")]

use divan::Bencher;
use divan::counter::ItemsCount;
use karui::TriMesh;
use karui::mesh::shapes;
use karui::simplify::{Cost, Placement, Quality, SimplifyOptions, Stop, simplify};

fn main() {
    divan::main();
}

fn run(bencher: Bencher<'_, '_>, mesh: TriMesh, options: SimplifyOptions<'static>) {
    let options = SimplifyOptions {
        stop: Stop::ratio(0.1),
        ..options
    };
    bencher
        .counter(ItemsCount::new(mesh.triangles.len()))
        .bench(|| simplify(&mesh, &options));
}

/// 20,000 and 80,000 triangles without attributes to 10 %.
#[divan::bench(args = [100, 200], sample_count = 5)]
fn terrain(bencher: Bencher<'_, '_>, side: u32) {
    let mut mesh = shapes::terrain(side, side, 1);
    mesh.attributes = karui::mesh::Attributes::default();
    run(bencher, mesh, SimplifyOptions::default());
}

/// 32,512 triangles with normals, tangents, two UV sets, colours, skin
/// weights, a morph target and two materials to 10 %.
#[divan::bench(sample_count = 5)]
fn loaded_sphere(bencher: Bencher<'_, '_>) {
    let mesh = shapes::loaded_sphere(128, 128);
    run(bencher, mesh, SimplifyOptions::default());
}

#[divan::bench(sample_count = 5)]
fn sphere_accumulated(bencher: Bencher<'_, '_>) {
    let options = SimplifyOptions {
        cost: Cost::Accumulated,
        ..SimplifyOptions::default()
    };
    run(bencher, shapes::icosphere(5), options);
}

#[divan::bench(sample_count = 5)]
fn sphere_half_edge(bencher: Bencher<'_, '_>) {
    let options = SimplifyOptions {
        placement: Placement::HalfEdge,
        ..SimplifyOptions::default()
    };
    run(bencher, shapes::icosphere(5), options);
}

/// 69,696 triangles, equally rough everywhere, to 50, 10 and 1 %.
#[divan::bench(
    args = [
        (Quality::Fast, 0.5), (Quality::Fast, 0.1), (Quality::Fast, 0.01),
        (Quality::Balanced, 0.5), (Quality::Balanced, 0.1), (Quality::Balanced, 0.01),
        (Quality::Exact, 0.1),
    ],
    sample_count = 3,
)]
fn landscape(bencher: Bencher<'_, '_>, (quality, ratio): (Quality, f64)) {
    let mesh = shapes::landscape(264, 132, 7);
    let options = SimplifyOptions {
        stop: Stop::ratio(ratio),
        quality,
        ..SimplifyOptions::default()
    };
    bencher
        .counter(ItemsCount::new(mesh.triangles.len()))
        .bench(|| simplify(&mesh, &options));
}

/// The log of 69,696 triangles to 1 %, played to its end: on the mesh itself,
/// and on a pose, with places found anew. Items are collapses.
#[divan::bench(args = [false, true], sample_count = 5)]
fn replay(bencher: Bencher<'_, '_>, posed: bool) {
    let mut mesh = shapes::landscape(264, 132, 7);
    let options = SimplifyOptions {
        stop: Stop::ratio(0.01),
        log: true,
        ..SimplifyOptions::default()
    };
    let log = simplify(&mesh, &options).ok().and_then(|coarse| coarse.log);
    let Some(log) = log else { return };
    if posed {
        mesh.positions.iter_mut().for_each(|p| p.z += 0.1 * p.x);
    }
    bencher
        .counter(ItemsCount::new(log.len()))
        .bench(|| log.level(&mesh, Stop::default()));
}
