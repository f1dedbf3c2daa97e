//! From a mesh of vertices to a surface of points and wedges.

use super::{sheets, surface::Surface};
use crate::geom::normal_times_two_areas;
use crate::mesh::{Attribute, AttributeValues, Attributes, MorphTarget, PositionIds, TriMesh};
use glam::{DVec3, Vec3};
use smallvec::SmallVec;

/// A mesh made ready to be simplified.
pub(crate) struct Prepared {
    /// Its points, wedges and triangles.
    pub surface: Surface,
    /// Vertex of the source mesh that every wedge stands for.
    pub source_vertex: Vec<u32>,
    /// Triangle of the source mesh that every triangle stands for.
    pub source_triangle: Vec<u32>,
    /// What becomes of the normals.
    pub normals: Normals,
}

/// What becomes of the normals. Where they break along so many edges that
/// hardly one could collapse, breaks in them are no seams.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Normals {
    /// They are attributes like any other.
    Kept,
    /// Flat shading: every triangle gets its own at the end.
    Flat,
    /// At the end they are looked up on the input's surface.
    LookedUp,
}

/// Links equal vertices, leaves out triangles without area of their own and
/// splits points that join several fans. The mesh must be valid.
pub(crate) fn prepare(mesh: &TriMesh) -> Prepared {
    let ids = PositionIds::of_mesh(mesh);
    let (class, normals) = classes(mesh, &ids);
    let range_of = mesh.range_of_triangles();
    let all: Vec<u32> = (0..mesh.triangles.len() as u32).collect();
    let kept = distinct_triangles(mesh, &ids, &all, &class, &range_of);
    let (points, position_of) = sheets::points(mesh, &ids, &kept, &range_of);
    let first = ids.first_vertices();
    let place = |&id: &u32| mesh.positions[first[id as usize] as usize].as_dvec3();
    let positions: Vec<DVec3> = position_of.iter().map(place).collect();
    let (wedges, source_vertex) = wedges(mesh, &class, &kept, &points);
    Prepared {
        surface: Surface::new(positions, points, wedges),
        source_vertex,
        source_triangle: kept,
        normals,
    }
}

/// What stands for every vertex, and what becomes of the normals.
pub(crate) fn classes(mesh: &TriMesh, ids: &PositionIds) -> (Classes, Normals) {
    let whole = Classes::of(mesh, ids, false);
    if mesh.attributes.normals.is_none() && mesh.attributes.tangents.is_none() {
        return (whole, Normals::Kept);
    }
    let shape = Classes::of(mesh, ids, true);
    match shape.count * 10 < whole.count * 9 {
        false => (whole, Normals::Kept),
        true if is_flat_shaded(mesh) => (shape, Normals::Flat),
        true => (shape, Normals::LookedUp),
    }
}

/// Vertices grouped by position and attributes; the first stands for all.
pub(crate) struct Classes {
    pub of_vertex: Vec<u32>,
    count: usize,
}

impl Classes {
    fn of(mesh: &TriMesh, ids: &PositionIds, without_normals: bool) -> Self {
        let n = mesh.positions.len();
        let mut of_vertex: Vec<u32> = (0..n as u32).collect();
        let mut at_position = vec![SmallVec::<[u32; 2]>::new(); ids.count];
        let mut count = 0;
        for v in 0..n as u32 {
            let known = &mut at_position[ids.of_vertex[v as usize] as usize];
            // Far more different vertices at one place are noise; they stay apart.
            let recent = known.iter().rev().take(64);
            let same = |&&k: &&u32| equal(&mesh.attributes, k, v, without_normals);
            match recent.clone().find(same) {
                Some(&k) => of_vertex[v as usize] = k,
                None => {
                    known.push(v);
                    count += 1;
                }
            }
        }
        Self { of_vertex, count }
    }
}

fn equal(attributes: &Attributes, a: u32, b: u32, without_normals: bool) -> bool {
    let (a, b) = (a as usize, b as usize);
    let shading = without_normals
        || (same(attributes.normals.as_deref(), a, b)
            && same(attributes.tangents.as_deref(), a, b));
    shading
        && attributes.uvs.iter().all(|set| set[a] == set[b])
        && attributes.colors.iter().all(|set| set[a] == set[b])
        && attributes.skins.iter().all(|set| set[a] == set[b])
        && attributes
            .morphs
            .iter()
            .all(|m| equal_morph(m, a, b, without_normals))
        && attributes.custom.iter().all(|c| equal_custom(c, a, b))
}

fn same<T: PartialEq>(values: Option<&[T]>, a: usize, b: usize) -> bool {
    values.is_none_or(|v| v[a] == v[b])
}

fn equal_morph(morph: &MorphTarget, a: usize, b: usize, without_normals: bool) -> bool {
    same(morph.positions.as_deref(), a, b)
        && (without_normals
            || (same(morph.normals.as_deref(), a, b) && same(morph.tangents.as_deref(), a, b)))
}

fn equal_custom(attribute: &Attribute, a: usize, b: usize) -> bool {
    let n = attribute.components;
    let at = |i: usize| i * n..(i + 1) * n;
    match &attribute.values {
        AttributeValues::I8(v) => v[at(a)] == v[at(b)],
        AttributeValues::U8(v) => v[at(a)] == v[at(b)],
        AttributeValues::I16(v) => v[at(a)] == v[at(b)],
        AttributeValues::U16(v) => v[at(a)] == v[at(b)],
        AttributeValues::I32(v) => v[at(a)] == v[at(b)],
        AttributeValues::U32(v) => v[at(a)] == v[at(b)],
        AttributeValues::F32(v) => v[at(a)] == v[at(b)],
        AttributeValues::F64(v) => v[at(a)] == v[at(b)],
    }
}

/// Whether triangles are shaded flat, nearly all: one normal for all three
/// corners, more or less their own (that of a quad, say).
fn is_flat_shaded(mesh: &TriMesh) -> bool {
    let Some(normals) = &mesh.attributes.normals else {
        return false;
    };
    let (mut flat, mut all) = (0usize, 0usize);
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        let face = normal_times_two_areas(mesh.corners(t))
            .as_vec3()
            .normalize_or_zero();
        if face != Vec3::ZERO {
            let [a, b, c] = triangle.map(|v| normals[v as usize]);
            all += 1;
            flat += usize::from(a.dot(b) > 0.9998 && a.dot(c) > 0.9998 && a.dot(face) > 0.7);
        }
    }
    flat * 20 >= all * 19
}

/// Those of the triangles `candidates` that have three different positions,
/// each once.
pub(super) fn distinct_triangles(
    mesh: &TriMesh,
    ids: &PositionIds,
    candidates: &[u32],
    class: &Classes,
    range_of: &[u32],
) -> Vec<u32> {
    let mut keyed: Vec<([u32; 3], u32, u32)> = Vec::with_capacity(candidates.len());
    for &t in candidates {
        let triangle = mesh.triangles[t as usize];
        let [a, b, c] = triangle.map(|v| ids.of_vertex[v as usize]);
        if a != b && b != c && c != a {
            let wedges = triangle.map(|v| class.of_vertex[v as usize]);
            keyed.push((least_first(wedges), range_of[t as usize], t));
        }
    }
    keyed.sort_unstable();
    keyed.dedup_by_key(|k| (k.0, k.1));
    let mut kept: Vec<u32> = keyed.into_iter().map(|k| k.2).collect();
    kept.sort_unstable();
    kept
}

/// The corners turned so that the least comes first.
pub(super) fn least_first([a, b, c]: [u32; 3]) -> [u32; 3] {
    if a < b && a < c {
        [a, b, c]
    } else if b < c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

/// Wedges of every triangle, each the property of one point, and the vertex
/// each stands for, in the order of the vertices.
fn wedges(
    mesh: &TriMesh,
    class: &Classes,
    kept: &[u32],
    points: &[[u32; 3]],
) -> (Vec<[u32; 3]>, Vec<u32>) {
    let mut keyed: Vec<(u32, u32, u32)> = Vec::with_capacity(kept.len() * 3);
    for (i, &t) in kept.iter().enumerate() {
        for (k, &v) in mesh.triangles[t as usize].iter().enumerate() {
            let vertex = class.of_vertex[v as usize];
            keyed.push((points[i][k], vertex, (3 * i + k) as u32));
        }
    }
    keyed.sort_unstable_by_key(|&(point, vertex, corner)| (vertex, point, corner));
    let mut wedges = vec![[0; 3]; kept.len()];
    let mut source = Vec::new();
    for one in keyed.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        for &(_, _, corner) in one {
            wedges[corner as usize / 3][corner as usize % 3] = source.len() as u32;
        }
        source.push(one[0].1);
    }
    (wedges, source)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes;

    #[test]
    fn an_unindexed_mesh_is_linked_again() {
        let mut mesh = shapes::icosphere(2);
        let corners: Vec<u32> = mesh.triangles.iter().flatten().copied().collect();
        let points = mesh.positions.len();
        mesh.gather_vertices(&corners);
        mesh.triangles = (0..mesh.triangles.len() as u32)
            .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
            .collect();
        let prepared = prepare(&mesh);
        assert_eq!(prepared.surface.position.len(), points);
        assert_eq!(prepared.source_vertex.len(), points);
    }

    #[test]
    fn duplicate_and_degenerate_triangles_are_left_out() {
        let p = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        let mesh = TriMesh::new(p, vec![[0, 1, 2], [1, 2, 0], [0, 1, 1]]);
        let prepared = prepare(&mesh);
        assert_eq!(prepared.source_triangle, [0]);
    }
}
