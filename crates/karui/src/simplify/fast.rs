//! The round-based driver on a whole mesh.

use super::options::{Border, Cost, Placement, Quality, Simplified, SimplifyOptions, Stop};
use super::rounds::{Guard, Level, Pace, Ran, Rules, run};
use super::{exact::Target, points::points, target};
use crate::error::Result;
use crate::mesh::TriMesh;
use crate::spatial::Bvh;

/// As [`super::simplify_chain`], in rounds; none if the options or the mesh
/// ask for what only the exact driver does.
///
/// # Errors
/// [`Error::Cancelled`](crate::Error::Cancelled).
pub(super) fn simplify_chain(
    mesh: &TriMesh,
    stops: &[Stop],
    options: &SimplifyOptions<'_>,
) -> Result<Option<Vec<Simplified>>> {
    let share = match options.quality {
        Quality::Fast => 0.5,
        Quality::Balanced => 0.25,
        Quality::Exact => return Ok(None),
    };
    if !is_served(mesh, options) {
        return Ok(None);
    }
    let scale = scale_of(mesh);
    let (mut level, vertex) = level_of(mesh, options, scale);
    let index = match options.quality {
        Quality::Balanced if !mesh.triangles.is_empty() => Some(Bvh::build(mesh)?),
        _ => None,
    };
    let guard = index.as_ref().map(|index| Guard { index, scale });
    let pace = Pace { share };
    let mut done = (0, 0.0f64);
    let mut chain = Vec::with_capacity(stops.len());
    for stop in stops {
        let target = target(mesh, stop);
        let scaled = Target {
            error: target.error * f64::from(scale),
            ..target
        };
        let rules = rules(options, scaled);
        let ran = run(level, scaled, pace, rules, guard, options.progress)?;
        done = (
            done.0 + ran.collapses,
            done.1.max(f64::from(ran.error / scale)),
        );
        chain.push(Simplified {
            mesh: output(mesh, &ran, &vertex, scale),
            error: done.1,
            stopped: ran.stopped,
            collapses: done.0,
            blocked: ran.blocked,
        });
        level = ran.level;
    }
    Ok(Some(chain))
}

fn is_served(mesh: &TriMesh, options: &SimplifyOptions<'_>) -> bool {
    options.cost == Cost::Memoryless
        && options.pairs.is_none()
        && mesh.attributes == Default::default()
        && mesh.ranges.len() <= 1
}

fn rules(options: &SimplifyOptions<'_>, target: Target) -> Rules {
    Rules {
        least_turn: options.max_normal_turn.cos() as f32,
        hold_borders: options.border != Border::Free,
        lock_borders: options.border == Border::Lock,
        subset: options.placement == Placement::HalfEdge,
        max_error: target.error as f32,
    }
}

/// A power of two, so that nothing is rounded, that brings the mesh to about
/// unit size: prices are fourth powers of lengths, which in `f32` would
/// otherwise run out of range.
fn scale_of(mesh: &TriMesh) -> f32 {
    let diagonal = mesh.bounds().diagonal();
    if diagonal > 0.0 && diagonal.is_finite() {
        (-diagonal.log2().round()).exp2() as f32
    } else {
        1.0
    }
}

fn level_of(mesh: &TriMesh, options: &SimplifyOptions<'_>, scale: f32) -> (Level, Vec<u32>) {
    let points = points(mesh);
    let of = |v: &u32| *v as usize;
    let weight = |w: &[f32]| points.vertex.iter().map(|v| w[of(v)]).collect();
    let lock = |l: &[bool]| points.vertex.iter().map(|v| l[of(v)]).collect();
    let place = |v: &u32| mesh.positions[of(v)] * scale;
    let level = Level {
        position: points.vertex.iter().map(place).collect(),
        weight: options.weights.map(weight).unwrap_or_default(),
        locked: options.locks.map(lock).unwrap_or_default(),
        triangle: points.triangle,
        source: points.source,
        ..Level::default()
    };
    (level, points.vertex)
}

/// The triangles that are left, in the input's order, and their vertices, in
/// the order of those they have come from.
fn output(source: &TriMesh, ran: &Ran, vertex: &[u32], scale: f32) -> TriMesh {
    let level = &ran.level;
    let mut order: Vec<u32> = (0..level.triangle.len() as u32).collect();
    order.sort_unstable_by_key(|&t| level.source[t as usize]);
    let from = |&p: &u32| {
        let origin = level.origin.get(p as usize).copied().unwrap_or(p);
        (vertex[origin as usize], origin)
    };
    let mut points: Vec<u32> = (0..level.position.len() as u32).collect();
    points.sort_unstable_by_key(from);
    let mut index = vec![0; points.len()];
    for (i, &p) in points.iter().enumerate() {
        index[p as usize] = i as u32;
    }
    let triangle = |&t: &u32| level.triangle[t as usize].map(|p| index[p as usize]);
    let mut mesh = TriMesh {
        positions: points
            .iter()
            .map(|&p| level.position[p as usize] / scale)
            .collect(),
        triangles: order.iter().map(triangle).collect(),
        ..TriMesh::default()
    };
    let kept: Vec<u32> = order.iter().map(|&t| level.source[t as usize]).collect();
    mesh.face_attributes = source
        .face_attributes
        .iter()
        .map(|a| a.gathered(&kept))
        .collect();
    mesh.ranges = source.ranges.clone();
    for range in &mut mesh.ranges {
        range.count = mesh.triangles.len() as u32;
    }
    mesh.remove_unreferenced_vertices();
    mesh
}
