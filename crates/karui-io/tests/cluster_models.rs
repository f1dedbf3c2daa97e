//! Cluster DAGs of real models: sound, without cracks, honest about errors,
//! and exported cuts can be read again.
#![allow(clippy::unwrap_used, reason = "a failed unwrap fails the test")]
#![allow(clippy::print_stdout, reason = "figures, and what is skipped")]

mod common;

use common::models;
use karui::TriMesh;
use karui::geom::{Camera, Vec3};
use karui::hierarchy::cluster::{ClusterDag, ClusterDagOptions, Cut, View};
use karui::mesh::{NamedMesh, Node, PositionIds, Scene};
use karui::metrics::{Samples, SurfaceDistanceOptions, surface_distance};
use karui::simplify::{SimplifyOptions, Stop, simplify};
use std::collections::BTreeSet;
use std::time::Instant;

/// Files, and the largest share of triangles that the roots may have.
const FILES: [(&str, f64); 12] = [
    ("scans/bun_zipper.ply.gz", 0.01),
    ("scans/dragon_vrip.ply.gz", 0.01),
    ("scans/boot.obj", 0.01),
    ("gltf/FlightHelmet/FlightHelmet.gltf", 0.05),
    ("gltf/DragonAttenuation.glb", 0.1),
    ("gltf/2CylinderEngine.glb", 0.2),
    ("gltf/many-cubes.gltf", 1.0),
    ("gltf/CesiumMan.glb", 0.2),
    ("hard/sponza.obj.gz", 0.2),
    ("hard/bones.off", 0.2),
    ("hard/elephant-with-holes.off", 0.2),
    ("hard/tetra_intersected_by_triangle.off", 1.0),
];

fn mesh_of(file: &std::path::Path) -> TriMesh {
    let scene = karui_io::read(file).unwrap();
    scene.into_single_mesh().unwrap()
}

#[test]
fn graphs_of_real_models_hold() {
    let Some(folder) = models() else { return };
    for (file, most) in FILES.iter().filter(|f| folder.join(f.0).is_file()) {
        let mesh = mesh_of(&folder.join(file));
        let start = Instant::now();
        let dag = ClusterDag::build(&mesh, &ClusterDagOptions::default()).unwrap();
        let seconds = start.elapsed().as_secs_f64();
        let fine = dag.clusters().iter().filter(|c| c.level == 0).count();
        let share = dag.triangles_of_roots() as f64 / mesh.triangles.len() as f64;
        println!(
            "{file}: {} triangles, {seconds:.2} s, {} clusters, {:.1} triangles each at level 0, {} levels, {} roots with {:.3} %, stuck {} times",
            mesh.triangles.len(),
            dag.clusters().len(),
            mesh.triangles.len() as f64 / fine as f64,
            dag.levels(),
            dag.roots().len(),
            100.0 * share,
            dag.stuck(),
        );
        assert!(share <= *most, "{file}: {share}");
        dag.validate_for(&mesh)
            .unwrap_or_else(|e| panic!("{file}: {e}"));
        assert_eq!(ClusterDag::from_bytes(&dag.to_bytes()).unwrap(), dag);
        check_cuts(file, &mesh, &dag);
    }
}

fn check_cuts(file: &str, mesh: &TriMesh, dag: &ClusterDag) {
    // Where three triangles meet in an edge, one may go and leave a border.
    let ends = odd_edges(mesh, &mesh.triangles).into_iter();
    let ends: BTreeSet<u32> = ends.flat_map(|(a, b, _)| [a, b]).collect();
    let mut camera = Camera::looking_at(mesh.bounds(), Vec3::new(0.4, 0.3, 1.0), 0.8);
    for nearer in [3.0, 0.5, 0.5, 0.2] {
        camera.eye = camera.target + (camera.eye - camera.target) * nearer;
        let cut = dag.cut(&View::new(camera)).unwrap();
        let edges = odd_edges(mesh, &cut.triangles()).into_iter();
        for (a, b, _) in edges.filter(|e| e.2 % 2 == 1) {
            assert!(ends.contains(&a) && ends.contains(&b), "{file}: a crack");
        }
    }
    for share in [3, 15, 100] {
        let cut = dag.cut_to(mesh.triangles.len() / share);
        check_error(file, mesh, &cut);
    }
}

fn check_error(file: &str, mesh: &TriMesh, cut: &Cut<'_>) {
    let coarse = cut.to_mesh(mesh).unwrap();
    coarse.validate().unwrap();
    let options = SurfaceDistanceOptions {
        samples: Samples::Count(50_000),
        ..SurfaceDistanceOptions::default()
    };
    let measured = surface_distance(mesh, &coarse, &options).unwrap();
    let told = f64::from(cut.error());
    let stop = Stop::triangles(cut.triangle_count());
    let plain = simplify(
        mesh,
        &SimplifyOptions {
            stop,
            ..SimplifyOptions::default()
        },
    );
    let plain = plain.unwrap().mesh;
    let least = surface_distance(mesh, &plain, &options).unwrap();
    println!(
        "  {} triangles: told {:.3e}, measured {:.3e} of the diagonal, rms {:.3e}; plain {}: {:.3e}, {:.3e}: {:.2} times",
        coarse.triangles.len(),
        told / measured.diagonal,
        measured.max() / measured.diagonal,
        measured.rms() / measured.diagonal,
        plain.triangles.len(),
        least.max() / measured.diagonal,
        least.rms() / measured.diagonal,
        measured.rms() / least.rms(),
    );
    let slack = 1e-6 * measured.diagonal;
    assert!(
        measured.max() <= told + slack,
        "{file}: {} > {told}",
        measured.max()
    );
}

/// Edges, by position, that have not two triangles, or twice the same, and how
/// many they have.
fn odd_edges(mesh: &TriMesh, triangles: &[[u32; 3]]) -> Vec<(u32, u32, usize)> {
    let linked = PositionIds::of_mesh(mesh).triangles(triangles);
    let is_whole = |[a, b, c]: &&[u32; 3]| a != b && b != c && c != a;
    let whole = linked.iter().filter(is_whole);
    let sides = whole.flat_map(|&[a, b, c]| [(a, b, c), (b, c, a), (c, a, b)]);
    let mut edges: Vec<_> = sides.map(|(a, b, c)| (a.min(b), a.max(b), c)).collect();
    edges.sort_unstable();
    let same = edges.chunk_by(|x, y| (x.0, x.1) == (y.0, y.1));
    let odd = same.filter(|same| same.len() != 2 || same[0] == same[1]);
    odd.map(|same| (same[0].0, same[0].1, same.len())).collect()
}

#[test]
fn a_cut_is_written_and_read_again() {
    let Some(folder) = models() else { return };
    let mesh = mesh_of(&folder.join("scans/bun_zipper.ply.gz"));
    let dag = ClusterDag::build(&mesh, &ClusterDagOptions::default()).unwrap();
    let coarse = dag.cut_to(5000).to_mesh(&mesh).unwrap();
    let scene = Scene {
        meshes: vec![NamedMesh {
            mesh: coarse.clone(),
            ..NamedMesh::default()
        }],
        nodes: vec![Node {
            mesh: Some(0),
            ..Node::default()
        }],
        roots: vec![0],
        ..Scene::default()
    };
    let place = tempfile::tempdir().unwrap();
    let file = place.path().join("cut.glb");
    karui_io::write(&file, &scene).unwrap();
    let again = mesh_of(&file);
    assert_eq!(again.triangles.len(), coarse.triangles.len());
}
