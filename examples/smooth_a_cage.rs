//! How does a coarse cage become a smooth surface, and how is an animated one kept up with?
//!
//! `cargo run --release --example smooth_a_cage -- CAGE OUT [LEVELS]` refines a file (OBJ with
//! tags, PLY, OFF); without it, a cube with a crease around its top, in memory.

#![allow(clippy::print_stdout, reason = "an example shows its results")]

use karui::Scene;
use karui::Silent;
use karui::subdiv::{
    Cage, ControlMesh, Crease, Refinement, SubdivOptions, SurfaceOptions, Workspace, subdivide,
};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let control = match args.first() {
        Some(file) => karui_io::read_control(file)?.mesh,
        None => creased_cube(),
    };
    let levels = args.get(2).map_or(Ok(3), |text| text.parse())?;
    let options = control.rules.apply(SubdivOptions {
        levels,
        ..SubdivOptions::default()
    });

    // Once: a mesh on the limit surface, with its normals.
    let surface = SurfaceOptions {
        on_limit: true,
        normals: true,
    };
    let smooth = subdivide(&control, &options, surface, &Silent)?;
    println!(
        "{} faces -> {}",
        control.cage.face_count(),
        smooth.mesh.face_count()
    );
    if let Some(out) = args.get(1) {
        karui_io::write(out, &Scene::from_mesh(smooth.mesh.triangulate()))?;
    }

    // Every frame: connectivity stays, positions are evaluated anew.
    let refinement = Refinement::new(&control.cage, &options)?;
    let (mut workspace, mut vertices) = (Workspace::default(), Vec::new());
    for frame in 0..3 {
        let stretch = 1.0 + 0.5 * frame as f32;
        let cage = control.positions.iter().map(|p| [p.x, stretch * p.y, p.z]);
        let cage: Vec<[f32; 3]> = cage.collect();
        refinement.evaluate_into(&cage, &mut workspace, &mut vertices)?;
        let top = vertices.iter().map(|v| v[1]).fold(f32::MIN, f32::max);
        println!(
            "frame {frame}: {} vertices, the highest at {top:.3}",
            vertices.len()
        );
    }
    Ok(())
}

fn creased_cube() -> ControlMesh {
    let corner = |i: u8| [0, 1, 2].map(|axis| f32::from(i >> axis & 1)).into();
    let crease = |vertices| Crease {
        vertices,
        sharpness: 2.5,
    };
    ControlMesh {
        cage: Cage {
            vertices: 8,
            offsets: (0..=6).map(|f| 4 * f).collect(),
            indices: vec![
                0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5,
            ],
            creases: [[2, 3], [3, 7], [7, 6], [6, 2]].map(crease).to_vec(),
            ..Cage::default()
        },
        positions: (0..8).map(corner).collect(),
        ..ControlMesh::default()
    }
}
