//! `karui task`: one row of a manifest.

use crate::console::Console;
use crate::outofcore::{Work, observer, split, told};
use anyhow::Result;
use clap::Subcommand;
use karui::outofcore::{Manifest, run_task};
use std::path::PathBuf;

/// Run one task of a plan, for engines that start programs
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run one row of a manifest; prints its result as JSON
    Run(Run),
}

#[derive(Debug, clap::Args)]
struct Run {
    /// The manifest, with the plan's folder or URL before it
    manifest: PathBuf,
    /// The row, from 0
    #[arg(long, value_name = "N")]
    row: u64,
}

/// Does what the subcommand says.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    let Command::Run(args) = &args.command;
    let (place, name) = split(&args.manifest)?;
    let work = Work::open(&place)?;
    let manifest = Manifest::load(&work.store, name).map_err(told)?;
    let observer = observer(true);
    let result = run_task(&work.store, &*work.source, &manifest, args.row, &*observer);
    let result = result.map_err(told)?;
    console.document(&result)?;
    console.data(&serde_json::to_string(&result)?)
}
