//! `karui bench hlod`: scenes of very many objects, measured.

mod chart;
mod coarser;
mod counts;
mod crowd;
mod groupings;
mod nestings;
mod paper;
pub(super) mod solo;
mod stage;

use super::page::{self, Page};
use crate::console::Console;
use crate::output::Staged;
use crate::table::seconds;
use anyhow::Result;
use clap::ArgGroup;
use groupings::Plan;
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
    /// Repeat the experiments of Kato, Kanoh and Nishihara 1998
    #[arg(long, group = "experiment")]
    paper: bool,
    /// Compare groups by perception with groups by place at equal numbers of triangles
    #[arg(long, group = "experiment")]
    groupings: bool,
    /// Objects of the scenes for --groupings
    #[arg(long, value_name = "N", default_value_t = 400,
          value_parser = clap::value_parser!(u32).range(2..=1_000_000))]
    objects: u32,
    /// Views of a scene for --groupings
    #[arg(long, value_name = "N", default_value_t = 4,
          value_parser = clap::value_parser!(u32).range(1..=1000))]
    views: u32,
    /// Folder of models, some of which --groupings takes
    #[arg(
        long,
        value_name = "DIR",
        env = "KARUI_MODELS",
        hide_env_values = true,
        default_value = "../shared/models"
    )]
    models: PathBuf,
    /// Folder to write pictures into: hlod-*.png and hlod-*.svg
    #[arg(long, value_name = "DIR")]
    pictures: Option<PathBuf>,
    /// Markdown file to write the figures into instead of printing them
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// Runs the experiments that were asked for.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    let staged = args.pictures.as_deref().map(Staged::in_directory);
    let staged = staged.transpose()?;
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
    if args.paper {
        tell("paper", &|| paper::run(staged.as_ref()))?;
    }
    if args.groupings {
        let plan = Plan {
            models: &args.models,
            objects: args.objects as usize,
            views: args.views,
            pictures: staged.as_ref(),
        };
        tell("groupings", &|| groupings::run(&plan, console))?;
    }
    staged.map(Staged::publish).transpose()?;
    console.document(&found)?;
    console.summary(&format!("measured in {}", seconds(console.elapsed())))
}
