//! `karui plan`: work out of core that can be stopped, shared and looked at.

use crate::console::Console;
use crate::explain;
use crate::failure::Failure;
use crate::outofcore::{BlockArgs, TargetArgs, Work, finish, memory, told};
use crate::table::{count, number, table};
use anyhow::Result;
use clap::Subcommand;
use karui::outofcore::{self, Next, Store as _, Summary, manifests, next};
use karui::simplify::Stopped;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Work on models larger than memory: plan, run, resume, verify
///
/// A plan is a folder, or a prefix of a bucket (an s3://, gs:// or az:// URL, of a karui built with
/// `--features cloud`). It holds phases of tasks that do not need each other and what they have
/// made; `karui task run` does one of them, anywhere.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Make a plan
    New(New),
    /// Show a plan and how far it has come
    Show(In),
    /// Do all that is still to be done, here
    #[command(visible_alias = "resume")]
    Run(Run),
    /// Close the phase if all its tasks are done; name the next one
    Next(In),
    /// Check every block; exit with 1 if some are missing or damaged
    Verify(In),
    /// Write the result of a plan that is done
    Write(Write),
}

#[derive(Debug, clap::Args)]
struct New {
    /// The model
    input: PathBuf,
    /// The folder to make, or a URL
    plan: PathBuf,
    #[command(flatten)]
    target: TargetArgs,
    #[command(flatten)]
    blocks: BlockArgs,
}

#[derive(Debug, clap::Args)]
struct In {
    /// The plan's folder or URL
    plan: PathBuf,
}

#[derive(Debug, clap::Args)]
struct Run {
    /// The plan's folder or URL
    plan: PathBuf,
    /// The PLY file to write in the end
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Memory that may be taken
    #[arg(long, value_name = "SIZE", value_parser = memory, default_value = "1GiB")]
    memory_limit: u64,
}

#[derive(Debug, clap::Args)]
struct Write {
    /// The plan's folder or URL
    plan: PathBuf,
    /// The PLY file
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
}

/// Does what the subcommand says.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    match &args.command {
        Command::New(args) => new(args, console),
        Command::Show(args) => show(&args.plan, console),
        Command::Run(args) => all(args, console),
        Command::Next(args) => step(&args.plan, console),
        Command::Verify(args) => verify(&args.plan, console),
        Command::Write(args) => write(args, console),
    }
}

fn new(args: &New, console: &Console) -> Result<()> {
    let work = Work::create(&args.input, &args.plan, args.blocks.options(&args.target))?;
    announce(&work, console)
}

fn step(folder: &Path, console: &Console) -> Result<()> {
    let work = Work::open(folder)?;
    if let Next::Run(manifest) = next(&work.store, &work.plan).map_err(told)? {
        let found = |row: u64| outofcore::verify_task(&work.store, &manifest, row);
        let results: outofcore::Result<Vec<_>> =
            (0..manifest.rows.len() as u64).map(found).collect();
        match results {
            Ok(results) => manifest.commit(&work.store, results).map_err(told)?,
            Err(error) if error.lost().is_some() => {}
            Err(error) => return Err(told(error)),
        }
    }
    announce(&work, console)
}

/// Names the manifest to be run next and its number of rows; nothing if there is none.
fn announce(work: &Work, console: &Console) -> Result<()> {
    let Next::Run(manifest) = next(&work.store, &work.plan).map_err(told)? else {
        return console.document(&json!({ "done": true }));
    };
    let path = work.store.name().join(manifest.name());
    let rows = manifest.rows.len();
    console.document(&json!({ "done": false, "manifest": path, "rows": rows }))?;
    console.data(&format!("{} {rows}", path.display()))
}

fn all(args: &Run, console: &Console) -> Result<()> {
    args.output.as_deref().map(finish).transpose()?;
    let work = Work::open(&args.plan)?;
    let last = work.run(args.memory_limit, threads(), console)?;
    let Some(output) = &args.output else {
        return announce(&work, console);
    };
    let summary = work.write(&last, output, console)?;
    tell(&summary, output, console)
}

/// Threads that there are, or as many as `--threads` says.
pub fn threads() -> usize {
    rayon::current_num_threads()
}

fn write(args: &Write, console: &Console) -> Result<()> {
    finish(&args.output)?;
    let work = Work::open(&args.plan)?;
    let Next::Done(last) = next(&work.store, &work.plan).map_err(told)? else {
        let hint = format!("`karui plan resume {}` does the rest", args.plan.display());
        return Err(Failure::input("the plan is not done").hint(hint).into());
    };
    let summary = work.write(&last, &args.output, console)?;
    tell(&summary, &args.output, console)
}

/// Says what has been made.
pub fn tell(summary: &Summary, output: &Path, console: &Console) -> Result<()> {
    console.document(&json!({
        "output": output,
        "triangles": { "before": summary.input, "after": summary.triangles },
        "vertices": { "after": summary.vertices },
        "error": { "estimate": summary.error },
        "stopped": summary.stopped.map(explain::key),
    }))?;
    if let Some(reason) = summary.stopped {
        console.summary(&format!("stopped    {}", why(summary, reason)))?;
    }
    console.summary(&format!(
        "{}: {} -> {} triangles, {} vertices, error about {}; {}",
        output.display(),
        count(summary.input as usize),
        count(summary.triangles as usize),
        count(summary.vertices as usize),
        number(summary.error),
        crate::table::seconds(console.elapsed()),
    ))
}

/// Why there are more triangles than were asked for.
fn why(summary: &Summary, stopped: Stopped) -> String {
    let wanted = match summary.target {
        0 => String::new(),
        target => format!("before {} triangles: ", count(target as usize)),
    };
    let reason = explain::reason(stopped);
    let advice = match stopped {
        Stopped::Locked => "; larger blocks have shorter borders and go further",
        _ => "",
    };
    format!("{wanted}{reason}{advice}")
}

fn show(folder: &Path, console: &Console) -> Result<()> {
    let work = Work::open(folder)?;
    next(&work.store, &work.plan).map_err(told)?;
    let mut lines = Vec::new();
    let mut phases: Vec<Value> = Vec::new();
    for manifest in manifests(&work.store).map_err(told)? {
        let (phase, rows) = (&manifest.phase, manifest.rows.len());
        let is_there = |row: &&outofcore::Row| work.store.exists(&row.output).unwrap_or(false);
        let done = manifest.rows.iter().filter(is_there).count();
        let results = manifest.results(&work.store).map_err(told)?;
        let triangles: Option<u64> = results.map(|r| r.iter().map(|r| r.triangles).sum());
        phases.push(json!({
            "kind": phase.kind, "level": phase.level, "rows": rows, "done": done,
            "closed": triangles.is_some(), "target": phase.target, "triangles": triangles,
        }));
        lines.push(vec![
            phase.name(""),
            count(done),
            count(rows),
            count(phase.triangles as usize),
            count(phase.target as usize),
            triangles.map_or("open".into(), |n| count(n as usize)),
        ]);
    }
    let plan = &work.plan;
    console.document(&json!({ "plan": plan, "phases": phases }))?;
    console.data(&format!(
        "{}: {} vertices, faces in {} portions; blocks of {} triangles",
        plan.source,
        count(plan.vertices as usize),
        count(plan.chunks as usize),
        count(plan.options.block_triangles as usize),
    ))?;
    let header = ["phase", "done", "of", "before", "target", "triangles"];
    console.data(&table(&header, &lines, false))
}

fn verify(folder: &Path, console: &Console) -> Result<()> {
    let work = Work::open(folder)?;
    let lost = outofcore::verify(&work.store).map_err(told)?;
    console.document(&json!({ "lost": lost }))?;
    if lost.is_empty() {
        return console.data("all blocks are whole");
    }
    console.data(&lost.join("\n"))?;
    let message = format!("{} blocks are missing or damaged", lost.len());
    let hint = format!("`karui plan resume {}` makes them anew", folder.display());
    Err(Failure::check(message).hint(hint).into())
}
