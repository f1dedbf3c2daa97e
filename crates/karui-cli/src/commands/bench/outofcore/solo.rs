//! `karui bench outofcore-solo`: one model in a process of its own, whose memory is thus known.

use super::super::clock::{Watch, peak_memory};
use crate::commands::plan::threads;
use crate::console::Console;
use crate::outofcore::Work;
use anyhow::Result;
use karui::outofcore::{PlanOptions, Summary};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Simplify one model in blocks (used by `karui bench outofcore`)
#[derive(Debug, clap::Args)]
#[command(hide = true)]
pub struct Args {
    /// The model
    input: PathBuf,
    /// Folder for all that is made
    #[arg(long)]
    folder: PathBuf,
    #[arg(long)]
    ratio: f64,
    #[arg(long)]
    memory: u64,
}

/// What it took.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct Told {
    pub triangles: u64,
    pub left: u64,
    /// Seconds on the wall, reading and writing included.
    pub wall: f64,
    /// Seconds of the processor, all threads together, user and system.
    pub cpu: f64,
    /// Most memory of the process, bytes.
    pub peak: Option<u64>,
}

/// Runs in the process of its own.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    let (done, cost) = Watch::Time.call(|| all(args, console));
    let summary = done?;
    console.document(&Told {
        triangles: summary.input,
        left: summary.triangles,
        wall: cost.wall,
        cpu: cost.cpu,
        peak: peak_memory(),
    })
}

/// As `karui simplify --memory-limit` does it.
fn all(args: &Args, console: &Console) -> Result<Summary> {
    let options = PlanOptions {
        ratio: Some(args.ratio),
        block_triangles: PlanOptions::block_triangles_for(args.memory),
        ..PlanOptions::default()
    };
    let at = |name: &str| Path::new(&args.folder).join(name);
    let work = Work::create(&args.input, &at("blocks"), options)?;
    let last = work.run(args.memory, threads(), console)?;
    let summary = work.write(&last, &at("coarse.ply"), console)?;
    work.store.clear()?;
    Ok(summary)
}
