//! Masks of Catmull and Clark, "Recursively generated B-spline surfaces on arbitrary
//! topological meshes", 1978, where nothing is sharp.

use super::level::Level;
use super::options::TriangleRule;
use super::sum::Sum;

/// Weight of a face point of a triangle under [`TriangleRule::Smooth`].
const SMOOTH_TRIANGLE: f64 = 0.470;

/// The mean of both ends and both face points.
pub(super) fn smooth_edge<const N: usize>(
    level: &Level,
    e: u32,
    from: &[[f32; N]],
    faces: &[[f32; N]],
) -> Sum<N> {
    let corners = level.edge_corners(e);
    let face = weight_of_faces(level, corners);
    let end = 0.5 - 0.5 * face;
    let mut sum = Sum::ZERO;
    for &c in corners {
        let f = level.faces.of_corner(c) as usize;
        sum.add(face / corners.len() as f64, &faces[f]);
    }
    for v in level.edge(e) {
        sum.add(end, &from[v as usize]);
    }
    sum
}

/// Weight of the face points of an edge together: half of the whole.
fn weight_of_faces(level: &Level, corners: &[u32]) -> f64 {
    if level.triangles == TriangleRule::CatmullClark || corners.len() != 2 {
        return 0.5;
    }
    let size = |&c: &u32| level.faces.corners(level.faces.of_corner(c) as usize).len();
    let weight = |c| if size(c) == 3 { SMOOTH_TRIANGLE } else { 0.25 };
    corners.iter().map(weight).sum()
}

/// Q/n + 2R/n + S (n - 3)/n with the mean Q of the face points, R of the edges' middles.
pub(super) fn smooth_vertex<const N: usize>(
    level: &Level,
    v: u32,
    from: &[[f32; N]],
    faces: &[[f32; N]],
) -> Sum<N> {
    let corners = level.vertex_corners(v);
    let n = corners.len() as f64;
    let outer = 1.0 / (n * n);
    let mut sum = Sum::ZERO;
    for &c in corners {
        sum.add(outer, &faces[level.faces.of_corner(c) as usize]);
    }
    for &e in level.vertex_edges(v) {
        sum.add(outer, &from[level.other_end(e, v) as usize]);
    }
    sum.add((n - 2.0) / n, &from[v as usize]);
    sum
}
