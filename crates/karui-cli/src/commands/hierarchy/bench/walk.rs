//! Walks around models, timed.

use super::{Args, quantile, two_lights};
use crate::commands::bench::page::machine;
use crate::commands::hierarchy::frames::read_path;
use crate::commands::hierarchy::{build, read_mesh};
use crate::console::{Console, to_stderr};
use crate::failure::Failure;
use crate::progress::check_cancelled;
use crate::table::{count, table};
use anyhow::Result;
use karui::TriMesh;
use karui::geom::{Aabb, Camera, Light, turntable_directions};
use karui::hierarchy::{Budget, Change, Hierarchy};
use karui::mesh::shapes;
use karui_io::FrameOfPath;
use serde::Serialize;
use std::path::Path;
use std::time::Instant;

#[derive(Debug, Serialize)]
struct Row {
    model: String,
    triangles: usize,
    build_seconds: f64,
    nodes: usize,
    bytes_per_node: f64,
    /// Medians over the frames of the walk.
    drawn: usize,
    front: usize,
    tests: usize,
    changes: usize,
    milliseconds: f64,
    /// 95 % of the frames take no longer.
    late: f64,
    /// Time of a frame by its changes, microseconds, and the correlation of both.
    slope: f64,
    correlation: f64,
}

/// Width and height of the pictures, pixels.
const SCREEN: (u32, u32) = (1920, 1080);

/// Walks around every model; as Markdown.
pub fn run(args: &Args, console: &Console) -> Result<String> {
    let mut rows = Vec::new();
    for file in &args.files {
        let (_, mesh) = read_mesh(file, console)?;
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        rows.push(of_mesh(&name, &mesh, file, args, console)?);
    }
    for &size in &args.sizes {
        let columns = f64::from(size / 2).sqrt() as u32;
        let mesh = shapes::terrain(columns, size / 2 / columns.max(1), 1);
        let name = format!("terrain {}", count(mesh.triangles.len()));
        rows.push(of_mesh(&name, &mesh, Path::new("terrain"), args, console)?);
    }
    console.document(&rows)?;
    Ok(markdown(&rows, args))
}

fn of_mesh(name: &str, mesh: &TriMesh, path: &Path, args: &Args, console: &Console) -> Result<Row> {
    if !console.quiet {
        to_stderr(name);
    }
    let started = Instant::now();
    let hierarchy = build(mesh, args.build, path, console)?;
    let build_seconds = started.elapsed().as_secs_f64();
    let (changes, front) = walked(&hierarchy, args)?;
    let by = |pick: fn(&Change) -> f64| quantile(changes.iter().map(pick).collect(), 0.5);
    let time = |c: &Change| c.time.as_secs_f64() * 1e3;
    let moved = |c: &Change| (c.splits + c.collapses) as f64;
    let pairs: Vec<[f64; 2]> = changes.iter().map(|c| [moved(c), time(c)]).collect();
    let (slope, correlation) = line(&pairs);
    let nodes = hierarchy.node_count();
    Ok(Row {
        model: name.to_owned(),
        triangles: mesh.triangles.len(),
        build_seconds,
        nodes,
        bytes_per_node: hierarchy.node_bytes() as f64 / nodes.max(1) as f64,
        drawn: by(|c| c.triangles as f64) as usize,
        front,
        tests: by(|c| c.tests as f64) as usize,
        changes: by(moved) as usize,
        milliseconds: by(time),
        late: quantile(changes.iter().map(time).collect(), 0.95),
        slope: slope * 1e3,
        correlation,
    })
}

/// Every frame but the first, which comes from nowhere; and the size of the front.
fn walked(hierarchy: &Hierarchy, args: &Args) -> Result<(Vec<Change>, usize)> {
    let mut cut = hierarchy.coarsest();
    let mut changes = Vec::new();
    for (camera, lights) in views(hierarchy.bounds(), args)? {
        check_cancelled()?;
        let criteria = args.criteria.resolve(camera, lights, SCREEN);
        changes.push(cut.refine(&criteria, Budget::UNLIMITED)?);
    }
    changes.remove(0);
    Ok((changes, cut.front_len()))
}

/// Cameras and lights of the walk.
fn views(bounds: Aabb, args: &Args) -> Result<Vec<(Camera, Vec<Light>)>> {
    if let Some(path) = &args.path {
        let frames = read_path(path)?.frames;
        if frames.len() < 2 {
            let few = format!("{}: a walk has two frames at least", path.display());
            return Err(Failure::input(few).into());
        }
        let views = frames.iter().map(FrameOfPath::resolve);
        return Ok(views.collect::<karui::Result<_>>()?);
    }
    let lights = two_lights(bounds);
    let view = |direction| (Camera::looking_at(bounds, direction, 0.6), lights.clone());
    let directions = turntable_directions(args.frames, 0.3);
    Ok(directions.into_iter().map(view).collect())
}

/// Slope of the line of least squares through `[x, y]`, and Pearson's correlation.
fn line(pairs: &[[f64; 2]]) -> (f64, f64) {
    let n = pairs.len().max(1) as f64;
    let mean = |k: usize| pairs.iter().map(|p| p[k]).sum::<f64>() / n;
    let (mx, my) = (mean(0), mean(1));
    let sum = |f: fn(f64, f64) -> f64| pairs.iter().map(|p| f(p[0] - mx, p[1] - my)).sum::<f64>();
    let (xx, xy, yy) = (sum(|x, _| x * x), sum(|x, y| x * y), sum(|_, y| y * y));
    match xx > 0.0 && yy > 0.0 {
        true => (xy / xx, xy / (xx * yy).sqrt()),
        false => (0.0, 0.0),
    }
}

fn markdown(rows: &[Row], args: &Args) -> String {
    let walk = match &args.path {
        Some(path) => format!("along `{}`, 1920 x 1080 pixels", path.display()),
        None => format!(
            "once around in {} frames, 1920 x 1080 pixels, two lights that stand still",
            args.frames
        ),
    };
    let (alpha, criteria) = (args.build.alpha, &args.criteria);
    let header = [
        "model",
        "triangles",
        "build s",
        "M/s",
        "B/node",
        "drawn",
        "front",
        "tests",
        "changes",
        "ms",
        "95 %",
        "us/change",
        "r",
    ];
    let cells: Vec<Vec<String>> = rows.iter().map(cells).collect();
    format!(
        "## Half-edge hierarchies, frame by frame{}\n\n\
         Written by `karui hierarchy bench FILES --sizes N,N -o FILE` (release build).\n\n\
         - M/s: million triangles built a second. B/node: bytes of the nodes and their order.\n\
         - The walk: {walk},\n\
         \u{20} alpha {alpha}, {criteria}. Medians over all frames but the first: triangles\n\
         \u{20} drawn, nodes asked, nodes changed, milliseconds of `refine`; front: nodes that could be\n\
         \u{20} the next to change.\n\
         - us/change: slope of the line of least squares of time over changes; r: their correlation.\n\n\
         {}\n\n{}\n",
        if args.files.is_empty() {
            ": one land, ever finer"
        } else {
            ""
        },
        machine(),
        table(&header, &cells, true)
    )
}

fn cells(row: &Row) -> Vec<String> {
    vec![
        format!("`{}`", row.model),
        count(row.triangles),
        format!("{:.2}", row.build_seconds),
        format!("{:.2}", row.triangles as f64 / row.build_seconds * 1e-6),
        format!("{:.1}", row.bytes_per_node),
        count(row.drawn),
        count(row.front),
        count(row.tests),
        count(row.changes),
        format!("{:.3}", row.milliseconds),
        format!("{:.3}", row.late),
        format!("{:.2}", row.slope),
        format!("{:.2}", row.correlation),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_found() {
        let pairs: Vec<[f64; 2]> = (0..9)
            .map(|i| [f64::from(i), 3.0 * f64::from(i) + 1.0])
            .collect();
        let (slope, correlation) = line(&pairs);
        assert!((slope - 3.0).abs() < 1e-12 && (correlation - 1.0).abs() < 1e-12);
        assert_eq!(line(&[]), (0.0, 0.0));
        assert_eq!(quantile(vec![3.0, 1.0, 2.0], 0.5), 2.0);
    }
}
