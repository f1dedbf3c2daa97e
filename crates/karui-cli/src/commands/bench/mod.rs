//! `karui bench`: what Karui does to a folder of models, measured.

mod models;
mod one;

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
    One(one::Args),
}

/// Runs the benchmark.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    match &args.what {
        What::Models(args) => models::run(args, console),
        What::One(args) => one::run(args, console),
    }
}
