//! `karui hierarchy build`: a model prepared once.

use super::{BuildArgs, read_mesh};
use crate::console::Console;
use crate::output::staged;
use crate::table::{bytes, count, seconds};
use anyhow::Result;
use serde_json::json;
use std::path::PathBuf;
use std::time::Instant;

/// Prepare a model for refinement and write the hierarchy to a file
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The model; all of it becomes one mesh
    input: PathBuf,
    /// The file to write
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    #[command(flatten)]
    build: BuildArgs,
}

/// Reads, builds, writes, then tells.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    let (_, mesh) = read_mesh(&args.input, console)?;
    let started = Instant::now();
    let hierarchy = super::build(&mesh, args.build, &args.input, console)?;
    let took = started.elapsed();
    let written = hierarchy.to_bytes();
    staged(&args.output, &written)?.publish()?;
    let (nodes, counts) = (hierarchy.node_count(), hierarchy.counts());
    let per_node = hierarchy.node_bytes() as f64 / nodes.max(1) as f64;
    console.document(&json!({
        "input": args.input, "output": args.output, "bytes": written.len(),
        "triangles": { "finest": hierarchy.triangle_count(), "coarsest": counts.coarsest },
        "nodes": nodes, "bytes_per_node": per_node, "seconds": took.as_secs_f64(),
        "dropped": counts.dropped,
        "split": { "edges": counts.split_edges, "vertices": counts.split_vertices },
    }))?;
    console.summary(&format!(
        "{}: {} collapses from {} to {} triangles, {per_node:.1} bytes each, {}; built in {}",
        args.output.display(),
        count(nodes),
        count(hierarchy.triangle_count()),
        count(counts.coarsest),
        bytes(written.len() as u64),
        seconds(took),
    ))
}
