//! `karui measure`: how far two models are apart.

use crate::console::Console;
use crate::failure::Failure;
use crate::input::{self, Input};
use crate::output;
use crate::table::{count, number, percent, seconds, table};
use anyhow::Result;
use karui::mesh::{Attribute, AttributeValues};
use karui::metrics::{
    Distance, Samples, SurfaceDistance, SurfaceDistanceOptions, surface_distance, vertex_distances,
};
use karui::render::heat_color;
use karui::{Scene, TriMesh};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Measure how far two models are apart
///
/// Two-sided distance between the surfaces, with all instances in place: the largest (a lower
/// bound of the Hausdorff distance), the mean and the root mean square of many samples.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The original
    a: PathBuf,
    /// The model to compare with it
    b: PathBuf,
    /// Face samples, and as many edge samples, in each direction; every vertex is one too
    #[arg(long, value_name = "N", default_value_t = 500_000)]
    samples: u64,
    /// Places the samples
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    /// Write A with each vertex's distance to B, as attribute `distance` and as colour (dark blue
    /// is none, yellow the largest); PLY keeps both
    #[arg(long, value_name = "FILE")]
    map: Option<PathBuf>,
    #[command(flatten)]
    limits: Limits,
}

/// The largest distances accepted.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Checks (exit code 1 if one fails)")]
struct Limits {
    /// Largest distance accepted, in model units
    #[arg(long, value_name = "DISTANCE")]
    max: Option<f64>,
    /// Largest mean distance accepted
    #[arg(long, value_name = "DISTANCE")]
    mean: Option<f64>,
    /// Largest root mean square distance accepted
    #[arg(long, value_name = "DISTANCE")]
    rms: Option<f64>,
    /// The accepted distances are shares of A's diagonal
    #[arg(long)]
    relative: bool,
}

/// Measures, writes the map, then checks.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    if let Some(map) = &args.map {
        input::output_format(map)?;
    }
    let [a, b] = [&args.a, &args.b].map(|path| mesh(path, console));
    let (a, b) = (a?, b?);
    let distance = distance(&a, &b, (args.samples, args.seed), console)?;
    if let Some(map) = &args.map {
        let scene = Scene::from_mesh(error_map(a, &b)?);
        output::write_one(map, &scene, &karui_io::WriteOptions::default())?;
    }
    console.data(&text(&distance))?;
    console.document(&document(args, &distance))?;
    console.summary(&summary(&distance, console))?;
    args.limits.check(&distance)
}

/// All that a model shows, in place.
pub(super) fn mesh(path: &Path, console: &Console) -> Result<TriMesh> {
    let input: Input = input::read(path, console)?;
    input.require_triangles()?;
    let mesh = input.scene.into_single_mesh()?;
    if mesh.triangles.is_empty() {
        let message = format!("{}: no mesh with triangles is placed", path.display());
        let hint = "`karui info` shows instances; the default scene has to show a mesh";
        return Err(Failure::input(message).hint(hint).into());
    }
    Ok(mesh)
}

/// The distance, from so many samples of either kind a direction, placed by a seed.
pub(super) fn distance(
    a: &TriMesh,
    b: &TriMesh,
    (samples, seed): (u64, u64),
    console: &Console,
) -> Result<SurfaceDistance> {
    let progress = console.progress();
    let options = SurfaceDistanceOptions {
        samples: Samples::Count(samples),
        seed,
        progress: &*progress,
        ..SurfaceDistanceOptions::default()
    };
    Ok(surface_distance(a, b, &options)?)
}

/// `a` with the distance of every vertex, as a number and as a colour.
fn error_map(mut a: TriMesh, b: &TriMesh) -> Result<TriMesh> {
    let distances = vertex_distances(&a, b)?;
    let largest = distances.iter().copied().fold(0.0, f32::max);
    let share = |d: &f32| if largest > 0.0 { d / largest } else { 0.0 };
    let colors = distances.iter().map(|d| heat_color(share(d))).collect();
    a.attributes.colors = vec![colors];
    a.attributes.custom.retain(|c| c.name != "distance");
    a.attributes.custom.push(Attribute {
        name: "distance".into(),
        components: 1,
        values: AttributeValues::F32(distances),
    });
    Ok(a)
}

/// A table of the distances both ways and together.
pub(super) fn text(distance: &SurfaceDistance) -> String {
    let row = |name: &str, [max, mean, rms]: [f64; 3], samples: u64| {
        vec![
            name.to_owned(),
            number(max),
            number(mean),
            number(rms),
            percent(max / distance.diagonal),
            percent(rms / distance.diagonal),
            count(samples as usize),
        ]
    };
    let one_way = |name, d: &Distance| row(name, [d.max, d.mean, d.rms], d.samples);
    let both = [distance.max(), distance.mean(), distance.rms()];
    let (to, back) = (&distance.a_to_b, &distance.b_to_a);
    let rows = [
        one_way("A to B", to),
        one_way("B to A", back),
        row("two-sided", both, to.samples + back.samples),
    ];
    let header = [
        "",
        "max",
        "mean",
        "RMS",
        "max/diagonal",
        "RMS/diagonal",
        "samples",
    ];
    table(&header, &rows, false)
}

fn summary(distance: &SurfaceDistance, console: &Console) -> String {
    let at = distance.a_to_b.farthest[0];
    let at = at.to_array().map(|x| number(x.into())).join(", ");
    let time = seconds(console.elapsed());
    format!(
        "A is farthest from B at ({at}); A's diagonal is {}; {time}",
        number(distance.diagonal)
    )
}

fn document(args: &Args, distance: &SurfaceDistance) -> Value {
    let one_way = |d: &Distance| {
        json!({
            "max": d.max, "mean": d.mean, "rms": d.rms, "samples": d.samples,
            "farthest": d.farthest.map(|p| p.to_array()),
        })
    };
    json!({
        "a": args.a, "b": args.b, "seed": args.seed, "diagonal": distance.diagonal,
        "max": distance.max(), "mean": distance.mean(), "rms": distance.rms(),
        "max_of_diagonal": distance.max() / distance.diagonal,
        "rms_of_diagonal": distance.rms() / distance.diagonal,
        "a_to_b": one_way(&distance.a_to_b),
        "b_to_a": one_way(&distance.b_to_a),
        "map": args.map,
    })
}

impl Limits {
    fn check(&self, distance: &SurfaceDistance) -> Result<()> {
        let unit = if self.relative {
            distance.diagonal
        } else {
            1.0
        };
        let limits = [
            ("largest", distance.max(), self.max),
            ("mean", distance.mean(), self.mean),
            ("root mean square", distance.rms(), self.rms),
        ];
        let over = |(name, found, limit): (&str, f64, Option<f64>)| {
            let limit = limit? * unit;
            let fails = found.is_nan() || found > limit;
            fails.then(|| {
                format!(
                    "the {name} distance {} exceeds {}",
                    number(found),
                    number(limit)
                )
            })
        };
        let failed: Vec<String> = limits.into_iter().filter_map(over).collect();
        if failed.is_empty() {
            return Ok(());
        }
        Err(Failure::check(failed.join("; ")).into())
    }
}
