//! `karui hierarchy clusters bench`: builds, and cuts along walks.

mod row;

use super::BuildArgs;
use crate::commands::bench::page::{Page, tell};
use crate::commands::hierarchy::bench::quantile;
use crate::commands::hierarchy::read_mesh;
use crate::console::{Console, to_stderr};
use crate::progress::check_cancelled;
use crate::table::{count, seconds};
use anyhow::Result;
use karui::TriMesh;
use karui::geom::{Aabb, Camera, Projection, Vec3, turntable_directions};
use karui::hierarchy::cluster::{ClusterDag, Cut, View};
use karui::mesh::shapes;
use row::{Row, markdown};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Measure clusters: builds, sizes, cuts along a walk
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The models
    #[arg(value_name = "FILES", required_unless_present = "sizes")]
    files: Vec<PathBuf>,
    /// Also fly over landscapes of so many triangles
    #[arg(long, value_name = "TRIANGLES", value_delimiter = ',',
          value_parser = clap::value_parser!(u32).range(2..=100_000_000))]
    sizes: Vec<u32>,
    /// Frames of a walk: once around
    #[arg(long, value_name = "N", default_value_t = 600,
          value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    frames: u32,
    /// Markdown file to write the figures into instead of printing them
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    build: BuildArgs,
}

/// Builds and walks, model after model.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    let page = args.output.as_deref().map(Page::open).transpose()?;
    let mut rows = Vec::new();
    for file in &args.files {
        let (_, mesh) = read_mesh(file, console)?;
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        let walk = around(mesh.bounds(), args.frames);
        rows.push(of_mesh(&name, &mesh, file, &walk, args, console)?);
    }
    for &size in &args.sizes {
        let columns = f64::from(size / 2).sqrt() as u32;
        let mesh = shapes::landscape(columns, size / 2 / columns.max(1), 1);
        let name = format!("landscape {}", count(mesh.triangles.len()));
        let walk = flight(mesh.bounds(), args.frames);
        let path = Path::new("landscape");
        rows.push(of_mesh(&name, &mesh, path, &walk, args, console)?);
    }
    console.document(&rows)?;
    let text = markdown(&rows, args.frames, args.build);
    tell(page, "karui hierarchy clusters bench", &text, console)?;
    let took = seconds(console.elapsed());
    console.summary(&format!("{} models; {took}", count(rows.len())))
}

/// Once around a model.
fn around(bounds: Aabb, frames: u32) -> Vec<Camera> {
    let directions = turntable_directions(frames, 0.3).into_iter();
    directions
        .map(|d| Camera::looking_at(bounds, d, 0.6))
        .collect()
}

/// Once around in a circle over half of the land, close above its highest point.
fn flight(bounds: Aabb, frames: u32) -> Vec<Camera> {
    let size = bounds.max - bounds.min;
    let middle = bounds.center().with_y(bounds.max.y + 20.0);
    let camera = |way: Vec3| {
        let eye = middle + way * 0.25 * size.x.min(size.z);
        Camera {
            eye,
            target: eye + Vec3::new(way.z, -0.25, -way.x),
            up: Vec3::Y,
            projection: Projection::Perspective { fov_y: 1.0 },
            near: None,
            far: None,
        }
    };
    let ways = turntable_directions(frames, 0.0).into_iter();
    ways.map(camera).collect()
}

fn of_mesh(
    name: &str,
    mesh: &TriMesh,
    path: &Path,
    walk: &[Camera],
    args: &Args,
    console: &Console,
) -> Result<Row> {
    if !console.quiet {
        to_stderr(name);
    }
    let started = Instant::now();
    let dag = super::build(mesh, args.build, path, console)?;
    let build_seconds = started.elapsed().as_secs_f64();
    let mut frames = Vec::new();
    for &camera in walk {
        check_cancelled()?;
        frames.push(Frame::of(&dag, camera)?);
    }
    let at = |q: f64, pick: fn(&Frame) -> f64| quantile(frames.iter().map(pick).collect(), q);
    let triangles = mesh.triangles.len();
    Ok(Row {
        model: name.to_owned(),
        triangles,
        build_seconds,
        clusters: dag.clusters().len(),
        levels: dag.levels(),
        fill: fill(&dag, args.build.max_triangles.into()),
        root_share: dag.triangles_of_roots() as f64 / triangles as f64,
        stuck: dag.stuck(),
        bytes_per_triangle: dag.bytes() as f64 / triangles as f64,
        file_bytes: dag.to_bytes().len(),
        drawn: [
            at(0.5, |f| f.drawn[0] as f64),
            at(0.5, |f| f.drawn[1] as f64),
        ]
        .map(|n| n as usize),
        cut_milliseconds: [at(0.5, |f| f.cut[0]), at(0.5, |f| f.cut[1])],
        late: at(0.95, |f| f.cut[1]),
        index_milliseconds: at(0.5, |f| f.index),
    })
}

/// One frame, without and with culling; milliseconds.
struct Frame {
    drawn: [usize; 2],
    cut: [f64; 2],
    index: f64,
}

impl Frame {
    fn of(dag: &ClusterDag, camera: Camera) -> Result<Self> {
        let all = View::new(camera);
        let culled = View {
            frustum: true,
            backfaces: true,
            ..all
        };
        let (all, slow) = timed(|| dag.cut(&all));
        let (seen, fast) = timed(|| dag.cut(&culled));
        let seen = seen?;
        let (triangles, index) = timed(|| Cut::triangles(&seen));
        Ok(Self {
            drawn: [all?.triangle_count(), triangles.len()],
            cut: [slow, fast],
            index,
        })
    }
}

/// What comes of the work, and its milliseconds.
fn timed<R>(work: impl FnOnce() -> R) -> (R, f64) {
    let started = Instant::now();
    let result = std::hint::black_box(work());
    (result, started.elapsed().as_secs_f64() * 1e3)
}

fn fill(dag: &ClusterDag, most: usize) -> f64 {
    let fine = dag.clusters().iter().filter(|c| c.level == 0).count();
    dag.input_triangles() as f64 / (fine * most).max(1) as f64
}
