//! How do I draw a scene of very many objects, and how do I stream it?
//!
//! `cargo run --release --example stream_a_city -- [OUT]`
#![allow(clippy::print_stdout, reason = "an example may print")]

use karui::Silent;
use karui::geom::{Camera, Vec3};
use karui::hlod::tiles::{Hlod, HlodOptions};
use karui::hlod::{Assets, Levels, View, Walk};
use karui::mesh::scenes::{CityOptions, CityParts, city};
use karui_io::tiles::{TilesOptions, check, write_hlod};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let out = std::env::args().nth(1).unwrap_or_else(|| "out".into());
    let options = CityOptions {
        count: 200,
        ..CityOptions::default()
    };
    let scene = city(&options, &CityParts::built_in())?;
    let hlod = Hlod::build(
        &scene,
        &[], // its images, decoded: it has none
        &HlodOptions {
            triangles: 2_000,
            ..HlodOptions::default()
        },
    )?;

    // Frame by frame: which groups, which objects.
    let levels: Vec<Levels> = scene
        .meshes
        .iter()
        .map(|m| Levels {
            switch: Vec::new(),
            triangles: vec![m.mesh.triangles.len() as u32],
        })
        .collect();
    let sources = (0..hlod.object_count() as u32).filter_map(|o| hlod.source(o));
    let levels_of_object: Vec<u32> = sources.map(|(_, mesh)| mesh).collect();
    let boxes = vec![12; hlod.tree().group_capacity()];
    let assets = Assets {
        levels: &levels,
        levels_of_object: &levels_of_object,
        proxies: &boxes,
    };
    let mut walk = Walk::default();
    for away in [0.3, 1.0, 3.0] {
        let mut camera = Camera::looking_at(scene.bounds(), Vec3::new(0.5, 0.7, 1.0), 0.8);
        camera.eye = camera.target + (camera.eye - camera.target) * away;
        let view = View {
            threshold: 0.01,
            ..View::new(camera)
        };
        let counts = walk.frame(hlod.tree(), &view, &assets)?.counts;
        println!(
            "{} groups and {} objects, {} triangles",
            counts.groups, counts.objects, counts.triangles
        );
    }

    // Once for all: 3D Tiles.
    let tiles = TilesOptions {
        overwrite: true,
        ..TilesOptions::default()
    };
    let folder = format!("{out}/city");
    let written = write_hlod(&folder, &hlod, &tiles, &Silent)?;
    let report = check(format!("{folder}/tileset.json"))?;
    println!("{} tiles, valid: {}", written.tiles, report.is_valid());
    Ok(())
}
