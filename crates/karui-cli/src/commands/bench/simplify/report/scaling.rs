//! Time and memory by size.

use super::super::inputs::Kind;
use super::super::peers;
use super::super::solo::Row;
use super::ratio::{Ratio, cell};
use crate::table::{count, table as plain_table};

/// The table of all rows.
pub fn table(rows: &[Row]) -> String {
    let header = [
        "tool",
        "threads",
        "triangles",
        "left",
        "s",
        "CPU s",
        "ns/triangle",
        "÷ smallest",
        "bytes/triangle",
        "MB",
        "÷ time",
        "÷ MB",
    ];
    let lines: Vec<Vec<String>> = rows.iter().map(|row| line(row, rows)).collect();
    plain_table(&header, &lines, true)
}

fn line(row: &Row, rows: &[Row]) -> Vec<String> {
    let nanoseconds = |r: &Row| r.costs.wall.least * 1e9 / r.triangles as f64;
    let same_tool = |r: &&Row| r.name == row.name && r.threads == row.threads;
    let smallest = rows
        .iter()
        .filter(same_tool)
        .min_by_key(|r| r.triangles)
        .unwrap_or(row);
    let reference = peers::reference(Kind::Geometry, &row.name).name();
    let other = (rows.iter().filter(|_| row.ours))
        .find(|r| r.name == reference && r.triangles == row.triangles);
    let time = other.map(|o| Ratio::of(row.costs.wall.least, o.costs.wall.least));
    let memory = other.and_then(|o| {
        let [ours, theirs] = [row.costs.growth?, o.costs.growth?];
        Some(Ratio::of(ours as f64, theirs as f64))
    });
    let growth = row.costs.growth.map(|bytes| bytes as f64);
    let known = |x: Option<f64>| x.map_or_else(|| "?".into(), |x| format!("{x:.0}"));
    vec![
        row.name.clone(),
        row.threads.to_string(),
        count(row.triangles),
        count(row.left),
        format!("{:.3}", row.costs.wall.median),
        format!("{:.3}", row.costs.cpu.median),
        format!("{:.0}", nanoseconds(row)),
        format!("{:.2}", nanoseconds(row) / nanoseconds(smallest)),
        known(growth.map(|bytes| bytes / row.triangles as f64)),
        known(growth.map(|bytes| bytes / 1e6)),
        cell(time),
        cell(memory),
    ]
}
