//! `--kills`: runs that are killed and resumed write what one that was let alone does.

use super::super::child;
use super::super::page::machine;
use super::land::{LIMIT, Size, words};
use crate::progress::check_cancelled;
use anyhow::{Result, ensure};
use serde::Serialize;
use serde_json::{Value, json};
use std::ffi::OsString;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Vertices along x and z of the land.
const LAND: &str = "513x513";
/// So that there are some tens of tasks.
const MEMORY: &str = "40MiB";

#[derive(Debug, Default, Serialize)]
struct Found {
    /// Runs that were killed before they ended.
    killed: u32,
    /// Runs that had ended.
    late: u32,
    /// Names of files that killed writers left half-written beside the blocks.
    aside: usize,
    /// Seconds that a run takes.
    seconds: f64,
}

/// Kills run after run, each at another moment.
pub fn run(count: u32, ratio: f64, folder: &Path) -> Result<(String, Value)> {
    let size: Size = LAND.parse().map_err(anyhow::Error::msg)?;
    let land = size.make(folder, false)?;
    let [whole, out] = ["whole.ply", "out.ply"].map(|name| folder.join(name));
    let started = Instant::now();
    finish(&command(&land, ratio, &whole))?;
    let mut found = Found {
        seconds: started.elapsed().as_secs_f64(),
        ..Found::default()
    };
    let expected = fs::read(&whole)?;
    for kill in 0..count {
        check_cancelled()?;
        let words = command(&land, ratio, &out);
        let wait = Duration::from_secs_f64(found.seconds * moment(kill));
        if killed(&words, wait)? {
            found.killed += 1;
            ensure!(
                !out.exists(),
                "a run that was killed has written {}",
                out.display()
            );
        } else {
            found.late += 1;
        }
        found.aside += aside(&folder.join("out.ply.karui"));
        finish(&words)?;
        let same = fs::read(&out)? == expected;
        ensure!(
            same,
            "killed after {wait:?} and resumed, it wrote something else"
        );
        fs::remove_file(&out)?;
    }
    Ok((markdown(size, &found), json!(found)))
}

/// Shares of a run that lie all over it: multiples of the golden ratio.
fn moment(kill: u32) -> f64 {
    (f64::from(kill + 1) * 0.618_033_988_749_895).fract()
}

fn command(land: &Path, ratio: f64, out: &Path) -> Vec<OsString> {
    let mut words = words(["simplify", "--quiet", "--memory-limit", MEMORY, "--ratio"]);
    words.extend([
        ratio.to_string().into(),
        "--output".into(),
        out.into(),
        land.into(),
    ]);
    words
}

fn finish(words: &[OsString]) -> Result<()> {
    let ended = child::run(words, &[], LIMIT)?;
    ensure!(ended.code == Some(0), "simplifying: {}", ended.error);
    Ok(())
}

/// Whether the process was still at work when it was killed.
fn killed(words: &[OsString], wait: Duration) -> Result<bool> {
    let mut command = Command::new(std::env::current_exe()?);
    let command = command.args(words).stdin(Stdio::null());
    let mut child = command
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()?;
    std::thread::sleep(wait);
    child.kill()?;
    Ok(child.wait()?.code().is_none())
}

/// How many files were being written when their writer was killed.
fn aside(store: &Path) -> usize {
    let names = fs::read_dir(store).into_iter().flatten().flatten();
    let aside = |entry: &fs::DirEntry| entry.file_name().to_string_lossy().starts_with('~');
    names.filter(aside).count()
}

fn markdown(size: Size, found: &Found) -> String {
    format!(
        "{} Land of {size} vertices, memory limit {MEMORY}, a run takes {:.1} s: {} runs ended by \
         SIGKILL at moments spread over a run ({} more had ended before), {} files left \
         half-written aside; every run, resumed, wrote the same bytes as one let alone.",
        machine(),
        found.seconds,
        found.killed,
        found.late,
        found.aside
    )
}
