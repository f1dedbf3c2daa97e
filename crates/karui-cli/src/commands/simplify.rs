//! `karui simplify`: one coarser model.

use super::plan;
use crate::args::{SimplifyArgs, WriteArgs};
use crate::console::Console;
use crate::failure::Failure;
use crate::input::{self, Input};
use crate::outofcore::{BlockArgs, CutArgs, TargetArgs, Work, finish, memory};
use crate::output::Staged;
use crate::table::{bytes, count, number, percent, seconds};
use crate::{explain, output};
use anyhow::Result;
use karui::lod::{LevelSummary, Levels, LodChain, LodOptions, SceneChain, chain_scene};
use karui::simplify::{CollapseLog, SimplifyOptions, Stop, Stopped};
use karui::{Scene, TriMesh, geom};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Remove triangles from a model
///
/// Stops at whichever target is met first. Errors are measured afterwards (two-sided distance to
/// the original); an error that is asked for holds for the measured maximum.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The model
    input: PathBuf,
    /// The file to write
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Also write what collapsed: `karui replay` makes any level between of it, and the same
    /// triangles for the model in other poses; parts, holes and handles then all stay
    #[arg(long, value_name = "FILE",
          conflicts_with_all = ["pairs", "prune", "sloppy", "sloppy_fallback", "foliage"])]
    log: Option<PathBuf>,
    #[command(flatten)]
    stop: StopArgs,
    #[command(flatten)]
    large: LargeArgs,
    #[command(flatten)]
    simplify: SimplifyArgs,
    /// Face samples, and as many edge samples, that the error is measured with at most
    #[arg(long, value_name = "N", default_value_t = 200_000)]
    samples: u64,
    #[command(flatten)]
    write: WriteArgs,
}

/// When to stop.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Target")]
#[group(required = true, multiple = true)]
struct StopArgs {
    /// Share of the triangles to keep, 0 to 1
    #[arg(long, value_name = "SHARE")]
    ratio: Option<f64>,
    /// Triangles to keep
    #[arg(long, value_name = "COUNT")]
    triangles: Option<usize>,
    /// Largest error, in model units
    #[arg(long, value_name = "ERROR")]
    error: Option<f64>,
    /// Largest error, as a share of the diagonal of the model's box
    #[arg(long, value_name = "SHARE")]
    relative_error: Option<f64>,
}

/// Models larger than memory.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Models larger than memory")]
struct LargeArgs {
    /// Read the model in slices and work on it in blocks, with so much memory, e.g. 1GiB; the
    /// error is then estimated, not measured
    #[arg(long, value_name = "SIZE", value_parser = memory,
          conflicts_with_all = ["log", "relative_error", "samples", "SimplifyArgs", "WriteArgs"])]
    memory_limit: Option<u64>,
    /// Folder, or s3://, gs:// or az:// URL, for what is not finished [default: the output's name
    /// with .karui]
    #[arg(long, value_name = "PLACE", requires = "memory_limit")]
    work: Option<PathBuf>,
    /// Leave that when all is done
    #[arg(long, requires = "memory_limit")]
    keep_work: bool,
    #[command(flatten)]
    cut: CutArgs,
}

impl StopArgs {
    fn resolve(&self) -> Result<Stop> {
        let fraction = |option: &str, value: Option<f64>, most: f64| match value {
            Some(v) if !(0.0..=most).contains(&v) => {
                let limit = if most < f64::MAX {
                    format!("0 to {most}")
                } else {
                    "0 or more".into()
                };
                Err(Failure::input(format!(
                    "--{option} is {v}; it must be {limit}"
                )))
            }
            value => Ok(value),
        };
        Ok(Stop {
            triangles: self.triangles,
            ratio: fraction("ratio", self.ratio, 1.0)?,
            error: fraction("error", self.error, f64::MAX)?,
            relative_error: fraction("relative-error", self.relative_error, f64::MAX)?,
        })
    }
}

/// Reads, simplifies, measures, writes, then tells.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    input::output_format(&args.output)?;
    let stop = args.stop.resolve()?;
    if let Some(memory) = args.large.memory_limit {
        return in_blocks(args, memory, console);
    }
    args.large.cut.refuse()?;
    let input = input::read(&args.input, console)?;
    input.require_triangles()?;
    let chain = build(args, stop, &input, console)?;
    let scene = chain.scene_at(&input.scene, 1);
    let log = args.log.as_deref().map(|path| staged_log(path, &chain));
    let log = log.transpose()?;
    let written = output::write_one(&args.output, &scene, &args.write.resolve())?;
    log.map(Staged::publish).transpose()?;
    let outcome = Outcome {
        summary: chain.summary(&input.scene, 1),
        area: [area(&input.scene), area(&scene)],
        stopped: tally(&chain, stopped),
        clustered: tally(&chain, |c| c.levels.first()?.fallback),
        bytes: written.bytes,
    };
    console.summary(&outcome.text(&input, &chain))?;
    console.document(&outcome.document(args, &input, &chain))?;
    console.summary(&outcome.last_line(args, console))
}

/// The same without ever holding the model.
fn in_blocks(args: &Args, memory: u64, console: &Console) -> Result<()> {
    finish(&args.output)?;
    let target = TargetArgs {
        ratio: args.stop.ratio,
        triangles: args.stop.triangles.map(|n| n as u64),
        error: args.stop.error,
    };
    let blocks = BlockArgs {
        memory_limit: Some(memory),
        cut: args.large.cut.clone(),
    };
    let beside = || {
        let mut name = args.output.clone().into_os_string();
        name.push(".karui");
        PathBuf::from(name)
    };
    let folder = args.large.work.clone().unwrap_or_else(beside);
    let work = Work::create(&args.input, &folder, blocks.options(&target))?;
    work.store.sweep()?;
    let last = work.run(memory, plan::threads(), console)?;
    let summary = work.write(&last, &args.output, console)?;
    if !args.large.keep_work {
        work.store.clear()?;
    }
    plan::tell(&summary, &args.output, console)
}

fn build(args: &Args, stop: Stop, input: &Input, console: &Console) -> Result<SceneChain> {
    let weights = args.simplify.weights(input, console)?;
    let progress = console.progress();
    let options = LodOptions {
        levels: Levels::Stops(vec![stop]),
        simplify: SimplifyOptions {
            log: args.log.is_some(),
            ..args.simplify.resolve()
        },
        method: args.simplify.method(),
        prune: args.simplify.prune()?,
        weights: &weights,
        samples: args.samples,
        progress: &*progress,
        ..LodOptions::default()
    };
    Ok(chain_scene(&input.scene, &options)?)
}

/// Meshes that got no coarser have no log.
fn staged_log(path: &Path, chain: &SceneChain) -> Result<Staged> {
    let log = |c: &Option<LodChain>| c.as_ref()?.levels.first()?.log.clone();
    let logs: Vec<_> = chain.chains.iter().map(log).collect();
    let logs: Vec<_> = logs.iter().map(Option::as_ref).collect();
    output::staged(path, &CollapseLog::scene_to_bytes(&logs))
}

struct Outcome {
    summary: LevelSummary,
    /// Of all meshes before and after, each counted once.
    area: [f64; 2],
    /// Reasons why meshes stopped, with the number of meshes, most first.
    stopped: Vec<(Stopped, usize)>,
    /// Why clustering took over, likewise.
    clustered: Vec<(Stopped, usize)>,
    bytes: u64,
}

fn area(scene: &Scene) -> f64 {
    let of_mesh = |mesh: &TriMesh| -> f64 {
        let triangles = 0..mesh.triangles.len();
        triangles.map(|t| geom::area(mesh.corners(t))).sum()
    };
    scene.meshes.iter().map(|m| of_mesh(&m.mesh)).sum()
}

fn stopped(chain: &LodChain) -> Option<Stopped> {
    let level = chain.levels.first().map(|l| l.stopped);
    level.or_else(|| chain.dropped.first().map(|d| d.stopped))
}

/// How many meshes have each reason, most first.
fn tally(
    chain: &SceneChain,
    reason: impl Fn(&LodChain) -> Option<Stopped>,
) -> Vec<(Stopped, usize)> {
    let mut counts: Vec<(Stopped, usize)> = Vec::new();
    for stopped in chain.chains.iter().flatten().filter_map(reason) {
        match counts.iter_mut().find(|(s, _)| *s == stopped) {
            Some((_, count)) => *count += 1,
            None => counts.push((stopped, 1)),
        }
    }
    counts.sort_by_key(|&(_, count)| std::cmp::Reverse(count));
    counts
}

fn pruned_line(chain: &SceneChain) -> Option<String> {
    let pruned = chain.pruned();
    let (parts, triangles) = (count(pruned.components), count(pruned.triangles));
    let size = number(pruned.error);
    (pruned.components > 0).then(|| {
        format!("pruned     {parts} parts of {triangles} triangles, the largest {size} across")
    })
}

impl Outcome {
    fn text(&self, input: &Input, chain: &SceneChain) -> String {
        let before = chain.summary(&input.scene, 0);
        let LevelSummary {
            triangles,
            vertices,
            max,
            mean,
            rms,
            ..
        } = self.summary;
        let share = triangles as f64 / before.triangles.max(1) as f64;
        let of_diagonal = |x: f64| percent(x / chain.diagonal);
        let mut lines = vec![
            format!(
                "triangles  {} -> {} ({})",
                count(before.triangles),
                count(triangles),
                percent(share),
            ),
            format!(
                "vertices   {} -> {}",
                count(before.vertices),
                count(vertices)
            ),
            format!(
                "error      max {}, mean {}, RMS {}; max {} and RMS {} of the diagonal",
                number(max),
                number(mean),
                number(rms),
                of_diagonal(max),
                of_diagonal(rms),
            ),
        ];
        let [area, left] = self.area;
        lines.push(format!(
            "area       {} -> {} ({})",
            number(area),
            number(left),
            percent(left / area.max(f64::MIN_POSITIVE))
        ));
        lines.extend(pruned_line(chain));
        let of = |meshes: usize| match chain.chains.len() {
            0 | 1 => String::new(),
            _ => format!(" ({meshes} meshes)"),
        };
        for &(reason, meshes) in &self.clustered {
            lines.push(format!(
                "clustered  instead of edge collapse{}: {}",
                of(meshes),
                explain::reason(reason)
            ));
        }
        for &(stopped, meshes) in &self.stopped {
            let of = of(meshes);
            let advice = explain::advice(stopped).map_or(String::new(), |a| format!("; {a}"));
            lines.push(format!(
                "stopped    {}{of}{advice}",
                explain::reason(stopped)
            ));
        }
        lines.join("\n")
    }

    fn document(&self, args: &Args, input: &Input, chain: &SceneChain) -> Value {
        let before = chain.summary(&input.scene, 0);
        let s = self.summary;
        let stopped = |&(why, meshes): &(Stopped, usize)| json!({ "reason": explain::key(why), "meshes": meshes, "advice": explain::advice(why) });
        let pruned = chain.pruned();
        json!({
            "input": args.input, "output": args.output, "bytes": self.bytes,
            "triangles": { "before": before.triangles, "after": s.triangles },
            "vertices": { "before": before.vertices, "after": s.vertices },
            "area": { "before": self.area[0], "after": self.area[1] },
            "diagonal": chain.diagonal,
            "error": { "max": s.max, "mean": s.mean, "rms": s.rms },
            "pruned": { "parts": pruned.components, "triangles": pruned.triangles, "largest": pruned.error },
            "clustered": self.clustered.iter().map(stopped).collect::<Vec<_>>(),
            "stopped": self.stopped.iter().map(stopped).collect::<Vec<_>>(),
        })
    }

    fn last_line(&self, args: &Args, console: &Console) -> String {
        format!(
            "{}: {} triangles, {}, off by at most {}; {}",
            args.output.display(),
            count(self.summary.triangles),
            bytes(self.bytes),
            number(self.summary.max),
            seconds(console.elapsed()),
        )
    }
}
