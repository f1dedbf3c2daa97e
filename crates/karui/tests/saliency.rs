//! Curvature and mesh saliency.

#![allow(clippy::unwrap_used, reason = "a failed unwrap fails the test")]

use glam::Vec3;
use karui::Error;
use karui::mesh::{TriMesh, shapes};
use karui::saliency::{Curvature, curvature};

fn scaled(mut mesh: TriMesh, by: f32) -> TriMesh {
    mesh.positions.iter_mut().for_each(|p| *p *= by);
    mesh
}

fn assert_near(found: f64, expected: f64, tolerance: f64, what: &str) {
    let off = (found - expected).abs();
    assert!(off <= tolerance, "{what}: {found}, expected {expected}");
}

/// Away from the poles, which lie on the y axis.
fn is_midway(p: Vec3) -> bool {
    p.normalize().y.abs() < 0.7
}

#[test]
fn spheres_bend_by_one_over_their_radius() {
    for radius in [0.01, 1.0, 250.0] {
        let of = |mesh: TriMesh| scaled(mesh, radius);
        let spheres = [
            shapes::uv_sphere(96, 192),
            shapes::textured_sphere(128, 128),
        ];
        for mesh in spheres.map(of).iter().chain([&of(shapes::icosphere(5))]) {
            let all = curvature(mesh).unwrap();
            for (c, p) in all.iter().zip(&mesh.positions).filter(|c| is_midway(*c.1)) {
                let r = f64::from(radius);
                assert_near(c.k1 * r, 1.0, 0.02, "k1");
                assert_near(c.k2 * r, 1.0, 0.02, "k2");
                assert!(c.directions.iter().all(|d| d.dot(*p).abs() < 0.02 * radius));
            }
        }
    }
}

/// Open, around the y axis, of quads split by diagonals.
fn cylinder(radius: f32, segments: u32, rows: u32) -> TriMesh {
    let mut mesh = shapes::grid(segments, rows);
    for p in &mut mesh.positions {
        let (sin, cos) = (p.x * std::f32::consts::TAU).sin_cos();
        *p = Vec3::new(radius * cos, 6.0 * radius * p.z, radius * sin);
    }
    mesh
}

#[test]
fn a_cylinder_bends_one_way() {
    let mesh = cylinder(2.0, 64, 64);
    let inner = |p: &Vec3| p.y > 0.5 && p.y < 11.5 && p.z.abs() > 0.2;
    let all = curvature(&mesh).unwrap();
    let mut signs = 0.0;
    for (c, p) in all.iter().zip(&mesh.positions).filter(|c| inner(c.1)) {
        let (large, small) = if c.mean() > 0.0 {
            (c.k1, c.k2)
        } else {
            (c.k2, c.k1)
        };
        assert_near(large.abs(), 0.5, 0.01, "around");
        assert_near(small, 0.0, 0.01, "along");
        let along = c.directions[usize::from(c.mean() > 0.0)];
        assert!(along.y.abs() > 0.99, "{along} at {p}");
        signs += c.mean().signum();
    }
    assert!(f64::abs(signs) > 1000.0, "{signs}");
}

#[test]
fn a_plane_does_not_bend_and_its_border_neither() {
    for c in curvature(&shapes::grid(9, 7)).unwrap() {
        assert_eq!((c.k1.abs(), c.k2.abs()), (0.0, 0.0));
    }
}

#[test]
fn a_torus_has_its_closed_form() {
    let (major, minor) = (2.0, 0.7);
    let mesh = shapes::torus(2.0, 0.7, 192, 96);
    for (c, p) in curvature(&mesh).unwrap().iter().zip(&mesh.positions) {
        let out = f64::from(p.x).hypot(f64::from(p.z));
        let around = (out - major) / minor / out;
        assert_near(c.k1, 1.0 / minor, 0.03, "k1");
        assert_near(c.k2, around, 0.03, "k2");
    }
}

/// By position, so that another numbering of vertices does not matter.
fn by_place(mesh: &TriMesh, values: &[Curvature]) -> Vec<([u32; 3], u64)> {
    let bits = |p: Vec3| (p + Vec3::ZERO).to_array().map(f32::to_bits);
    let pairs = mesh.positions.iter().zip(values);
    let mut all: Vec<_> = pairs.map(|(p, c)| (bits(*p), c.mean().to_bits())).collect();
    all.sort_unstable();
    all.dedup();
    all
}

#[test]
fn seams_do_not_matter() {
    let mesh = shapes::torus(2.0, 0.7, 24, 12);
    let mut soup = TriMesh::default();
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        let place = |v: &u32| mesh.positions[*v as usize];
        soup.positions.extend(triangle.iter().map(place));
        soup.triangles.push([0, 1, 2].map(|k| 3 * t as u32 + k));
    }
    let (one, other) = (curvature(&mesh).unwrap(), curvature(&soup).unwrap());
    assert_eq!(by_place(&mesh, &one), by_place(&soup, &other));
}

#[test]
fn curvature_of_anything_is_finite() {
    let mut zoo = shapes::zoo();
    zoo.push(("point", TriMesh::new(vec![Vec3::ONE], vec![])));
    zoo.push(("no area", TriMesh::new(vec![Vec3::ONE; 3], vec![[0, 1, 2]])));
    for (name, mesh) in zoo {
        for by in [1e-30, 1.0, 1e30] {
            let mesh = scaled(mesh.clone(), by);
            for c in curvature(&mesh).unwrap() {
                let all_finite = c.k1.is_finite() && c.k2.is_finite();
                assert!(all_finite && c.k1 >= c.k2, "{name}: {c:?}");
                assert!(
                    c.directions.iter().all(|d| d.is_normalized()),
                    "{name}: {c:?}"
                );
            }
        }
    }
}

#[test]
fn wrong_meshes_are_errors() {
    let mut mesh = shapes::triangle();
    mesh.positions[1].y = f32::NAN;
    assert!(matches!(
        curvature(&mesh),
        Err(Error::NotFinite { index: 1, .. })
    ));
    let mesh = TriMesh::new(vec![Vec3::ONE], vec![[0, 0, 1]]);
    assert!(matches!(
        curvature(&mesh),
        Err(Error::IndexOutOfRange { .. })
    ));
}
