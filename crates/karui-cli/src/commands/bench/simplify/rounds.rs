//! All contestants on one model, in turn, round by round.

use super::super::clock::{Cost, Costs, Watch};
use super::contestants::Contestant;
use super::errors::{Errors, Reference};
use super::inputs::{Kind, Model};
use super::{Args, solo};
use crate::console::Console;
use crate::progress::check_cancelled;
use anyhow::Result;
use karui::TriMesh;
use serde::Serialize;

/// The figures of one contestant on one model to one target.
#[derive(Debug, Clone, Serialize)]
pub struct Row {
    pub model: String,
    pub triangles: usize,
    /// Share of the triangles asked for.
    pub target: f64,
    pub name: String,
    pub ours: bool,
    pub threads: usize,
    pub costs: Costs,
    pub errors: Errors,
}

/// Everything that is compared on one model.
pub fn rows(
    args: &Args,
    console: &Console,
    model: &Model,
    kind: Kind,
    contestants: &[Contestant],
) -> Result<Vec<Row>> {
    let mesh = model.mesh(kind)?;
    let reference = Reference::new(mesh)?;
    let mut rows: Vec<Row> = Vec::new();
    for &target in &args.targets {
        let wanted = (target * mesh.triangles.len() as f64).round() as usize;
        let entries = race(contestants, mesh, wanted, args.runs, Watch::Time)?;
        let mut last: Option<(&str, &TriMesh, Errors)> = None;
        for (contestant, (result, costs)) in contestants.iter().zip(&entries) {
            let errors = match last {
                Some((name, same, errors)) if name == contestant.name && same == result => errors,
                _ => reference.measure(result, args.samples)?,
            };
            if last.is_some_and(|(name, same, _)| name == contestant.name && same != result) {
                let what = format!("{} {}", model.name, contestant.name);
                console.warn(&format!(
                    "{what}: the result depends on the number of threads"
                ));
            }
            last = Some((&contestant.name, result, errors));
            rows.push(Row {
                model: model.name.clone(),
                triangles: mesh.triangles.len(),
                target,
                name: contestant.name.clone(),
                ours: contestant.is_ours(),
                threads: contestant.threads,
                costs: Costs {
                    growth: solo::growth(args, &model.source, kind, contestant, target)?,
                    ..*costs
                },
                errors,
            });
        }
    }
    Ok(rows)
}

/// Who has run for longer does not run again, seconds.
const ENOUGH: f64 = 10.0;

/// Runs all contestants in turn, `runs` times, so that whatever else happens
/// on the machine happens to all of them: the first result and the costs of
/// each.
pub fn race(
    contestants: &[Contestant],
    mesh: &TriMesh,
    wanted: usize,
    runs: usize,
    watch: Watch,
) -> Result<Vec<(TriMesh, Costs)>> {
    let mut results: Vec<TriMesh> = Vec::new();
    let mut costs: Vec<Vec<Cost>> = vec![Vec::new(); contestants.len()];
    for round in 0..runs.max(1) {
        for (contestant, costs) in contestants.iter().zip(&mut costs) {
            check_cancelled()?;
            if costs.iter().map(|c| c.wall).sum::<f64>() > ENOUGH {
                continue;
            }
            let (result, cost) = contestant.run(mesh, wanted, watch)?;
            costs.push(cost);
            if round == 0 {
                results.push(result);
            }
        }
    }
    let costs = costs.iter().map(|c| Costs::of(c));
    Ok(results.into_iter().zip(costs).collect())
}
