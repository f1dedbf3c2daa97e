//! `karui hierarchy clusters build`: a model prepared once.

use super::BuildArgs;
use crate::commands::hierarchy::read_mesh;
use crate::console::Console;
use crate::output::staged;
use crate::table::{bytes, count, percent, seconds};
use anyhow::Result;
use serde_json::json;
use std::path::PathBuf;
use std::time::Instant;

/// Split a model into clusters, simplify them level by level, and write all to a file
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
    let dag = super::build(&mesh, args.build, &args.input, console)?;
    let took = started.elapsed();
    let written = dag.to_bytes();
    staged(&args.output, &written)?.publish()?;
    let (triangles, roots) = (dag.input_triangles(), dag.triangles_of_roots());
    let share = roots as f64 / triangles.max(1) as f64;
    console.document(&json!({
        "input": args.input, "output": args.output, "bytes": written.len(),
        "clusters": dag.clusters().len(), "groups": dag.groups().len(),
        "levels": dag.levels(), "stuck": dag.stuck(),
        "triangles": { "input": triangles, "roots": roots }, "share_of_roots": share,
        "bytes_per_triangle": written.len() as f64 / triangles.max(1) as f64,
        "seconds": took.as_secs_f64(),
    }))?;
    console.summary(&format!(
        "{}: {} clusters and {} groups in {} levels, {} stuck; from {} to {} triangles ({}), {}; built in {}",
        args.output.display(),
        count(dag.clusters().len()),
        count(dag.groups().len()),
        dag.levels(),
        count(dag.stuck()),
        count(triangles),
        count(roots),
        percent(share),
        bytes(written.len() as u64),
        seconds(took),
    ))
}
