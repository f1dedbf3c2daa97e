//! A group made coarser.

use super::ClusterDag;
use super::options::ClusterDagOptions;
use super::source::{Source, numbers};
use super::split::edge_key;
use crate::error::Result;
use crate::geom::Aabb;
use crate::mesh::{Components, MaterialRange, PositionIds, TriMesh};
use crate::progress::Silent;
use crate::simplify::{Placement, Simplified, SimplifyOptions, Stop, Topology, simplify};
use crate::spatial::Bvh;
use glam::DVec3;
use smallvec::SmallVec;

/// A group that keeps more than this share of its triangles is stuck.
const STUCK: f64 = 0.85;

/// How much farther off what lies between the places where distances are
/// measured is taken to be.
const BETWEEN: f64 = 1.1;

/// Which parts of a stuck group may go.
#[derive(Debug, Clone, Copy)]
pub(super) struct Loss {
    /// Most triangles.
    triangles: usize,
    /// Largest diagonal of the box, as a share of that of the group.
    size: f64,
}

impl Loss {
    /// What has come down to a box, more or less, and is small.
    pub const LITTLE: Self = Self {
        triangles: 16,
        size: 0.125,
    };
    /// Once nothing else is left to be done.
    pub const MUCH: Self = Self {
        triangles: usize::MAX,
        size: 0.5,
    };

    pub fn is_little(self) -> bool {
        self.triangles == Self::LITTLE.triangles
    }
}

/// The triangles of one material range.
pub(super) type Part = (u32, Vec<[u32; 3]>);

/// What a group has become.
pub(super) struct Coarse {
    /// In order of their ranges; none is empty.
    pub parts: Vec<Part>,
    /// Distance to what the group was, model units.
    pub deviation: f64,
}

/// Simplifies a group, clusters with their ranges and in order of those, to half
/// of its triangles. Positions for which `is_shared` says so stay. None if the group is stuck.
///
/// # Errors
/// As [`simplify`].
pub(super) fn coarsen(
    source: &Source<'_>,
    dag: &ClusterDag,
    group: &[(u32, u32)],
    is_shared: impl Fn(u32) -> bool,
    options: &ClusterDagOptions<'_>,
    loss: Loss,
) -> Result<Option<Coarse>> {
    let (local, vertices) = local_mesh(source, dag, group);
    let shared = |&v: &u32| is_shared(source.ids.of_vertex[v as usize]);
    let locks: Vec<bool> = vertices.iter().map(shared).collect();
    let count = local.triangles.len();
    let simplified = simplified(&local, &locks, options)?;
    let mut coarse = simplified.mesh;
    let Some(number) = numbers(&local, &coarse) else {
        return Ok(None);
    };
    let is_stuck = |mesh: &TriMesh| mesh.triangles.len() as f64 > STUCK * count as f64;
    if is_stuck(&coarse) && options.topology == Topology::Simplify {
        let held = |v: u32| locks[number[v as usize] as usize];
        drop_small(&mut coarse, count / 2, loss, held)?;
    }
    if coarse.triangles.is_empty() || is_stuck(&coarse) {
        return Ok(None);
    }
    let triangles: Vec<[u32; 3]> = coarse
        .triangles
        .iter()
        .map(|t| t.map(|v| number[v as usize]))
        .collect();
    let linked = |t: &[[u32; 3]]| -> Vec<[u32; 3]> {
        t.iter()
            .map(|t| source.linked(t.map(|v| vertices[v as usize])))
            .collect()
    };
    if !keeps_rim(&linked(&local.triangles), &linked(&triangles), &is_shared) {
        return Ok(None);
    }
    Ok(Some(Coarse {
        deviation: deviation(&local, &coarse, &triangles)?,
        parts: parts_of(&coarse, group, &triangles, &vertices),
    }))
}

/// The mesh with half of its triangles, if it can be had.
fn simplified(
    local: &TriMesh,
    locks: &[bool],
    options: &ClusterDagOptions<'_>,
) -> Result<Simplified> {
    let count = local.triangles.len();
    let options = SimplifyOptions {
        quality: options.quality,
        stop: Stop::triangles(target(count, options.max_triangles)),
        placement: Placement::HalfEdge,
        border: options.border,
        locks: Some(locks),
        attributes: options.attributes,
        topology: options.topology,
        progress: &Silent,
        ..SimplifyOptions::default()
    };
    simplify(local, &options)
}

/// Leaves out the smallest connected parts, as boxes go, until so many
/// triangles are left; neither the last one nor any with vertices that are held.
fn drop_small(
    mesh: &mut TriMesh,
    triangles: usize,
    loss: Loss,
    held: impl Fn(u32) -> bool,
) -> Result<()> {
    let components = Components::of(mesh, &PositionIds::of_mesh(mesh))?;
    let mut boxes = vec![(Aabb::EMPTY, 0usize, false); components.count];
    for (t, &part) in mesh.triangles.iter().zip(&components.of_triangle) {
        let (bounds, count, is_held) = &mut boxes[part as usize];
        for &v in t {
            *bounds = bounds.with(mesh.positions[v as usize]);
            *is_held |= held(v);
        }
        *count += 1;
    }
    let mut order: Vec<usize> = (0..boxes.len()).collect();
    let size = |&part: &usize| boxes[part].0.diagonal();
    order.sort_by(|a, b| size(a).total_cmp(&size(b)));
    order.pop();
    let mut left = mesh.triangles.len();
    let mut goes = vec![false; boxes.len()];
    let whole = boxes.iter().fold(Aabb::EMPTY, |b, part| b.union(part.0));
    let most = loss.size * whole.diagonal();
    let may_go = |part: &usize| {
        let (_, count, is_held) = boxes[*part];
        !is_held && count <= loss.triangles && size(part) <= most
    };
    for part in order.into_iter().filter(may_go) {
        if left <= triangles {
            break;
        }
        goes[part] = true;
        left -= boxes[part].1;
    }
    mesh.retain_triangles(|t| !goes[components.of_triangle[t] as usize]);
    Ok(())
}

/// Half of the triangles, and whole clusters of them where there are several.
fn target(count: usize, cluster: usize) -> usize {
    let half = count / 2;
    if half > 2 * cluster {
        half / cluster * cluster
    } else {
        half.max(1)
    }
}

/// The triangles with their vertices numbered from 0, and those vertices.
fn local_mesh(source: &Source<'_>, dag: &ClusterDag, group: &[(u32, u32)]) -> (TriMesh, Vec<u32>) {
    let canonical = |&v: &u32| source.canonical[v as usize];
    let all = group.iter().flat_map(|&(_, c)| dag.vertices_of(c));
    let mut vertices: Vec<u32> = all.map(canonical).collect();
    vertices.sort_unstable();
    vertices.dedup();
    let mut mesh = source.local(&vertices);
    let number = |v: &u32| vertices.partition_point(|&known| known < canonical(v)) as u32;
    for clusters in group.chunk_by(|a, b| a.0 == b.0) {
        let first = mesh.triangles.len();
        for &(_, c) in clusters {
            let own: SmallVec<[u32; 128]> = dag.vertices_of(c).iter().map(number).collect();
            let corners = dag.corners_of(c).iter();
            mesh.triangles
                .extend(corners.map(|t| t.map(|v| own[usize::from(v)])));
        }
        mesh.ranges.push(MaterialRange {
            first: first as u32,
            count: (mesh.triangles.len() - first) as u32,
            ..MaterialRange::default()
        });
    }
    if mesh.ranges.len() == 1 {
        mesh.ranges.clear();
    }
    (mesh, vertices)
}

fn parts_of(
    coarse: &TriMesh,
    group: &[(u32, u32)],
    triangles: &[[u32; 3]],
    vertices: &[u32],
) -> Vec<Part> {
    let ranges = coarse.ranges_or_whole().into_iter();
    let names = group.chunk_by(|a, b| a.0 == b.0).map(|same| same[0].0);
    let both = ranges.zip(names).filter(|(range, _)| range.count > 0);
    both.map(|(range, name)| {
        let own = triangles[range.triangles()].iter();
        let named = own.map(|t| t.map(|v| vertices[v as usize]));
        (name, named.collect())
    })
    .collect()
}

/// Whether every edge with one triangle between positions that stay still has
/// one: what lies beyond it in another group still meets it. Triangles are by
/// position id.
fn keeps_rim(before: &[[u32; 3]], after: &[[u32; 3]], is_shared: impl Fn(u32) -> bool) -> bool {
    let rim = |triangles: &[[u32; 3]]| -> Vec<u64> {
        let mut edges = Vec::new();
        for &[a, b, c] in triangles
            .iter()
            .filter(|[a, b, c]| a != b && b != c && c != a)
        {
            let [x, y, z] = [a, b, c].map(&is_shared);
            edges.extend((x && y).then(|| edge_key(a, b)));
            edges.extend((y && z).then(|| edge_key(b, c)));
            edges.extend((z && x).then(|| edge_key(c, a)));
        }
        edges.sort_unstable();
        let single = edges.chunk_by(|a, b| a == b).filter(|same| same.len() == 1);
        single.map(|same| same[0]).collect()
    };
    let after = rim(after);
    rim(before)
        .iter()
        .all(|edge| after.binary_search(edge).is_ok())
}

/// Distance between the surfaces: of the vertices that are gone to the coarser
/// one, and of the middles of triangles, and of edges that are new, to the one
/// that was. `left` are its triangles with the vertices of `local`.
fn deviation(local: &TriMesh, coarse: &TriMesh, left: &[[u32; 3]]) -> Result<f64> {
    let mut stays = vec![false; local.positions.len()];
    let corners = left.iter().flatten();
    corners.for_each(|&v| stays[v as usize] = true);
    let gone = local.positions.iter().zip(&stays).filter(|p| !p.1);
    let away = farthest(coarse, gone.map(|p| p.0.as_dvec3()))?;
    let known = edges(&local.triangles);
    let new = edges(left).into_iter();
    let new = new.filter(|edge| known.binary_search(edge).is_err());
    let middle = |edge: u64| {
        let ends = [edge >> 32, edge & 0xffff_ffff];
        let [a, b] = ends.map(|v| local.positions[v as usize].as_dvec3());
        (a + b) * 0.5
    };
    let middles = (0..coarse.triangles.len()).map(|t| {
        let [a, b, c] = coarse.corners(t);
        (a + b + c) / 3.0
    });
    let back = farthest(local, new.map(middle).chain(middles))?;
    Ok(BETWEEN * away.max(back))
}

/// All edges, ascending.
fn edges(triangles: &[[u32; 3]]) -> Vec<u64> {
    let mut edges = Vec::with_capacity(3 * triangles.len());
    for &[a, b, c] in triangles {
        edges.extend([edge_key(a, b), edge_key(b, c), edge_key(c, a)]);
    }
    edges.sort_unstable();
    edges.dedup();
    edges
}

/// Largest distance of the points to the surface of `mesh`.
fn farthest(mesh: &TriMesh, points: impl Iterator<Item = DVec3>) -> Result<f64> {
    let bvh = Bvh::build_quick(mesh)?;
    let (mut slot, mut most) = (0, 0.0f64);
    for point in points {
        // What is no farther than another point need not be known exactly.
        let hit = bvh.closest_or_within(point, slot, most);
        most = most.max(hit.distance_squared);
        slot = hit.slot;
    }
    Ok(most.sqrt())
}
