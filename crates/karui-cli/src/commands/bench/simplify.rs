//! `karui bench simplify`: time, error and memory of simplification, ours
//! beside those of other libraries.

mod attributes;
mod contestants;
mod errors;
mod inputs;
pub mod judge;
mod peers;
mod report;
mod rounds;
pub mod solo;

use super::models::models;
use super::page::Page;
use crate::console::{Console, to_stderr};
use crate::failure::Failure;
use crate::progress::check_cancelled;
use crate::table::seconds;
use anyhow::Result;
use contestants::{Contestant, MODES};
use inputs::{Kind, Model};
use rounds::{Row, rows};
use serde::Serialize;
use std::path::PathBuf;

/// Compare time, error and memory of simplification, by mode and with meshoptimizer
///
/// Every model is simplified to each share of its triangles in each mode, all tools in turn, and
/// the results are measured. First without attributes, vertices at one place joined; then with
/// normals and texture coordinates; then made-up land of several sizes, for time and memory by
/// size. Models that cannot be read or are too small are left out.
///
/// `--peers` needs a build with a C++ compiler:
/// `cargo run --release -p karui-cli --features peers -- bench simplify --peers`
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Models to take instead of a folder
    files: Vec<PathBuf>,
    /// Folder of models, searched with everything below it
    #[arg(
        long,
        value_name = "DIR",
        env = "KARUI_MODELS",
        hide_env_values = true,
        default_value = "../shared/models"
    )]
    models: PathBuf,
    /// Leave out models with no more triangles than this
    #[arg(long, value_name = "N", default_value_t = 20_000)]
    more_than: usize,
    /// Shares of the triangles to keep
    #[arg(long, value_delimiter = ',', value_name = "SHARES", default_values_t = [0.5, 0.1, 0.01])]
    targets: Vec<f64>,
    /// Modes of ours to run [default: all]
    #[arg(long, value_delimiter = ',', value_name = "MODES", value_parser = MODES.map(|m| m.name))]
    quality: Vec<String>,
    /// Numbers of threads to run ours with
    #[arg(long, value_delimiter = ',', value_name = "COUNTS", default_values_t = [1, 2])]
    workers: Vec<usize>,
    /// Runs of everything; fewer of what takes longer than 10 s in all
    #[arg(long, value_name = "N", default_value_t = 5)]
    runs: usize,
    /// Run meshoptimizer too, in the same process (cargo feature `peers`)
    #[arg(long)]
    peers: bool,
    /// Run meshoptimizer without ours
    #[arg(long, requires = "peers", conflicts_with = "quality")]
    no_ours: bool,
    /// Parts to run
    #[arg(long, value_delimiter = ',', value_enum, default_values_t = [
        Part::Geometry, Part::Attributes, Part::Scaling,
    ])]
    parts: Vec<Part>,
    /// Triangles of the land of the third part, simplified to 10 %
    #[arg(long, value_delimiter = ',', value_name = "COUNTS", default_values_t = [
        69_000, 349_000, 2_100_000, 8_400_000, 16_777_216,
    ])]
    sizes: Vec<usize>,
    /// Face samples, and as many edge samples, that errors are measured with
    #[arg(long, value_name = "N", default_value_t = 200_000)]
    samples: u64,
    /// Do not measure memory, which takes another run each in a process of its own
    #[arg(long)]
    no_memory: bool,
    /// Markdown file to write the figures into instead of printing them
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// What is compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Part {
    Geometry,
    Attributes,
    Scaling,
}

/// All figures, as `--json` prints them.
#[derive(Debug, Default, Serialize)]
struct Figures {
    geometry: Vec<Row>,
    attributes: Vec<Row>,
    scaling: Vec<solo::Row>,
}

/// Runs the comparison.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    if args.peers {
        peers::require()?;
    }
    let page = args.output.as_deref().map(Page::open).transpose()?;
    let mut figures = Figures::default();
    let wants = |part| args.parts.contains(&part);
    if wants(Part::Geometry) || wants(Part::Attributes) {
        compare_models(args, console, &mut figures)?;
    }
    if wants(Part::Scaling) {
        let contestants = args.contestants(Kind::Geometry)?;
        figures.scaling = solo::scaling(args, &contestants, console)?;
    }
    let markdown = report::markdown(args, &figures);
    match page {
        Some(page) => page.write("karui bench simplify", &markdown)?,
        None => console.data(&markdown)?,
    }
    console.document(&figures)?;
    let rows = figures.geometry.len() + figures.attributes.len() + figures.scaling.len();
    let time = seconds(console.elapsed());
    console.summary(&format!("{rows} combinations; {time}"))
}

fn compare_models(args: &Args, console: &Console, figures: &mut Figures) -> Result<()> {
    let files = match args.files.is_empty() {
        true => models(&args.models)?,
        false => args.files.clone(),
    };
    let mut found = 0;
    for (i, file) in files.iter().enumerate() {
        check_cancelled()?;
        let model = match Model::read(file, &args.models) {
            Ok(model) => model,
            Err(error) => {
                console.warn(&format!("{}: {error:#}", file.display()));
                continue;
            }
        };
        if model.geometry.triangles.len() <= args.more_than {
            continue;
        }
        found += 1;
        if !console.quiet {
            to_stderr(&format!("{}/{} {}", i + 1, files.len(), model.name));
        }
        compare(args, console, &model, figures)?;
    }
    if found > 0 {
        return Ok(());
    }
    let message = format!("no model with more than {} triangles", args.more_than);
    let hint = "name models, a folder by --models, or fewer triangles by --more-than";
    Err(Failure::input(message).hint(hint).into())
}

fn compare(args: &Args, console: &Console, model: &Model, figures: &mut Figures) -> Result<()> {
    if args.parts.contains(&Part::Geometry) {
        let contestants = args.contestants(Kind::Geometry)?;
        let more = rows(args, console, model, Kind::Geometry, &contestants)?;
        figures.geometry.extend(more);
    }
    if args.parts.contains(&Part::Attributes) && model.attributes.is_some() {
        let contestants = args.contestants(Kind::Attributes)?;
        let more = rows(args, console, model, Kind::Attributes, &contestants)?;
        figures.attributes.extend(more);
    }
    Ok(())
}

impl Args {
    /// Everyone who takes part: our modes with every number of threads, then
    /// the others.
    fn contestants(&self, kind: Kind) -> Result<Vec<Contestant>> {
        let mut all = Vec::new();
        for mode in MODES {
            let asked_for = match self.quality.is_empty() {
                true => !self.no_ours,
                false => self.quality.iter().any(|q| q == mode.name),
            };
            let takes_part = asked_for && (kind == Kind::Geometry || !mode.loose);
            for &threads in self.workers.iter().filter(|_| takes_part) {
                all.push(Contestant::named(mode.name, threads)?);
            }
        }
        for peer in peers::of(kind).iter().filter(|_| self.peers) {
            all.push(Contestant::named(peer.name(), 1)?);
        }
        Ok(all)
    }
}
