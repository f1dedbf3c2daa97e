//! Regularity: triangles come out more even, at a price.
#![allow(clippy::unwrap_used, reason = "it is a test")]

use karui::simplify::Quality;
use karui::{SimplifyOptions, Stop, TriMesh, mesh::shapes, metrics::surface_distance, simplify};

fn simplified(mesh: &TriMesh, quality: Quality, regularity: f64) -> TriMesh {
    let options = SimplifyOptions {
        quality,
        regularity,
        stop: Stop::ratio(0.1),
        ..SimplifyOptions::default()
    };
    simplify(mesh, &options).unwrap().mesh
}

/// Mean over the triangles of area beside that of an even triangle with the
/// same sum of squared sides (1 for those), and standard deviation of the
/// lengths of sides beside their mean.
fn evenness(mesh: &TriMesh) -> (f64, f64) {
    let (mut shape, mut lengths) = (0.0, Vec::new());
    for t in 0..mesh.triangles.len() {
        let [a, b, c] = mesh.corners(t);
        let sides = [b - a, c - b, a - c].map(|e| e.length());
        let squares: f64 = sides.iter().map(|l| l * l).sum();
        shape += 2.0 * 3f64.sqrt() * (b - a).cross(c - a).length() / squares;
        lengths.extend(sides);
    }
    let count = lengths.len() as f64;
    let mean = lengths.iter().sum::<f64>() / count;
    let variance = lengths.iter().map(|l| (l - mean) * (l - mean)).sum::<f64>() / count;
    (shape / mesh.triangles.len() as f64, variance.sqrt() / mean)
}

#[test]
fn triangles_become_more_even_the_more_it_is_asked_for() {
    for mesh in [shapes::terrain(70, 70, 5), shapes::torus(1.0, 0.4, 90, 40)] {
        for quality in [Quality::Fast, Quality::Balanced, Quality::Exact] {
            let (mut shape, mut spread) = evenness(&simplified(&mesh, quality, 0.0));
            for regularity in [0.1, 0.5] {
                let (new_shape, new_spread) = evenness(&simplified(&mesh, quality, regularity));
                assert!(
                    new_shape > shape,
                    "{quality:?} {regularity}: {new_shape} {shape}"
                );
                assert!(
                    new_spread < spread,
                    "{quality:?} {regularity}: {new_spread} {spread}"
                );
                (shape, spread) = (new_shape, new_spread);
            }
        }
    }
}

#[test]
fn it_costs_closeness() {
    let mesh = shapes::terrain(70, 70, 5);
    let rms = |regularity| {
        let coarse = simplified(&mesh, Quality::Balanced, regularity);
        let distance = surface_distance(&mesh, &coarse, &Default::default()).unwrap();
        distance.rms()
    };
    let (free, mild, strong) = (rms(0.0), rms(0.1), rms(0.5));
    assert!(free < mild && mild < strong, "{free} {mild} {strong}");
}

#[test]
fn what_is_no_preference_is_refused() {
    for regularity in [-1.0, f64::NAN, f64::INFINITY] {
        let options = SimplifyOptions {
            regularity,
            ..SimplifyOptions::default()
        };
        let error = simplify(&shapes::cube(2), &options).unwrap_err();
        assert!(error.to_string().contains("regularity"), "{error}");
    }
}
