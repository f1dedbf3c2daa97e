//! How does a cage become smooth where the camera looks, and stay coarse elsewhere?
//!
//! `cargo run --release --example only_where_looked_at -- [CAGE] [OUT]` walks around a control
//! mesh (OBJ with tags, PLY, OFF; a torus of 96 quads without one) and writes the last frame.

#![allow(clippy::print_stdout, reason = "an example may print")]

use karui::Scene;
use karui::geom::{Aabb, Camera, turntable_directions};
use karui::mesh::{PolyMesh, shapes};
use karui::subdiv::adaptive::{Adaptive, AdaptiveMesh, AdaptiveOptions, View};
use karui::subdiv::{ControlMesh, SubdivOptions};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let control = match args.first() {
        Some(file) => karui_io::read_control(file)?.mesh,
        None => torus(),
    };
    let options = control.rules.apply(SubdivOptions::default());
    let mut adaptive = Adaptive::new(&control.cage, &control.positions, &options)?;

    // Half a pixel from the limit surface; a quarter along silhouettes.
    let how = AdaptiveOptions::within(0.5);
    let bounds = Aabb::of(control.positions.iter().copied());
    let mut drawn = AdaptiveMesh::default(); // its memory is used again
    for (i, direction) in turntable_directions(8, 0.4).into_iter().enumerate() {
        let view = View {
            camera: Camera::looking_at(bounds, direction, 0.6),
            size: [1920, 1080],
            lights: Vec::new(),
        };
        adaptive.refine_into(&view, &how, &mut drawn)?;
        let deepest = drawn.depths.iter().max().copied().unwrap_or(0);
        println!(
            "frame {i}: {} faces -> {}, up to depth {deepest}; uniformly they were {}",
            control.cage.face_count(),
            drawn.mesh.face_count(),
            (control.cage.indices.len() << deepest) / 4,
        );
    }
    if let Some(out) = args.get(1) {
        karui_io::write(out, &Scene::from_mesh(drawn.to_tri_mesh()))?;
    }
    Ok(())
}

fn torus() -> ControlMesh {
    let (around, across) = (12, 8);
    let mut mesh = PolyMesh {
        positions: shapes::torus(1.0, 0.4, around, across).positions,
        ..PolyMesh::default()
    };
    for j in 0..across {
        for i in 0..around {
            let at = |i: u32, j: u32| j % across * around + i % around;
            mesh.push_face(&[at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    ControlMesh::of_poly_mesh(&mesh)
}
