//! `karui bench hlod-solo`: one scene in a process of its own, so that the memory of
//! another does not count.

use super::crowd::{Crowd, FOV_Y};
use crate::commands::bench::child;
use crate::commands::bench::clock::{Watch, peak_memory};
use crate::console::Console;
use anyhow::{Context as _, Result, bail};
use karui::geom::{Camera, Projection, Vec3};
use karui::hlod::{Assets, Tree, TreeOptions, View, Walk};
use karui::mesh::scenes::{CityOptions, CityParts, ForestOptions, city, forest};
use serde::{Deserialize, Serialize};
use std::ffi::OsString;
use std::time::Duration;

/// Values of Omega_t; at 0 no group stands for its objects.
const THRESHOLDS: [f64; 4] = [0.0, 0.01, 0.02, 0.05];

/// No scene takes this long.
const LIMIT: Duration = Duration::from_secs(3600);

/// Measure one scene (used by `karui bench hlod`)
#[derive(Debug, clap::Args)]
#[command(hide = true)]
pub struct Args {
    #[arg(long, value_enum)]
    kind: Kind,
    #[arg(long)]
    count: u32,
    #[arg(long)]
    frames: u32,
}

/// What the objects are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    Forest,
    City,
}

impl Kind {
    pub fn name(self) -> &'static str {
        match self {
            Self::Forest => "forest",
            Self::City => "city",
        }
    }

    fn crowd(self, count: usize) -> Result<Crowd> {
        let scene = match self {
            Self::Forest => forest(&ForestOptions {
                count,
                red: 0.2,
                ground: false,
                ..ForestOptions::default()
            })?,
            Self::City => {
                let options = CityOptions {
                    count,
                    ..CityOptions::default()
                };
                city(&options, &CityParts::built_in())?
            }
        };
        Crowd::new(scene, Vec::new(), "", false)
    }
}

/// What is found of a scene.
#[derive(Debug, Serialize, Deserialize)]
pub struct Row {
    pub kind: Kind,
    pub objects: usize,
    pub groups: usize,
    /// Of the tree alone.
    pub seconds: f64,
    pub cpu_seconds: f64,
    /// Most memory that the tree took, beyond what there was before; bytes.
    pub growth: Option<u64>,
    /// Most memory of the process while the tree was built, the scene included; bytes.
    pub peak: Option<u64>,
    pub lists: Vec<ListRow>,
}

/// Draw lists of a flight.
#[derive(Debug, Serialize, Deserialize)]
pub struct ListRow {
    pub threshold: f64,
    /// Half, 95 % and all of the frames took no longer on the clock on the wall.
    pub milliseconds: [f64; 3],
    /// All of the frames took no more of the processor, whatever else it had to do.
    pub most_cpu_milliseconds: f64,
    /// Means over the frames.
    pub items: f64,
    pub triangles: f64,
}

/// Runs in the process of its own.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    let mut crowd = args.kind.crowd(args.count as usize)?;
    let objects = std::mem::take(&mut crowd.objects);
    crowd.places = Vec::new();
    let build = || Tree::build(objects, &TreeOptions::default());
    let (tree, cost) = Watch::TimeAndMemory.call(build);
    let (tree, peak) = (tree?, peak_memory());
    let cameras = flight(&tree, args.frames);
    let lists = THRESHOLDS.map(|threshold| fly(&tree, &crowd, &cameras, threshold));
    console.document(&Row {
        kind: args.kind,
        objects: tree.object_count(),
        groups: tree.group_count(),
        seconds: cost.wall,
        cpu_seconds: cost.cpu,
        growth: cost.growth,
        peak,
        lists: lists.into_iter().collect::<Result<_>>()?,
    })
}

/// Asks a process of its own.
pub fn ask(kind: Kind, count: u32, frames: u32) -> Result<Row> {
    let mut words = ["bench", "hlod-solo", "--json", "--quiet"]
        .map(OsString::from)
        .to_vec();
    for (option, value) in [
        ("--kind", kind.name().to_owned()),
        ("--count", count.to_string()),
        ("--frames", frames.to_string()),
    ] {
        words.extend([option.into(), value.into()]);
    }
    let ended = child::run(&words, &[], LIMIT)?;
    match ended.code {
        Some(0) => serde_json::from_str(&ended.out).context("reading figures"),
        _ => bail!("{} of {count}: {}", kind.name(), ended.error),
    }
}

/// From one end to the other, just above what half of the objects reach, looking
/// ahead and first to the right, then to the left.
fn flight(tree: &Tree, frames: u32) -> Vec<Camera> {
    let Some(bounds) = tree.bounds() else {
        return Vec::new();
    };
    let objects = (0..tree.object_capacity() as u32).filter_map(|id| tree.object(id));
    let mut tops: Vec<f64> = objects.map(|o| o.bounds.max.y).collect();
    let middle = tops.len() / 2;
    let (_, top, _) = tops.select_nth_unstable_by(middle, f64::total_cmp);
    let (min, size, top) = (bounds.min.as_vec3(), bounds.size().as_vec3(), *top as f32);
    let camera = |frame: u32| {
        let t = frame as f32 / frames as f32;
        let eye = Vec3::new(
            min.x + size.x * (0.05 + 0.9 * t),
            top + 0.5,
            min.z + size.z * (0.45 + 0.1 * t),
        );
        Camera {
            eye,
            target: eye + Vec3::new(1.0, -0.05, 0.6 - 1.2 * t),
            up: Vec3::Y,
            projection: Projection::Perspective { fov_y: FOV_Y },
            near: None,
            far: None,
        }
    };
    (0..frames).map(camera).collect()
}

/// A box of 12 triangles stands for every group.
fn fly(tree: &Tree, crowd: &Crowd, cameras: &[Camera], threshold: f64) -> Result<ListRow> {
    let proxies = vec![12; tree.group_capacity()];
    let assets = Assets {
        levels: &crowd.levels,
        levels_of_object: &crowd.meshes,
        proxies: &proxies,
    };
    let mut walk = Walk::default();
    let mut times = Vec::new();
    let mut most_cpu = 0f64;
    let (mut items, mut triangles) = (0, 0);
    for &camera in cameras {
        let view = View {
            threshold,
            ..View::new(camera)
        };
        let (list, cost) = Watch::Time.call(|| walk.frame(tree, &view, &assets));
        let list = list?;
        times.push(cost.wall * 1e3);
        most_cpu = most_cpu.max(cost.cpu * 1e3);
        items += list.items.len() as u64;
        triangles += list.counts.triangles;
    }
    times.sort_unstable_by(f64::total_cmp);
    let at = |q: f64| times[(q * (times.len() - 1) as f64).round() as usize];
    let mean = |sum: u64| sum as f64 / cameras.len() as f64;
    Ok(ListRow {
        threshold,
        milliseconds: [at(0.5), at(0.95), at(1.0)],
        most_cpu_milliseconds: most_cpu,
        items: mean(items),
        triangles: mean(triangles),
    })
}
