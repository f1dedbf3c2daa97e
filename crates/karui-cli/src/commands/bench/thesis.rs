//! `karui bench thesis`: the times of An's thesis, fig. 5.10, measured here.

use super::page::{Page, machine, tell};
use crate::console::Console;
use crate::input;
use crate::progress::check_cancelled;
use crate::table::{count, seconds, table};
use anyhow::Result;
use karui::render::Model;
use karui::saliency::{
    CurvatureOptions, Estimator, HybridOptions, Preset, curvature_sizes, curvature_with, hybrid,
    mesh_saliency, multi_view,
};
use karui::simplify::{SimplifyOptions, Stop, simplify};
use karui::{Silent, TriMesh};
use serde::Serialize;
use std::path::PathBuf;
use std::time::Instant;

/// Times of saliency and of a collapse, as the thesis gives them (An 2014, fig. 5.10)
///
/// The model is brought down to each number of triangles first. Then mesh saliency, image saliency
/// of 614 views and what combines them are timed as `thesis2014` has them, and a collapse: half of
/// the triangles go, one collapse at a time, weighted, with averaged quadrics.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The model; the thesis has the armadillo
    input: PathBuf,
    /// Numbers of triangles
    #[arg(long, value_name = "N", value_delimiter = ',', default_values_t = [5000, 4000, 3000, 2000])]
    triangles: Vec<usize>,
    /// Markdown file to write the figures into instead of printing them
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

#[derive(Debug, Serialize)]
struct Row {
    triangles: usize,
    /// Seconds: mesh saliency, image saliency, hybrid, a collapse.
    seconds: [f64; 4],
}

/// What the thesis says of its four sizes: seconds, as in [`Row`]; of hybrid saliency that it
/// takes less than this.
const THESIS: [(usize, [f64; 4]); 4] = [
    (5000, [6.80, 14.93, 0.001, 0.0024]),
    (4000, [4.24, 14.88, 0.001, 0.0023]),
    (3000, [2.46, 14.89, 0.001, 0.0016]),
    (2000, [1.11, 14.67, 0.001, 0.0011]),
];

/// Measures every size, one after the other.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    let page = args.output.as_deref().map(Page::open).transpose()?;
    let input = input::read(&args.input, console)?;
    input.require_triangles()?;
    let mesh = input.scene.into_single_mesh()?;
    let mut rows = Vec::new();
    for &triangles in &args.triangles {
        check_cancelled()?;
        rows.push(of_size(&mesh, triangles)?);
    }
    let name = args.input.file_name().unwrap_or_default().to_string_lossy();
    let markdown = markdown(&name, &rows);
    tell(page, "karui bench thesis", &markdown, console)?;
    console.document(&rows)?;
    console.summary(&format!(
        "{} sizes; {}",
        rows.len(),
        seconds(console.elapsed())
    ))
}

fn of_size(mesh: &TriMesh, triangles: usize) -> Result<Row> {
    let options = SimplifyOptions {
        stop: Stop::triangles(triangles),
        ..SimplifyOptions::default()
    };
    let mesh = simplify(mesh, &options)?.mesh;
    let estimator = Estimator::Taubin1995;
    let shape = Preset::Thesis2014.mesh().unwrap_or_default();
    let model = Model::of_mesh(&mesh);
    let views = Preset::Thesis2014.views().unwrap_or_default();
    let bends = curvature_sizes(&curvature_with(&mesh, &CurvatureOptions { estimator })?);
    let (shape, of_mesh) = timed(|| mesh_saliency(&mesh, &shape))?;
    let (seen, of_views) = timed(|| multi_view(&model, &views, &Silent))?;
    let (found, of_hybrid) = timed(|| hybrid(&bends, &shape, &seen[0], &HybridOptions::default()))?;
    let weights = Preset::Thesis2014.weights().weights(&found.values)?;
    let options = SimplifyOptions {
        stop: Stop::triangles(mesh.triangles.len() / 2),
        weights: Some(&weights),
        cost: Preset::Thesis2014.cost(),
        ..SimplifyOptions::default()
    };
    let (coarse, of_collapses) = timed(|| simplify(&mesh, &options))?;
    let of_collapse = of_collapses / coarse.collapses.max(1) as f64;
    Ok(Row {
        triangles: mesh.triangles.len(),
        seconds: [of_mesh, of_views, of_hybrid, of_collapse],
    })
}

fn timed<T>(work: impl FnOnce() -> karui::Result<T>) -> karui::Result<(T, f64)> {
    let start = Instant::now();
    Ok((work()?, start.elapsed().as_secs_f64()))
}

fn markdown(name: &str, rows: &[Row]) -> String {
    let header = [
        "triangles",
        "mesh saliency, s",
        "614 views, s",
        "hybrid, ms",
        "collapse, ms",
    ];
    let cells: Vec<Vec<String>> = rows
        .iter()
        .map(|row| {
            let published = THESIS.iter().find(|t| row.triangles.abs_diff(t.0) <= 50);
            let [mesh, views, hybrid, collapse] = std::array::from_fn(|i| {
                let scale = if i < 2 { 1.0 } else { 1000.0 };
                let own = format!("{:.4}", row.seconds[i] * scale);
                let under = if i == 2 { "under " } else { "" };
                let theirs = published.map(|t| format!(" ({under}{})", t.1[i] * scale));
                own + &theirs.unwrap_or_default()
            });
            vec![count(row.triangles), mesh, views, hybrid, collapse]
        })
        .collect();
    format!(
        "## Times of An's thesis\n\n\
         Written by `karui bench thesis MODEL -o FILE` (release build) for `{name}`; in brackets\n\
         what the thesis gives (2014, its fig. 5.10). A collapse: one at a time, averaged quadrics.\n\n\
         {}\n\n{}\n",
        machine(),
        table(&header, &cells, true)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_times_stand_beside_those_of_the_same_size() {
        let row = |triangles| Row {
            triangles,
            seconds: [0.5, 2.0, 0.0001, 0.0003],
        };
        let page = markdown("a.off", &[row(4998), row(700)]);
        assert!(
            page.contains("0.5000 (6.8)") && page.contains("(under 1)"),
            "{page}"
        );
        assert!(
            page.lines().any(|l| l.contains("700") && !l.contains('(')),
            "{page}"
        );
    }
}
