//! Masks of Loop, "Smooth subdivision surfaces based on triangles", 1987, where nothing is
//! sharp.

use super::level::Level;
use super::sum::Sum;
use crate::geom::sin_cos;
use std::f64::consts::TAU;

/// Three eighths of both ends, an eighth of the vertices across.
pub(super) fn smooth_edge<const N: usize>(level: &Level, e: u32, from: &[[f32; N]]) -> Sum<N> {
    let corners = level.edge_corners(e);
    let across = 0.25 / corners.len() as f64;
    let mut sum = Sum::ZERO;
    for &c in corners {
        let opposite = level.faces.previous(c);
        sum.add(across, &from[level.corners[opposite as usize] as usize]);
    }
    for v in level.edge(e) {
        sum.add(0.375, &from[v as usize]);
    }
    sum
}

/// Weight of every neighbour of a vertex of `n` edges.
pub(super) fn neighbour_weight(n: usize) -> f64 {
    let n = n as f64;
    let beta = 0.375 + 0.25 * sin_cos(TAU / n).1;
    (0.625 - beta * beta) / n
}

pub(super) fn smooth_vertex<const N: usize>(level: &Level, v: u32, from: &[[f32; N]]) -> Sum<N> {
    let edges = level.vertex_edges(v);
    let weight = neighbour_weight(edges.len());
    let mut sum = Sum::ZERO;
    for &e in edges {
        sum.add(weight, &from[level.other_end(e, v) as usize]);
    }
    sum.add(1.0 - weight * edges.len() as f64, &from[v as usize]);
    sum
}
