//! How time, memory and draw lists grow with the number of objects.

use super::solo::{Kind, Row, ask};
use crate::commands::bench::page::machine;
use crate::console::{Console, to_stderr};
use crate::progress::check_cancelled;
use crate::table::{bytes, count, percent, table};
use anyhow::Result;
use serde_json::Value;

/// Measures forests and cities of all sizes; as Markdown and rows.
pub fn run(counts: &[u32], frames: u32, console: &Console) -> Result<(String, Value)> {
    let mut rows = Vec::new();
    for kind in [Kind::Forest, Kind::City] {
        for &size in counts {
            check_cancelled()?;
            if !console.quiet {
                to_stderr(&format!("{} of {}", kind.name(), count(size as usize)));
            }
            rows.push(ask(kind, size, frames)?);
        }
    }
    Ok((markdown(&rows, frames), serde_json::to_value(&rows)?))
}

fn markdown(rows: &[Row], frames: u32) -> String {
    format!(
        "## Scenes of very many objects\n\n\
         Written by `karui bench hlod --counts N,... -o FILE` (release build): made-up forests (a\n\
         fifth of the trees red) and cities, each object an instance; default options.\n\n\
         - s, CPU s: to build the tree of groups. ns by n log2 n: the former by n log2 n.\n\
         - tree: most memory that building took beyond the scene's; in all: of the process.\n\n\
         {}\n\n{}\n\n\
         A flight of {frames} frames from end to end, just above the objects, {FLIGHT}\n\n{}\n",
        machine(),
        builds(rows),
        lists(rows)
    )
}

const FLIGHT: &str = "looking ahead; a box of\n\
    12 triangles stands for each group. At Omega_t = 0 there are no groups, only objects at the\n\
    level for their distance. ms: to make the draw list of a frame, on the clock on the wall, where the\n\
    machine's other work counts as well, and of the processor alone; items and triangles: means over\n\
    the frames.";

fn builds(rows: &[Row]) -> String {
    let header = [
        "scene",
        "objects",
        "groups",
        "s",
        "CPU s",
        "ns by n log2 n",
        "tree",
        "in all",
    ];
    let memory = |found: Option<u64>| found.map_or("-".to_owned(), bytes);
    let row = |row: &Row| {
        let n = row.objects as f64;
        vec![
            row.kind.name().to_owned(),
            count(row.objects),
            count(row.groups),
            format!("{:.3}", row.seconds),
            format!("{:.3}", row.cpu_seconds),
            format!("{:.0}", 1e9 * row.seconds / (n * n.log2().max(1.0))),
            memory(row.growth),
            memory(row.peak),
        ]
    };
    let cells: Vec<Vec<String>> = rows.iter().map(row).collect();
    table(&header, &cells, true)
}

fn lists(rows: &[Row]) -> String {
    let header = [
        "scene",
        "objects",
        "Omega_t",
        "ms, median",
        "ms, 95 %",
        "ms, worst",
        "CPU ms, worst",
        "items",
        "triangles",
        "of those without groups",
    ];
    let mut cells = Vec::new();
    for row in rows {
        let without = row.lists.first().map_or(f64::NAN, |l| l.triangles);
        for list in &row.lists {
            let mut line = vec![
                row.kind.name().to_owned(),
                count(row.objects),
                list.threshold.to_string(),
            ];
            line.extend(list.milliseconds.map(|ms| format!("{ms:.3}")));
            line.push(format!("{:.3}", list.most_cpu_milliseconds));
            line.extend([list.items, list.triangles].map(|n| count(n.round() as usize)));
            line.push(percent(list.triangles / without.max(1.0)));
            cells.push(line);
        }
    }
    table(&header, &cells, true)
}
