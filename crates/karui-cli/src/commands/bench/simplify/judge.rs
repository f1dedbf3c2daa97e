//! `karui bench judge`: results of any tool, measured as ours are.

use super::errors::{Errors, Reference};
use super::inputs::Model;
use crate::console::Console;
use crate::output::write_one;
use anyhow::{Context as _, Result};
use karui::Scene;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Measure simplified models against the original (used by `tools/peers.py`)
///
/// The original is taken without attributes and with vertices at one place joined, which is what
/// `--prepare` writes, for a tool to simplify.
#[derive(Debug, clap::Args)]
#[command(hide = true)]
pub struct Args {
    /// The original
    original: PathBuf,
    /// Simplified models
    results: Vec<PathBuf>,
    /// Write the original as it is to be simplified
    #[arg(long, value_name = "FILE")]
    prepare: Option<PathBuf>,
    /// Face samples, and as many edge samples
    #[arg(long, value_name = "N", default_value_t = 200_000)]
    samples: u64,
}

/// What is printed.
#[derive(Debug, Serialize)]
struct Judgement {
    triangles: usize,
    results: Vec<Errors>,
}

/// Writes the original, then measures.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    let mesh = Model::read(&args.original, Path::new(""))?.geometry;
    if let Some(path) = &args.prepare {
        write_one(
            path,
            &Scene::from_mesh(mesh.clone()),
            &karui_io::WriteOptions::default(),
        )?;
    }
    let mut results = Vec::new();
    if !args.results.is_empty() {
        let reference = Reference::new(&mesh)?;
        for path in &args.results {
            let name = || path.display().to_string();
            let result = Model::read(path, Path::new("")).with_context(name)?;
            let errors = reference.measure(&result.geometry, args.samples);
            results.push(errors.with_context(name)?);
        }
    }
    console.document(&Judgement {
        triangles: mesh.triangles.len(),
        results,
    })
}
