//! Walks around real models: every cut a mesh of the input's topology, and back
//! where it began the mesh that it began with.
#![allow(clippy::unwrap_used, reason = "a failed unwrap fails the test")]
#![allow(clippy::print_stdout, reason = "a test that is skipped says so")]

mod common;

use common::models;
use karui::TriMesh;
use karui::geom::{Camera, Light, Vec3};
use karui::hierarchy::{Budget, Hierarchy, HierarchyOptions, ViewAndLight};
use karui::mesh::{Halfedge, PositionIds, RepairOptions, repair};

/// Scans, one with seams, one that is not manifold, one of many parts, CAD.
const MODELS: [&str; 8] = [
    "scans/bun_zipper.ply.gz",
    "scans/armadillo.off.gz",
    "scans/dragon_vrip_res2.ply.gz",
    "scans/skull.obj.gz",
    "gltf/FlightHelmet/FlightHelmet.gltf",
    "gltf/many-cubes.gltf",
    "hard/counter.unitsmm.STL.gz",
    "hard/chair_model.obj",
];

fn view(mesh: &TriMesh, step: u32) -> ViewAndLight {
    let a = 0.9 * step as f32;
    let mut camera = Camera::looking_at(mesh.bounds(), Vec3::new(a.sin(), 0.3, a.cos()), 0.6);
    camera.eye = camera.target + (camera.eye - camera.target) * [1.0, 0.5, 2.0][step as usize % 3];
    ViewAndLight {
        lights: Light::three_points(&camera).unwrap(),
        size: [640, 480],
        camera,
        ..ViewAndLight::default()
    }
}

#[test]
fn walks_around_real_models_hold_together() {
    let Some(folder) = models() else { return };
    for file in MODELS {
        let mesh = karui_io::read(folder.join(file))
            .unwrap()
            .into_single_mesh()
            .unwrap();
        let hierarchy = Hierarchy::build(&mesh, &HierarchyOptions::default()).unwrap();
        hierarchy
            .validate()
            .unwrap_or_else(|e| panic!("{file}: {e}"));
        let mut cut = hierarchy.coarsest();
        let repaired = repair(&mesh, &RepairOptions::default()).unwrap();
        let expected = euler(&repaired.mesh, &repaired.ids);
        let manifold = repaired.counts.split_edges + repaired.counts.split_vertices == 0;
        let mut first = None;
        for step in [0, 1, 2, 3, 4, 0] {
            cut.refine(&view(&mesh, step), Budget::UNLIMITED).unwrap();
            cut.validate().unwrap_or_else(|e| panic!("{file}: {e}"));
            first.get_or_insert_with(|| cut.triangles());
            if manifold {
                let drawn = cut.to_mesh(&mesh).unwrap();
                drawn.validate().unwrap();
                assert_eq!(
                    euler(&drawn, &PositionIds::of_mesh(&drawn)),
                    expected,
                    "{file}"
                );
            }
        }
        assert_eq!(first, Some(cut.triangles()), "{file}");
        let again = Hierarchy::from_bytes(&hierarchy.to_bytes()).unwrap();
        assert!(again == hierarchy && again.is_of(&mesh), "{file}");
    }
}

fn euler(mesh: &TriMesh, ids: &PositionIds) -> i64 {
    Halfedge::of_mesh(mesh, ids).unwrap().euler_characteristic()
}
