//! `karui bench models`: a folder of models, each in a process of its own.

use super::child;
use super::one::{Figures, Level};
use super::page::{Page, machine};
use crate::console::{Console, to_stderr};
use crate::failure::Failure;
use crate::progress::check_cancelled;
use crate::table::{count, seconds, table};
use anyhow::{Context as _, Result};
use karui_io::Format;
use serde::Serialize;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Simplify every model of a folder and tabulate what comes out
///
/// Every model is read, simplified to each ratio, written as GLB, read again and measured, in a
/// process of its own. What cannot be read is listed with the error.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Folder of models, searched with everything below it
    #[arg(
        long,
        value_name = "DIR",
        env = "KARUI_MODELS",
        hide_env_values = true,
        default_value = "../shared/models"
    )]
    models: PathBuf,
    /// Markdown file to write the figures into instead of printing them
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Shares of the triangles to keep
    #[arg(long, value_delimiter = ',', default_values_t = [0.5, 0.1, 0.01])]
    ratio: Vec<f64>,
    /// Seconds a model may take
    #[arg(long, value_name = "S", default_value_t = 600)]
    timeout: u64,
}

#[derive(Debug, Serialize)]
struct Outcome {
    file: String,
    figures: Option<Figures>,
    /// Refused by the reader, which is right for what is no sound model.
    refused: Option<String>,
    /// Anything else that went wrong.
    failed: Option<String>,
}

/// Runs every model, one after the other for the sake of the times.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    let files = models(&args.models)?;
    if files.is_empty() {
        let message = format!("{}: no models in it", args.models.display());
        return Err(Failure::input(message)
            .hint("name a folder by --models")
            .into());
    }
    let page = args.output.as_deref().map(Page::open).transpose()?;
    let mut outcomes = Vec::new();
    for (i, file) in files.iter().enumerate() {
        check_cancelled()?;
        if !console.quiet {
            to_stderr(&format!("{}/{} {}", i + 1, files.len(), file.display()));
        }
        let outcome = run_one(file, args)?;
        for why in [&outcome.refused, &outcome.failed].into_iter().flatten() {
            console.warn(why);
        }
        outcomes.push(outcome);
    }
    let markdown = markdown(args, &outcomes);
    if let Some(page) = page {
        page.write("karui bench models", &markdown)?;
    } else {
        console.data(&markdown)?;
    }
    console.document(&outcomes)?;
    let failed = outcomes.iter().filter(|o| o.failed.is_some()).count();
    let done = outcomes.iter().filter(|o| o.figures.is_some()).count();
    console.summary(&format!(
        "{done} of {} models simplified, {failed} failed; {}",
        outcomes.len(),
        seconds(console.elapsed()),
    ))?;
    if failed > 0 {
        return Err(Failure::check(format!("{failed} models failed")).into());
    }
    Ok(())
}

/// All files with the extension of a model, in order.
pub fn models(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        let fail =
            |e| Failure::input(format!("{}: {e}", folder.display())).hint("name it by --models");
        for entry in std::fs::read_dir(&folder).map_err(fail)? {
            let path = entry?.path();
            if path.is_dir() {
                folders.push(path);
            } else if Format::from_path(&path).is_ok() {
                files.push(path);
            }
        }
    }
    files.sort();
    Ok(files)
}

fn run_one(file: &Path, args: &Args) -> Result<Outcome> {
    let name = file.strip_prefix(&args.models).unwrap_or(file);
    let mut outcome = Outcome {
        file: name.display().to_string(),
        figures: None,
        refused: None,
        failed: None,
    };
    let ratios: Vec<String> = args.ratio.iter().map(f64::to_string).collect();
    let ratios = ratios.join(",");
    let words = ["bench", "one", "--json", "--quiet", "--ratio", &ratios];
    let mut words: Vec<OsString> = words.map(OsString::from).into();
    words.push(file.into());
    let ended = child::run(&words, &[], Duration::from_secs(args.timeout))?;
    let folder = format!("{}/", args.models.display());
    let told = ended.error.replace(&folder, "");
    match ended.code {
        None => outcome.failed = Some(format!("took more than {} s", args.timeout)),
        Some(0) => {
            let figures = serde_json::from_str(&ended.out).context("reading figures")?;
            outcome.figures = Some(figures);
        }
        Some(2) => outcome.refused = Some(told),
        Some(code) => outcome.failed = Some(format!("exit code {code}: {told}")),
    }
    Ok(outcome)
}

fn markdown(args: &Args, outcomes: &[Outcome]) -> String {
    let mut text = String::from(HEAD);
    text += &format!("{}\n\n", machine());
    text += &figures_table(args, outcomes);
    let lists = [
        (
            "Refused",
            outcomes
                .iter()
                .map(|o| (&o.file, &o.refused))
                .collect::<Vec<_>>(),
        ),
        (
            "Failed",
            outcomes.iter().map(|o| (&o.file, &o.failed)).collect(),
        ),
    ];
    for (title, list) in lists {
        let lines = list
            .iter()
            .filter_map(|(file, why)| Some(format!("- `{file}`: {}\n", why.as_ref()?)));
        let lines: String = lines.collect();
        let lines = if lines.is_empty() {
            "None.\n".to_owned()
        } else {
            lines
        };
        text += &format!("\n\n## {title}\n{lines}");
    }
    text
}

const HEAD: &str = "\
# Measured

Written by `karui bench models -o docs/measured.md` (release build). Every model is read,
simplified with the default options, written as GLB, read again and compared with the original.

- s: seconds of processor time for simplifying, one thread.
- RMS, max: measured two-sided distance, in percent of the diagonal of the mesh; of several meshes
  the worst.
- flips: triangles that face away from the nearest point of the original, beyond those of the
  original compared with itself. non-m.: edges with more than two triangles, beyond the original's.
- MB: memory at most for reading and simplifying.

";

fn figures_table(args: &Args, outcomes: &[Outcome]) -> String {
    let mut header = vec!["model".to_owned(), "triangles".into()];
    for ratio in &args.ratio {
        header.push(format!("{} %", ratio * 100.0));
        header.extend(["s", "RMS", "max"].map(String::from));
    }
    header.extend(["flips", "non-m.", "MB"].map(String::from));
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    let rows: Vec<_> = outcomes.iter().filter_map(row).collect();
    table(&header, &rows, true)
}

fn row(outcome: &Outcome) -> Option<Vec<String>> {
    let figures = outcome.figures.as_ref()?;
    let mut cells = vec![format!("`{}`", outcome.file), count(figures.triangles)];
    for level in &figures.levels {
        cells.push(count(level.triangles));
        cells.push(format!("{:.2}", level.seconds));
        cells.extend([level.rms, level.max].map(|x| format!("{:.3}", x * 100.0)));
    }
    let sum = |what: fn(&Level) -> usize| count(figures.levels.iter().map(what).sum());
    cells.push(sum(|l| l.new_flips));
    cells.push(sum(|l| l.new_non_manifold));
    cells.push(
        figures
            .peak_mb
            .map_or_else(|| "?".into(), |mb| format!("{mb:.0}")),
    );
    Some(cells)
}
