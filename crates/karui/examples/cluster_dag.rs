//! A cluster DAG of made-up land, and what there is in it:
//! `cargo run --release -p karui --example cluster_dag -- [columns] [rows]`.
#![allow(clippy::print_stdout, reason = "an example shows what it does")]

use karui::geom::{Camera, Vec3};
use karui::hierarchy::cluster::{ClusterDag, ClusterDagOptions, View};
use karui::mesh::{TriMesh, shapes};
use std::time::Instant;

fn main() -> karui::Result<()> {
    let mut numbers = std::env::args().skip(1).filter_map(|a| a.parse().ok());
    let columns = numbers.next().unwrap_or(512);
    let rows = numbers.next().unwrap_or(columns);
    let mesh = shapes::landscape(columns, rows, 7);
    let start = Instant::now();
    let dag = ClusterDag::build(&mesh, &ClusterDagOptions::default())?;
    println!(
        "{} triangles, {:.2} s: {} clusters, {} groups, {} levels, {} triangles in {} roots, stuck {} times, {} bytes",
        mesh.triangles.len(),
        start.elapsed().as_secs_f64(),
        dag.clusters().len(),
        dag.groups().len(),
        dag.levels(),
        dag.triangles_of_roots(),
        dag.roots().len(),
        dag.stuck(),
        dag.bytes(),
    );
    for level in 0..dag.levels() {
        let at = |c: &&karui::hierarchy::cluster::Cluster| usize::from(c.level) == level;
        let own = dag.clusters().iter().filter(at);
        let triangles: usize = own.clone().map(|c| usize::from(c.triangles)).sum();
        let groups = dag
            .groups()
            .iter()
            .filter(|g| usize::from(g.level) == level);
        let errors: Vec<f32> = groups.map(|g| g.bounds.error).collect();
        println!(
            "level {level}: {} clusters of {:.1} triangles; {} groups, largest error {:e}, mean {:e}",
            own.clone().count(),
            triangles as f64 / own.count() as f64,
            errors.len(),
            errors.iter().copied().fold(0.0, f32::max),
            errors.iter().sum::<f32>() / errors.len().max(1) as f32,
        );
    }
    let start = Instant::now();
    let bytes = dag.to_bytes();
    let written = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let again = ClusterDag::from_bytes(&bytes)?;
    println!(
        "{} bytes written in {written:.2} s, read and checked in {:.2} s, equal: {}",
        bytes.len(),
        start.elapsed().as_secs_f64(),
        again == dag,
    );
    for frustum in [false, true] {
        for (place, height, threshold) in
            [("high", 0.3, 1.0), ("low", 0.02, 1.0), ("low", 0.02, 4.0)]
        {
            time_cut(&dag, &mesh, place, height, threshold, frustum)?;
        }
    }
    Ok(())
}

/// From above the middle of one side, so high as a share of its length, towards
/// the middle.
fn time_cut(
    dag: &ClusterDag,
    mesh: &TriMesh,
    place: &str,
    height: f32,
    threshold: f32,
    frustum: bool,
) -> karui::Result<()> {
    let bounds = mesh.bounds();
    let (center, size) = (bounds.center(), bounds.size());
    let eye = Vec3::new(center.x, bounds.max.y + height * size.x, bounds.min.z);
    let camera = Camera {
        eye,
        target: center,
        ..Camera::looking_at(bounds, Vec3::Z, 0.8)
    };
    let view = View {
        threshold,
        frustum,
        backfaces: frustum,
        ..View::new(camera)
    };
    let mut times = Vec::new();
    for _ in 0..51 {
        let start = Instant::now();
        std::hint::black_box(dag.cut(&view)?);
        times.push(start.elapsed().as_secs_f64() * 1e3);
    }
    times.sort_by(f64::total_cmp);
    let cut = dag.cut(&view)?;
    let start = Instant::now();
    let triangles = cut.triangles();
    println!(
        "cut from {place}, {threshold} px, culled: {frustum}: {} clusters, {} triangles, median {:.3} ms (least {:.3}); its indices {:.1} ms",
        cut.clusters().len(),
        triangles.len(),
        times[times.len() / 2],
        times[0],
        start.elapsed().as_secs_f64() * 1e3,
    );
    Ok(())
}
