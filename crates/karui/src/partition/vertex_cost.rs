//! What the edges of a vertex cost, VC of the paper.

use super::{PlaneSum, plane_sum::Quadric};
use crate::{Error, Result};
use glam::Vec3;
use std::ops::Range;

/// What is known of a vertex before it is simplified.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct VertexCost {
    /// Mean quadric error of its edges' midpoints, square model units (equation 1); 0
    /// without edges, NaN or infinite where coordinates are.
    pub cost: f64,
    /// Its edges.
    pub edges: u32,
}

/// Costs of the vertices `own` of a slice (equation 1 of the paper): the mean, over the
/// edges of a vertex, of x^T (Q_v + Q_w) x at the midpoint x.
///
/// Exact if the slice holds every triangle at the vertices `own` and at their neighbours;
/// at the rim of a slice without these, planes and edges are missing. What is there may
/// come in any order of triangles: the costs are the same to the bit.
///
/// # Errors
/// [`Error::IndexOutOfRange`]; [`Error::BadOption`] if `own` ends beyond the vertices.
pub fn vertex_costs(
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    own: Range<usize>,
) -> Result<Vec<VertexCost>> {
    check(positions.len(), triangles, &own)?;
    let planes = quadrics(positions, triangles);
    let (starts, mut neighbours) = neighbours(triangles, &own);
    let mut costs = Vec::with_capacity(own.len());
    let mut edges = Vec::new();
    for (v, ends) in own.zip(starts.windows(2)) {
        let around = &mut neighbours[ends[0]..ends[1]];
        around.sort_unstable();
        edges.clear();
        let mut last = None;
        for &w in &*around {
            if last.replace(w) == Some(w) || w as usize == v {
                continue;
            }
            let half = (positions[w as usize].as_dvec3() - positions[v].as_dvec3()) * 0.5;
            edges.push(planes[v].cost(half) + planes[w as usize].cost(-half));
        }
        costs.push(mean(&mut edges));
    }
    Ok(costs)
}

/// The mean does not depend on how the neighbours are numbered.
fn mean(edges: &mut [f64]) -> VertexCost {
    edges.sort_unstable_by(f64::total_cmp);
    let sum: f64 = edges.iter().sum();
    VertexCost {
        cost: sum / edges.len().max(1) as f64,
        edges: edges.len() as u32,
    }
}

fn check(vertices: usize, triangles: &[[u32; 3]], own: &Range<usize>) -> Result<()> {
    if own.end > vertices {
        return Err(Error::BadOption {
            option: "own",
            found: format!("{own:?} of {vertices} vertices"),
            expected: "a range of vertices",
        });
    }
    let is_bad = |&v: &u32| v as usize >= vertices;
    let bad = triangles.iter().enumerate();
    let mut bad = bad.filter_map(|(face, t)| Some((face, t.iter().copied().find(is_bad)?)));
    match bad.next() {
        None => Ok(()),
        Some((face, index)) => Err(Error::IndexOutOfRange {
            face,
            index,
            vertices,
        }),
    }
}

fn quadrics(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Quadric> {
    let mut sums = vec![PlaneSum::default(); positions.len()];
    for triangle in triangles {
        let mut plane = PlaneSum::default();
        plane.add_triangle(triangle.map(|v| positions[v as usize]));
        for &v in triangle {
            sums[v as usize].merge(&plane);
        }
    }
    sums.into_iter().map(PlaneSum::to_f64).collect()
}

/// The other corners of the triangles at each of the vertices `own`, one list after the
/// other, and where each list starts.
fn neighbours(triangles: &[[u32; 3]], own: &Range<usize>) -> (Vec<usize>, Vec<u32>) {
    let place = |v: u32| own.contains(&(v as usize)).then(|| v as usize - own.start);
    let mut starts = vec![0; own.len() + 1];
    for own in triangles.as_flattened().iter().filter_map(|&v| place(v)) {
        starts[own + 1] += 2;
    }
    for i in 1..starts.len() {
        starts[i] += starts[i - 1];
    }
    let mut next = starts.clone();
    let mut found = vec![0; starts[own.len()]];
    for &[a, b, c] in triangles {
        for (v, others) in [(a, [b, c]), (b, [c, a]), (c, [a, b])] {
            if let Some(own) = place(v) {
                found[next[own]..next[own] + 2].copy_from_slice(&others);
                next[own] += 2;
            }
        }
    }
    (starts, found)
}
