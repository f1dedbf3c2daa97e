//! `karui task`: one row of a manifest.

use crate::console::Console;
use crate::failure::Failure;
use crate::outofcore::{Work, observer, told};
use anyhow::Result;
use clap::Subcommand;
use karui::outofcore::{Manifest, run_task};
use std::path::{Path, PathBuf};

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
    /// The manifest, in the plan's folder
    manifest: PathBuf,
    /// The row, from 0
    #[arg(long, value_name = "N")]
    row: u64,
}

/// Does what the subcommand says.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    let Command::Run(args) = &args.command;
    let name = args.manifest.file_name().and_then(|name| name.to_str());
    let Some(name) = name else {
        return Err(Failure::input("the manifest has no name").into());
    };
    let folder = args.manifest.parent().unwrap_or(Path::new("."));
    let folder = if folder == Path::new("") {
        Path::new(".")
    } else {
        folder
    };
    let work = Work::open(folder)?;
    let manifest = Manifest::load(&work.store, name).map_err(told)?;
    let observer = observer(true);
    let result = run_task(&work.store, &*work.source, &manifest, args.row, &*observer);
    let result = result.map_err(told)?;
    console.document(&result)?;
    console.data(&serde_json::to_string(&result)?)
}
