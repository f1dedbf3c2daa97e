//! How do I make levels of detail of my model?
//!
//! `cargo run --release --example lod_chain -- out/`
#![allow(clippy::print_stdout, reason = "an example may print")]

use karui::lod::{Levels, LodOptions, chain_scene, to_msft_lod};
use std::{error::Error, path::PathBuf};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "out".into()));
    std::fs::create_dir_all(&folder)?;

    let scene = karui_io::read(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../assets/sheen_cloth.glb"
    ))?;
    let options = LodOptions {
        levels: Levels::Ratios(vec![0.5, 0.25, 0.1]),
        ..LodOptions::default()
    };
    let chain = chain_scene(&scene, &options)?;
    for level in 0..chain.level_count() {
        let s = chain.summary(&scene, level);
        println!(
            "{} triangles, off by {:.2e} at most, shown beyond {:.2}",
            s.triangles, s.max, s.switch_distance
        );
    }
    karui_io::write(
        folder.join("lod_chain.glb"),
        &to_msft_lod(&scene, &chain).scene,
    )?;
    Ok(())
}
