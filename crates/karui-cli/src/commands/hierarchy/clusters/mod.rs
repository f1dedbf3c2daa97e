//! `karui hierarchy clusters`: levels of detail in clusters of triangles.

mod bench;
mod build;
mod cut;

use crate::console::Console;
use crate::failure::Failure;
use crate::progress::check_cancelled;
use anyhow::Result;
use clap::Subcommand;
use karui::hierarchy::cluster::{ClusterDag, ClusterDagOptions};
use karui::{Error, TriMesh};
use std::path::Path;

/// Draw a model in clusters, each as coarse as the view allows
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    Build(build::Args),
    Cut(cut::Args),
    Bench(bench::Args),
}

/// Runs the subcommand.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    match &args.what {
        What::Build(args) => build::run(args, console),
        What::Cut(args) => cut::run(args, console),
        What::Bench(args) => bench::run(args, console),
    }
}

/// How large clusters and groups are.
#[derive(Debug, Clone, Copy, clap::Args)]
struct BuildArgs {
    /// Most triangles of a cluster, 8 to 255
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(8..),
          default_value_t = ClusterDagOptions::default().max_triangles as u8)]
    max_triangles: u8,
    /// Most clusters that are simplified together, 2 to 64; more where these cannot be
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(2..=64),
          default_value_t = ClusterDagOptions::default().group_size as u8)]
    group_size: u8,
}

/// Clusters of a mesh that was read from `path`.
fn build(mesh: &TriMesh, args: BuildArgs, path: &Path, console: &Console) -> Result<ClusterDag> {
    let progress = console.progress();
    let options = ClusterDagOptions {
        max_triangles: args.max_triangles.into(),
        group_size: args.group_size.into(),
        progress: &*progress,
        ..ClusterDagOptions::default()
    };
    let built = ClusterDag::build(mesh, &options);
    drop(progress);
    check_cancelled()?;
    let fail = |e| Failure::input(format!("{}: {e}", path.display()));
    Ok(built.map_err(fail)?)
}

/// Clusters from the file `path`, if they are those of `mesh`, read from `model`.
fn read(path: &Path, mesh: &TriMesh, model: &Path) -> Result<ClusterDag> {
    let fail = |e: &dyn std::fmt::Display| {
        let failure = Failure::input(format!("{}: {e}", path.display()));
        failure.hint("`karui hierarchy clusters build` writes such files")
    };
    let bytes = std::fs::read(path).map_err(|e| fail(&e))?;
    let dag = ClusterDag::from_bytes(&bytes).map_err(|e| fail(&e))?;
    // It holds together, so what is wrong now is wrong for this mesh.
    dag.validate_for(mesh).map_err(|e| {
        let why = match e {
            Error::OtherMesh { what } => format!("its {what} differs"),
            other => other.to_string(),
        };
        let model = model.display();
        fail(&format!(
            "the clusters are of another mesh than {model}: {why}"
        ))
    })?;
    Ok(dag)
}
