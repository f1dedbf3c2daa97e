//! `karui bench`: what Karui does to a folder of models, measured.

mod adaptive;
mod child;
mod clock;
mod hlod;
mod models;
mod one;
mod outofcore;
pub(super) mod page;
mod saliency;
mod simplify;
mod subdivide;
mod thesis;
mod views;

use crate::console::Console;
use anyhow::Result;
use clap::Subcommand;

/// Measure Karui on a folder of models
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    Models(models::Args),
    Simplify(simplify::Args),
    Saliency(saliency::Args),
    Views(views::Args),
    Thesis(thesis::Args),
    Hlod(hlod::Args),
    Subdivide(subdivide::Args),
    Adaptive(adaptive::Args),
    #[command(name = "outofcore")]
    OutOfCore(outofcore::Args),
    One(one::Args),
    Solo(simplify::solo::Args),
    Judge(simplify::judge::Args),
    HlodSolo(hlod::solo::Args),
    #[command(name = "outofcore-solo")]
    OutOfCoreSolo(outofcore::solo::Args),
}

/// Runs the benchmark.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    match &args.what {
        What::Models(args) => models::run(args, console),
        What::Simplify(args) => simplify::run(args, console),
        What::Saliency(args) => saliency::run(args, console),
        What::Views(args) => views::run(args, console),
        What::Thesis(args) => thesis::run(args, console),
        What::Hlod(args) => hlod::run(args, console),
        What::Subdivide(args) => subdivide::run(args, console),
        What::Adaptive(args) => adaptive::run(args, console),
        What::OutOfCore(args) => outofcore::run(args, console),
        What::One(args) => one::run(args, console),
        What::Solo(args) => simplify::solo::run(args, console),
        What::Judge(args) => simplify::judge::run(args, console),
        What::HlodSolo(args) => hlod::solo::run(args, console),
        What::OutOfCoreSolo(args) => outofcore::solo::run(args, console),
    }
}
