//! `karui scene city`: houses along streets.

use super::{MadeArgs, OutputArgs, refused};
use crate::console::Console;
use crate::failure::Failure;
use crate::input;
use anyhow::Result;
use karui::mesh::scenes::{CityOptions, CityParts, CityRole, city};
use std::path::{Path, PathBuf};

/// Make a city
///
/// Streets, houses, cars, lights and bushes on a grid of tiles 2 units wide: plain ones, or the
/// parts of a folder like that of the KayKit City Builder pack, by the names of the files:
/// building_*, base, road_straight, road_junction, car_*, streetlight, bush, bench, dumpster,
/// firehydrant, trash_*, box_*.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    made: MadeArgs,
    /// Folder of glTF parts to use
    #[arg(long, value_name = "DIR")]
    parts: Option<PathBuf>,
    /// Tiles from one street to the next, 1 to 100
    #[arg(long, value_name = "N", default_value_t = CityOptions::default().block)]
    block: u32,
    /// Mean number of cars a tile of street, 0 to 2
    #[arg(long, value_name = "N", default_value_t = CityOptions::default().traffic)]
    traffic: f32,
    #[command(flatten)]
    output: OutputArgs,
}

/// Makes and writes it.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    args.output.check()?;
    let parts = match &args.parts {
        Some(folder) => read_parts(folder, console)?,
        None => CityParts::built_in(),
    };
    let options = CityOptions {
        count: args.made.count as usize,
        seed: args.made.seed,
        block: args.block,
        traffic: args.traffic,
    };
    let scene = city(&options, &parts).map_err(|error| refused(&args.output, error))?;
    args.output.write(&scene, "a city", console)
}

/// All glTF files of a folder that a city has a use for, in order of names.
pub fn read_parts(folder: &Path, console: &Console) -> Result<CityParts> {
    let fail = |error| Failure::input(format!("cannot read {}: {error}", folder.display()));
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(fail)? {
        files.push(entry.map_err(fail)?.path());
    }
    files.sort();
    let mut parts = CityParts::default();
    let mut used = 0;
    for path in files {
        let extension = path.extension().and_then(|e| e.to_str());
        let name = path
            .file_stem()
            .and_then(|n| n.to_str())
            .unwrap_or_default();
        let role = CityRole::of_name(name).filter(|_| matches!(extension, Some("gltf" | "glb")));
        if let Some(role) = role {
            let scene = input::read(&path, console)?.scene;
            let added = parts.add(name, role, scene);
            added.map_err(|e| karui_io::Error::file(&path, karui_io::ErrorKind::Geometry(e)))?;
            used += 1;
        }
    }
    if used > 0 {
        return Ok(parts);
    }
    let message = format!("{}: no parts of a city", folder.display());
    let hint = "`karui scene city --help` lists the names of files it looks for";
    Err(Failure::input(message).hint(hint).into())
}
