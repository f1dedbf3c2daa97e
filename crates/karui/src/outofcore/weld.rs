//! Vertices that pages share, made one again.

use super::block::Part;
use super::checksum::mixed;
use crate::mesh::{Attribute, AttributeValues, PositionIds};
use std::collections::HashMap;

/// Makes one of vertices with the same place and attributes, in order of their first use;
/// vertices that no triangle uses go.
pub(super) fn weld(part: Part) -> Part {
    let mut used = vec![false; part.positions.len()];
    let corners = part.triangles.as_flattened();
    corners.iter().for_each(|&v| used[v as usize] = true);
    let same = same(&part);
    let mut chosen = vec![u32::MAX; part.positions.len()];
    let mut number = chosen.clone();
    let mut kept = Vec::new();
    let mut rim = Vec::new();
    for v in (0..used.len()).filter(|&v| used[v]) {
        let chosen = &mut chosen[same[v] as usize];
        if *chosen == u32::MAX {
            *chosen = kept.len() as u32;
            kept.push(v as u32);
            rim.push(false);
        }
        number[v] = *chosen;
        rim[*chosen as usize] |= part.rim[v];
    }
    let triangles = part.triangles.iter();
    Part {
        positions: kept.iter().map(|&v| part.positions[v as usize]).collect(),
        triangles: triangles.map(|t| t.map(|v| number[v as usize])).collect(),
        columns: part.columns.iter().map(|c| c.gathered(&kept)).collect(),
        rim,
    }
}

/// For every vertex a number below theirs that all that are the same have.
fn same(part: &Part) -> Vec<u32> {
    let places = PositionIds::of(&part.positions);
    if part.columns.is_empty() {
        return places.of_vertex;
    }
    let mut first = HashMap::with_capacity(places.count);
    let vertices = places.of_vertex.iter().zip(0u32..);
    vertices
        .map(|(&place, v)| {
            *first
                .entry((place, hash(&part.columns, v as usize)))
                .or_insert(v)
        })
        .collect()
}

/// Hash of the attributes of a vertex.
pub(super) fn hash(columns: &[Attribute], vertex: usize) -> u64 {
    columns.iter().fold(1, |hash, column| {
        let first = vertex * column.components;
        let range = first..first + column.components;
        words(&column.values, range).fold(hash, mixed)
    })
}

fn words(
    values: &AttributeValues,
    range: std::ops::Range<usize>,
) -> Box<dyn Iterator<Item = u64> + '_> {
    macro_rules! words {
        ($($kind:ident $of:expr),*) => {
            match values {
                $(AttributeValues::$kind(v) => Box::new(v[range].iter().map($of)),)*
            }
        };
    }
    words!(
        I8 | x: &i8 | *x as u64,
        U8 | x: &u8 | u64::from(*x),
        I16 | x: &i16 | *x as u64,
        U16 | x: &u16 | u64::from(*x),
        I32 | x: &i32 | *x as u64,
        U32 | x: &u32 | u64::from(*x),
        F32 | x: &f32 | u64::from(x.to_bits()),
        F64 | x: &f64 | x.to_bits()
    )
}
