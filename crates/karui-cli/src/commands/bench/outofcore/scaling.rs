//! `--sizes`: time grows as the model, memory does not.

use super::super::child;
use super::super::page::machine;
use super::land::{LIMIT, Size, words};
use super::solo::Told;
use crate::progress::check_cancelled;
use crate::table::{count, table};
use anyhow::{Context as _, Result, bail};
use serde_json::{Value, json};
use std::path::Path;

/// Land of every size, one after the other; each is removed before the next.
pub fn run(args: &super::Args, folder: &Path) -> Result<(String, Value)> {
    let mut rows = Vec::new();
    for &size in &args.sizes {
        check_cancelled()?;
        rows.push(of_size(args, size, folder)?);
    }
    Ok((markdown(args, &rows), json!(rows)))
}

fn of_size(args: &super::Args, size: Size, folder: &Path) -> Result<Told> {
    let land = size.make(folder, false)?;
    let mut words = words(["bench", "outofcore-solo", "--json", "--quiet"]);
    words.extend(["--folder".into(), folder.into()]);
    words.extend(["--ratio".into(), args.ratio.to_string().into()]);
    words.extend(["--memory".into(), args.memory_limit.to_string().into()]);
    words.push(land.clone().into());
    let ended = child::run(&words, &[], LIMIT)?;
    std::fs::remove_file(&land)?;
    match ended.code {
        Some(0) => serde_json::from_str(&ended.out).context("reading figures"),
        _ => bail!("land of {size}: {}", ended.error),
    }
}

fn markdown(args: &super::Args, rows: &[Told]) -> String {
    let header = [
        "triangles",
        "left",
        "CPU, s",
        "wall, s",
        "memory, MiB",
        "CPU, µs a triangle",
        "triangles/s",
    ];
    let mebibytes = |bytes: u64| format!("{:.0}", bytes as f64 / f64::from(1 << 20));
    let row = |told: &Told| {
        let triangles = told.triangles as f64;
        vec![
            count(told.triangles as usize),
            count(told.left as usize),
            format!("{:.1}", told.cpu),
            format!("{:.1}", told.wall),
            told.peak.map_or("-".into(), mebibytes),
            format!("{:.2}", told.cpu / triangles * 1e6),
            count((triangles / told.wall) as usize),
        ]
    };
    let rows: Vec<_> = rows.iter().map(row).collect();
    format!(
        "{} Land, binary PLY to binary PLY, a share of {} left, memory limit {} MiB. CPU: user \
         and system, all threads. Memory: most that was resident.\n\n{}",
        machine(),
        args.ratio,
        mebibytes(args.memory_limit),
        table(&header, &rows, true)
    )
}
