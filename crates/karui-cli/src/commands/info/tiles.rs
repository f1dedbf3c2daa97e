//! `karui info tileset.json`: what a tileset holds and which rules it breaks.

use crate::table::{bytes, count, number, table};
use karui_io::Format;
use karui_io::tiles::{Finding, Findings, Report};
use std::path::Path;

/// Levels that are shown one by one.
const LEVELS: usize = 40;

/// Whether a file is to be read as a tileset: JSON by its name, unless what it
/// holds is a glTF.
pub fn is_tileset(path: &Path) -> bool {
    let json = path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("json"));
    json && Format::detect(path, &unless_tileset(path)).is_err()
}

/// The text of a file, unless it says `geometricError`, as every tileset does
/// and no glTF.
fn unless_tileset(path: &Path) -> Vec<u8> {
    let text = std::fs::read(path).unwrap_or_default();
    let tileset = text.windows(16).any(|w| w == b"\"geometricError\"");
    if tileset { Vec::new() } else { text }
}

/// The report as text.
pub fn text(report: &Report) -> String {
    let counts = &report.counts;
    let versions = report.versions.join(", ");
    let mut lines = vec![format!(
        "{}: 3D Tiles {versions}, {}",
        report.file.display(),
        bytes(counts.bytes)
    )];
    let [tiles, contents, files] = [counts.tiles, counts.contents, counts.files].map(whole);
    let [triangles, sets, trees] = [counts.triangles, counts.tilesets, counts.subtrees].map(whole);
    lines.push(format!(
        "{tiles} tiles in {} levels, {contents} contents in {files} files, {triangles} triangles",
        counts.depth
    ));
    lines.push(format!("{sets} tilesets, {trees} subtrees"));
    for (names, what) in [
        (&report.extensions_used, "used"),
        (&report.extensions_required, "required"),
    ] {
        if !names.is_empty() {
            lines.push(format!("extensions {what}: {}", names.join(", ")));
        }
    }
    lines.push(levels(report));
    lines.extend(findings(&report.findings));
    lines.join("\n")
}

fn whole(n: u64) -> String {
    count(usize::try_from(n).unwrap_or(usize::MAX))
}

fn levels(report: &Report) -> String {
    let row = |(i, level): (usize, &karui_io::tiles::Level)| {
        vec![
            i.to_string(),
            whole(level.tiles),
            whole(level.contents),
            number(level.min_error),
            number(level.max_error),
        ]
    };
    let shown = report.levels.iter().enumerate().take(LEVELS);
    let rows: Vec<_> = shown.map(row).collect();
    let header = [
        "level",
        "tiles",
        "contents",
        "least error",
        "greatest error",
    ];
    let mut text = table(&header, &rows, false);
    if report.levels.len() > LEVELS {
        text += &format!("\nand {} more levels", report.levels.len() - LEVELS);
    }
    text
}

fn findings(findings: &Findings) -> Vec<String> {
    let kinds = [
        ("error", &findings.errors, findings.further_errors),
        ("warning", &findings.warnings, findings.further_warnings),
    ];
    let mut lines = Vec::new();
    for (kind, list, further) in kinds {
        lines.extend(list.iter().map(|f: &Finding| format!("{kind}: {f}")));
        if further > 0 {
            lines.push(format!("{kind}: {} more", whole(further)));
        }
    }
    lines
}
