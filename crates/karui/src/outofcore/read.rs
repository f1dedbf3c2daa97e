//! Portions of the input's faces, joined with their vertices.

use super::block::Head;
use super::columns::columns;
use super::join::fetched;
use super::load::costs;
use super::manifest::{Phase, Row};
use super::pack::{Contents, pack};
use super::{Error, Result, Source, Store, Vertices};
use crate::mesh::Attribute;
use glam::Vec3;
use std::ops::Range;

/// Vertices read in one piece at most.
const SLICE: u64 = 1 << 16;
/// Vertices between two that are needed that are read along rather than skipped.
const GAP: u64 = 256;
/// Up to so many ids a triangle, a table over all of them beats searching.
const DENSE: u64 = 4;

/// The block of the portions that `row` names.
///
/// # Errors
/// Those of the source; [`Error::IndexOutOfRange`], [`Error::NotFinite`].
pub(super) fn read(
    store: &dyn Store,
    source: &dyn Source,
    phase: &Phase,
    row: &Row,
) -> Result<Vec<u8>> {
    let triangles = triangles(source, row)?;
    let (ids, local) = numbered(&triangles);
    drop(triangles);
    let (positions, columns) = match row.inputs.is_empty() {
        true => vertices(source, &ids)?,
        false => fetched(store, row, ids.len())?,
    };
    let costs = costs(&positions, &local)?;
    let contents = Contents {
        positions: &positions,
        triangles: &local,
        columns: &columns,
        costs: Some(&costs),
        sample: phase.sample,
    };
    let head = Head {
        number: row.id,
        ..Head::default()
    };
    let keys = phase.next.as_ref().ok_or_else(|| phase.broken("no keys"))?;
    Ok(pack(&contents, keys, head))
}

/// The triangles of the portions that `row` names, checked.
///
/// # Errors
/// Those of the source; [`Error::IndexOutOfRange`].
pub(super) fn triangles(source: &dyn Source, row: &Row) -> Result<Vec<[u64; 3]>> {
    let mut triangles = Vec::new();
    for chunk in row.first..row.end {
        triangles.extend(source.read_triangles(chunk)?);
    }
    check(&triangles, row, source.vertices())?;
    Ok(triangles)
}

/// Triangle numbers in errors count from the first portion of the row.
fn check(triangles: &[[u64; 3]], row: &Row, vertices: u64) -> Result<()> {
    let is_bad = |t: &&[u64; 3]| t.iter().any(|&v| v >= vertices);
    match triangles.iter().position(|t| is_bad(&t)) {
        None => Ok(()),
        Some(bad) => Err(Error::IndexOutOfRange {
            triangle: (row.first << 16) + bad as u64,
            index: triangles[bad].into_iter().max().unwrap_or_default(),
            vertices,
        }),
    }
}

/// The ids in use, in order, and the triangles by their places among them.
pub(super) fn numbered(triangles: &[[u64; 3]]) -> (Vec<u64>, Vec<[u32; 3]>) {
    let corners = triangles.as_flattened();
    let least = corners.iter().copied().min().unwrap_or(0);
    let end = corners.iter().copied().max().map_or(0, |most| most + 1);
    if end - least > DENSE * triangles.len() as u64 {
        return searched(triangles);
    }
    let mut number = vec![u32::MAX; (end - least) as usize];
    corners
        .iter()
        .for_each(|&id| number[(id - least) as usize] = 0);
    let mut ids = Vec::new();
    for (id, number) in (least..).zip(&mut number).filter(|n| *n.1 == 0) {
        *number = ids.len() as u32;
        ids.push(id);
    }
    let local = triangles
        .iter()
        .map(|t| t.map(|id| number[(id - least) as usize]));
    (ids, local.collect())
}

fn searched(triangles: &[[u64; 3]]) -> (Vec<u64>, Vec<[u32; 3]>) {
    let mut ids = triangles.as_flattened().to_vec();
    ids.sort_unstable();
    ids.dedup();
    let number = |id: u64| ids.partition_point(|&other| other < id) as u32;
    let local = triangles.iter().map(|t| t.map(number)).collect();
    (ids, local)
}

/// The vertices of these ids, which ascend.
pub(super) fn vertices(source: &dyn Source, ids: &[u64]) -> Result<(Vec<Vec3>, Vec<Attribute>)> {
    let mut positions = Vec::with_capacity(ids.len());
    let mut all: Vec<Attribute> = Vec::new();
    let mut rest = ids;
    while let Some(&first) = rest.first() {
        let near = |w: &[u64]| w[1] - w[0] <= GAP && w[1] - first < SLICE;
        let run = rest.windows(2).take_while(|w| near(w)).count() + 1;
        let (wanted, others) = rest.split_at(run);
        rest = others;
        let mut slice = slice(source, first..wanted[run - 1] + 1)?;
        let kept: Vec<u32> = wanted.iter().map(|id| (id - first) as u32).collect();
        if kept.len() < slice.positions.len() {
            slice.positions = kept.iter().map(|&i| slice.positions[i as usize]).collect();
            slice.attributes.gather(&kept);
        }
        positions.append(&mut slice.positions);
        let more = columns(slice.attributes);
        if all.is_empty() {
            all = more;
        } else {
            let both = all.iter_mut().zip(more);
            both.for_each(|(column, more)| column.values.append(more.values));
        }
    }
    Ok((positions, all))
}

/// A slice of the vertices, as many as were asked for and all of them finite.
fn slice(source: &dyn Source, ids: Range<u64>) -> Result<Vertices> {
    let slice = source.read_vertices(ids.clone())?;
    let found = slice.positions.len() as u64;
    if found != ids.end - ids.start {
        return Err(Error::ShortSlice {
            first: ids.start,
            end: ids.end,
            found,
        });
    }
    match slice.positions.iter().position(|p| !p.is_finite()) {
        None => Ok(slice),
        Some(bad) => Err(Error::NotFinite {
            vertex: ids.start + bad as u64,
        }),
    }
}

/// Positions of a range of vertices.
///
/// # Errors
/// Those of the source; [`Error::ShortSlice`], [`Error::NotFinite`].
pub(super) fn positions(source: &dyn Source, ids: Range<u64>) -> Result<Vec<Vec3>> {
    Ok(slice(source, ids)?.positions)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn both_ways_to_number_agree(
            corners in prop::collection::vec(prop::array::uniform3(0u64..40), 1..60),
        ) {
            prop_assert_eq!(numbered(&corners), searched(&corners));
        }
    }
}
