//! Every mode of ours against every other tool, over all models.

use super::super::peers::are_alike;
use super::super::rounds::Row;
use super::models::{ERRORS, error_ratio, memory_ratio, same_task, time_ratio};
use super::ratio::{Ratio, geometric_mean, marked};
use crate::table::table as plain_table;

/// Geometric means of the ratios, and how many models were not won; `None`
/// without anybody to compare with.
pub fn table(rows: &[Row]) -> Option<String> {
    let mut tasks: Vec<(&str, usize, f64, &str)> = Vec::new();
    for ours in rows.iter().filter(|r| r.ours) {
        let others = rows.iter().filter(|r| !r.ours && same_task(r, ours));
        for other in others.filter(|r| are_alike(&ours.name, &r.name)) {
            let task = (&*ours.name, ours.threads, ours.target, &*other.name);
            if !tasks.contains(&task) {
                tasks.push(task);
            }
        }
    }
    if tasks.is_empty() {
        return None;
    }
    let header = [
        "mode",
        "threads",
        "target",
        "against",
        "models",
        "÷ time",
        "÷ CPU",
        "÷ mean",
        "÷ RMS",
        "÷ max",
        "÷ normal",
        "÷ UV",
        "÷ MB",
    ];
    let mut lines: Vec<Vec<String>> = tasks.iter().map(|t| line(rows, *t)).collect();
    let mut header = header.to_vec();
    for column in (0..header.len()).rev() {
        if lines.iter().all(|l| l[column].is_empty()) {
            header.remove(column);
            lines.iter_mut().for_each(|l| drop(l.remove(column)));
        }
    }
    let note =
        "Geometric means over the models; in brackets on how many of them ours does not win.\n";
    Some(format!("{note}\n{}", plain_table(&header, &lines, true)))
}

fn line(rows: &[Row], (name, threads, target, against): (&str, usize, f64, &str)) -> Vec<String> {
    let of_task = |r: &&Row| r.name == name && r.threads == threads && r.target == target;
    let pairs: Vec<(&Row, &Row)> = (rows.iter().filter(of_task))
        .filter_map(|ours| {
            let other = rows
                .iter()
                .find(|r| r.name == against && same_task(r, ours))?;
            Some((ours, other))
        })
        .collect();
    let of_cpu = |ours: &Row, other: &Row| Ratio::of(ours.costs.cpu.least, other.costs.cpu.least);
    let collect = |ratio: &dyn Fn(&Row, &Row) -> Option<Ratio>| -> Vec<Ratio> {
        pairs
            .iter()
            .filter_map(|(ours, other)| ratio(ours, other))
            .collect()
    };
    let mut columns = vec![
        collect(&|ours, other| Some(time_ratio(ours, other))),
        collect(&|ours, other| Some(of_cpu(ours, other))),
    ];
    columns.extend(ERRORS.map(|pick| collect(&|ours, other| error_ratio(ours, other, pick))));
    columns.push(collect(&memory_ratio));
    let mut cells = vec![
        name.to_owned(),
        threads.to_string(),
        format!("{} %", target * 100.0),
        against.to_owned(),
        pairs.len().to_string(),
    ];
    cells.extend(columns.iter().map(|ratios| summed_up(ratios)));
    cells
}

fn summed_up(ratios: &[Ratio]) -> String {
    if ratios.is_empty() {
        return String::new();
    }
    let (mean, lost) = (
        geometric_mean(ratios),
        ratios.iter().filter(|r| !r.won).count(),
    );
    marked(format!("{mean:.2} ({lost})"), lost > 0)
}
