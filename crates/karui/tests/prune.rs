//! Removal of small parts.

#![allow(clippy::unwrap_used, reason = "a failed unwrap fails the test")]

use glam::Vec3;
use karui::Error;
use karui::mesh::{Components, PositionIds, TriMesh, shapes};
use karui::simplify::{PruneOptions, Pruned, prune};
use proptest::prelude::*;

/// One mesh of several, each scaled and moved.
fn together(parts: &[(TriMesh, f32, Vec3)]) -> TriMesh {
    let mut all = TriMesh::default();
    for (part, scale, place) in parts {
        let first = all.positions.len() as u32;
        all.positions
            .extend(part.positions.iter().map(|p| *p * *scale + *place));
        all.triangles
            .extend(part.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    all
}

/// Spheres of diameters 2, 0.2 and 0.02, far apart.
fn spheres() -> TriMesh {
    let at = |x: f32| Vec3::new(x, 0.0, 0.0);
    let ball = || shapes::icosphere(2);
    together(&[
        (ball(), 0.1, at(3.0)),
        (ball(), 1.0, at(0.0)),
        (ball(), 0.01, at(5.0)),
    ])
}

fn parts(mesh: &TriMesh) -> usize {
    Components::of(mesh, &PositionIds::of_mesh(mesh))
        .unwrap()
        .count
}

fn pruned(mesh: &TriMesh, error: f64) -> Pruned {
    prune(mesh, &PruneOptions::error(error)).unwrap()
}

#[test]
fn parts_up_to_the_bound_go() {
    let mesh = spheres();
    let one = mesh.triangles.len() / 3;
    // The box around a sphere of diameter d has a diagonal of sqrt(3) d.
    for (error, gone, size) in [
        (0.03, 0, 0.0),
        (0.036, 1, 0.02),
        (0.36, 2, 0.2),
        (100.0, 2, 0.2),
    ] {
        let found = pruned(&mesh, error);
        assert_eq!(
            (found.components, found.triangles),
            (gone, gone * one),
            "{error}"
        );
        assert!(
            (found.error - size * 3f64.sqrt()).abs() <= 0.02 * size,
            "{error} {}",
            found.error
        );
        assert!(found.error <= error);
        assert_eq!(parts(&found.mesh), 3 - gone);
        found.mesh.validate().unwrap();
        for (&v, p) in found.vertices.iter().zip(&found.mesh.positions) {
            assert_eq!(mesh.positions[v as usize], *p);
        }
    }
}

#[test]
fn a_share_of_the_diagonal() {
    let mesh = spheres();
    let relative = PruneOptions::relative_error(0.36 / mesh.bounds().diagonal());
    assert_eq!(prune(&mesh, &relative).unwrap(), pruned(&mesh, 0.36));
    // Of two bounds the smaller holds; of none, nothing goes.
    let both = PruneOptions {
        error: Some(0.036),
        ..relative
    };
    assert_eq!(prune(&mesh, &both).unwrap().components, 1);
    assert_eq!(prune(&mesh, &PruneOptions::default()).unwrap().mesh, mesh);
}

#[test]
fn seams_do_not_separate() {
    let cube = shapes::cube(3);
    assert!(cube.attributes.normals.is_some());
    let found = pruned(&cube, 1.5);
    assert_eq!((found.components, found.mesh), (0, cube));
}

#[test]
fn something_is_always_left() {
    for (name, mesh) in shapes::zoo() {
        let found = pruned(&mesh, f64::MAX);
        assert_eq!(
            found.mesh.triangles.is_empty(),
            mesh.triangles.is_empty(),
            "{name}"
        );
        assert_eq!(parts(&found.mesh), parts(&mesh).min(1), "{name}");
        let ranges = |m: &TriMesh| m.ranges.len();
        assert_eq!(ranges(&found.mesh), ranges(&mesh), "{name}");
        found.mesh.validate().unwrap();
    }
}

#[test]
fn nonsense_is_refused() {
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        let found = prune(&shapes::icosphere(1), &PruneOptions::error(bad));
        assert!(matches!(found, Err(Error::BadOption { .. })), "{bad}");
    }
}

proptest! {
    #[test]
    fn what_stays_is_larger_than_what_goes(
        scales in prop::collection::vec(0.01f32..2.0, 1..12),
        error in 0.0f64..4.0,
    ) {
        let place = |i: usize| Vec3::new(0.0, 10.0 * i as f32, 0.0);
        let balls = scales.iter().enumerate().map(|(i, &s)| (shapes::icosphere(1), s, place(i)));
        let mesh = together(&balls.collect::<Vec<_>>());
        let found = pruned(&mesh, error);
        prop_assert_eq!(parts(&found.mesh) + found.components, scales.len());
        prop_assert!(found.error <= error);
        let left = Components::of(&found.mesh, &PositionIds::of_mesh(&found.mesh)).unwrap();
        let sizes: Vec<f64> = left.extract(&found.mesh).unwrap().iter().map(|m| m.bounds().diagonal()).collect();
        prop_assert!(sizes.len() == 1 || sizes.iter().all(|s| *s > error));
    }
}
