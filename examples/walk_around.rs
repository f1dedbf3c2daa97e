//! How do I draw no more triangles than this view and these lights need?
//!
//! `cargo run --release --example walk_around -- [MODEL]`
#![allow(clippy::print_stdout, reason = "an example may print")]

use karui::geom::{Camera, Light, turntable_directions};
use karui::hierarchy::{Budget, Hierarchy, HierarchyOptions, ViewAndLight};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let default = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/sheen_cloth.glb");
    let model = std::env::args().nth(1).unwrap_or_else(|| default.into());
    let mesh = karui_io::read(model)?.into_single_mesh()?;
    let hierarchy = Hierarchy::build(&mesh, &HierarchyOptions::default())?;

    let mut cut = hierarchy.coarsest(); // all state of one view
    let mut uploaded = cut.indices().to_vec(); // what lies on the GPU
    for (i, direction) in turntable_directions(24, 0.5).into_iter().enumerate() {
        let camera = Camera::looking_at(hierarchy.bounds(), direction, 0.6);
        let criteria = ViewAndLight {
            camera,
            lights: Light::three_points(&camera)?,
            ..ViewAndLight::default()
        };
        let change = cut.refine(&criteria, Budget::triangles(40_000))?;
        uploaded.resize(change.triangles, [0; 3]);
        for range in &change.ranges {
            let range = range.start as usize..range.end as usize;
            uploaded[range.clone()].copy_from_slice(&cut.indices()[range]);
        }
        println!(
            "frame {i}: {} of {} triangles, {} changes",
            change.triangles,
            mesh.triangles.len(),
            change.splits + change.collapses,
        );
    }
    assert_eq!(uploaded, cut.indices());
    Ok(())
}
