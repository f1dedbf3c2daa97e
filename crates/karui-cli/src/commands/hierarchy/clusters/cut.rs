//! `karui hierarchy clusters cut`: the frames of a path.

use super::BuildArgs;
use crate::commands::hierarchy::criteria::{at_least_zero, within};
use crate::commands::hierarchy::frames::{Frames, FramesArgs, Sheet};
use crate::commands::hierarchy::read_mesh;
use crate::console::Console;
use crate::table::{count, seconds};
use anyhow::Result;
use karui::geom::{Camera, Light};
use karui::hierarchy::ViewAndLight;
use karui::hierarchy::cluster::{ClusterDag, Cut, Detail, View};
use serde::Serialize;
use serde_json::json;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Choose the clusters to draw along a path of cameras and lights
///
/// Writes `frames.csv`, a line a frame, and on demand every frame as a picture and as a mesh.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The model; all of it becomes one mesh
    input: PathBuf,
    /// Its clusters, from `karui hierarchy clusters build` [default: built first]
    #[arg(long, value_name = "FILE", conflicts_with_all = ["max_triangles", "group_size"])]
    dag: Option<PathBuf>,
    #[command(flatten)]
    frames: FramesArgs,
    /// Instead of looking at the screen: the least error in at most this many triangles
    #[arg(long, value_name = "COUNT", conflicts_with_all = [
        "threshold", "no_frustum", "no_back_facing", "light_factor", "highlight"])]
    triangles: Option<usize>,
    #[command(flatten)]
    build: BuildArgs,
    #[command(flatten)]
    detail: DetailArgs,
}

/// What a view asks for.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "What is drawn")]
struct DetailArgs {
    /// Largest error on the screen, pixels
    #[arg(long, value_name = "PX", default_value_t = 1.0, value_parser = at_least_zero)]
    threshold: f64,
    /// Also draw what is outside the picture
    #[arg(long)]
    no_frustum: bool,
    /// Also draw what faces away
    #[arg(long)]
    no_back_facing: bool,
    /// Factor to the threshold in highlights and where lit turns to dark; 1 turns it off
    #[arg(long, value_name = "F", default_value_t = 1.0, value_parser = factor)]
    light_factor: f64,
    /// A highlight: degrees between the mirrored light and the eye; 0 for none
    #[arg(long, value_name = "DEG", default_value_t = 30.0, value_parser = two_right_angles,
          requires = "light_factor")]
    highlight: f64,
}

fn factor(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|f: &f64| *f > 0.0 && *f <= 1.0);
    number.ok_or_else(|| "expected a number above 0, at most 1".to_owned())
}

fn two_right_angles(text: &str) -> Result<f64, String> {
    within(text, 180.0)
}

impl DetailArgs {
    fn view<'a>(&self, criteria: &'a ViewAndLight) -> View<'a> {
        let [width, height] = criteria.size.map(|side| side as f32);
        let factor = self.light_factor as f32;
        View {
            height,
            aspect: width / height,
            threshold: self.threshold as f32,
            frustum: !self.no_frustum,
            backfaces: !self.no_back_facing,
            detail: (factor < 1.0).then_some(Detail { criteria, factor }),
            ..View::new(criteria.camera)
        }
    }

    /// Where light makes detail visible, and nowhere else.
    fn criteria(&self, camera: Camera, lights: &[Light], size: (u32, u32)) -> ViewAndLight {
        ViewAndLight::by_light(camera, [size.0, size.1], lights.to_vec(), self.highlight)
    }
}

/// What is told of a frame.
#[derive(Debug, Serialize)]
struct Row {
    clusters: usize,
    triangles: usize,
    /// Model units.
    error: f32,
    cut_milliseconds: f64,
    index_milliseconds: f64,
}

/// Reads, cuts frame by frame, writes all or nothing, then tells.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    let (input, mesh) = read_mesh(&args.input, console)?;
    let path = args.frames.path(mesh.bounds())?;
    let frames = Frames::new(&args.frames, &input, console)?;
    let dag = match &args.dag {
        Some(path) => super::read(path, &mesh, &args.input)?,
        None => super::build(&mesh, args.build, &args.input, console)?,
    };
    let rows = frames.walk(&path, "cut", console, |i, camera, lights| {
        let (cut, row) = args.cut(&dag, camera, &lights)?;
        frames.write(i, &camera, &lights, || cut.to_mesh(&mesh))?;
        Ok(row)
    })?;
    let sheet = sheet(&rows);
    let files = frames.publish(&sheet)?;
    console.data(&sheet.shown())?;
    console.document(&json!({
        "input": args.input, "triangles": dag.input_triangles(),
        "clusters": dag.clusters().len(), "frames": rows, "files": files,
    }))?;
    let total = rows.iter().map(|r| r.cut_milliseconds).sum::<f64>();
    console.summary(&format!(
        "{}: {} frames in {} files; {} of cuts, {} in all",
        args.frames.output.display(),
        count(rows.len()),
        count(files.len()),
        seconds(Duration::from_secs_f64(total / 1e3)),
        seconds(console.elapsed()),
    ))
}

impl Args {
    fn cut<'a>(
        &self,
        dag: &'a ClusterDag,
        camera: Camera,
        lights: &[Light],
    ) -> Result<(Cut<'a>, Row)> {
        let criteria = self.detail.criteria(camera, lights, self.frames.size);
        let view = self.detail.view(&criteria);
        let started = Instant::now();
        let cut = match self.triangles {
            Some(most) => dag.cut_to(most),
            None => dag.cut(&view)?,
        };
        let chosen = Instant::now();
        let triangles = std::hint::black_box(cut.triangles());
        let row = Row {
            clusters: cut.clusters().len(),
            triangles: triangles.len(),
            error: cut.error(),
            cut_milliseconds: (chosen - started).as_secs_f64() * 1e3,
            index_milliseconds: chosen.elapsed().as_secs_f64() * 1e3,
        };
        Ok((cut, row))
    }
}

const COLUMNS: [&str; 6] = [
    "frame",
    "clusters",
    "triangles",
    "error",
    "cut_ms",
    "index_ms",
];

fn sheet(rows: &[Row]) -> Sheet {
    Sheet {
        header: &COLUMNS,
        rows: rows.iter().enumerate().map(cells).collect(),
    }
}

fn cells((i, row): (usize, &Row)) -> Vec<String> {
    vec![
        i.to_string(),
        row.clusters.to_string(),
        row.triangles.to_string(),
        row.error.to_string(),
        format!("{:.4}", row.cut_milliseconds),
        format!("{:.4}", row.index_milliseconds),
    ]
}
