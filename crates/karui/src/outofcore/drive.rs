//! Runs all tasks in this process.

use super::manifest::{Manifest, Phase, RowResult};
use super::next::{Next, manifests, next};
use super::task::{run_task, verify_task};
use super::{Error, Plan, Result, Source, Store};
use crate::progress::{Progress, Silent, step};
use std::{
    fmt,
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
    thread,
};

/// Options of [`run`].
#[derive(Clone, Copy)]
pub struct RunOptions<'a> {
    /// Tasks at the same time, at least 1; what comes out does not depend on it. Default: 1.
    pub workers: usize,
    /// Told about the whole work, and asked whether to go on.
    pub progress: &'a dyn Progress,
}

impl Default for RunOptions<'_> {
    fn default() -> Self {
        Self {
            workers: 1,
            progress: &Silent,
        }
    }
}

impl fmt::Debug for RunOptions<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RunOptions")
            .field("workers", &self.workers)
            .finish_non_exhaustive()
    }
}

/// Does all that is still to be done, and returns the last manifest, whose blocks are the
/// result. Tasks whose output is there and whole are not run again; damaged blocks are made
/// anew.
///
/// # Errors
/// As [`next`] and [`run_task`]; [`crate::Error::Cancelled`]. All finished blocks stay: called
/// again, it goes on from there.
pub fn run(
    store: &dyn Store,
    source: &dyn Source,
    plan: &Plan,
    options: &RunOptions<'_>,
) -> Result<Manifest> {
    let mut made = None;
    loop {
        match mended(store, source, || next(store, plan))? {
            Next::Run(manifest) => {
                let slot = Slot::of(plan, &manifest.phase);
                let results = rows(store, source, &manifest, slot, options)?;
                manifest.commit(store, results)?;
                made = Some(manifest.name());
            }
            Next::Done(manifest) => {
                // What was made before may have been damaged since.
                if made.as_ref() != Some(&manifest.name()) {
                    let slot = Slot::of(plan, &manifest.phase);
                    rows(store, source, &manifest, slot, options)?;
                }
                return Ok(manifest);
            }
        }
    }
}

/// Runs the rows of one phase that have not been run.
fn rows(
    store: &dyn Store,
    source: &dyn Source,
    manifest: &Manifest,
    slot: Slot,
    options: &RunOptions<'_>,
) -> Result<Vec<RowResult>> {
    let workers = options.workers.clamp(1, manifest.rows.len().max(1));
    let (taken, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let stopped = AtomicBool::new(false);
    let progress = options.progress;
    let report = |done: usize| {
        let share = done as f32 / manifest.rows.len().max(1) as f32;
        step(progress, manifest.phase.kind.name(), slot.at(share))
    };
    report(0)?;
    let outcomes: Mutex<Vec<Result<RowResult>>> = Mutex::default();
    let mutex = Mutex::new(());
    let work = || {
        while !stopped.load(Ordering::Relaxed) {
            let row = taken.fetch_add(1, Ordering::Relaxed);
            if row >= manifest.rows.len() {
                break;
            }
            let outcome = row_done(store, source, manifest, row as u64, progress);
            let failed = outcome.is_err();
            locked(&outcomes).push(outcome);
            // One at a time, so that what is reported grows.
            let _turn = locked(&mutex);
            let count = done.fetch_add(1, Ordering::Relaxed) + 1;
            if failed || report(count).is_err() {
                stopped.store(true, Ordering::Relaxed);
            }
        }
    };
    thread::scope(|scope| {
        (0..workers).for_each(|_| drop(scope.spawn(work)));
    });
    report(manifest.rows.len())?;
    outcomes
        .into_inner()
        .unwrap_or_else(PoisonError::into_inner)
        .into_iter()
        .collect()
}

/// Where in the whole work a phase lies, as shares of it.
#[derive(Clone, Copy)]
struct Slot {
    start: f32,
    end: f32,
}

impl Slot {
    /// Guessed from the plan alone, so that what is reported only grows.
    fn of(plan: &Plan, phase: &Phase) -> Self {
        let ends = ends(plan);
        let number = (phase.number as usize).min(ends.len() - 2);
        Self {
            start: ends[number],
            end: ends[number + 1],
        }
    }

    fn at(self, share: f32) -> f32 {
        self.start + share * (self.end - self.start)
    }
}

/// Shares of the work that are done before each phase, and in the end.
fn ends(plan: &Plan) -> Vec<f32> {
    let triangles = plan.chunks as f64 * 65_536.0;
    if plan.options.tiles.is_some() {
        return shares(&tile_costs(triangles));
    }
    // What each phase costs a triangle, seconds a million, and how many there are.
    let left = |level: usize| plan.triangles_before(triangles, level as u32);
    let mut costs = vec![0.02 * triangles, 0.4 * triangles];
    for level in 0..3 {
        costs.extend([0.03 * left(level), left(level)]);
    }
    costs.push(0.3 * left(3));
    shares(&costs)
}

/// What phases that make tiles cost, about; those after the last count for nothing.
fn tile_costs(triangles: f64) -> Vec<f64> {
    let mut costs = vec![0.02 * triangles, 0.4 * triangles, 0.4 * triangles];
    let mut left = triangles;
    for _ in 0..TILE_LEVELS {
        costs.extend([0.03 * left, 2.0 * left]);
        left /= 3.0;
    }
    costs
}

/// Levels of tiles that are told apart in what is reported.
const TILE_LEVELS: usize = 12;

fn shares(costs: &[f64]) -> Vec<f32> {
    let all: f64 = costs.iter().sum();
    let mut sum = 0.0;
    let mut ends = vec![0.0];
    for cost in costs {
        sum += cost;
        ends.push((sum / all.max(1.0)) as f32);
    }
    ends
}

/// Share of the work that is done once all but the writing is.
pub(super) fn before_writing(plan: &Plan) -> f32 {
    let ends = ends(plan);
    ends[ends.len() - 2]
}

fn locked<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn row_done(
    store: &dyn Store,
    source: &dyn Source,
    manifest: &Manifest,
    row: u64,
    progress: &dyn Progress,
) -> Result<RowResult> {
    match verify_task(store, manifest, row) {
        Err(error) if error.lost().is_some() => {}
        outcome => return outcome,
    }
    mended(store, source, || {
        run_task(store, source, manifest, row, progress)
    })
}

/// Times that lost blocks are made anew before it is given up.
const TRIES: usize = 100;

/// Does something; as long as that fails for a lost or damaged block, makes that anew.
///
/// # Errors
/// What is no matter of blocks, or does not go away.
pub(super) fn mended<T>(
    store: &dyn Store,
    source: &dyn Source,
    what: impl Fn() -> Result<T>,
) -> Result<T> {
    let mut outcome = what();
    for _ in 0..TRIES {
        let lost = match &outcome {
            Err(error) => error.lost().map(str::to_owned),
            Ok(_) => None,
        };
        let Some(name) = lost else { break };
        if !rebuild(store, source, &name)? {
            break;
        }
        outcome = what();
    }
    outcome
}

/// Makes an output anew, and what that needs; whether it is one of a known manifest.
///
/// # Errors
/// As [`run_task`].
pub fn rebuild(store: &dyn Store, source: &dyn Source, name: &str) -> Result<bool> {
    for manifest in manifests(store)? {
        let maker = manifest.rows.iter().find(|row| row.output == name);
        if let Some(row) = maker {
            let make = || run_task(store, source, &manifest, row.id, &Silent);
            // Inputs come from phases before, so that this ends.
            let make: &dyn Fn() -> Result<RowResult> = &make;
            return mended(store, source, make).map(|_| true);
        }
    }
    Ok(false)
}

/// Checks all outputs of closed phases, and of the open one those that are there. Returns
/// the names of those that are missing, damaged or not what they were.
///
/// # Errors
/// As [`next`]; what is no matter of blocks.
pub fn verify(store: &dyn Store) -> Result<Vec<String>> {
    let mut lost = Vec::new();
    for manifest in manifests(store)? {
        let results = match manifest.results(store) {
            Err(error) if error.lost().is_some() => {
                lost.push(manifest.done_name());
                None
            }
            results => results?,
        };
        for row in &manifest.rows {
            let outcome = verify_task(store, &manifest, row.id);
            let expected = results.as_ref().map(|r| &r[row.id as usize]);
            match (outcome, expected) {
                (Ok(found), Some(expected)) if found != *expected => lost.push(row.output.clone()),
                (Err(Error::Missing { .. }), None) | (Ok(_), _) => {}
                (Err(error), _) if error.lost().is_some() => lost.push(row.output.clone()),
                (Err(error), _) => return Err(error),
            }
        }
    }
    Ok(lost)
}
