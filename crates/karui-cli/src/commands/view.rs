//! `karui view`: a page to look at models.

use crate::console::{Console, to_stdout};
use crate::failure::Failure;
use crate::progress::check_cancelled;
use anyhow::Result;
use karui_viewer::{Error, Viewer, ViewerOptions};
use serde_json::json;
use std::path::PathBuf;

/// Look at models on a page in the browser
///
/// Levels of detail side by side or by distance, what they cost and how far they are off, heat
/// maps, levels made at a click. The page is served to this machine alone, at an address that no
/// one else knows, until interrupted. Further models can be dropped on it; they stay in memory.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Models, or the tileset.json of 3D Tiles
    #[arg(value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Port on 127.0.0.1 [default: any that is free]
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    port: u16,
    /// Print the address only, open no browser
    #[arg(long)]
    no_open: bool,
    /// Largest file that may be dropped on the page, in MiB
    #[arg(long, value_name = "MIB", default_value_t = 512, value_parser = clap::value_parser!(u32).range(1..=16384))]
    upload_limit: u32,
}

/// Reads the files, tells the address, answers until interrupted.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    let options = ViewerOptions {
        port: args.port,
        upload_bytes: (args.upload_limit as usize) << 20,
    };
    let viewer = Viewer::open(&args.files, &options).map_err(explained)?;
    for warning in viewer.warnings() {
        console.warn(&warning);
    }
    let url = viewer.url();
    // Whoever started this has to learn the address, however quiet it is to be.
    match console.json {
        true => to_stdout(&json!({ "url": url }).to_string())?,
        false => to_stdout(&url)?,
    }
    if !args.no_open
        && let Err(error) = open::that_detached(&url)
    {
        console.warn(&format!("no browser could be started: {error}"));
    }
    // To be interrupted is how it ends.
    Ok(viewer.run(&|| check_cancelled().is_err())?)
}

fn explained(error: Error) -> anyhow::Error {
    let hint = match &error {
        Error::NoTriangles(_) => {
            "points and lines are not handled; `karui info` shows what there is"
        }
        Error::Listen { .. } => "another program listens there; leave out --port for a free one",
        Error::TooManyFiles { .. } => "the folder of the tileset should hold the tileset alone",
        _ => return error.into(),
    };
    Failure::input(error.to_string()).hint(hint).into()
}
