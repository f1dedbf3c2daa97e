//! From points and wedges back to a mesh.

use super::grid::differ;
use super::groups::Groups;
use super::place::Placed;
use crate::geom::{closest_barycentric, interpolate, normal_times_two_areas};
use crate::mesh::{Attributes, TriMesh};
use crate::simplify::blend::{Mix, blend};
use crate::simplify::wedges::least_first;
use glam::DVec3;
use rayon::prelude::*;

/// Triangles a task takes.
const CHUNK: usize = 1 << 14;
/// No triangle, no wedge.
const NONE: u32 = u32::MAX;

/// The mesh of the triangles kept.
pub(super) fn output(mesh: &TriMesh, groups: &Groups, placed: &Placed, kept: &[u32]) -> TriMesh {
    let wedges = Wedges::used(mesh, groups, kept);
    let place = |&p: &u32| placed.positions[p as usize];
    let positions: Vec<_> = wedges.points.par_iter().map(place).collect();
    let triangle = |&t: &u32| mesh.triangles[t as usize].map(|v| wedges.number(groups, v));
    let mut coarse = TriMesh {
        triangles: kept.par_iter().map(triangle).collect(),
        attributes: attributes(mesh, groups, &wedges, placed),
        positions,
        face_attributes: (mesh.face_attributes.iter().map(|a| a.gathered(kept))).collect(),
        ranges: mesh.ranges.clone(),
    };
    let before = |t: u32| kept.partition_point(|&k| k < t) as u32;
    for range in &mut coarse.ranges {
        let (first, end) = (before(range.first), before(range.first + range.count));
        (range.first, range.count) = (first, end - first);
    }
    coarse
}

/// Triangles with three points that span an area, each once a range, in the
/// input's order.
pub(super) fn kept(mesh: &TriMesh, groups: &Groups, placed: &Placed) -> Vec<u32> {
    let points = |t: u32| mesh.triangles[t as usize].map(|v| groups.point_of[v as usize]);
    let stays = |t: &u32| {
        let points = points(*t);
        let corners = || points.map(|p| placed.positions[p as usize].as_dvec3());
        differ(&points) && normal_times_two_areas(corners()) != DVec3::ZERO
    };
    let chunks = (0..mesh.triangles.len() as u32)
        .into_par_iter()
        .step_by(CHUNK);
    let chunk = |first: u32| {
        let end = (first as usize + CHUNK).min(mesh.triangles.len());
        (first..end as u32).filter(stays)
    };
    let mut kept: Vec<u32> = chunks.flat_map_iter(chunk).collect();
    let ends: Vec<u32> = mesh.ranges.iter().map(|r| r.first + r.count).collect();
    let range = |t: u32| ends.partition_point(|&end| end <= t);
    // Triangles already met, in one list a least point.
    let mut first = vec![NONE; groups.points];
    let mut next: Vec<u32> = Vec::with_capacity(kept.len());
    let mut met: Vec<([u32; 3], usize)> = Vec::with_capacity(kept.len());
    kept.retain(|&t| {
        let this = (least_first(points(t)), range(t));
        let head = &mut first[this.0[0] as usize];
        let mut at = *head;
        while at != NONE {
            if met[at as usize] == this {
                return false;
            }
            at = next[at as usize];
        }
        next.push(*head);
        *head = met.len() as u32;
        met.push(this);
        true
    });
    kept
}

/// The wedges that are left, in the order of their first vertices.
struct Wedges {
    /// Number of every wedge, [`NONE`] if it is gone.
    number: Vec<u32>,
    /// Point of every one that is left.
    points: Vec<u32>,
}

impl Wedges {
    fn used(mesh: &TriMesh, groups: &Groups, kept: &[u32]) -> Self {
        let mut point_of = vec![NONE; groups.wedges];
        for &v in kept.iter().flat_map(|&t| &mesh.triangles[t as usize]) {
            point_of[groups.wedge_of[v as usize] as usize] = groups.point_of[v as usize];
        }
        let mut points = Vec::new();
        let mut number = point_of;
        for slot in number.iter_mut().filter(|p| **p != NONE) {
            let point = std::mem::replace(slot, points.len() as u32);
            points.push(point);
        }
        Self { number, points }
    }

    fn number(&self, groups: &Groups, vertex: u32) -> u32 {
        self.number[groups.wedge_of[vertex as usize] as usize]
    }
}

/// Attributes of the wedges left: those of the nearest place on the triangles
/// at the nearest of their own vertices, all of one UV chart.
fn attributes(mesh: &TriMesh, groups: &Groups, wedges: &Wedges, placed: &Placed) -> Attributes {
    if mesh.attributes == Attributes::default() {
        return Attributes::default();
    }
    let nearest = nearest_vertices(mesh, groups, wedges, placed);
    let mixes = nearest_places(mesh, groups, wedges, placed, &nearest);
    let count = mixes.len() as u32;
    let corner = |k: usize| mixes.iter().map(move |m| m.sources[k]);
    let sources: Vec<u32> = (0..3).flat_map(corner).collect();
    let mut attributes = mesh.attributes.gathered(&sources);
    for (w, mix) in (0..count).zip(&mixes) {
        // A vertex that was not joined keeps its very bits.
        if mix.shares[0] < 1.0 {
            let sources = [w, count + w, 2 * count + w];
            let shares = mix.shares;
            blend(&mut attributes, w, &Mix { sources, shares });
        }
    }
    attributes.gather(&(0..count).collect::<Vec<_>>());
    attributes
}

/// Of every wedge left the vertex that lies nearest to its new position.
fn nearest_vertices(mesh: &TriMesh, groups: &Groups, wedges: &Wedges, placed: &Placed) -> Vec<u32> {
    let mut nearest = vec![(f32::INFINITY, NONE); wedges.points.len()];
    for (v, &position) in mesh.positions.iter().enumerate() {
        let wedge = wedges.number(groups, v as u32);
        if wedge == NONE {
            continue;
        }
        let place = placed.positions[groups.point_of[v] as usize];
        let distance = position.distance_squared(place);
        let best = &mut nearest[wedge as usize];
        if distance < best.0 || best.1 == NONE {
            *best = (distance, v as u32);
        }
    }
    nearest.into_iter().map(|n| n.1).collect()
}

/// The nearest place on the triangles at the nearest vertices, the vertex
/// itself (or the nearest corner) with its share first.
fn nearest_places(
    mesh: &TriMesh,
    groups: &Groups,
    wedges: &Wedges,
    placed: &Placed,
    nearest: &[u32],
) -> Vec<Mix> {
    let at_nearest = |&t: &u32| {
        let triangle = mesh.triangles[t as usize];
        triangle.iter().any(|&v| {
            let wedge = wedges.number(groups, v);
            wedge != NONE && nearest[wedge as usize] == v
        })
    };
    let around: Vec<u32> = (0..mesh.triangles.len() as u32)
        .into_par_iter()
        .with_min_len(CHUNK)
        .filter(at_nearest)
        .collect();
    let alone = |&v: &u32| Mix {
        sources: [v; 3],
        shares: [1.0, 0.0, 0.0],
    };
    let mut best: Vec<(f64, Mix)> = nearest.iter().map(|v| (f64::INFINITY, alone(v))).collect();
    for t in around {
        let (triangle, corners) = (mesh.triangles[t as usize], mesh.corners(t as usize));
        for (k, &v) in triangle.iter().enumerate() {
            let wedge = wedges.number(groups, v);
            if wedge == NONE || nearest[wedge as usize] != v {
                continue;
            }
            let place = placed.positions[wedges.points[wedge as usize] as usize].as_dvec3();
            let shares = closest_barycentric(place, corners);
            let distance = place.distance_squared(interpolate(corners, shares));
            let best = &mut best[wedge as usize];
            if distance < best.0 {
                let turned = |i: usize| (k + i) % 3;
                let mix = Mix {
                    sources: [0, 1, 2].map(|i| triangle[turned(i)]),
                    shares: [0, 1, 2].map(|i| shares[turned(i)]),
                };
                *best = (distance, mix);
            }
        }
    }
    best.into_iter().map(|b| b.1).collect()
}
