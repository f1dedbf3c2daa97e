//! `karui bench subdivide`: how fast cages are refined.

use super::clock::{Watch, peak_memory};
use super::page::{Page, machine, tell};
use crate::console::Console;
use crate::table::{count, seconds, table};
use anyhow::Result;
use karui::subdiv::{Cage, Refinement, Scheme, SubdivOptions, Workspace};
use serde::Serialize;
use std::path::PathBuf;

/// Refine a torus of quads: connectivity, then positions, then positions again
///
/// With 128 x 64 quads and 5 levels it is what `tools/osd_oracle` times OpenSubdiv with.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Quads around and across the torus
    #[arg(long, value_name = "N,M", value_delimiter = ',', num_args = 2, default_values_t = [128, 64],
          value_parser = clap::value_parser!(u32).range(3..=4096))]
    quads: Vec<u32>,
    /// Steps of Catmull-Clark; √2 takes twice as many, √3 and Loop of triangles two fewer
    #[arg(long, value_name = "N", default_value_t = 5,
          value_parser = clap::value_parser!(u32).range(2..=12))]
    levels: u32,
    /// Times to run; the fastest counts
    #[arg(long, value_name = "N", default_value_t = 5,
          value_parser = clap::value_parser!(u32).range(1..=100))]
    runs: u32,
    /// Markdown file to write the figures into instead of printing them
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

#[derive(Debug, Serialize)]
struct Row {
    scheme: &'static str,
    faces: usize,
    /// Seconds for connectivity, for the first positions, for positions again; on the wall
    /// and of the processor.
    connectivity: [f64; 2],
    first: [f64; 2],
    again: [f64; 2],
    /// Most memory of the process, bytes for every face.
    bytes_a_face: Option<f64>,
}

/// Runs every scheme, one after the other.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    let page = args.output.as_deref().map(Page::open).transpose()?;
    let (quads, positions) = torus(args.quads[0], args.quads[1]);
    let triangles = split(&quads);
    let schemes = [
        ("Catmull-Clark", Scheme::CatmullClark, &quads, args.levels),
        ("√2", Scheme::Sqrt2, &quads, 2 * args.levels),
        ("Loop", Scheme::Loop, &triangles, args.levels - 2),
        ("√3", Scheme::Sqrt3, &triangles, args.levels - 2),
    ];
    let mut rows = Vec::new();
    for (name, scheme, cage, levels) in schemes {
        let options = SubdivOptions {
            scheme,
            levels,
            ..SubdivOptions::default()
        };
        rows.push(measured(name, cage, &positions, &options, args.runs)?);
    }
    let markdown = markdown(&rows);
    tell(page, "karui bench subdivide", &markdown, console)?;
    console.document(&rows)?;
    console.summary(&format!(
        "{} schemes; {}",
        rows.len(),
        seconds(console.elapsed())
    ))
}

fn measured(
    scheme: &'static str,
    cage: &Cage,
    positions: &[[f32; 3]],
    options: &SubdivOptions,
    runs: u32,
) -> Result<Row> {
    let mut row = Row {
        scheme,
        faces: 0,
        connectivity: [f64::INFINITY; 2],
        first: [f64::INFINITY; 2],
        again: [f64::INFINITY; 2],
        bytes_a_face: None,
    };
    let least = |of: &mut [f64; 2], cost: super::clock::Cost| {
        *of = [of[0].min(cost.wall), of[1].min(cost.cpu)];
    };
    for _ in 0..runs {
        let (refinement, cost) = Watch::TimeAndMemory.call(|| Refinement::new(cage, options));
        least(&mut row.connectivity, cost);
        let refinement = refinement?;
        let (mut workspace, mut to) = (Workspace::default(), Vec::new());
        for time in [&mut row.first, &mut row.again] {
            let evaluate = || refinement.evaluate_into(positions, &mut workspace, &mut to);
            let (done, cost) = Watch::Time.call(evaluate);
            done?;
            least(time, cost);
        }
        row.faces = refinement.faces().count();
        row.bytes_a_face = peak_memory().map(|bytes| bytes as f64 / row.faces as f64);
    }
    Ok(row)
}

fn markdown(rows: &[Row]) -> String {
    let header = [
        "scheme",
        "faces",
        "connectivity, ms",
        "positions, ms",
        "again, ms",
        "million faces/s",
        "bytes a face",
    ];
    let pair = |[wall, cpu]: [f64; 2]| format!("{:.0} ({:.0})", wall * 1e3, cpu * 1e3);
    let row = |row: &Row| {
        let rate = row.faces as f64 / (row.connectivity[0] + row.first[0]) / 1e6;
        vec![
            row.scheme.to_owned(),
            count(row.faces),
            pair(row.connectivity),
            pair(row.first),
            pair(row.again),
            format!("{rate:.1}"),
            row.bytes_a_face.map_or("-".into(), |b| format!("{b:.0}")),
        ]
    };
    let rows: Vec<_> = rows.iter().map(row).collect();
    format!(
        "{}\n\nTimes on the wall, in brackets of the processor; the least of all runs. The rate \
         is of connectivity and first positions together. Memory is the most the process had.\n\n{}",
        machine(),
        table(&header, &rows, true)
    )
}

fn torus(around: u32, across: u32) -> (Cage, Vec<[f32; 3]>) {
    let mesh = karui::mesh::shapes::torus(1.0, 0.4, around, across);
    let mut cage = Cage {
        vertices: mesh.positions.len(),
        offsets: vec![0],
        ..Cage::default()
    };
    for j in 0..across {
        for i in 0..around {
            let at = |i: u32, j: u32| j % across * around + i % around;
            cage.indices
                .extend([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
            cage.offsets.push(cage.indices.len() as u32);
        }
    }
    (cage, mesh.positions.iter().map(|p| p.to_array()).collect())
}

/// Every quad as two triangles.
fn split(quads: &Cage) -> Cage {
    let halves = quads.indices.chunks_exact(4);
    let indices: Vec<u32> = halves
        .flat_map(|q| [q[0], q[1], q[2], q[0], q[2], q[3]])
        .collect();
    Cage {
        vertices: quads.vertices,
        offsets: (0..=indices.len() as u32 / 3).map(|f| 3 * f).collect(),
        indices,
        ..Cage::default()
    }
}
