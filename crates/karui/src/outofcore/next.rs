//! What is to be done next, told from what the store holds.

use super::block::{BUCKETS, Block, Head};
use super::cut::cut;
use super::keys::Keys;
use super::manifest::{Kind, Manifest, PORTION, Phase, RowResult, bounds, rows};
use super::share::share;
use super::task::read_bounds;
use super::tiles;
use super::{Error, Plan, Result, Store};

/// Levels at most. Each has its borders elsewhere; after three next to nothing of the first
/// is left.
const LEVELS: u32 = 3;

/// Where the work stands.
#[derive(Debug, Clone, PartialEq)]
pub enum Next {
    /// These tasks are to be run, in any order, and their results committed.
    Run(Manifest),
    /// The last phase is closed: its blocks are the result.
    Done(Manifest),
}

/// What is to be done next. Puts the manifest of a phase into the store when all before are
/// closed; asked twice, answers the same.
///
/// # Errors
/// [`Error::Manifest`], [`Error::Damaged`], those of the store; [`crate::Error::Empty`] for
/// a model without triangles.
pub fn next(store: &dyn Store, plan: &Plan) -> Result<Next> {
    let mut manifest = saved(store, bounds(plan))?;
    loop {
        // Results that are damaged are found again: blocks that are there are not made anew.
        let results = match manifest.results(store) {
            Err(error) if error.lost().is_some() => None,
            results => results?,
        };
        let Some(results) = results else {
            return Ok(Next::Run(manifest));
        };
        if manifest.phase.last {
            return Ok(Next::Done(manifest));
        }
        let name = following(plan, &manifest.phase);
        manifest = match Manifest::load(store, &name) {
            Err(Error::Missing { .. } | Error::Damaged { .. }) => {
                saved(store, after(store, plan, &manifest, &results)?)?
            }
            loaded => loaded?,
        };
    }
}

/// All manifests that there are, the earliest first.
///
/// # Errors
/// As [`next`].
pub fn manifests(store: &dyn Store) -> Result<Vec<Manifest>> {
    let names = store.list()?;
    let tasks = names.iter().filter(|name| name.ends_with(".tasks"));
    tasks.map(|name| Manifest::load(store, name)).collect()
}

fn saved(store: &dyn Store, manifest: Manifest) -> Result<Manifest> {
    match Manifest::load(store, &manifest.name()) {
        Ok(found) => Ok(found),
        Err(Error::Missing { .. } | Error::Damaged { .. }) => {
            manifest.save(store)?;
            Ok(manifest)
        }
        Err(error) => Err(error),
    }
}

/// Name of the manifest of the phase after this one.
fn following(plan: &Plan, phase: &Phase) -> String {
    let tiles = plan.options.tiles.filter(|_| after_reading(phase.kind));
    let kind = match phase.kind {
        kind if let Some(cut) = tiles => tiles::following(cut, kind),
        Kind::Bounds if plan.scattered => Kind::Scan,
        Kind::Scan => Kind::Fetch,
        Kind::Bounds | Kind::Fetch => Kind::Read,
        Kind::Read | Kind::Simplify => Kind::Borders,
        _ => Kind::Simplify,
    };
    let number = phase.number + 1;
    format!("{number:02}-{}.tasks", kind.name())
}

fn after_reading(kind: Kind) -> bool {
    !matches!(kind, Kind::Bounds | Kind::Scan | Kind::Fetch)
}

fn after(
    store: &dyn Store,
    plan: &Plan,
    manifest: &Manifest,
    results: &[RowResult],
) -> Result<Manifest> {
    if let Some(cut) = plan
        .options
        .tiles
        .filter(|_| after_reading(manifest.phase.kind))
    {
        return tiles::after(store, plan, cut, manifest, results);
    }
    match manifest.phase.kind {
        Kind::Bounds => {
            let keys = keys(store, plan, results)?;
            Ok(reading(plan, &manifest.phase, Some(keys), &[]))
        }
        Kind::Scan => Ok(fetching(plan, manifest, results)),
        Kind::Fetch => Ok(reading(plan, &manifest.phase, manifest.phase.next, results)),
        Kind::Read | Kind::Simplify => bordering(store, plan, manifest, results),
        _ => simplifying(store, manifest, results),
    }
}

/// Keys of the first level, from boxes around all vertices.
fn keys(store: &dyn Store, plan: &Plan, results: &[RowResult]) -> Result<Keys> {
    let mut corners = [[f32::MAX; 3], [f32::MIN; 3]];
    for result in results {
        let [min, max] = read_bounds(store, &result.output)?;
        for i in 0..3 {
            corners[0][i] = corners[0][i].min(min[i]);
            corners[1][i] = corners[1][i].max(max[i]);
        }
    }
    let keys = Keys::of(&plan.options, corners, 0);
    Ok(match plan.options.tiles {
        Some(_) => keys.padded(),
        None => keys,
    })
}

/// Portions of faces to be scanned, or read.
fn reading(plan: &Plan, before: &Phase, next: Option<Keys>, fetched: &[RowResult]) -> Manifest {
    let scans = plan.scattered && before.kind == Kind::Bounds;
    let phase = Phase {
        number: before.number + 1,
        kind: if scans { Kind::Scan } else { Kind::Read },
        range: plan.options.block_triangles,
        next,
        ..before.clone()
    };
    let portions = (plan.options.block_triangles / PORTION).max(1);
    let kind = if scans { ".ids" } else { ".block" };
    let mut manifest = rows(phase, plan.chunks, portions, kind);
    let inputs: Vec<_> = fetched.iter().map(|r| (r.output.clone(), 0, 0)).collect();
    for row in &mut manifest.rows {
        row.inputs.clone_from(&inputs);
    }
    manifest
}

/// Ranges of vertices to be read for all portions.
fn fetching(plan: &Plan, scanned: &Manifest, results: &[RowResult]) -> Manifest {
    let phase = Phase {
        number: scanned.phase.number + 1,
        kind: Kind::Fetch,
        ..scanned.phase.clone()
    };
    let mut manifest = rows(
        phase,
        plan.vertices,
        plan.options.block_triangles,
        ".vertices",
    );
    let inputs: Vec<_> = results.iter().map(|r| (r.output.clone(), 0, 0)).collect();
    for row in &mut manifest.rows {
        row.inputs.clone_from(&inputs);
    }
    manifest
}

fn bordering(
    store: &dyn Store,
    plan: &Plan,
    manifest: &Manifest,
    results: &[RowResult],
) -> Result<Manifest> {
    let heads = heads(store, results)?;
    let before = &manifest.phase;
    let level = match before.kind {
        Kind::Read => 0,
        _ => before.level + 1,
    };
    let triangles: u64 = heads.iter().map(|h| h.triangles).sum();
    if triangles == 0 {
        return Err(crate::Error::Empty { what: "model" }.into());
    }
    let whole = match before.kind {
        Kind::Read => triangles,
        _ => before.whole,
    };
    let options = &plan.options;
    let wanted = options.target(whole).min(triangles);
    let gone = 1.0 - wanted as f64 / triangles as f64;
    let cuts = cut(&heads, options.block_triangles, options.scheme, level, gone);
    let last = cuts.len() == 1 || level + 1 == LEVELS;
    let error = heads.iter().map(|h| h.error).fold(0.0, f64::max);
    let phase = Phase {
        number: before.number + 1,
        kind: Kind::Borders,
        level,
        triangles,
        whole,
        target: target(wanted, triangles, last),
        error: options.error.map(|bound| left(bound, error, last)),
        last: false,
        keys: before.next,
        range: 0,
        sample: before.sample,
        next: before.next.as_ref().map(|keys| keys.at_level(level + 1)),
        cuts,
        borders: Vec::new(),
        aligned: false,
    };
    let rims: u64 = heads
        .iter()
        .flat_map(|h| &h.buckets)
        .map(|b| u64::from(b.rims))
        .sum();
    let parts = rims
        .div_ceil(options.block_triangles)
        .clamp(1, BUCKETS as u64);
    let step = (BUCKETS as u64).div_ceil(parts);
    // One region shares nothing.
    let buckets = if phase.cuts.len() == 1 {
        0
    } else {
        BUCKETS as u64
    };
    let mut manifest = rows(phase, buckets, step, ".rims");
    let inputs: Vec<_> = results.iter().map(|r| (r.output.clone(), 0, 0)).collect();
    for row in &mut manifest.rows {
        row.inputs.clone_from(&inputs);
    }
    Ok(manifest)
}

/// Triangles to leave at this level: a quarter of the way, as ratios go, is left to the
/// levels after it, so that they have something to choose from where borders have been.
fn target(wanted: u64, triangles: u64, last: bool) -> u64 {
    if last || wanted == 0 {
        return wanted;
    }
    // Roots are the same on every machine; powers need not be.
    let excess = (triangles as f64 / wanted as f64).sqrt().sqrt();
    ((wanted as f64 * excess) as u64).clamp(wanted, triangles)
}

/// Share of the error that may still be made that a level takes.
const ERROR_SHARE: f64 = 0.6;

fn left(bound: f64, error: f64, last: bool) -> f64 {
    let left = (bound - error).max(0.0);
    if last { left } else { left * ERROR_SHARE }
}

fn simplifying(store: &dyn Store, manifest: &Manifest, results: &[RowResult]) -> Result<Manifest> {
    let before = &manifest.phase;
    let phase = Phase {
        number: before.number + 1,
        kind: Kind::Simplify,
        last: before.cuts.len() == 1 || before.level + 1 == LEVELS,
        borders: results.iter().map(|r| r.output.clone()).collect(),
        ..before.clone()
    };
    let blocks = blocks_before(store, before)?;
    let heads = heads(store, &blocks)?;
    let shares = share(&heads, &phase.cuts, phase.target);
    let mut manifest = rows(phase, shares.len() as u64, 1, ".block");
    let cuts = manifest.phase.cuts.clone();
    for (row, share) in manifest.rows.iter_mut().zip(shares) {
        (row.triangles, row.target) = (share.triangles, share.target);
        let region = row.first as usize;
        let range = [
            cuts[region],
            cuts.get(region + 1).copied().unwrap_or(u64::MAX),
        ];
        for (block, head) in blocks.iter().zip(&heads) {
            if let Some((first, end)) = pages(head, range) {
                row.inputs.push((block.output.clone(), first, end));
            }
        }
    }
    Ok(manifest)
}

/// What the last phase that made blocks has made.
fn blocks_before(store: &dyn Store, borders: &Phase) -> Result<Vec<RowResult>> {
    let kind = match borders.level {
        0 => Kind::Read,
        _ => Kind::Simplify,
    };
    let name = format!("{:02}-{}.tasks", borders.number - 1, kind.name());
    let manifest = Manifest::load(store, &name)?;
    let results = manifest.results(store)?;
    results.ok_or_else(|| Error::Missing {
        name: manifest.done_name(),
    })
}

/// First page and one past the last that have keys of a range.
pub(super) fn pages(head: &Head, [first, end]: [u64; 2]) -> Option<(u32, u32)> {
    let start = head.pages.partition_point(|p| p.last < first);
    let stop = head.pages.partition_point(|p| p.first < end);
    (start < stop).then_some((start as u32, stop as u32))
}

pub(super) fn heads(store: &dyn Store, results: &[RowResult]) -> Result<Vec<Head>> {
    let head = |r: &RowResult| Ok(Block::open(store, &r.output)?.head);
    results.iter().map(head).collect()
}
