//! How far is one surface from another, and where is it worst?
//!
//! `cargo run --release --example how_far -- A B [SAMPLES]` measures two files;
//! without them, a terrain and the same terrain with a tenth of the triangles.

#![allow(clippy::print_stdout, reason = "an example shows its results")]

use karui::mesh::shapes;
use karui::metrics::{Samples, SurfaceDistanceOptions, surface_distance, vertex_distances};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [a, b] = match args.as_slice() {
        [a, b, ..] => [
            karui_io::read(a)?.into_single_mesh()?,
            karui_io::read(b)?.into_single_mesh()?,
        ],
        _ => [shapes::terrain(250, 250, 7), shapes::terrain(79, 79, 7)],
    };
    let mut options = SurfaceDistanceOptions::default();
    if let Some(samples) = args.get(2) {
        options.samples = Samples::Count(samples.parse()?);
    }

    let d = surface_distance(&a, &b, &options)?;
    println!(
        "{} triangles against {}",
        a.triangles.len(),
        b.triangles.len()
    );
    println!("direction max mean rms samples");
    for (name, d) in [("a_to_b", d.a_to_b), ("b_to_a", d.b_to_a)] {
        println!(
            "{name} {:.6e} {:.6e} {:.6e} {}",
            d.max, d.mean, d.rms, d.samples
        );
    }
    println!(
        "RMS is {:.4} % of the diagonal",
        100.0 * d.rms() / d.diagonal
    );

    let [from, to] = d.a_to_b.farthest;
    println!("a is farthest from b at {from}, nearest there {to}");
    let map = vertex_distances(&a, &b)?;
    let far = map
        .iter()
        .filter(|&&v| f64::from(v) > 2.0 * d.rms())
        .count();
    println!(
        "{far} of {} vertices of a are off by more than twice the RMS",
        map.len()
    );
    Ok(())
}
