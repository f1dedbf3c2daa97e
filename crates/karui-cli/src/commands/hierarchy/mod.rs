//! `karui hierarchy`: detail where the camera and the light need it.

mod bench;
mod build;
mod clusters;
mod criteria;
mod frames;
mod refine;

use crate::console::Console;
use crate::failure::Failure;
use crate::input::{self, Input};
use anyhow::Result;
use clap::Subcommand;
use karui::TriMesh;
use karui::hierarchy::{Hierarchy, HierarchyOptions};
use std::path::Path;

/// Refine a model frame by frame, by view and by light
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    Build(build::Args),
    Refine(refine::Args),
    Bench(bench::Args),
    Clusters(clusters::Args),
}

/// Runs the subcommand.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    match &args.what {
        What::Build(args) => build::run(args, console),
        What::Refine(args) => refine::run(args, console),
        What::Bench(args) => bench::run(args, console),
        What::Clusters(args) => clusters::run(args, console),
    }
}

/// Down to one vertex in how many.
#[derive(Debug, Clone, Copy, clap::Args)]
struct BuildArgs {
    /// The coarsest mesh has one in ALPHA of the vertices; `inf` goes as far as can be
    #[arg(long, value_name = "ALPHA", default_value_t = 10.0, value_parser = alpha)]
    alpha: f64,
}

fn alpha(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|a: &f64| *a >= 1.0);
    number.ok_or_else(|| "expected a number of 1 or more, or `inf`".to_owned())
}

/// A model as the one mesh that a hierarchy is built from.
fn read_mesh(path: &Path, console: &Console) -> Result<(Input, TriMesh)> {
    let input = input::read(path, console)?;
    input.require_triangles()?;
    let fail = |e| Failure::input(format!("{}: {e}", path.display()));
    let mesh = input.scene.clone().into_single_mesh().map_err(fail)?;
    Ok((input, mesh))
}

fn build(mesh: &TriMesh, args: BuildArgs, path: &Path, console: &Console) -> Result<Hierarchy> {
    let progress = console.progress();
    let options = HierarchyOptions {
        alpha: args.alpha,
        progress: &*progress,
        ..HierarchyOptions::default()
    };
    let built = Hierarchy::build(mesh, &options);
    drop(progress);
    crate::progress::check_cancelled()?;
    let fail = |e| Failure::input(format!("{}: {e}", path.display()));
    let hierarchy = built.map_err(fail)?;
    let counts = hierarchy.counts();
    if counts.split_edges + counts.split_vertices > 0 {
        console.warn(&format!(
            "{}: cut open at {} edges and {} vertices that are not manifold; these stay as they are",
            path.display(),
            counts.split_edges,
            counts.split_vertices,
        ));
    }
    Ok(hierarchy)
}
