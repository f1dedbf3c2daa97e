//! `karui hierarchy bench`: how fast, and how alike.

mod check;
mod paper;
mod walk;

use super::BuildArgs;
use super::criteria::CriteriaArgs;
use crate::commands::bench::page::{Page, tell};
use crate::console::Console;
use crate::table::{count, seconds};
use anyhow::Result;
use karui::geom::{Aabb, Light, Vec3};
use std::path::PathBuf;

/// Measure hierarchies: builds, walks around, walks that are checked, the published experiment
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The models
    #[arg(value_name = "FILES")]
    files: Vec<PathBuf>,
    /// Also walk over one fractal terrain in so many triangles
    #[arg(long, value_name = "TRIANGLES", value_delimiter = ',',
          value_parser = clap::value_parser!(u32).range(2..=100_000_000))]
    sizes: Vec<u32>,
    /// Frames of a walk: once around
    #[arg(long, value_name = "N", default_value_t = 1200,
          value_parser = clap::value_parser!(u32).range(2..=1_000_000))]
    frames: u32,
    /// Walk along a path of cameras and lights instead, as JSON (`karui view` records them)
    #[arg(long, value_name = "FILE", conflicts_with_all = ["frames", "sizes", "check", "paper"])]
    path: Option<PathBuf>,
    /// Instead: random walks of N frames, every one checked
    #[arg(long, value_name = "N", conflicts_with_all = ["paper", "sizes"])]
    check: Option<u32>,
    /// Instead: the experiment of Miyamura and Imai, table 2
    #[arg(long, conflicts_with = "sizes")]
    paper: bool,
    /// With --paper: square pixels at which view and light are compared with the view alone
    #[arg(long, value_name = "PX2", value_delimiter = ',', default_values_t = [50.0, 200.0])]
    areas: Vec<f64>,
    /// With --paper: rho for these, degrees
    #[arg(long, value_name = "DEG", default_value_t = 10.0)]
    rho: f64,
    /// With --paper: also write the pictures, and how they differ
    #[arg(long, value_name = "DIR", requires = "paper")]
    pictures: Option<PathBuf>,
    /// Markdown file to write the figures into instead of printing them
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    criteria: CriteriaArgs,
    #[command(flatten)]
    build: BuildArgs,
}

/// Runs what was asked for, model after model.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    let page = args.output.as_deref().map(Page::open).transpose()?;
    let (section, markdown) = if let Some(frames) = args.check {
        (
            "karui hierarchy bench --check",
            check::run(args, frames, console)?,
        )
    } else if args.paper {
        ("karui hierarchy bench --paper", paper::run(args, console)?)
    } else {
        // Land alone has a section of its own, so that it can have its own criteria.
        let section = match args.files.is_empty() {
            true => "karui hierarchy bench --sizes",
            false => "karui hierarchy bench",
        };
        (section, walk::run(args, console)?)
    };
    tell(page, section, &markdown, console)?;
    console.summary(&format!(
        "{} models; {}",
        count(args.files.len() + args.sizes.len()),
        seconds(console.elapsed())
    ))
}

/// Two white lights that stand still: upper left in front, right behind.
fn two_lights(bounds: Aabb) -> Vec<Light> {
    let far = 2.0 * bounds.diagonal() as f32;
    let light = |direction: Vec3, share: f32| Light::Point {
        position: bounds.center() + direction.normalize_or_zero() * far,
        color: Vec3::ONE,
        intensity: share * far * far,
    };
    vec![
        light(Vec3::new(-1.0, 1.0, 1.5), 0.8),
        light(Vec3::new(1.5, 0.6, -0.5), 0.5),
    ]
}

/// The value that a share `q` of all does not exceed; 0 of none.
pub(super) fn quantile(mut values: Vec<f64>, q: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let at = (q * (values.len().max(1) - 1) as f64).round() as usize;
    values.get(at).copied().unwrap_or_default()
}
