//! `--balance`: how alike the work of regions is on land that is half flat.

use super::super::clock::Watch;
use super::super::page::machine;
use super::land::Size;
use crate::outofcore::{Work, told};
use crate::progress::check_cancelled;
use crate::table::{count, table};
use anyhow::Result;
use karui::Silent;
use karui::outofcore::{self, Manifest, Next, PlanOptions, Scheme, next, run_task};
use serde::Serialize;
use serde_json::{Value, json};
use std::path::Path;

/// Ways to cut, and how many blocks the land would fill at least. Slabs of as much work need
/// larger blocks for as few of them.
const CUTS: [(&str, Scheme, u64); 4] = [
    ("slabs of as many triangles", Scheme::Slabs, 8),
    ("slabs of as much work", Scheme::Sweep, 8),
    ("slabs of as much work", Scheme::Sweep, 5),
    ("cells", Scheme::Cells, 8),
];

#[derive(Debug, Serialize)]
struct Row {
    cut: &'static str,
    block_triangles: u64,
    /// Of the first level: triangles, and seconds of the processor.
    regions: Vec<(u64, f64)>,
}

/// Every way to cut, one task at a time.
pub fn run(size: Size, ratio: f64, folder: &Path) -> Result<(String, Value)> {
    let land = size.make(folder, true)?;
    let mut rows = Vec::new();
    for (cut, scheme, blocks) in CUTS {
        let options = PlanOptions {
            ratio: Some(ratio),
            // A sample more, as cuts lie between samples.
            block_triangles: size.triangles() / blocks + 1024,
            scheme,
            ..PlanOptions::default()
        };
        let work = Work::create(&land, &folder.join("blocks"), options)?;
        rows.push(Row {
            cut,
            block_triangles: work.plan.options.block_triangles,
            regions: first_level(&work)?,
        });
        work.store.clear()?;
    }
    Ok((markdown(size, &rows), json!(rows)))
}

/// Triangles and time of every region of the first level.
fn first_level(work: &Work) -> Result<Vec<(u64, f64)>> {
    loop {
        check_cancelled()?;
        let Next::Run(manifest) = next(&work.store, &work.plan).map_err(told)? else {
            return Ok(Vec::new());
        };
        let (results, times) = rows(work, &manifest).map_err(told)?;
        if manifest.phase.kind == outofcore::Kind::Simplify {
            let triangles = manifest.rows.iter().map(|row| row.triangles);
            return Ok(triangles.zip(times).collect());
        }
        manifest.commit(&work.store, results).map_err(told)?;
    }
}

/// Runs all rows and tells how long each took, seconds of the processor.
fn rows(
    work: &Work,
    manifest: &Manifest,
) -> outofcore::Result<(Vec<outofcore::RowResult>, Vec<f64>)> {
    let run = |row: &outofcore::Row| {
        let task = || run_task(&work.store, &*work.source, manifest, row.id, &Silent);
        let (result, cost) = Watch::Time.call(task);
        Ok((result?, cost.cpu))
    };
    manifest.rows.iter().map(run).collect()
}

fn markdown(size: Size, rows: &[Row]) -> String {
    let header = [
        "cut",
        "block, triangles",
        "regions",
        "largest / smallest",
        "slowest, s",
        "fastest, s",
        "slowest / fastest",
        "mean / slowest",
    ];
    let rows: Vec<_> = rows.iter().map(cells).collect();
    format!(
        "{} Land of {} triangles, half of it flat; regions of the first level, one at a time, \
         seconds of the processor.\n\n{}",
        machine(),
        count(size.triangles() as usize),
        table(&header, &rows, true)
    )
}

fn cells(row: &Row) -> Vec<String> {
    let times = row.regions.iter().map(|r| r.1);
    let slowest = times.clone().fold(0.0, f64::max);
    let fastest = times.clone().fold(f64::INFINITY, f64::min);
    let mean = times.sum::<f64>() / row.regions.len() as f64;
    let triangles = row.regions.iter().map(|r| r.0 as f64);
    let largest = triangles.clone().fold(0.0, f64::max);
    let smallest = triangles.fold(f64::INFINITY, f64::min);
    vec![
        row.cut.to_owned(),
        count(row.block_triangles as usize),
        row.regions.len().to_string(),
        format!("{:.2}", largest / smallest),
        format!("{slowest:.2}"),
        format!("{fastest:.2}"),
        format!("{:.2}", slowest / fastest),
        format!("{:.2}", mean / slowest),
    ]
}
