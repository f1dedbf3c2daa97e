//! Every tool on every model to every target.

use super::super::inputs::Kind;
use super::super::peers;
use super::super::rounds::Row;
use super::ratio::{Ratio, cell, marked};
use crate::table::{count, table as plain_table};

/// A line: the rows of one tool that differ in the number of threads only.
type Line<'a> = Vec<&'a Row>;

/// The table of all rows.
pub fn table(kind: Kind, rows: &[Row]) -> Option<String> {
    let threads = thread_counts(rows);
    let compared = rows.iter().any(|r| !r.ours);
    let lines = lines(rows);
    let cells: Vec<Vec<String>> = lines
        .iter()
        .map(|line| {
            let reference = peers::reference(kind, &line[0].name).name();
            let other = lines
                .iter()
                .find(|l| l[0].name == reference && same_task(l[0], line[0]));
            let other = other.map(|l| l[0]).filter(|_| line[0].ours);
            let mut cells = figures(kind, line, &threads);
            if compared {
                cells.extend(ratios(kind, line, other, &threads));
            }
            cells
        })
        .collect();
    let header = header(kind, &threads, compared);
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    Some(plain_table(&header, &cells, true)).filter(|_| !rows.is_empty())
}

/// Whether two rows are of the same model and target.
pub fn same_task(a: &Row, b: &Row) -> bool {
    a.model == b.model && a.target == b.target
}

/// The numbers of threads of any row, in order.
fn thread_counts(rows: &[Row]) -> Vec<usize> {
    let mut counts: Vec<usize> = rows.iter().map(|r| r.threads).collect();
    counts.sort_unstable();
    counts.dedup();
    counts
}

fn lines(rows: &[Row]) -> Vec<Line<'_>> {
    let same_line = |a: &Row, b: &Row| same_task(a, b) && a.name == b.name;
    rows.chunk_by(same_line)
        .map(|c| c.iter().collect())
        .collect()
}

fn header(kind: Kind, threads: &[usize], compared: bool) -> Vec<String> {
    let of_threads = |what: &str, n: &usize| match n {
        1 => format!("{what}, 1 thread"),
        n => format!("{what}, {n} threads"),
    };
    let mut header = ["model", "triangles", "target", "tool", "left"]
        .map(String::from)
        .to_vec();
    header.extend(threads.iter().map(|n| of_threads("ms", n)));
    header.extend(["CPU ms", "ns/triangle", "mean", "RMS", "max"].map(String::from));
    header.extend(own_columns(kind).map(String::from));
    header.push("MB".into());
    if compared {
        header.extend(threads.iter().map(|n| of_threads("÷ ms", n)));
        header.extend(["÷ mean", "÷ RMS", "÷ max"].map(String::from));
        header.extend(own_ratios(kind).iter().map(ToString::to_string));
        header.push("÷ MB".into());
    }
    header
}

fn own_columns(kind: Kind) -> [&'static str; 3] {
    match kind {
        Kind::Geometry => ["flips", "non-m.", "border"],
        Kind::Attributes => ["normal", "UV", "flips"],
    }
}

fn own_ratios(kind: Kind) -> &'static [&'static str] {
    match kind {
        Kind::Geometry => &[],
        Kind::Attributes => &["÷ normal", "÷ UV"],
    }
}

fn figures(kind: Kind, line: &Line<'_>, threads: &[usize]) -> Vec<String> {
    let row = line[0];
    let (errors, costs) = (&row.errors, &row.costs);
    let too_many = row.ours && too_many(row);
    let mut cells = vec![
        format!("`{}`", row.model),
        count(row.triangles),
        format!("{} %", row.target * 100.0),
        row.name.clone(),
        marked(count(errors.triangles), too_many),
    ];
    for &n in threads {
        let with = line.iter().find(|r| r.threads == n);
        cells.push(with.map_or_else(String::new, |r| digits(r.costs.wall.median * 1e3)));
    }
    let nanoseconds = costs.wall.least * 1e9 / row.triangles as f64;
    cells.extend([digits(costs.cpu.median * 1e3), format!("{nanoseconds:.0}")]);
    cells.extend([errors.mean, errors.rms, errors.max].map(|e| digits(e * 1e4)));
    let bad = |n: usize| marked(count(n), row.ours && n > 0);
    match kind {
        Kind::Geometry => {
            let drifted = row.ours && errors.border.is_some_and(|b| b > errors.max);
            let border = errors
                .border
                .map_or_else(|| "-".into(), |b| digits(b * 1e4));
            let counts = [errors.new_flips, errors.new_non_manifold].map(bad);
            cells.extend(counts);
            cells.push(marked(border, drifted));
        }
        Kind::Attributes => {
            let scaled = [(errors.attributes.normal, 1.0), (errors.attributes.uv, 1e4)];
            let off = scaled.map(|(e, unit)| e.map_or_else(|| "-".into(), |e| digits(e * unit)));
            cells.extend(off);
            cells.push(bad(errors.new_flips));
        }
    }
    let mb = costs.growth.map(|bytes| digits(bytes as f64 / 1e6));
    cells.push(mb.unwrap_or_else(|| "?".into()));
    cells
}

/// Whether the target was missed by more than 1 %.
fn too_many(row: &Row) -> bool {
    let wanted = row.target * row.triangles as f64;
    row.errors.triangles as f64 > wanted * 1.01 + 1.0
}

/// Ours against `other`; empty cells if there is none.
fn ratios(kind: Kind, line: &Line<'_>, other: Option<&Row>, threads: &[usize]) -> Vec<String> {
    let with = |n: &usize| line.iter().find(|r| r.threads == *n).copied();
    let of_time = |n| Some(time_ratio(with(n)?, other?));
    let mut ratios: Vec<Option<Ratio>> = threads.iter().map(of_time).collect();
    let of_error = |pick: Pick| other.and_then(|other| error_ratio(line[0], other, pick));
    let picks: &[Pick] = match kind {
        Kind::Geometry => &ERRORS[..3],
        Kind::Attributes => &ERRORS,
    };
    ratios.extend(picks.iter().map(|&pick| of_error(pick)));
    ratios.push(other.and_then(|other| memory_ratio(line[0], other)));
    ratios.into_iter().map(cell).collect()
}

/// One of the errors of a row.
pub type Pick = fn(&Row) -> Option<f64>;

/// Mean, RMS, largest distance, normals, texture coordinates.
pub const ERRORS: [Pick; 5] = [
    |r| Some(r.errors.mean),
    |r| Some(r.errors.rms),
    |r| Some(r.errors.max),
    |r| r.errors.attributes.normal,
    |r| r.errors.attributes.uv,
];

/// Least time on the wall, ours by the other's.
pub fn time_ratio(ours: &Row, other: &Row) -> Ratio {
    Ratio::of(ours.costs.wall.least, other.costs.wall.least)
}

/// An error, ours by the other's; it is not won with more triangles than both
/// the other and the target have.
pub fn error_ratio(ours: &Row, other: &Row, pick: Pick) -> Option<Ratio> {
    let fair = !too_many(ours) || ours.errors.triangles <= other.errors.triangles;
    Some(Ratio::of(pick(ours)?, pick(other)?).only_if(fair))
}

/// Memory, ours by the other's.
pub fn memory_ratio(ours: &Row, other: &Row) -> Option<Ratio> {
    let [ours, other] = [ours.costs.growth?, other.costs.growth?];
    Some(Ratio::of(ours as f64, other as f64))
}

/// Three significant digits.
fn digits(x: f64) -> String {
    if !x.is_finite() {
        return "lost".into();
    }
    let decimals = match x.abs() {
        100.0.. => 0,
        10.0.. => 1,
        1.0.. => 2,
        _ => 3,
    };
    format!("{x:.decimals$}")
}
