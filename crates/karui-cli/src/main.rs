//! The `karui` command line.

mod args;
mod commands;
mod console;
mod explain;
mod eye;
mod failure;
mod input;
mod outofcore;
mod output;
mod progress;
#[cfg(test)]
mod reference;
mod saliency;
mod sheet;
mod table;
mod text;
mod textures;
mod weights;

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    let args = args::Cli::parse();
    let console = console::Console::new(&args.global);
    let outcome = console
        .prepare(&args.global)
        .and_then(|()| commands::run(args.command, &console));
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => failure::report(&error),
    }
}
