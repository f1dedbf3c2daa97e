//! Speed of cluster DAGs: `cargo bench -p karui --bench cluster_dag`.
#![allow(missing_docs, reason = "benches are named after what they time")]

use divan::Bencher;
use divan::counter::ItemsCount;
use karui::geom::{Camera, Vec3};
use karui::hierarchy::cluster::{ClusterDag, ClusterDagOptions, View};
use karui::mesh::{TriMesh, shapes};

fn main() {
    divan::main();
}

fn build(bencher: Bencher<'_, '_>, threads: usize, mesh: &TriMesh) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    let Ok(pool) = pool.build() else { return };
    let options = ClusterDagOptions::default();
    bencher
        .counter(ItemsCount::new(mesh.triangles.len()))
        .bench(|| pool.install(|| ClusterDag::build(mesh, &options)));
}

/// 2,097,152 triangles without attributes.
#[divan::bench(args = [1, 2], sample_count = 3)]
fn landscape(bencher: Bencher<'_, '_>, threads: usize) {
    build(bencher, threads, &shapes::landscape(1024, 1024, 7));
}

/// 130,560 triangles with everything a mesh can carry.
#[divan::bench(args = [1, 2], sample_count = 3)]
fn loaded_sphere(bencher: Bencher<'_, '_>, threads: usize) {
    build(bencher, threads, &shapes::loaded_sphere(256, 256));
}

fn standing_on(mesh: &TriMesh) -> View<'static> {
    let bounds = mesh.bounds();
    let center = bounds.center();
    View::new(Camera {
        eye: Vec3::new(center.x, bounds.max.y, bounds.min.z),
        target: center,
        ..Camera::looking_at(bounds, Vec3::Z, 0.8)
    })
}

/// One view of 524,288 triangles, everything or what is in the picture.
#[divan::bench(args = [false, true])]
fn cut(bencher: Bencher<'_, '_>, culled: bool) {
    let mesh = shapes::landscape(512, 512, 7);
    let Ok(dag) = ClusterDag::build(&mesh, &ClusterDagOptions::default()) else {
        return;
    };
    let view = View {
        frustum: culled,
        backfaces: culled,
        ..standing_on(&mesh)
    };
    bencher.bench(|| dag.cut(&view));
}

/// The index buffer of one view of 524,288 triangles.
#[divan::bench]
fn indices(bencher: Bencher<'_, '_>) {
    let mesh = shapes::landscape(512, 512, 7);
    let Ok(dag) = ClusterDag::build(&mesh, &ClusterDagOptions::default()) else {
        return;
    };
    let Ok(cut) = dag.cut(&standing_on(&mesh)) else {
        return;
    };
    bencher
        .counter(ItemsCount::new(cut.triangle_count()))
        .bench(|| cut.triangles());
}

/// To bytes and back: 524,288 triangles.
#[divan::bench(args = ["to", "from"])]
fn bytes(bencher: Bencher<'_, '_>, way: &str) {
    let mesh = shapes::landscape(512, 512, 7);
    let Ok(dag) = ClusterDag::build(&mesh, &ClusterDagOptions::default()) else {
        return;
    };
    let bytes = dag.to_bytes();
    match way {
        "to" => bencher.bench(|| dag.to_bytes()),
        _ => bencher.bench(|| ClusterDag::from_bytes(&bytes)),
    }
}
