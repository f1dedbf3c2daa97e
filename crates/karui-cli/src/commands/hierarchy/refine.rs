//! `karui hierarchy refine`: the frames of a path.

use super::criteria::CriteriaArgs;
use super::path::CameraPath;
use super::{BuildArgs, read_mesh};
use crate::console::Console;
use crate::failure::Failure;
use crate::output::Staged;
use crate::progress::check_cancelled;
use crate::table::{count, seconds, table};
use crate::textures;
use anyhow::Result;
use karui::geom::{Camera, Light};
use karui::hierarchy::{Budget, Change, Cut, Hierarchy};
use karui::render::{Model, Outputs, Picture, RenderOptions, Renderer};
use karui::{Scene, TriMesh};
use karui_io::WriteOptions;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Refine a model along a path of cameras and lights
///
/// Writes `frames.csv`, a line a frame, and on demand every frame as a picture and as a mesh.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The model; all of it becomes one mesh
    input: PathBuf,
    /// The directory to write to
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Its hierarchy, from `karui hierarchy build` [default: built first]
    #[arg(long, value_name = "FILE")]
    hierarchy: Option<PathBuf>,
    /// Cameras and lights, as JSON [default: once around]
    #[arg(long, value_name = "FILE", conflicts_with = "around")]
    path: Option<PathBuf>,
    /// Frames once around the model
    #[arg(long, value_name = "N", default_value_t = 24, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    around: u32,
    /// Width and height of a frame, pixels
    #[arg(long, value_name = "N|WxH", default_value = "1024x768", value_parser = crate::args::size)]
    size: (u32, u32),
    /// At most this many triangles a frame: what is largest on the screen stays
    #[arg(long, value_name = "COUNT")]
    triangles: Option<usize>,
    /// Write every frame as a picture: frame-000.png and so on
    #[arg(long)]
    pictures: bool,
    /// Draw the edges of the triangles in the pictures
    #[arg(long, requires = "pictures")]
    wireframe: bool,
    /// Write every frame as a mesh: frame-000.glb and so on
    #[arg(long)]
    meshes: bool,
    #[command(flatten)]
    criteria: CriteriaArgs,
    #[command(flatten)]
    build: BuildArgs,
}

/// Reads, refines frame by frame, writes all or nothing, then tells.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    let (input, mesh) = read_mesh(&args.input, console)?;
    let hierarchy = match &args.hierarchy {
        Some(path) => read_hierarchy(path, &mesh, &args.input)?,
        None => super::build(&mesh, args.build, &args.input, console)?,
    };
    let path = match &args.path {
        Some(path) => CameraPath::read(path)?,
        None => CameraPath::around(hierarchy.bounds(), args.around),
    };
    let images = match args.pictures {
        true => textures::decode(&input, console),
        false => Vec::new(),
    };
    let staged = Staged::in_directory(&args.output)?;
    let mut walk = Walk {
        args,
        mesh: &mesh,
        scene: &input.scene,
        images: &images,
        staged: &staged,
        cut: hierarchy.coarsest(),
    };
    let progress = console.progress();
    let mut rows = Vec::new();
    for (i, frame) in path.frames.iter().enumerate() {
        check_cancelled()?;
        progress.report("refine", i as f32 / path.frames.len() as f32);
        let (camera, lights) = frame.resolve()?;
        rows.push(walk.frame(i, camera, lights)?);
    }
    drop(progress);
    staged.bytes("frames.csv", csv(&rows).as_bytes())?;
    let files = staged.publish()?;
    console.data(&shown(&rows))?;
    console.document(&json!({
        "input": args.input, "triangles": hierarchy.triangle_count(),
        "frames": rows.iter().map(document).collect::<Vec<_>>(), "files": files,
    }))?;
    let total: std::time::Duration = rows.iter().map(|c| c.time).sum();
    console.summary(&format!(
        "{}: {} frames in {} files; {} of refinement, {} in all",
        args.output.display(),
        count(rows.len()),
        count(files.len()),
        seconds(total),
        seconds(console.elapsed()),
    ))
}

struct Walk<'a> {
    args: &'a Args,
    mesh: &'a TriMesh,
    scene: &'a Scene,
    images: &'a [Option<Picture>],
    staged: &'a Staged,
    cut: Cut<'a>,
}

impl Walk<'_> {
    fn frame(&mut self, i: usize, camera: Camera, lights: Vec<Light>) -> Result<Change> {
        let args = self.args;
        let criteria = args.criteria.resolve(camera, lights.clone(), args.size);
        let budget = Budget {
            triangles: args.triangles,
            time: None,
        };
        let fail = |e| Failure::input(format!("frame {i}: {e}"));
        let change = self.cut.refine(&criteria, budget).map_err(fail)?;
        if !args.pictures && !args.meshes {
            return Ok(change);
        }
        let scene = self.scene_of(self.cut.to_mesh(self.mesh)?);
        if args.meshes {
            let name = format!("frame-{i:03}.glb");
            self.staged.scene(&name, &scene, &WriteOptions::default())?;
        }
        if args.pictures {
            let options = RenderOptions {
                width: args.size.0,
                height: args.size.1,
                samples: 2,
                outputs: Outputs::COLOR,
                wireframe: args.wireframe.then(Default::default),
                ..RenderOptions::default()
            };
            let model = Model::of_scene(&scene, self.images);
            let frame = Renderer::of_model(&model)?.frame(&camera, &lights, &options)?;
            let png = karui_io::encode_png(&frame.color)?;
            self.staged.bytes(&format!("frame-{i:03}.png"), &png)?;
        }
        Ok(change)
    }

    /// The cut with the materials of the model.
    fn scene_of(&self, mut mesh: TriMesh) -> Scene {
        // What a range was in the file does not hold for the mesh of all.
        mesh.ranges.iter_mut().for_each(|r| r.source = None);
        Scene {
            materials: self.scene.materials.clone(),
            textures: self.scene.textures.clone(),
            images: self.scene.images.clone(),
            ..Scene::from_mesh(mesh)
        }
    }
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

fn csv(rows: &[Change]) -> String {
    let lines = rows.iter().enumerate().map(|(i, c)| cells(i, c).join(","));
    let header = std::iter::once(COLUMNS.join(","));
    header.chain(lines).map(|line| line + "\n").collect()
}

fn shown(rows: &[Change]) -> String {
    let rows: Vec<Vec<String>> = rows
        .iter()
        .enumerate()
        .map(|(i, c)| cells(i, c).into())
        .collect();
    table(&COLUMNS, &rows, false)
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
