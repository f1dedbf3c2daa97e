//! `karui scene forest`: trees on rolling ground.

use super::{MadeArgs, OutputArgs, refused};
use crate::console::Console;
use anyhow::Result;
use karui::mesh::scenes::{ForestOptions, TreeKind, forest};

/// Make a forest
///
/// Broad trees of 720 triangles and conifers of 105, in several variants, each with a simplified
/// form of 18 or 12 as a level of detail (`MSFT_lod`). Lengths are in metres.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    made: MadeArgs,
    /// Kinds of trees, equally frequent
    #[arg(long, value_enum, value_delimiter = ',', value_name = "KIND",
          default_values_t = [Kind::Broad, Kind::Conifer])]
    kinds: Vec<Kind>,
    /// Share of red trees, 0 to 1
    #[arg(long, value_name = "SHARE", default_value_t = 0.0)]
    red: f32,
    /// Mean distance of neighbours, metres; from 4.75 on no two trees touch
    #[arg(long, value_name = "METRES", default_value_t = ForestOptions::default().spacing)]
    spacing: f32,
    /// Leave the simplified forms out
    #[arg(long)]
    no_lods: bool,
    /// Leave the ground out, which is one object more
    #[arg(long)]
    no_ground: bool,
    #[command(flatten)]
    output: OutputArgs,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Kind {
    Broad,
    Conifer,
}

/// Makes and writes it.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    args.output.check()?;
    let kind = |kind: &Kind| match kind {
        Kind::Broad => TreeKind::Broad,
        Kind::Conifer => TreeKind::Conifer,
    };
    let scene = forest(&ForestOptions {
        count: args.made.count as usize,
        seed: args.made.seed,
        kinds: args.kinds.iter().map(kind).collect(),
        red: args.red,
        spacing: args.spacing,
        lods: !args.no_lods,
        ground: !args.no_ground,
        ..ForestOptions::default()
    });
    let scene = scene.map_err(|error| refused(&args.output, error))?;
    args.output.write(&scene, "a forest", console)
}
