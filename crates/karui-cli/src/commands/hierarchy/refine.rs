//! `karui hierarchy refine`: the frames of a path.

use super::criteria::CriteriaArgs;
use super::frames::{Frames, FramesArgs, Sheet};
use super::{BuildArgs, read_mesh};
use crate::console::Console;
use crate::failure::Failure;
use crate::table::{count, seconds};
use anyhow::Result;
use karui::TriMesh;
use karui::hierarchy::{Budget, Change, Hierarchy};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Refine a model along a path of cameras and lights
///
/// Writes `frames.csv`, a line a frame, and on demand every frame as a picture and as a mesh.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The model; all of it becomes one mesh
    input: PathBuf,
    /// Its hierarchy, from `karui hierarchy build` [default: built first]
    #[arg(long, value_name = "FILE")]
    hierarchy: Option<PathBuf>,
    #[command(flatten)]
    frames: FramesArgs,
    /// At most this many triangles a frame: what is largest on the screen stays
    #[arg(long, value_name = "COUNT")]
    triangles: Option<usize>,
    #[command(flatten)]
    build: BuildArgs,
    #[command(flatten)]
    criteria: CriteriaArgs,
}

/// Reads, refines frame by frame, writes all or nothing, then tells.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    let (input, mesh) = read_mesh(&args.input, console)?;
    let hierarchy = match &args.hierarchy {
        Some(path) => read_hierarchy(path, &mesh, &args.input)?,
        None => super::build(&mesh, args.build, &args.input, console)?,
    };
    let path = args.frames.path(hierarchy.bounds())?;
    let frames = Frames::new(&args.frames, &input, console)?;
    let budget = Budget {
        triangles: args.triangles,
        time: None,
    };
    let mut cut = hierarchy.coarsest();
    let rows = frames.walk(&path, "refine", console, |i, camera, lights| {
        let criteria = args
            .criteria
            .resolve(camera, lights.clone(), args.frames.size);
        let change = cut.refine(&criteria, budget)?;
        frames.write(i, &camera, &lights, || cut.to_mesh(&mesh))?;
        Ok(change)
    })?;
    let sheet = sheet(&rows);
    let files = frames.publish(&sheet)?;
    console.data(&sheet.shown())?;
    console.document(&json!({
        "input": args.input, "triangles": hierarchy.triangle_count(),
        "frames": rows.iter().map(document).collect::<Vec<_>>(), "files": files,
    }))?;
    let total: std::time::Duration = rows.iter().map(|c| c.time).sum();
    console.summary(&format!(
        "{}: {} frames in {} files; {} of refinement, {} in all",
        args.frames.output.display(),
        count(rows.len()),
        count(files.len()),
        seconds(total),
        seconds(console.elapsed()),
    ))
}

fn read_hierarchy(path: &Path, mesh: &TriMesh, model: &Path) -> Result<Hierarchy> {
    let fail = |e: &dyn std::fmt::Display| Failure::input(format!("{}: {e}", path.display()));
    let bytes = std::fs::read(path).map_err(|e| fail(&e))?;
    let hint = "`karui hierarchy build` writes hierarchies";
    let hierarchy = Hierarchy::from_bytes(&bytes).map_err(|e| fail(&e).hint(hint))?;
    if hierarchy.is_of(mesh) {
        return Ok(hierarchy);
    }
    let other = format!("the hierarchy is of another mesh than {}", model.display());
    Err(fail(&other).hint(hint).into())
}

const COLUMNS: [&str; 9] = [
    "frame",
    "triangles",
    "splits",
    "collapses",
    "tests",
    "ranges",
    "uploaded",
    "floor",
    "ms",
];

fn cells(i: usize, change: &Change) -> [String; 9] {
    let uploaded: u32 = change.ranges.iter().map(|r| r.end - r.start).sum();
    [
        i.to_string(),
        change.triangles.to_string(),
        change.splits.to_string(),
        change.collapses.to_string(),
        change.tests.to_string(),
        change.ranges.len().to_string(),
        uploaded.to_string(),
        format!("{:.3}", change.floor),
        format!("{:.3}", change.time.as_secs_f64() * 1e3),
    ]
}

fn sheet(rows: &[Change]) -> Sheet {
    Sheet {
        header: &COLUMNS,
        rows: (0..).zip(rows).map(|(i, c)| cells(i, c).into()).collect(),
    }
}

fn document(change: &Change) -> Value {
    json!({
        "triangles": change.triangles, "splits": change.splits,
        "collapses": change.collapses, "tests": change.tests,
        "ranges": change.ranges.iter().map(|r| [r.start, r.end]).collect::<Vec<_>>(),
        "floor": change.floor, "complete": change.complete,
        "milliseconds": change.time.as_secs_f64() * 1e3,
    })
}
