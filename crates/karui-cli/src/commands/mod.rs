//! The commands, one file each.

mod bench;
mod compare;
mod completions;
mod convert;
mod hierarchy;
mod info;
mod lod;
mod man;
mod measure;
mod plan;
mod render;
mod replay;
mod saliency;
mod scene;
mod simplify;
mod subdivide;
mod task;
mod tiles;
mod validate;
mod view;

use crate::console::Console;
use anyhow::Result;
use clap::Subcommand;

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    Lod(lod::Args),
    Simplify(simplify::Args),
    Replay(replay::Args),
    Subdivide(subdivide::Args),
    Saliency(saliency::Args),
    Hierarchy(hierarchy::Args),
    Info(info::Args),
    Measure(measure::Args),
    Compare(compare::Args),
    View(view::Args),
    Validate(validate::Args),
    Render(render::Args),
    Convert(convert::Args),
    Scene(scene::Args),
    Tiles(tiles::Args),
    Plan(plan::Args),
    Task(task::Args),
    Bench(bench::Args),
    Completions(completions::Args),
    Man(man::Args),
}

/// Runs `command`.
pub fn run(command: Command, console: &Console) -> Result<()> {
    match command {
        Command::Lod(args) => lod::run(&args, console),
        Command::Simplify(args) => simplify::run(&args, console),
        Command::Replay(args) => replay::run(&args, console),
        Command::Subdivide(args) => subdivide::run(&args, console),
        Command::Saliency(args) => saliency::run(&args, console),
        Command::Hierarchy(args) => hierarchy::run(&args, console),
        Command::Info(args) => info::run(&args, console),
        Command::Measure(args) => measure::run(&args, console),
        Command::Compare(args) => compare::run(&args, console),
        Command::View(args) => view::run(&args, console),
        Command::Validate(args) => validate::run(&args, console),
        Command::Render(args) => render::run(&args, console),
        Command::Convert(args) => convert::run(&args, console),
        Command::Scene(args) => scene::run(&args, console),
        Command::Tiles(args) => tiles::run(&args, console),
        Command::Plan(args) => plan::run(&args, console),
        Command::Task(args) => task::run(&args, console),
        Command::Bench(args) => bench::run(&args, console),
        Command::Completions(args) => completions::run(&args),
        Command::Man(args) => man::run(&args, console),
    }
}
