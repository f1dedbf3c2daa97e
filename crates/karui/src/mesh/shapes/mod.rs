//! The mesh zoo: small deterministic shapes that tests, benches and examples
//! share, well-behaved and not.
//!
//! Closed shapes are oriented outwards. Resolutions below the least sensible
//! one are raised to it. Y points up, as in glTF.

mod cube;
mod faulty;
mod grid;
mod landscape;
mod one_sided;
mod sphere;
mod textured;
mod torus;
mod tree;

pub use cube::{closed_cube, cube};
pub use faulty::{
    book, bow_tie, cubes_sharing_edge, duplicate_faces, flipped_face, slivers, t_junction,
    touching_parts,
};
pub(super) use grid::value_noise;
pub use grid::{grid, height_grid, terrain};
pub use landscape::{landscape, landscape_height};
pub use one_sided::{klein_bottle, moebius};
pub use sphere::{icosphere, uv_sphere};
pub use textured::{loaded_sphere, textured_sphere};
pub use torus::torus;
pub use tree::tree;

use super::TriMesh;
use glam::Vec3;

/// One triangle in the plane z = 0, facing +z.
#[must_use]
pub fn triangle() -> TriMesh {
    TriMesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]])
}

/// The mesh without vertices and triangles.
#[must_use]
pub fn empty() -> TriMesh {
    TriMesh::default()
}

/// One small specimen of every shape, under the name of its function.
#[must_use]
pub fn zoo() -> Vec<(&'static str, TriMesh)> {
    vec![
        ("empty", empty()),
        ("triangle", triangle()),
        ("uv_sphere", uv_sphere(8, 12)),
        ("icosphere", icosphere(2)),
        ("torus", torus(1.0, 0.3, 16, 8)),
        ("cube", cube(1)),
        ("cube_subdivided", cube(4)),
        ("closed_cube", closed_cube(2)),
        ("grid", grid(6, 4)),
        ("terrain", terrain(16, 12, 7)),
        ("moebius", moebius(24, 4)),
        ("klein_bottle", klein_bottle(24, 12)),
        ("book", book(3)),
        ("bow_tie", bow_tie()),
        ("t_junction", t_junction()),
        ("slivers", slivers(8)),
        ("duplicate_faces", duplicate_faces()),
        ("flipped_face", flipped_face()),
        ("touching_parts", touching_parts()),
        ("cubes_sharing_edge", cubes_sharing_edge()),
        ("textured_sphere", textured_sphere(8, 12)),
        ("loaded_sphere", loaded_sphere(8, 12)),
    ]
}

/// Splits a `columns` x `rows` array of quads into triangles. `vertex(i, j)`
/// names the corner in column `i`, row `j`; seen from outside, columns run to
/// the right and rows upwards. Triangles with a repeated corner (at poles)
/// are left out.
pub(super) fn quads(columns: u32, rows: u32, vertex: impl Fn(u32, u32) -> u32) -> Vec<[u32; 3]> {
    let mut triangles = Vec::with_capacity(2 * columns as usize * rows as usize);
    for j in 0..rows {
        for i in 0..columns {
            let (a, b) = (vertex(i, j), vertex(i + 1, j));
            let (d, c) = (vertex(i, j + 1), vertex(i + 1, j + 1));
            triangles.extend([[a, b, c], [a, c, d]].into_iter().filter(is_proper));
        }
    }
    triangles
}

fn is_proper(&[a, b, c]: &[u32; 3]) -> bool {
    a != b && b != c && c != a
}

/// Sine and cosine of `step / steps` of a full turn, exact at the quarters so
/// that closed shapes meet exactly.
pub(super) fn turn(step: u32, steps: u32) -> (f64, f64) {
    let step = step % steps;
    let quarters = 4 * u64::from(step);
    let (quarter, rest) = (quarters / u64::from(steps), quarters % u64::from(steps));
    match (quarter, rest) {
        (0, 0) => (0.0, 1.0),
        (1, 0) => (1.0, 0.0),
        (2, 0) => (0.0, -1.0),
        (3, 0) => (-1.0, 0.0),
        _ => (std::f64::consts::TAU * f64::from(step) / f64::from(steps)).sin_cos(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn signed_volume(mesh: &TriMesh) -> f64 {
        let six_volumes = |t| {
            let [a, b, c] = mesh.corners(t);
            a.dot(b.cross(c))
        };
        (0..mesh.triangles.len()).map(six_volumes).sum::<f64>() / 6.0
    }

    #[test]
    fn closed_shapes_face_outwards_with_the_volume_of_their_ideal() {
        use std::f64::consts::PI;
        let ball = 4.0 / 3.0 * PI;
        let cases = [
            ("uv_sphere", uv_sphere(200, 400), ball),
            ("icosphere", icosphere(6), ball),
            ("textured_sphere", textured_sphere(200, 400), ball),
            ("cube", cube(3), 1.0),
            ("closed_cube", closed_cube(3), 1.0),
            ("torus", torus(2.0, 0.5, 300, 300), PI * PI),
            ("touching_parts", touching_parts(), 1.125),
            ("cubes_sharing_edge", cubes_sharing_edge(), 2.0),
        ];
        for (name, mesh, ideal) in cases {
            let volume = signed_volume(&mesh);
            assert!((volume - ideal).abs() < 1e-3 * ideal, "{name}: {volume}");
        }
    }

    #[test]
    fn names_differ_and_every_shape_is_valid() {
        let zoo = zoo();
        for (i, (name, mesh)) in zoo.iter().enumerate() {
            assert!(zoo[..i].iter().all(|(other, _)| other != name), "{name}");
            mesh.validate().unwrap_or_else(|e| panic!("{name}: {e}"));
        }
    }

    #[test]
    fn stored_normals_agree_with_the_faces() {
        for (name, mesh) in zoo() {
            let Some(normals) = &mesh.attributes.normals else {
                continue;
            };
            for (t, corners) in mesh.triangles.iter().enumerate() {
                let face = crate::geom::normal_times_two_areas(mesh.corners(t));
                for &v in corners {
                    let normal = normals[v as usize].as_dvec3();
                    assert!(face.dot(normal) > 0.0, "{name} {t}");
                    assert!((normal.length() - 1.0).abs() < 1e-6, "{name} {v}");
                }
            }
        }
    }

    #[test]
    fn least_resolutions_are_enforced() {
        assert_eq!(uv_sphere(0, 0), uv_sphere(2, 3));
        assert_eq!(torus(1.0, 0.3, 0, 0), torus(1.0, 0.3, 3, 3));
        assert_eq!(cube(0), cube(1));
        assert_eq!(grid(0, 0), grid(1, 1));
        assert_eq!(moebius(0, 0), moebius(3, 1));
        assert_eq!(klein_bottle(0, 0), klein_bottle(4, 4));
        assert_eq!(textured_sphere(0, 0), textured_sphere(2, 3));
        assert_eq!(terrain(0, 0, 1), terrain(1, 1, 1));
        assert_eq!(landscape(0, 0, 1), landscape(1, 1, 1));
    }
}
