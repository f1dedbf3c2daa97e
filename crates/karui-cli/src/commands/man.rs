//! `karui man`: manual pages.

use crate::args::Cli;
use crate::console::{Console, bytes_to_stdout};
use crate::output;
use anyhow::Result;
use clap::{Command, CommandFactory};
use clap_mangen::Man;
use std::path::PathBuf;

/// Print the manual page, or write one page a command
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Directory to write karui.1, karui-lod.1, ... to, instead of printing
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

/// Prints or writes the pages.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    let mut root = Cli::command();
    root.build();
    let Some(dir) = &args.output else {
        return bytes_to_stdout(&page(&root)?);
    };
    let staged = output::Staged::in_directory(dir)?;
    for command in pages(&root) {
        let name = format!("{}.1", command.get_display_name().unwrap_or("karui"));
        let bytes = page(command)?;
        staged.bytes(&name, &bytes)?;
    }
    let written = staged.publish()?;
    console.summary(&format!("{} pages in {}", written.len(), dir.display()))
}

fn pages(root: &Command) -> Vec<&Command> {
    let shown = |c: &&Command| !c.is_hide_set() && c.get_name() != "help";
    std::iter::once(root)
        .chain(root.get_subcommands().filter(shown))
        .collect()
}

fn page(command: &Command) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    Man::new(command.clone()).render(&mut bytes)?;
    Ok(bytes)
}
