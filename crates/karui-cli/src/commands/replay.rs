//! `karui replay`: another level from a log.

use crate::args::WriteArgs;
use crate::console::Console;
use crate::failure::Failure;
use crate::input::{self, Input};
use crate::output::{self, Staged};
use crate::table::{bytes, count, number, percent, seconds};
use anyhow::Result;
use karui::Scene;
use karui::simplify::{CollapseLog, Replayed, Stop, Stopped};
use serde_json::json;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Make another level from a log of `karui simplify --log`
///
/// Any level between the model and the one that was simplified to; or the same triangles for the
/// model in another pose, with vertices where that pose wants them. Without a target it is the
/// level that was simplified to.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The model that was simplified, or one that differs in positions alone: a pose, the target
    /// of a morph
    input: PathBuf,
    /// The log
    log: PathBuf,
    /// The file to write
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Triangles to keep
    #[arg(long, value_name = "COUNT")]
    triangles: Option<usize>,
    /// Share of the triangles to keep, 0 to 1
    #[arg(long, value_name = "SHARE")]
    ratio: Option<f64>,
    /// Also write which new vertex every old one has become part of: lines of mesh,old,new
    #[arg(long, value_name = "FILE")]
    map: Option<PathBuf>,
    #[command(flatten)]
    write: WriteArgs,
}

/// Reads, replays, writes, then tells.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    input::output_format(&args.output)?;
    let logs = read_logs(&args.log)?;
    let input = input::read(&args.input, console)?;
    input.require_triangles()?;
    let levels = replay(args, &input, &logs)?;
    let map = args.map.as_deref().map(|path| staged_map(path, &levels));
    let map = map.transpose()?;
    let mut scene = input.scene.clone();
    let mut ended = 0;
    let mut error = 0.0f64;
    for (named, level) in scene.meshes.iter_mut().zip(levels) {
        let Some(level) = level else { continue };
        ended += usize::from(level.stopped == Stopped::Exhausted);
        error = error.max(level.error);
        named.mesh = level.mesh;
    }
    scene.nodes.iter_mut().for_each(|node| node.lods = None);
    let written = output::write_one(&args.output, &scene, &args.write.resolve())?;
    map.map(Staged::publish).transpose()?;
    let [before, after] = [&input.scene, &scene].map(|s| [s.triangle_count(), vertices(s)]);
    let share = after[0] as f64 / before[0].max(1) as f64;
    let mut lines = vec![
        format!(
            "triangles  {} -> {} ({})",
            count(before[0]),
            count(after[0]),
            percent(share)
        ),
        format!("vertices   {} -> {}", count(before[1]), count(after[1])),
        format!("error      about {} (`karui measure` tells)", number(error)),
    ];
    let asked = args.triangles.is_some() || args.ratio.is_some();
    if asked && ended > 0 {
        lines.push(format!("stopped    at the end of {ended} logs"));
    }
    console.summary(&lines.join("\n"))?;
    console.document(&json!({
        "input": args.input, "log": args.log, "output": args.output, "bytes": written.bytes,
        "triangles": { "before": before[0], "after": after[0] },
        "vertices": { "before": before[1], "after": after[1] },
        "estimate": error,
        "logs_at_their_end": ended,
    }))?;
    console.summary(&format!(
        "{}: {} triangles, {}; {}",
        args.output.display(),
        count(after[0]),
        bytes(written.bytes),
        seconds(console.elapsed()),
    ))
}

fn vertices(scene: &Scene) -> usize {
    scene.meshes.iter().map(|m| m.mesh.positions.len()).sum()
}

fn read_logs(path: &Path) -> Result<Vec<Option<CollapseLog>>> {
    let fail =
        |error: &dyn std::fmt::Display| Failure::input(format!("{}: {error}", path.display()));
    let bytes = std::fs::read(path).map_err(|e| fail(&e))?;
    let logs = CollapseLog::scene_from_bytes(&bytes);
    let hint = "`karui simplify --log FILE` writes logs";
    Ok(logs.map_err(|e| fail(&e).hint(hint))?)
}

/// The level of every mesh that has a log.
fn replay(
    args: &Args,
    input: &Input,
    logs: &[Option<CollapseLog>],
) -> Result<Vec<Option<Replayed>>> {
    let meshes = &input.scene.meshes;
    let other = |what: String| {
        let hint = "a log is for the model it was made of, and for its poses";
        Failure::input(format!("{}: {what}", input.path.display())).hint(hint)
    };
    if logs.len() != meshes.len() {
        let what = format!(
            "the log is of {} meshes, the model has {}",
            logs.len(),
            meshes.len()
        );
        return Err(other(what).into());
    }
    if let Some(ratio) = args.ratio.filter(|r| !(0.0..=1.0).contains(r)) {
        let message = format!("--ratio is {ratio}; it must be 0 to 1");
        return Err(Failure::input(message).into());
    }
    let all = input.scene.triangle_count().max(1) as u128;
    let level = |(m, log): (usize, &Option<CollapseLog>)| {
        let Some(log) = log else { return Ok(None) };
        let mesh = &meshes[m].mesh;
        let own = mesh.triangles.len() as u128;
        let stop = Stop {
            triangles: args.triangles.map(|n| (n as u128 * own / all) as usize),
            ratio: args.ratio,
            ..Stop::default()
        };
        let level = log.level(mesh, stop);
        level
            .map(Some)
            .map_err(|e| other(format!("mesh {m}: {e}")).into())
    };
    logs.iter().enumerate().map(level).collect()
}

fn staged_map(path: &Path, levels: &[Option<Replayed>]) -> Result<Staged> {
    let mut text = String::from("mesh,old,new\n");
    for (m, level) in levels.iter().enumerate() {
        let map = level.iter().flat_map(|level| level.map.iter().enumerate());
        for (old, new) in map {
            let new = new.map_or(String::new(), |new| new.to_string());
            // Writing to a string does not fail.
            let _ = writeln!(text, "{m},{old},{new}");
        }
    }
    output::staged(path, text.as_bytes())
}
