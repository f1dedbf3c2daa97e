//! Places that cells of one depth share with others, found from the rims of their blocks.

use super::super::block::{Block, Place};
use super::super::bytes::{Reader, put_triples};
use super::super::manifest::{Phase, Row};
use super::super::sections::{Sections, to_bytes};
use super::super::{Error, Result, Store};
use std::collections::HashSet;

/// The places within the buckets that `row` names, a section for each cell of the phase.
/// Inputs are blocks, each with the number of its cell; larger leaves have numbers of their
/// own after those.
///
/// # Errors
/// Those of the store and of damaged blocks.
pub(in super::super) fn edges(store: &dyn Store, phase: &Phase, row: &Row) -> Result<Vec<u8>> {
    let mut seen: Vec<(Place, u32)> = Vec::new();
    for (name, cell, _) in &row.inputs {
        let block = Block::open(store, name)?;
        let rims = block.rims(row.first as usize..row.end as usize)?;
        let mut places: Vec<_> = rims.into_iter().map(|rim| (rim.place, *cell)).collect();
        places.dedup();
        seen.extend(places);
    }
    seen.sort_unstable();
    seen.dedup();
    let mut sections = vec![Vec::new(); phase.cuts.len()];
    for cells in seen.chunk_by(|a, b| a.0 == b.0).filter(|c| c.len() > 1) {
        for &(place, cell) in cells {
            if let Some(section) = sections.get_mut(cell as usize) {
                put_triples(section, std::iter::once(place));
            }
        }
    }
    Ok(to_bytes(&sections))
}

/// All places that a cell of the phase shares with others.
///
/// # Errors
/// [`Error::Damaged`], those of the store.
pub(super) fn shared(store: &dyn Store, phase: &Phase, cell: u64) -> Result<HashSet<Place>> {
    let mut shared = HashSet::new();
    for name in &phase.borders {
        let bytes = Sections::open(store, name)?.get(cell as usize)?;
        let places = Reader(&bytes).triples(bytes.len() / 12);
        shared.extend(places.ok_or_else(|| Error::Damaged {
            name: name.clone(),
            problem: "it makes no sense",
        })?);
    }
    Ok(shared)
}
