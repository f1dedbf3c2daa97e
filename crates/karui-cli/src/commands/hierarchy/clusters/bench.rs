//! `karui hierarchy clusters bench`: builds, and cuts along walks.

use super::BuildArgs;
use crate::commands::bench::page::{Page, machine, tell};
use crate::commands::hierarchy::bench::quantile;
use crate::commands::hierarchy::read_mesh;
use crate::console::{Console, to_stderr};
use crate::progress::check_cancelled;
use crate::table::{bytes, count, percent, seconds, table};
use anyhow::Result;
use karui::TriMesh;
use karui::geom::{Aabb, Camera, Projection, Vec3, turntable_directions};
use karui::hierarchy::cluster::{ClusterDag, Cut, View};
use karui::mesh::shapes;
use serde::Serialize;
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

#[derive(Debug, Serialize)]
struct Row {
    model: String,
    triangles: usize,
    build_seconds: f64,
    clusters: usize,
    levels: usize,
    /// Mean share of the triangles that a cluster of level 0 may have.
    fill: f64,
    root_share: f64,
    stuck: usize,
    /// In memory, by triangles of the model.
    bytes_per_triangle: f64,
    file_bytes: usize,
    /// Medians over the frames of the walk, without and with culling.
    drawn: [usize; 2],
    cut_milliseconds: [f64; 2],
    /// 95 % of the cuts with culling take no longer.
    late: f64,
    /// Median time of the index buffer, with culling.
    index_milliseconds: f64,
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
    let text = markdown(&rows, args);
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

fn markdown(rows: &[Row], args: &Args) -> String {
    let header = [
        "model",
        "triangles",
        "build s",
        "M/s",
        "clusters",
        "levels",
        "fill",
        "roots",
        "stuck",
        "B/tri",
        "file",
        "all",
        "all ms",
        "seen",
        "seen ms",
        "95 %",
        "index ms",
    ];
    let cells: Vec<Vec<String>> = rows.iter().map(cells).collect();
    format!(
        "## Clusters in levels of detail, frame by frame\n\n\
         Written by `karui hierarchy clusters bench FILES --sizes N,N -o FILE` ({} build).\n\n\
         - Clusters of at most {} triangles, at most {} of them in a group. M/s: million triangles\n\
         \u{20} of the model built a second, on all threads. Fill: triangles of the mean cluster of level 0\n\
         \u{20} by what it may have. Roots: triangles of the coarsest cut by those of the model. Stuck:\n\
         \u{20} failed attempts to simplify a group. B/tri: bytes in memory by triangles of the model. File:\n\
         \u{20} as `karui hierarchy clusters build` writes it.\n\
         - The walk: {} frames of 1920 x 1080 pixels, an error of at most 1 pixel, no lights. Models:\n\
         \u{20} once around, 0.3 rad above, all of the model in a field of view of 0.6 rad. Landscapes\n\
         \u{20} (`shapes::landscape`, seed 1): once around in a circle, a quarter of the shorter side from the\n\
         \u{20} middle, 20 units (quads) above the highest point, looking ahead and a quarter downwards, field\n\
         \u{20} of view 1 rad.\n\
         - All: triangles drawn and milliseconds of `ClusterDag::cut`, nothing culled. Seen: the same without\n\
         \u{20} what is outside the picture or faces away; 95 %: of these cuts take no longer. Index: milliseconds\n\
         \u{20} of `Cut::triangles` of what is seen. Medians over the frames, each measured once, cuts on one\n\
         \u{20} thread, nothing kept from frame to frame.\n\n\
         {}\n\n{}\n",
        if cfg!(debug_assertions) {
            "dev"
        } else {
            "release"
        },
        args.build.max_triangles,
        args.build.group_size,
        count(args.frames as usize),
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
        count(row.clusters),
        count(row.levels),
        percent(row.fill),
        percent(row.root_share),
        count(row.stuck),
        format!("{:.1}", row.bytes_per_triangle),
        bytes(row.file_bytes as u64),
        count(row.drawn[0]),
        format!("{:.3}", row.cut_milliseconds[0]),
        count(row.drawn[1]),
        format!("{:.3}", row.cut_milliseconds[1]),
        format!("{:.3}", row.late),
        format!("{:.3}", row.index_milliseconds),
    ]
}
