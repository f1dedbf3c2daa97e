//! How do I give a model and all its poses (or morph targets) the same level
//! of detail: one index buffer, and vertices where each pose wants them?
//!
//! `cargo run --release --example poses`
#![allow(clippy::print_stdout, reason = "an example may print")]

use glam::Vec3;
use karui::mesh::{Attributes, MorphTarget, shapes};
use karui::metrics::{SurfaceDistanceOptions, surface_distance};
use karui::{SimplifyOptions, Stop, TriMesh, simplify};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let (rest, pose) = arm();
    let options = SimplifyOptions {
        stop: Stop::ratio(0.02),
        log: true,
        ..Default::default()
    };
    let log = simplify(&rest, &options)?.log.ok_or("no log")?;

    // One replay each, from level to level.
    let (mut resting, mut posing) = (log.replay(&rest)?, log.replay(&pose)?);
    println!("triangles  off the pose, in 1e-4 of its diagonal (RMS):");
    println!("           replayed  morphed  simplified alone");
    for ratio in [0.3, 0.1, 0.02] {
        let stop = Stop::ratio(ratio);
        resting.advance(&stop)?;
        posing.advance(&stop)?;
        let (level, posed) = (resting.level()?, posing.level()?);
        assert_eq!(level.mesh.triangles, posed.mesh.triangles);

        // What the level's own morph target gives, mixed as any attribute.
        let mut morphed = level.mesh.clone();
        let deltas = level.mesh.attributes.morphs.first();
        let deltas = deltas.and_then(|morph| morph.positions.as_ref());
        for (p, delta) in morphed.positions.iter_mut().zip(deltas.ok_or("no morph")?) {
            *p += *delta;
        }
        let alone = SimplifyOptions { stop, ..options };
        let alone = simplify(&pose, &alone)?.mesh;
        println!(
            "{:9}  {:8.2}  {:7.2}  {:16.2}",
            posed.mesh.triangles.len(),
            off(&pose, &posed.mesh)?,
            off(&pose, &morphed)?,
            off(&pose, &alone)?
        );
    }

    // What a vertex of the model has become part of, to carry data of one's own.
    let map = log.map(&rest)?;
    println!("vertex 1000 is now part of vertex {:?}", map[1000]);
    Ok(())
}

/// An arm that can bend by a quarter of a circle, its morph target.
fn arm() -> (TriMesh, TriMesh) {
    let mut rest = shapes::icosphere(6);
    for p in &mut rest.positions {
        let bumps = 1.0 + 0.1 * (9.0 * p.x).sin() * (7.0 * p.y).cos();
        *p *= Vec3::new(1.0, 0.3, 0.2) * bumps;
    }
    let radius = 4.0 / std::f32::consts::PI;
    let bent = |p: Vec3| {
        let (sin, cos) = (p.x / radius).sin_cos();
        Vec3::new((radius - p.z) * sin, p.y, radius - (radius - p.z) * cos)
    };
    let positions: Vec<Vec3> = rest.positions.iter().map(|&p| bent(p)).collect();
    let pose = TriMesh::new(positions.clone(), rest.triangles.clone());
    let deltas = positions
        .iter()
        .zip(&rest.positions)
        .map(|(to, from)| *to - *from);
    rest.attributes = Attributes {
        morphs: vec![MorphTarget {
            positions: Some(deltas.collect()),
            ..MorphTarget::default()
        }],
        ..Attributes::default()
    };
    (rest, pose)
}

fn off(mesh: &TriMesh, coarse: &TriMesh) -> karui::Result<f64> {
    let distance = surface_distance(mesh, coarse, &SurfaceDistanceOptions::default())?;
    Ok(1e4 * distance.rms() / mesh.bounds().diagonal())
}
