//! One task, run anywhere: what it makes depends on the store, the manifest and the row.

use super::block::Block;
use super::borders::borders;
use super::checksum::checksum;
use super::join::{fetch, scan};
use super::manifest::{Kind, Manifest, Row, RowResult};
use super::read::read;
use super::region::region;
use super::tiles;
use super::{Error, Result, Source, Store};
use crate::progress::Progress;
use glam::Vec3;
use serde::{Deserialize, Serialize};

/// Runs row `row` of `manifest`: reads what it names, puts its output into the store. The
/// same row run twice, by whomever, puts the same bytes. `source` is only read by rows of
/// [`Kind::Bounds`], [`Kind::Scan`], [`Kind::Fetch`] and [`Kind::Read`]. `progress` is asked whether to go on.
///
/// # Errors
/// [`Error::NoRow`]; what the source, the store and the simplifier find;
/// [`crate::Error::Cancelled`].
pub fn run_task(
    store: &dyn Store,
    source: &dyn Source,
    manifest: &Manifest,
    row: u64,
    progress: &dyn Progress,
) -> Result<RowResult> {
    let row = manifest.row(row)?;
    let phase = &manifest.phase;
    let bytes = match phase.kind {
        Kind::Bounds => bounds(source, row)?,
        Kind::Scan => scan(source, phase, row)?,
        Kind::Fetch => fetch(store, source, phase, row)?,
        Kind::Read => read(store, source, phase, row)?,
        Kind::Borders => borders(store, phase, row)?,
        Kind::Simplify => region(store, phase, row, progress)?,
        Kind::Pieces => tiles::pieces(store, phase, row)?,
        Kind::Leaves => tiles::leaf(store, phase, row)?,
        Kind::Edges => tiles::edges(store, phase, row)?,
        Kind::Parents => tiles::parent(store, phase, row, progress)?,
    };
    store.put(&row.output, &bytes)?;
    drop(bytes);
    found(store, manifest, row.id)
}

/// What came of row `row`, if its output is in the store and whole.
///
/// # Errors
/// [`Error::Missing`] and [`Error::Damaged`] if the row has to be run (again);
/// [`Error::NoRow`]; those of the store.
pub fn verify_task(store: &dyn Store, manifest: &Manifest, row: u64) -> Result<RowResult> {
    let row = manifest.row(row)?;
    match manifest.phase.kind {
        kind if kind.makes_blocks() => Block::open(store, &row.output)?.verify()?,
        Kind::Bounds => drop(read_bounds(store, &row.output)?),
        Kind::Borders => super::borders::verify(store, &row.output)?,
        _ => super::sections::Sections::open(store, &row.output)?.verify()?,
    }
    found(store, manifest, row.id)
}

/// The result as the store tells it, without reading all of a block.
fn found(store: &dyn Store, manifest: &Manifest, row: u64) -> Result<RowResult> {
    let row = manifest.row(row)?;
    let (checksum, triangles) = match manifest.phase.kind {
        kind if kind.makes_blocks() => {
            let block = Block::open(store, &row.output)?;
            (block.checksum, block.head.triangles)
        }
        _ => (checksum(&store.get(&row.output)?), 0),
    };
    Ok(RowResult {
        id: row.id,
        output: row.output.clone(),
        checksum,
        triangles,
    })
}

/// Vertices looked at in one piece.
const SLICE: u64 = 1 << 16;

#[derive(Serialize, Deserialize)]
struct Bounds {
    min: [f32; 3],
    max: [f32; 3],
    /// Of the corners, so that a flipped bit is found.
    checksum: u64,
}

impl Bounds {
    fn new(min: [f32; 3], max: [f32; 3]) -> Self {
        let corners: Vec<u8> = [min, max]
            .as_flattened()
            .iter()
            .flat_map(|x| x.to_le_bytes())
            .collect();
        Self {
            min,
            max,
            checksum: checksum(&corners),
        }
    }
}

fn bounds(source: &dyn Source, row: &Row) -> Result<Vec<u8>> {
    let mut corners = [Vec3::INFINITY, Vec3::NEG_INFINITY];
    for first in (row.first..row.end).step_by(SLICE as usize) {
        let end = (first + SLICE).min(row.end);
        for position in super::read::positions(source, first..end)? {
            corners = [corners[0].min(position), corners[1].max(position)];
        }
    }
    // Adding zero makes one zero of both, whichever came first.
    let [min, max] = corners.map(|c| (c + 0.0).to_array());
    Ok(serde_json::to_vec(&Bounds::new(min, max)).unwrap_or_default())
}

/// What a row of [`Kind::Bounds`] has found.
///
/// # Errors
/// [`Error::Damaged`], those of the store.
pub(super) fn read_bounds(store: &dyn Store, name: &str) -> Result<[[f32; 3]; 2]> {
    let found: Option<Bounds> = serde_json::from_slice(&store.get(name)?).ok();
    let found = found.filter(|b| Bounds::new(b.min, b.max).checksum == b.checksum);
    let Some(Bounds { min, max, .. }) = found else {
        return Err(Error::Damaged {
            name: name.into(),
            problem: "the box makes no sense",
        });
    };
    Ok([min, max])
}
