//! Rational surfaces are what a projection makes of plain ones.

use super::*;
use glam::{Mat4, Vec3, Vec4};

/// Puts the viewer's plane aslant, so that no two vertices weigh the same.
fn projection() -> Mat4 {
    Mat4::from_cols(
        Vec4::new(1.0, 0.2, 0.0, 0.11),
        Vec4::new(0.0, 0.9, 0.3, -0.07),
        Vec4::new(0.1, 0.0, 1.1, 0.05),
        Vec4::new(0.3, -0.2, 0.4, 1.3),
    )
}

fn projected(at: Vec3) -> (Vec3, f32) {
    let four = projection() * at.extend(1.0);
    (four.truncate() / four.w, four.w)
}

fn control(mesh: &Mesh) -> ControlMesh {
    ControlMesh {
        cage: cage(&mesh.1, mesh.0.len()),
        positions: mesh.0.iter().copied().map(Vec3::from).collect(),
        ..ControlMesh::default()
    }
}

#[test]
fn weights_are_a_projection_of_the_surface() {
    for (mesh, scheme) in [
        (cube(), Scheme::CatmullClark),
        (sheet(4), Scheme::CatmullClark),
        (triangulated(cube()), Scheme::Loop),
    ] {
        for on_limit in [false, true] {
            let plain = control(&mesh);
            let (positions, weights) = plain.positions.iter().copied().map(projected).unzip();
            let rational = ControlMesh {
                positions,
                weights: Some(weights),
                ..plain.clone()
            };
            let surface = SurfaceOptions {
                on_limit,
                normals: true,
            };
            let options = options(scheme, 2);
            let of = |control| subdivide(control, &options, surface, &Silent).unwrap().mesh;
            let (plain, rational) = (of(&plain), of(&rational));
            assert_eq!(plain.indices, rational.indices);
            let [flat, seen] = [&plain, &rational].map(|m| m.attributes.normals.as_ref().unwrap());
            for (v, (normal, seen)) in flat.iter().zip(seen).enumerate() {
                let at = projected(plain.positions[v]).0;
                assert!(at.distance(rational.positions[v]) < 1e-5, "{scheme:?} {v}");
                // Planes go by the inverse; only that of the limit is one of the surface.
                if on_limit && normal.length() > 0.5 {
                    let plane = normal.extend(-normal.dot(plain.positions[v]));
                    let plane = projection().inverse().transpose() * plane;
                    let dot = plane.truncate().normalize().dot(*seen);
                    assert!(dot > 1.0 - 1e-4, "{scheme:?} {v}: {dot}");
                }
            }
        }
    }
}

#[test]
fn weights_that_are_no_weights_are_refused() {
    let mut wrong = control(&cube());
    for weights in [
        vec![1.0; 7],
        vec![1.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0],
        vec![f32::NAN; 8],
    ] {
        wrong.weights = Some(weights);
        let options = options(Scheme::CatmullClark, 1);
        let surface = SurfaceOptions::default();
        assert!(subdivide(&wrong, &options, surface, &Silent).is_err());
    }
}
