//! How do I keep the triangles that are looked at, and does it show?
//!
//! `cargo run --release --example what_matters -- out/`
#![allow(clippy::print_stdout, reason = "an example may print")]

use karui::geom::{Camera, Light, Vec3};
use karui::metrics::image::{PIXELS_PER_DEGREE, flip};
use karui::render::{Outputs, RenderOptions, Renderer};
use karui::saliency::{MeshSaliencyOptions, WeightMap, mesh_saliency};
use karui::simplify::{SimplifyOptions, Stop, simplify};
use std::{error::Error, path::PathBuf};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "out".into()));
    std::fs::create_dir_all(&folder)?;
    let mesh = karui_io::read(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../assets/sheen_cloth.glb"
    ))?
    .into_single_mesh()?;

    let saliency = mesh_saliency(&mesh, &MeshSaliencyOptions::default())?;
    let weights = WeightMap::default().weights(&saliency)?;
    let plain = SimplifyOptions {
        stop: Stop::ratio(0.1),
        ..SimplifyOptions::default()
    };
    let steered = SimplifyOptions {
        weights: Some(&weights),
        ..plain
    };

    let original = Renderer::of_mesh(&mesh)?;
    let camera = Camera::looking_at(original.bounds(), Vec3::new(1.0, 1.0, 2.0), 0.5);
    let lights = Light::three_points(&camera)?;
    let options = RenderOptions {
        width: 512,
        height: 512,
        outputs: Outputs::COLOR,
        ..RenderOptions::default()
    };
    let expected = original.frame(&camera, &lights, &options)?.color;
    for (name, how) in [("plain", plain), ("steered", steered)] {
        let coarse = simplify(&mesh, &how)?.mesh;
        let found = Renderer::of_mesh(&coarse)?
            .frame(&camera, &lights, &options)?
            .color;
        let difference = flip(&expected, &found, PIXELS_PER_DEGREE)?.mean;
        let triangles = coarse.triangles.len();
        println!("{name}: {triangles} triangles, FLIP {difference:.4}");
        let png = karui_io::encode_png(&found)?;
        std::fs::write(folder.join(format!("{name}.png")), png)?;
    }
    Ok(())
}
