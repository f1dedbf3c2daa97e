//! `karui bench outofcore`: models larger than memory, measured.

mod balance;
mod kills;
mod land;
mod scaling;
mod seams;
pub(super) mod solo;

use super::page::{self, Page};
use crate::console::Console;
use crate::outofcore::memory;
use crate::table::seconds;
use anyhow::Result;
use clap::ArgGroup;
use land::Size;
use serde_json::{Map, Value};
use std::path::PathBuf;
use tempfile::TempDir;

/// Models larger than memory: time, memory, balance, borders, kills
///
/// Makes land and simplifies it in blocks. Every experiment writes a section of its own.
#[derive(Debug, clap::Args)]
#[command(group = ArgGroup::new("experiment").required(true).multiple(true))]
pub struct Args {
    /// Time and memory for land of so many vertices along x and z
    #[arg(
        long,
        value_name = "COLUMNSxROWS",
        value_delimiter = ',',
        group = "experiment"
    )]
    sizes: Vec<Size>,
    /// Time of every region on land that is half flat: slabs of as many triangles against
    /// slabs of as much work
    #[arg(long, value_name = "COLUMNSxROWS", group = "experiment")]
    balance: Option<Size>,
    /// Error where borders of regions were and elsewhere, and of the same land in one piece
    #[arg(long, value_name = "COLUMNSxROWS", group = "experiment")]
    seams: Option<Size>,
    /// End so many runs by SIGKILL, resume each, compare what is written
    #[arg(long, value_name = "N", group = "experiment",
          value_parser = clap::value_parser!(u32).range(1..=10_000))]
    kills: Option<u32>,
    /// Share of the triangles to keep
    #[arg(long, value_name = "SHARE", default_value_t = 0.1)]
    ratio: f64,
    /// Memory for --sizes
    #[arg(long, value_name = "SIZE", value_parser = memory, default_value = "1GiB")]
    memory_limit: u64,
    /// Folder on a disk with room for the models [default: that of the system]
    #[arg(long, value_name = "DIR")]
    work: Option<PathBuf>,
    /// Markdown file to write the figures into instead of printing them
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// Runs the experiments that were asked for.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    let mut found = Map::new();
    let mut tell = |name: &str, work: &dyn Fn(&TempDir) -> Result<(String, Value)>| -> Result<()> {
        let page = args.output.as_deref().map(Page::open).transpose()?;
        let folder = match &args.work {
            Some(root) => tempfile::tempdir_in(root)?,
            None => tempfile::tempdir()?,
        };
        let (text, rows) = work(&folder)?;
        found.insert(name.to_owned(), rows);
        let command = format!("karui bench outofcore --{name}");
        page::tell(page, &command, &text, console)
    };
    if !args.sizes.is_empty() {
        tell("sizes", &|folder| scaling::run(args, folder.path()))?;
    }
    if let Some(size) = args.balance {
        tell("balance", &|folder| {
            balance::run(size, args.ratio, folder.path())
        })?;
    }
    if let Some(size) = args.seams {
        tell("seams", &|folder| {
            seams::run(size, args.ratio, folder.path())
        })?;
    }
    if let Some(count) = args.kills {
        tell("kills", &|folder| {
            kills::run(count, args.ratio, folder.path())
        })?;
    }
    console.document(&found)?;
    console.summary(&format!("measured in {}", seconds(console.elapsed())))
}
