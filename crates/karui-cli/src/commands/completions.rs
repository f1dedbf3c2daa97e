//! `karui completions`: tab completion for shells.

use crate::args::Cli;
use crate::console::bytes_to_stdout;
use anyhow::Result;
use clap::CommandFactory;
use clap_complete::Shell;

/// Print a shell's completion script
///
/// For bash: `karui completions bash > ~/.local/share/bash-completion/completions/karui`
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The shell
    shell: Shell,
}

/// Prints the script.
pub fn run(args: &Args) -> Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "karui", &mut script);
    bytes_to_stdout(&script)
}
