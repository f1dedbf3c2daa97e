//! `karui bench hlod`: scenes of very many objects, measured.

mod counts;
mod crowd;
pub(super) mod solo;

use super::page::{self, Page};
use crate::console::Console;
use crate::table::seconds;
use anyhow::Result;
use clap::ArgGroup;
use serde_json::{Map, Value};
use std::path::PathBuf;

/// Scenes of very many objects: how long groups and draw lists take
///
/// Every experiment writes a section of its own.
#[derive(Debug, clap::Args)]
#[command(group = ArgGroup::new("experiment").required(true).multiple(true))]
pub struct Args {
    /// Build trees of forests and cities of so many objects, and fly over them
    #[arg(long, value_name = "N", value_delimiter = ',', group = "experiment",
          value_parser = clap::value_parser!(u32).range(1..=100_000_000))]
    counts: Vec<u32>,
    /// Frames of a flight
    #[arg(long, value_name = "N", default_value_t = 300,
          value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    frames: u32,
    /// Markdown file to write the figures into instead of printing them
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// Runs the experiments that were asked for.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    let mut found = Map::new();
    let mut tell = |name: &str, work: &dyn Fn() -> Result<(String, Value)>| -> Result<()> {
        let page = args.output.as_deref().map(Page::open).transpose()?;
        let (text, rows) = work()?;
        found.insert(name.to_owned(), rows);
        page::tell(page, &format!("karui bench hlod --{name}"), &text, console)
    };
    if !args.counts.is_empty() {
        tell("counts", &|| {
            counts::run(&args.counts, args.frames, console)
        })?;
    }
    console.document(&found)?;
    console.summary(&format!("measured in {}", seconds(console.elapsed())))
}
