//! `karui lod`: a chain of levels of detail, the main job.

mod plan;
mod report;

use crate::args::{MetricArgs, ScreenArgs, SimplifyArgs, WriteArgs};
use crate::console::Console;
use crate::explain;
use crate::input::{self, Input};
use crate::output::Staged;
use crate::table::{bytes, count, number, seconds};
use crate::textures;
use anyhow::Result;
use karui::lod::{
    Levels, LodOptions, Reached, SceneChain, SeenOptions, chain_scene, chain_seen, to_msft_lod,
};
use karui_io::WriteOptions;
use plan::Plan;
use report::{Judged, Report};
use std::path::{Path, PathBuf};

/// Make a chain of levels of detail, with measured errors
///
/// Every level is simplified from the original and its true distance to it is measured, in both
/// directions. The switch distance is how far the eye has to be away for the largest error to
/// look no larger than the pixel tolerance; with --metric flip, for pictures of the level and of
/// the original to differ no more than a bound.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The model
    input: PathBuf,
    /// A folder, for a file a level and one with all of them; or a .glb or .gltf file, for one
    /// with all of them (MSFT_lod) and a report beside it
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    /// A file a level only, none with all of them
    #[arg(long)]
    separate: bool,
    /// Format of the file a level
    #[arg(long, value_enum, default_value_t, value_name = "FORMAT")]
    format: plan::LevelFormat,
    #[command(flatten)]
    levels: LevelArgs,
    #[command(flatten)]
    metric: MetricArgs,
    #[command(flatten)]
    screen: ScreenArgs,
    #[command(flatten)]
    simplify: SimplifyArgs,
    /// Face samples, and as many edge samples, that an error is measured with at most
    #[arg(long, value_name = "N", default_value_t = 200_000)]
    samples: u64,
    #[command(flatten)]
    write: WriteArgs,
}

/// Which levels to make.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Levels (default: by halving)")]
#[group(multiple = false)]
struct LevelArgs {
    /// Levels by halving: this many at most, besides the original [default: 5]
    #[arg(long, value_name = "N")]
    levels: Option<usize>,
    /// Shares of the triangles to keep, e.g. 0.5,0.1
    #[arg(long, value_delimiter = ',', value_name = "SHARES")]
    ratio: Vec<f64>,
    /// Triangles of the whole model to keep, e.g. 10000,1000
    #[arg(long, value_delimiter = ',', value_name = "COUNTS")]
    triangles: Vec<usize>,
    /// Largest measured errors, in model units
    #[arg(long, value_delimiter = ',', value_name = "ERRORS")]
    error: Vec<f64>,
    /// Heights of the model on the screen, in pixels; errors then stay below the tolerance
    #[arg(long, value_delimiter = ',', value_name = "HEIGHTS")]
    pixels: Vec<f64>,
}

impl LevelArgs {
    fn resolve(&self) -> Levels {
        if !self.ratio.is_empty() {
            return Levels::Ratios(self.ratio.clone());
        }
        if !self.triangles.is_empty() {
            return Levels::Triangles(self.triangles.clone());
        }
        if !self.error.is_empty() {
            return Levels::Errors(self.error.clone());
        }
        if !self.pixels.is_empty() {
            return Levels::Pixels(self.pixels.clone());
        }
        Levels::Halving {
            min_triangles: 32,
            max_levels: self.levels.unwrap_or(5),
        }
    }
}

/// Reads, builds the chain, writes everything, then tells.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    let seen = args.metric.resolve()?;
    let plan = Plan::new(&args.output, args.separate, args.format)?;
    let input = input::read(&args.input, console)?;
    input.require_triangles()?;
    // Find out before the work, not after it, that nothing can be written.
    drop(plan.stage()?);
    let mut chain = build(args, &input, console)?;
    let judged = seen.map(|options| look(&input, &mut chain, options, console));
    let judged = judged.transpose()?;
    let options = args.write.resolve();
    let report = Report::new(&input, &chain, args.samples, judged.as_ref());
    let (report, files) = write(&plan, &input, &chain, &options, report, console)?;
    console.summary(&report.table())?;
    console.document(&report)?;
    tell_clustered(&chain, console);
    tell_dropped(&input, &chain, console);
    tell_unlike(judged.as_ref(), console);
    console.summary(&last_line(&report, &files, console))
}

fn build(args: &Args, input: &Input, console: &Console) -> Result<SceneChain> {
    let weights = args.simplify.weights(input, console)?;
    if input.scene.stand_ins().contains(&true) {
        console.warn("the model has levels of detail already; new ones take their place");
    }
    let progress = console.progress();
    let options = LodOptions {
        levels: args.levels.resolve(),
        screen: args.screen.resolve(),
        simplify: args.simplify.resolve(),
        method: args.simplify.method(),
        prune: args.simplify.prune()?,
        weights: &weights,
        samples: args.samples,
        progress: &*progress,
        ..LodOptions::default()
    };
    Ok(chain_scene(&input.scene, &options)?)
}

/// Lets pictures decide from where on levels may be shown.
fn look(
    input: &Input,
    chain: &mut SceneChain,
    options: SeenOptions<'_>,
    console: &Console,
) -> Result<Judged> {
    let images = textures::decode(input, console);
    let progress = console.progress();
    let options = SeenOptions {
        screen: chain.screen,
        progress: &*progress,
        ..options
    };
    Ok(Judged {
        levels: chain_seen(&input.scene, &images, chain, &options)?,
        bound: options.bound,
        views: options.views,
        samples: options.samples,
    })
}

/// Writes all files or none.
fn write(
    plan: &Plan,
    input: &Input,
    chain: &SceneChain,
    options: &WriteOptions,
    mut report: Report,
    console: &Console,
) -> Result<(Report, Vec<PathBuf>)> {
    let staged = plan.stage()?;
    // Levels that are not kept as files are written all the same, for their
    // size, to a place that vanishes.
    let scratch = tempfile::tempdir()?;
    let measured = Staged::in_directory(scratch.path())?;
    for (level, row) in report.levels.iter_mut().enumerate() {
        let scene = chain.scene_at(&input.scene, level);
        let name = plan.level_name(&input.stem(), level);
        let place = if plan.separate { &staged } else { &measured };
        row.bytes = place.scene(&name, &scene, options)?;
        row.file = plan.separate.then_some(name);
    }
    if let Some(name) = plan.combined_name(&input.stem()) {
        let linked = to_msft_lod(&input.scene, chain);
        if !linked.left_out.is_empty() {
            let nodes = linked.left_out.len();
            console.warn(&format!(
                "{nodes} nodes keep full detail: an extension, or morph targets and children, forbid stand-ins"
            ));
        }
        report.combined_bytes = Some(staged.scene(&name, &linked.scene, options)?);
        report.combined = Some(name);
    }
    let json = serde_json::to_vec_pretty(&report)?;
    staged.bytes(&plan.report_name(), &json)?;
    Ok((report, staged.publish()?))
}

/// Levels that clustering had to make, in all meshes.
fn tell_clustered(chain: &SceneChain, console: &Console) {
    let levels = chain.chains.iter().flatten().flat_map(|c| &c.levels);
    let reasons: Vec<_> = levels.filter_map(|l| l.fallback).collect();
    if let Some(&first) = reasons.first() {
        let (levels, reason) = (count(reasons.len()), explain::reason(first));
        console.warn(&format!(
            "{levels} levels are clustered, edge collapse did not get there; the first: {reason}"
        ));
    }
}

/// Lines about levels left out that are printed; the report has all.
const TOLD: usize = 10;

fn tell_dropped(input: &Input, chain: &SceneChain, console: &Console) {
    let mut lines = Vec::new();
    for (named, chain) in input.scene.meshes.iter().zip(&chain.chains) {
        for level in chain.iter().flat_map(|c| &c.dropped) {
            let name = named.name.as_deref().unwrap_or("mesh");
            let stays = format!(
                "{name}: a level is left out, it would keep {} triangles",
                count(level.triangles)
            );
            let reason = explain::reason(level.stopped);
            let advice = explain::advice(level.stopped).map_or(String::new(), |a| format!("; {a}"));
            lines.push(format!("{stays}: {reason}{advice}"));
        }
    }
    if lines.is_empty() && chain.level_count() == 1 {
        console.warn("no level was made: every mesh has too few triangles; --ratio asks for less");
    }
    lines.iter().take(TOLD).for_each(|line| console.warn(line));
    if lines.len() > TOLD {
        console.warn(&format!(
            "{} more levels are left out; see the report",
            lines.len() - TOLD
        ));
    }
}

/// Levels that look different from however far away.
fn tell_unlike(judged: Option<&Judged>, console: &Console) {
    let Some(judged) = judged else { return };
    for (level, seen) in (1..).zip(&judged.levels) {
        if seen.reached == Reached::Never {
            console.warn(&format!(
                "level {level}: FLIP is {} even {} away, where the search ends; the bound is {}",
                number(seen.flip),
                number(seen.distance),
                number(judged.bound),
            ));
        }
    }
}

fn last_line(report: &Report, files: &[PathBuf], console: &Console) -> String {
    let sizes = files
        .iter()
        .filter_map(|f| Some(std::fs::metadata(f).ok()?.len()));
    let made = match files {
        [only] => only.display().to_string(),
        [first, ..] => {
            let folder = first.parent().unwrap_or(Path::new("."));
            format!("{} files in {}", files.len(), folder.display())
        }
        [] => String::new(),
    };
    let worst = report
        .levels
        .iter()
        .map(|l| l.error.max)
        .fold(0.0, f64::max);
    format!(
        "{made}, {}; coarsest {} triangles, off by at most {}; {}",
        bytes(sizes.sum()),
        count(report.levels.last().map_or(0, |l| l.triangles)),
        number(worst),
        seconds(console.elapsed()),
    )
}
