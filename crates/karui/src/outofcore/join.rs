//! Vertices for faces that use them from all over: brought by sorting, so that nothing is
//! read but from front to back.
//!
//! A *scan* of some portions of faces makes one section for each range of vertices: the
//! places in the range that are used, in order. A *fetch* of one range reads it once and
//! makes one section for each scan: those vertices. Sections of one scan, range after range,
//! are then all vertices of its portions, in order of their ids.

use super::bytes::{Reader, kind, put_kind, put_triples, put_values, read_values};
use super::manifest::{Phase, Row};
use super::read::{numbered, triangles, vertices};
use super::sections::{Sections, to_bytes};
use super::{Error, Result, Source, Store};
use crate::mesh::Attribute;
use glam::Vec3;

/// A model is scattered if its portions pass more than so many vertices for each they use.
pub(super) const SCATTERED: u64 = 4;
/// Vertices that are passed rather than skipped.
const GAP: u64 = 4096;

/// How far apart the vertices of some triangles lie.
pub(super) struct Reach {
    /// Vertices used.
    pub used: u64,
    /// Vertices from the first to the last of each run, gaps of some thousands included.
    pub passed: u64,
}

/// How far apart the vertices of some triangles lie.
pub(super) fn reach(triangles: &[[u64; 3]]) -> Reach {
    let mut ids = triangles.as_flattened().to_vec();
    ids.sort_unstable();
    ids.dedup();
    let steps = ids.windows(2).map(|w| (w[1] - w[0]).min(GAP));
    Reach {
        used: ids.len() as u64,
        passed: steps.sum(),
    }
}

/// Places within each range of vertices that the portions of `row` use.
///
/// # Errors
/// Those of the source; [`Error::IndexOutOfRange`].
pub(super) fn scan(source: &dyn Source, phase: &Phase, row: &Row) -> Result<Vec<u8>> {
    let (ids, _) = numbered(&triangles(source, row)?);
    let range = phase.range.max(1);
    let mut rest = ids.as_slice();
    let section = |r: u64| {
        let end = rest.partition_point(|&id| id < (r + 1) * range);
        let (own, others) = rest.split_at(end);
        rest = others;
        let places = own.iter().map(|id| (id - r * range) as u32);
        places.flat_map(u32::to_le_bytes).collect()
    };
    let ranges = source.vertices().div_ceil(range);
    let sections: Vec<Vec<u8>> = (0..ranges).map(section).collect();
    Ok(to_bytes(&sections))
}

/// The vertices of one range, for all scans.
///
/// # Errors
/// Those of the source and of the store.
pub(super) fn fetch(
    store: &dyn Store,
    source: &dyn Source,
    phase: &Phase,
    row: &Row,
) -> Result<Vec<u8>> {
    let ids: Vec<u64> = (row.first..row.end).collect();
    let (positions, columns) = vertices(source, &ids)?;
    drop(ids);
    let mut sections = Vec::with_capacity(row.inputs.len());
    for (name, ..) in &row.inputs {
        let bytes = Sections::open(store, name)?.get((row.first / phase.range.max(1)) as usize)?;
        let (places, _) = bytes.as_chunks::<4>();
        let places: Vec<u32> = places.iter().map(|&b| u32::from_le_bytes(b)).collect();
        if places.iter().any(|&p| p as usize >= positions.len()) {
            return Err(nonsense(name));
        }
        sections.push(section(&positions, &columns, &places));
    }
    Ok(to_bytes(&sections))
}

/// Counts, positions, kinds and values of some vertices.
fn section(positions: &[Vec3], columns: &[Attribute], places: &[u32]) -> Vec<u8> {
    let mut bytes = Vec::new();
    bytes.extend((places.len() as u32).to_le_bytes());
    bytes.extend((columns.len() as u32).to_le_bytes());
    let bits = |&p: &u32| positions[p as usize].to_array().map(f32::to_bits);
    put_triples(&mut bytes, places.iter().map(bits));
    for column in columns {
        put_kind(&mut bytes, column);
        put_values(&mut bytes, column, places);
    }
    bytes
}

/// The vertices that were fetched for the portions of `row`.
///
/// # Errors
/// [`Error::Damaged`] if they are not as many as expected; those of the store.
pub(super) fn fetched(
    store: &dyn Store,
    row: &Row,
    expected: usize,
) -> Result<(Vec<Vec3>, Vec<Attribute>)> {
    let mut positions = Vec::new();
    let mut all: Vec<Attribute> = Vec::new();
    for (name, ..) in &row.inputs {
        let bytes = Sections::open(store, name)?.get(row.id as usize)?;
        let found = of_section(&bytes).ok_or_else(|| nonsense(name))?;
        positions.extend(found.0);
        if all.is_empty() {
            all = found.1;
            continue;
        }
        let both = all.iter_mut().zip(found.1);
        both.for_each(|(column, more)| column.values.append(more.values));
    }
    if positions.len() == expected {
        return Ok((positions, all));
    }
    let first = row.inputs.first().map_or("", |i| &i.0);
    Err(nonsense(first))
}

fn of_section(bytes: &[u8]) -> Option<(Vec<Vec3>, Vec<Attribute>)> {
    let mut reader = Reader(bytes);
    let [vertices, columns] = [reader.u32()? as usize, reader.u32()? as usize];
    let position = |bits: [u32; 3]| Vec3::from(bits.map(f32::from_bits));
    let positions = reader.triples(vertices)?.map(position).collect();
    let read = |r: &mut Reader<'_>| {
        let kind = kind(r)?;
        read_values(r, &kind, vertices)
    };
    Some((positions, reader.many(columns, read)?))
}

fn nonsense(name: &str) -> Error {
    Error::Damaged {
        name: name.into(),
        problem: "it does not fit the faces",
    }
}
