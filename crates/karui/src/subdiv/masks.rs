//! One step of a level's values, by the masks of its scheme: what schemes have in common.

use super::crease::Rule;
use super::level::Level;
use super::split::Kind;
use super::sum::Sum;
use super::{catmull_clark, loop_};
use rayon::prelude::*;

/// Values a thread takes at a time.
const BATCH: usize = 2048;

/// Values of the next level from those of `level`. `to` is as long as the next level has
/// vertices.
pub(super) fn step<const N: usize>(
    level: &Level,
    kind: Kind,
    from: &[[f32; N]],
    to: &mut [[f32; N]],
) {
    let (vertices, rest) = to.split_at_mut(level.vertices);
    let face_points = if kind.triangles {
        0
    } else {
        level.faces.count()
    };
    let (faces, edges) = rest.split_at_mut(face_points);
    each(faces, |f| face_point(level, f, from));
    let faces = &*faces;
    each(edges, |e| edge_point(level, kind, e as u32, from, faces));
    each(vertices, |v| {
        vertex_point(level, kind, v as u32, from, faces)
    });
}

fn each<const N: usize>(to: &mut [[f32; N]], value: impl Fn(usize) -> Sum<N> + Sync) {
    let batches = to.par_iter_mut().with_min_len(BATCH);
    batches
        .enumerate()
        .for_each(|(i, to)| *to = value(i).value());
}

/// The mean of a face's vertices.
pub(super) fn face_point<const N: usize>(level: &Level, f: usize, from: &[[f32; N]]) -> Sum<N> {
    let range = level.faces.corners(f);
    let weight = 1.0 / range.len() as f64;
    let mut sum = Sum::ZERO;
    for &v in &level.corners[range] {
        sum.add(weight, &from[v as usize]);
    }
    sum
}

/// Where edge `e` is divided.
pub(super) fn edge_point<const N: usize>(
    level: &Level,
    kind: Kind,
    e: u32,
    from: &[[f32; N]],
    faces: &[[f32; N]],
) -> Sum<N> {
    let middle = || {
        let mut sum = Sum::ZERO;
        for v in level.edge(e) {
            sum.add(0.5, &from[v as usize]);
        }
        sum
    };
    let sharpness = level.edge_sharpness(e);
    if kind.linear || sharpness >= 1.0 {
        return middle();
    }
    let smooth = if kind.triangles {
        loop_::smooth_edge(level, e, from)
    } else {
        catmull_clark::smooth_edge(level, e, from, faces)
    };
    if sharpness <= 0.0 {
        return smooth;
    }
    middle().mixed(smooth, level.edge_share(e))
}

/// Where vertex `v` goes.
pub(super) fn vertex_point<const N: usize>(
    level: &Level,
    kind: Kind,
    v: u32,
    from: &[[f32; N]],
    faces: &[[f32; N]],
) -> Sum<N> {
    let by = |rule: Rule, after: bool| match rule {
        Rule::Smooth if kind.triangles => loop_::smooth_vertex(level, v, from),
        Rule::Smooth => catmull_clark::smooth_vertex(level, v, from, faces),
        Rule::Crease => crease_vertex(level, v, from, after),
        Rule::Corner => fixed(from, v),
    };
    if kind.linear {
        return fixed(from, v);
    }
    let blend = level.blend(v);
    let before = by(blend.before, false);
    if blend.before == blend.after {
        return before;
    }
    before.mixed(by(blend.after, true), blend.share)
}

fn fixed<const N: usize>(from: &[[f32; N]], v: u32) -> Sum<N> {
    let mut sum = Sum::ZERO;
    sum.add(1.0, &from[v as usize]);
    sum
}

/// A vertex of a curve. `after` takes the edges that are still sharp after the step.
fn crease_vertex<const N: usize>(level: &Level, v: u32, from: &[[f32; N]], after: bool) -> Sum<N> {
    let mut sum = Sum::ZERO;
    for e in level.crease_ends(v, after) {
        sum.add(0.125, &from[level.other_end(e, v) as usize]);
    }
    sum.add(0.75, &from[v as usize]);
    sum
}
