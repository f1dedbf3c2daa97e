//! One mesh of any size as tiles.

use super::Args;
use crate::console::Console;
use crate::outofcore::{Work, cloudy, memory, observer, told, told_of_files};
use crate::table::{bytes, count, number, seconds};
use anyhow::Result;
use karui::outofcore::{PlanOptions, TileCut, tile_tree};
use karui_io::tiles::{TilesOptions, TilesWritten, write_blocks, write_blocks_implicit};
use std::path::{Path, PathBuf};

/// Models larger than memory.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Models larger than memory")]
pub struct LargeArgs {
    /// Read one mesh in slices and work on it in blocks, with so much memory, e.g. 1GiB
    #[arg(long, value_name = "SIZE", value_parser = memory,
          conflicts_with_all = ["grouping", "stand_in", "kinds", "tolerance", "error", "pixels"])]
    pub memory_limit: Option<u64>,
    /// How tiles are told: each by itself, or all by a rule. By a rule, cells are of one size
    /// and triangles are cut at their faces
    #[arg(long, value_enum, default_value_t = Tiling::Explicit, requires = "memory_limit")]
    tiling: Tiling,
    /// Triangles of a block [default: as many as let two fit the memory]
    #[arg(long, value_name = "COUNT", requires = "memory_limit")]
    block_triangles: Option<u64>,
    /// Folder, or s3://, gs:// or az:// URL, for what is not finished [default: the output's name
    /// with .karui; of a URL the last part of it, in this folder]
    #[arg(long, value_name = "PLACE", requires = "memory_limit")]
    work: Option<PathBuf>,
    /// Leave that when all is done
    #[arg(long, requires = "memory_limit")]
    keep_work: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Tiling {
    Explicit,
    Implicit,
}

impl LargeArgs {
    fn plan(&self, triangles: usize, memory: u64) -> PlanOptions {
        let fitting = || PlanOptions::block_triangles_for(memory);
        let block_triangles = self.block_triangles.unwrap_or_else(fitting);
        PlanOptions {
            block_triangles,
            tiles: Some(TileCut {
                triangles: (triangles as u64).min(block_triangles / 8),
                aligned: self.tiling == Tiling::Implicit,
            }),
            ..PlanOptions::default()
        }
    }

    fn folder(&self, output: &Path) -> PathBuf {
        let beside = || {
            let last = cloudy(output).map(|_| output.file_name().unwrap_or_default());
            // Without a slash at its end, which would lead into the folder.
            let whole = || output.components().as_path().as_os_str();
            let mut name = last.unwrap_or_else(whole).to_owned();
            name.push(".karui");
            PathBuf::from(name)
        };
        self.work.clone().unwrap_or_else(beside)
    }
}

/// Makes the tiles.
pub fn run(args: &Args, memory: u64, options: &TilesOptions, console: &Console) -> Result<()> {
    let large = &args.large;
    let folder = large.folder(&args.output);
    let plan = large.plan(args.cut.triangles, memory);
    let work = Work::create(&args.input, &folder, plan)?;
    work.store.sweep()?;
    work.run(memory, rayon::current_num_threads(), console)?;
    let write = match large.tiling {
        Tiling::Explicit => write_blocks,
        Tiling::Implicit => write_blocks_implicit,
    };
    let observer = observer(console.quiet);
    let written = write(&args.output, &work.store, options, &*observer);
    drop(observer);
    let written = written.map_err(told_of_files)?;
    report(args, &work, &written, console)?;
    if !large.keep_work {
        work.store.clear()?;
    }
    Ok(())
}

fn report(args: &Args, work: &Work, written: &TilesWritten, console: &Console) -> Result<()> {
    let tree = tile_tree(&work.store).map_err(told)?;
    let parents: std::collections::BTreeSet<_> = tree.nodes.iter().map(|n| n.parent).collect();
    let is_leaf = |n: &u32| !parents.contains(&Some(*n));
    let leaves = (0..tree.nodes.len() as u32).filter(is_leaf);
    let full: u64 = leaves.map(|n| tree.nodes[n as usize].triangles).sum();
    let most = tree.nodes.iter().map(|n| n.triangles).max().unwrap_or(0);
    let root = &tree.nodes[0];
    console.summary(&format!(
        "{}: {} tiles of {} triangles, {} in a tile at most, {}; coarsest {} triangles, \
         off by {} m; {}",
        args.output.display(),
        count(written.contents as usize),
        count(full as usize),
        count(most as usize),
        bytes(written.bytes),
        count(root.triangles as usize),
        number(root.error),
        seconds(console.elapsed()),
    ))?;
    console.document(&serde_json::json!({
        "input": args.input,
        "output": args.output,
        "made": {
            "triangles": full,
            "most_triangles": most,
            "root_triangles": root.triangles,
            "root_error": root.error,
        },
        "written": written,
    }))
}
