//! Manifests of the phases that make tiles.

use super::super::block::{BUCKETS, Block, Head};
use super::super::manifest::{Kind, Manifest, Phase, Row, RowResult, rows};
use super::super::next::{heads, pages};
use super::super::{Plan, Result, Store};
use super::TileCut;
use super::cell::{Cell, DEEPEST};
use super::divide::{Stop, divide};
use super::tree::{kept, made};
use std::collections::BTreeMap;

/// What the phase after this one does.
pub(in super::super) fn following(cut: TileCut, kind: Kind) -> Kind {
    match kind {
        Kind::Read if cut.aligned => Kind::Pieces,
        Kind::Read | Kind::Pieces => Kind::Leaves,
        Kind::Edges => Kind::Parents,
        _ => Kind::Edges,
    }
}

/// The phase after this one.
///
/// # Errors
/// [`crate::Error::Empty`] for a model without triangles; those of the store.
pub(in super::super) fn after(
    store: &dyn Store,
    plan: &Plan,
    cut: TileCut,
    manifest: &Manifest,
    results: &[RowResult],
) -> Result<Manifest> {
    let kind = following(cut, manifest.phase.kind);
    let phase = Phase {
        number: manifest.phase.number + 1,
        kind,
        aligned: cut.aligned,
        keys: manifest.phase.next,
        ..manifest.phase.clone()
    };
    match kind {
        Kind::Pieces => cutting(store, cut, phase, results),
        Kind::Leaves => leaves(store, cut, phase, results),
        Kind::Parents => parents(store, cut, phase, results),
        _ => edges(store, plan, phase),
    }
}

/// Triangles of a model, of which there must be some.
fn triangles(heads: &[Head]) -> Result<u64> {
    match heads.iter().map(|h| h.triangles).sum() {
        0 => Err(crate::Error::Empty { what: "model" }.into()),
        triangles => Ok(triangles),
    }
}

/// Levels that a cell of average size is halved more at most, where all are of one size.
const UNEVEN: u32 = 3;

/// Blocks to be cut at the faces of the smallest cells. The depth of these is that of the
/// fullest, but for a model of which most is in one place.
fn cutting(store: &dyn Store, cut: TileCut, phase: Phase, read: &[RowResult]) -> Result<Manifest> {
    let heads = heads(store, read)?;
    let tiles = triangles(&heads)?.div_ceil(cut.triangles);
    let most = tiles.ilog2().div_ceil(2) + UNEVEN;
    let leaves = divide(&heads, Stop::Triangles(cut.triangles));
    let depth = leaves.iter().map(|leaf| leaf.0.depth).max().unwrap_or(0);
    let level = depth.min(most).min(DEEPEST);
    let mut manifest = rows(Phase { level, ..phase }, read.len() as u64, 1, ".block");
    for ((row, block), head) in manifest.rows.iter_mut().zip(read).zip(&heads) {
        let pages = head.pages.len() as u32;
        row.inputs.push((block.output.clone(), 0, pages));
        row.triangles = head.triangles;
    }
    Ok(manifest)
}

fn leaves(store: &dyn Store, cut: TileCut, phase: Phase, blocks: &[RowResult]) -> Result<Manifest> {
    let heads = heads(store, blocks)?;
    let whole = triangles(&heads)?;
    let stop = match cut.aligned {
        true => Stop::Depth(phase.level),
        false => Stop::Triangles(cut.triangles),
    };
    let leaves = divide(&heads, stop);
    let level = leaves.iter().map(|leaf| leaf.0.depth).max().unwrap_or(0);
    let phase = Phase {
        level,
        whole,
        triangles: whole,
        target: whole,
        last: level == 0,
        ..phase
    };
    let mut manifest = rows(phase, leaves.len() as u64, 1, ".block");
    for (row, (cell, triangles)) in manifest.rows.iter_mut().zip(leaves) {
        (row.first, row.end, row.triangles) = (cell.first, cell.end(), triangles);
        for (block, head) in blocks.iter().zip(&heads) {
            if let Some((first, end)) = pages(head, [cell.first, cell.end()]) {
                row.inputs.push((block.output.clone(), first, end));
            }
        }
    }
    Ok(manifest)
}

/// A cell of a level: its own blocks are those of its children.
type Level = BTreeMap<Cell, Vec<String>>;

/// The cells of a depth that have children, and larger leaves, as the phase numbered
/// `number` finds them.
fn level(store: &dyn Store, depth: u32, number: u32) -> Result<(Level, Vec<String>)> {
    let mut cells = Level::new();
    let mut alone = Vec::new();
    let mut before = kept(store)?;
    before.retain(|manifest| manifest.phase.number < number);
    for (cell, block) in made(store, &before)? {
        if cell.depth == depth + 1 {
            cells.entry(cell.parent()).or_default().push(block);
        } else if cell.depth <= depth {
            alone.push(block);
        }
    }
    Ok((cells, alone))
}

/// Places shared by cells one level up from the last that was made.
fn edges(store: &dyn Store, plan: &Plan, phase: Phase) -> Result<Manifest> {
    let depth = phase.level.saturating_sub(1);
    let (cells, alone) = level(store, depth, phase.number)?;
    let mut inputs = Vec::new();
    for (number, blocks) in (0..).zip(cells.values()) {
        inputs.extend(blocks.iter().map(|block| (block.clone(), number, 0)));
    }
    let after = cells.len() as u32..;
    inputs.extend(after.zip(alone).map(|(number, block)| (block, number, 0)));
    let mut rims = 0;
    for (block, ..) in &inputs {
        let head = Block::open(store, block)?.head;
        rims += head.buckets.iter().map(|b| u64::from(b.rims)).sum::<u64>();
    }
    let parts = rims.div_ceil(plan.options.block_triangles);
    let step = (BUCKETS as u64).div_ceil(parts.clamp(1, BUCKETS as u64));
    let phase = Phase {
        level: depth,
        cuts: cells.keys().map(|cell| cell.first).collect(),
        borders: Vec::new(),
        ..phase
    };
    // The whole shares nothing.
    let buckets = if depth == 0 { 0 } else { BUCKETS as u64 };
    let mut manifest = rows(phase, buckets, step, ".rims");
    for row in &mut manifest.rows {
        row.inputs.clone_from(&inputs);
    }
    Ok(manifest)
}

/// What is left of the triangles of so many children: a quarter where there are four or
/// more; all of an only one's.
fn target(triangles: u64, children: usize, cut: TileCut) -> u64 {
    match children as u64 {
        0 | 1 => triangles,
        n => triangles.div_ceil(n.min(4)).min(cut.triangles),
    }
}

fn parents(store: &dyn Store, cut: TileCut, phase: Phase, edges: &[RowResult]) -> Result<Manifest> {
    let (cells, _) = level(store, phase.level, phase.number)?;
    let mut all = Vec::new();
    for ((cell, blocks), id) in cells.into_iter().zip(0..) {
        let mut triangles = 0;
        for block in &blocks {
            triangles += Block::open(store, block)?.head.triangles;
        }
        all.push(Row {
            id,
            output: phase.name(&format!("-{id:06}.block")),
            first: cell.first,
            end: cell.end(),
            triangles,
            target: target(triangles, blocks.len(), cut),
            inputs: blocks.into_iter().map(|block| (block, 0, 0)).collect(),
        });
    }
    let phase = Phase {
        last: phase.level == 0,
        triangles: all.iter().map(|row| row.triangles).sum(),
        target: all.iter().map(|row| row.target).sum(),
        borders: edges.iter().map(|result| result.output.clone()).collect(),
        ..phase
    };
    Ok(Manifest { phase, rows: all })
}
