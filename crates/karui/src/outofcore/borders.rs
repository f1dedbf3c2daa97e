//! Places that several regions share, found from the rims of all blocks.
//!
//! `KARUIRIM`, the version, regions (`u32` each), checksum of what follows (`u64`); for each
//! region the number of its places (`u64`); then the places by region (three `u32` each).

use super::block::{Block, Place, Rim};
use super::bytes::{Reader, put_triples};
use super::checksum::checksum;
use super::manifest::{Phase, Row};
use super::{Error, Result, Store};
use std::collections::HashSet;

const MAGIC: [u8; 8] = *b"KARUIRIM";
const VERSION: u32 = 1;
const PREFIX: u64 = 24;

/// The region of a key.
pub(super) fn region_of(cuts: &[u64], key: u64) -> usize {
    cuts.partition_point(|&cut| cut <= key).saturating_sub(1)
}

/// The borders within the buckets that `row` names.
///
/// # Errors
/// Those of the store and of damaged blocks.
pub(super) fn borders(store: &dyn Store, phase: &Phase, row: &Row) -> Result<Vec<u8>> {
    let mut seen: Vec<(Place, u32)> = Vec::new();
    for (name, ..) in &row.inputs {
        let block = Block::open(store, name)?;
        let rims = block.rims(row.first as usize..row.end as usize)?;
        let seen_at = |rim: Rim| (rim.place, region_of(&phase.cuts, rim.key) as u32);
        seen.extend(rims.into_iter().map(seen_at));
    }
    seen.sort_unstable();
    seen.dedup();
    let mut shared: Vec<(u32, Place)> = Vec::new();
    for regions in seen.chunk_by(|a, b| a.0 == b.0).filter(|r| r.len() > 1) {
        shared.extend(regions.iter().map(|&(place, region)| (region, place)));
    }
    shared.sort_unstable();
    Ok(to_bytes(&shared, phase.cuts.len()))
}

fn to_bytes(shared: &[(u32, Place)], regions: usize) -> Vec<u8> {
    let mut counts = vec![0u64; regions];
    shared
        .iter()
        .for_each(|&(region, _)| counts[region as usize] += 1);
    let mut body: Vec<u8> = counts.iter().flat_map(|n| n.to_le_bytes()).collect();
    put_triples(&mut body, shared.iter().map(|s| s.1));
    let mut bytes = MAGIC.to_vec();
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend((regions as u32).to_le_bytes());
    bytes.extend(checksum(&body).to_le_bytes());
    bytes.extend(body);
    bytes
}

/// Makes sure that borders in the store are whole.
///
/// # Errors
/// [`Error::Damaged`], those of the store.
pub(super) fn verify(store: &dyn Store, name: &str) -> Result<()> {
    places(store, name, 0).map(drop)
}

/// Places that a region shares with others, out of one file.
///
/// # Errors
/// [`Error::Damaged`], those of the store.
fn places(store: &dyn Store, name: &str, region: usize) -> Result<Vec<Place>> {
    let damaged = |problem| Error::Damaged {
        name: name.into(),
        problem,
    };
    let bytes = store.get(name)?;
    let (prefix, body) = bytes
        .split_at_checked(PREFIX as usize)
        .ok_or_else(|| damaged("it ends early"))?;
    let mut reader = Reader(prefix);
    if reader.take(MAGIC.len()) != Some(&MAGIC) || reader.u32() != Some(VERSION) {
        return Err(damaged("it does not begin with KARUIRIM and version 1"));
    }
    let regions = reader.u32().unwrap_or_default() as usize;
    if reader.u64() != Some(checksum(body)) {
        return Err(damaged("the checksum is another"));
    }
    of_body(body, regions, region).ok_or_else(|| damaged("it makes no sense"))
}

fn of_body(body: &[u8], regions: usize, region: usize) -> Option<Vec<Place>> {
    let mut reader = Reader(body);
    let counts = reader.many(regions, Reader::u64)?;
    let add = |sum: u64, &count: &u64| sum.checked_add(count);
    let before = counts.get(..region)?.iter().try_fold(0, add)?;
    reader.take(usize::try_from(before.checked_mul(12)?).ok()?)?;
    let count = counts.get(region).copied().unwrap_or_default();
    Some(reader.triples(usize::try_from(count).ok()?)?.collect())
}

/// All places that a region shares with others.
///
/// # Errors
/// [`Error::Damaged`], those of the store.
pub(super) fn shared(store: &dyn Store, phase: &Phase, region: u64) -> Result<HashSet<Place>> {
    let mut shared = HashSet::new();
    for name in &phase.borders {
        shared.extend(places(store, name, region as usize)?);
    }
    Ok(shared)
}
