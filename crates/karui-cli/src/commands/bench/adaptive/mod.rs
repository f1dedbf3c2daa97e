//! `karui bench adaptive`: cages refined where they are looked at.

mod measured;
mod pictures;

use super::page::{Page, machine, tell};
use crate::args::size;
use crate::console::{Console, to_stderr};
use crate::output::Staged;
use crate::progress::check_cancelled;
use crate::table::{count, seconds, table};
use anyhow::{Context, Result};
use karui::subdiv::adaptive::AdaptiveOptions;
use measured::Row;
use std::path::PathBuf;

/// Refine cages for one view, then for a walk around, beside uniform refinement
///
/// Pictures are taken at the same camera and compared, by FLIP, with one of uniform refinement
/// two steps of √2 deeper than silhouettes are.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Control meshes
    #[arg(value_name = "FILES", required = true)]
    files: Vec<PathBuf>,
    /// Width and height of the pictures
    #[arg(long, value_name = "N|WxH", default_value = "1024", value_parser = size)]
    size: (u32, u32),
    /// Depth of front faces, as published
    #[arg(long, value_name = "N", default_value_t = 4,
          value_parser = clap::value_parser!(u32).range(0..=12))]
    depth_front: u32,
    /// Depth of silhouettes, as published
    #[arg(long, value_name = "N", default_value_t = 8,
          value_parser = clap::value_parser!(u32).range(0..=12))]
    depth_silhouette: u32,
    /// Distances to the limit surface, pixels
    #[arg(long, value_name = "PX", value_delimiter = ',', default_values_t = [1.0, 0.25])]
    pixels: Vec<f64>,
    /// Frames of the walk, half a degree apart
    #[arg(long, value_name = "N", default_value_t = 60,
          value_parser = clap::value_parser!(u32).range(1..=10_000))]
    frames: u32,
    /// Degrees around the model where it is looked at from, from +z towards +x
    #[arg(
        long,
        value_name = "DEG",
        default_value_t = 30.0,
        allow_hyphen_values = true
    )]
    azimuth: f64,
    /// Degrees above the horizon
    #[arg(
        long,
        value_name = "DEG",
        default_value_t = 15.0,
        allow_hyphen_values = true
    )]
    elevation: f64,
    /// Also write pictures from the front and from the side
    #[arg(long, value_name = "DIR")]
    pictures: Option<PathBuf>,
    /// Markdown file to write the figures into instead of printing them
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

impl Args {
    /// What is measured, by name.
    fn settings(&self) -> Vec<(String, AdaptiveOptions)> {
        let published = AdaptiveOptions {
            depth_front: self.depth_front,
            depth_silhouette: self.depth_silhouette,
            ..AdaptiveOptions::default()
        };
        let name = format!("depths {}/{}", self.depth_front, self.depth_silhouette);
        let within = |&px: &f64| (format!("{px} px"), AdaptiveOptions::within(px));
        let all = self.pixels.iter().map(within);
        [(name, published)].into_iter().chain(all).collect()
    }
}

/// Measures every file, one after the other.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    let page = args.output.as_deref().map(Page::open).transpose()?;
    let staged = args
        .pictures
        .as_deref()
        .map(Staged::in_directory)
        .transpose()?;
    let mut rows = Vec::new();
    for file in &args.files {
        check_cancelled()?;
        if !console.quiet {
            to_stderr(&file.display().to_string());
        }
        let mut control = karui_io::read_control(file)?.mesh;
        measured::turn_outwards(&mut control);
        let found = measured::of_control(file, &control, args, staged.as_ref());
        rows.extend(found.with_context(|| file.display().to_string())?);
    }
    if let Some(staged) = staged {
        staged.publish()?;
    }
    tell(
        page,
        "karui bench adaptive",
        &markdown(args, &rows),
        console,
    )?;
    console.document(&rows)?;
    console.summary(&format!(
        "{} rows; {}",
        rows.len(),
        seconds(console.elapsed())
    ))
}

fn times(uniform: &measured::Uniform, faces: usize) -> String {
    let times = uniform.faces as f64 / faces as f64;
    format!(
        "{}, depth {}: {times:.1} x",
        count(uniform.faces),
        uniform.depth
    )
}

fn markdown(args: &Args, rows: &[Row]) -> String {
    let header = [
        "model",
        "to",
        "faces",
        "FLIP",
        "uniformly as deep",
        "its FLIP",
        "as alike",
        "its FLIP",
        "first frame, ms",
        "next, ms",
        "CPU, ms",
        "slowest, ms",
        "kept",
    ];
    let cells = |row: &Row| {
        vec![
            format!("`{}`", row.model),
            row.setting.clone(),
            count(row.faces),
            format!("{:.4}", row.flip),
            times(&row.deep, row.faces),
            format!("{:.4}", row.deep.flip),
            times(&row.alike, row.faces),
            format!("{:.4}", row.alike.flip),
            format!("{:.1}", row.first * 1e3),
            format!("{:.1}", row.median * 1e3),
            format!("{:.1}", row.cpu * 1e3),
            format!("{:.1}", row.slowest * 1e3),
            count(row.kept),
        ]
    };
    let rows: Vec<_> = rows.iter().map(cells).collect();
    let (width, height) = args.size;
    format!(
        "## Refined where it is looked at\n\n\
         Written by `karui bench adaptive FILES -o FILE` (release build); pictures of {width} x \
         {height} pixels.\n\n\
         - FLIP: mean difference to a picture of uniform refinement to depth {}, 0 is none.\n\
         - uniformly as deep: all to the depth of silhouettes, and how many times as many faces; \
         as alike: the same for the least depth whose picture differs no more, or the deepest.\n\
         - first frame: from the cage, with nothing kept; next, CPU: median, and mean time of the \
         processor, of the {} after it, half a degree apart around the model. kept: faces of all \
         levels, after these.\n\
         - Closed cages whose faces are wound the other way are turned over first.\n\n{}\n\n{}\n",
        args.depth_silhouette + 2,
        args.frames,
        machine(),
        table(&header, &rows, true)
    )
}
