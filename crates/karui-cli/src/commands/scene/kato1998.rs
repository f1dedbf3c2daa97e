//! `karui scene kato1998`: the scenes of the paper on grouping.

use super::OutputArgs;
use crate::console::Console;
use anyhow::Result;
use karui::mesh::scenes::{kato1998_32_trees, kato1998_wide};

/// Make a scene of the paper on perceptual grouping (Kato, Kanoh and Nishihara 1998)
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Which scene: 32 green trees (fig. 11), the same with 5 red ones (fig. 9), or 24 trees
    /// near and 400 far (fig. 12)
    #[arg(value_enum)]
    which: Which,
    #[command(flatten)]
    output: OutputArgs,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Which {
    Single,
    Mixed,
    Wide,
}

/// Makes and writes it.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    args.output.check()?;
    let scene = match args.which {
        Which::Single => kato1998_32_trees(false),
        Which::Mixed => kato1998_32_trees(true),
        Which::Wide => kato1998_wide(1),
    };
    args.output.write(&scene, "the paper's scene", console)
}
