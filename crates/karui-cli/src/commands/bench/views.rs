//! `karui bench views`: how many directions image saliency needs.

use super::page::{Page, machine, tell};
use crate::console::{Console, to_stderr};
use crate::input;
use crate::progress::check_cancelled;
use crate::table::{count, seconds, table};
use crate::textures;
use anyhow::Result;
use karui::render::Model;
use karui::saliency::{MultiView, MultiViewOptions, Views, multi_view};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Image saliency from fewer directions, compared with that from the published 614
///
/// Every model is looked at from the grid of 614 directions (An 2014) and from fewer, spread
/// evenly, and what they say of its vertices is correlated.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The models
    #[arg(required = true, value_name = "FILES")]
    files: Vec<PathBuf>,
    /// Numbers of directions
    #[arg(long, value_name = "N", value_delimiter = ',', default_values_t = [24, 48, 96, 192],
          value_parser = clap::value_parser!(u32).range(1..=10_000))]
    views: Vec<u32>,
    /// Markdown file to write the figures into instead of printing them
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

#[derive(Debug, Serialize)]
struct Row {
    model: String,
    vertices: usize,
    views: String,
    seconds: f64,
    /// Correlation over the vertices of mean, maximum and minimum; none where the grid
    /// has one value for all.
    correlation: [Option<f64>; 3],
}

/// Runs every model, one after the other.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    let page = args.output.as_deref().map(Page::open).transpose()?;
    let mut rows = Vec::new();
    for file in &args.files {
        if !console.quiet {
            to_stderr(&file.display().to_string());
        }
        of_file(file, args, console, &mut rows)?;
    }
    let markdown = markdown(&rows);
    tell(page, "karui bench views", &markdown, console)?;
    console.document(&rows)?;
    console.summary(&format!(
        "{} models; {}",
        args.files.len(),
        seconds(console.elapsed())
    ))
}

fn of_file(path: &Path, args: &Args, console: &Console, rows: &mut Vec<Row>) -> Result<()> {
    let input = input::read(path, console)?;
    input.require_triangles()?;
    let images = textures::decode(&input, console);
    let model = Model::of_scene(&input.scene, &images);
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let mut look = |views: Views, label: String, best: Option<&[Vec<f32>; 3]>| -> Result<_> {
        check_cancelled()?;
        let options = MultiViewOptions {
            views,
            ..MultiViewOptions::default()
        };
        let start = Instant::now();
        let found = joined(&multi_view(&model, &options, &*console.progress())?);
        rows.push(Row {
            model: name.clone().into_owned(),
            vertices: found[0].len(),
            views: label,
            seconds: start.elapsed().as_secs_f64(),
            correlation: std::array::from_fn(|i| {
                correlation(&best.unwrap_or(&found)[i], &found[i])
            }),
        });
        Ok(found)
    };
    let grid = MultiViewOptions::default().views;
    let label = format!("{} (grid)", grid.directions().len());
    let best = look(grid, label, None)?;
    for &n in &args.views {
        look(Views::Fibonacci(n), n.to_string(), Some(&best))?;
    }
    Ok(())
}

/// Mean, maximum and minimum of the vertices of all meshes.
fn joined(meshes: &[MultiView]) -> [Vec<f32>; 3] {
    let all = |pick: fn(&MultiView) -> &Vec<f32>| meshes.iter().flat_map(pick).copied().collect();
    [all(|m| &m.mean), all(|m| &m.maximum), all(|m| &m.minimum)]
}

/// Pearson's; none if either does not vary.
fn correlation(a: &[f32], b: &[f32]) -> Option<f64> {
    let mean = |v: &[f32]| v.iter().map(|x| f64::from(*x)).sum::<f64>() / v.len() as f64;
    let (ma, mb) = (mean(a), mean(b));
    let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
    for (x, y) in a.iter().zip(b) {
        let (x, y) = (f64::from(*x) - ma, f64::from(*y) - mb);
        ab += x * y;
        aa += x * x;
        bb += y * y;
    }
    (aa > 0.0 && bb > 0.0).then(|| ab / (aa * bb).sqrt())
}

fn markdown(rows: &[Row]) -> String {
    let header = [
        "model", "vertices", "views", "s", "mean", "maximum", "minimum",
    ];
    let cells: Vec<Vec<String>> = rows
        .iter()
        .map(|row| {
            let mut line = vec![
                format!("`{}`", row.model),
                count(row.vertices),
                row.views.clone(),
                format!("{:.2}", row.seconds),
            ];
            let shown = |c: &Option<f64>| c.map_or("-".to_owned(), |c| format!("{c:.4}"));
            line.extend(row.correlation.iter().map(shown));
            line
        })
        .collect();
    format!(
        "## Image saliency from fewer directions\n\n\
         Written by `karui bench views FILES -o FILE` (release build): 512 x 512 pixels a view;\n\
         mean, maximum, minimum: correlation over all vertices with those of the grid.\n\n\
         {}\n\n{}\n",
        machine(),
        table(&header, &cells, true)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn correlations_of_lines_and_of_nothing() {
        let line = [1.0, 2.0, 3.0];
        assert_eq!(correlation(&line, &[10.0, 20.0, 30.0]), Some(1.0));
        assert_eq!(correlation(&line, &[3.0, 2.0, 1.0]), Some(-1.0));
        assert_eq!(correlation(&line, &[7.0; 3]), None);
    }
}
