//! From the simplified surface back to a mesh.

use super::state::State;
use super::wedges::{Normals, Prepared};
use crate::geom::normal_times_two_areas;
use crate::mesh::{Attributes, SkinWeights, TriMesh};
use crate::spatial::Bvh;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// A triangle that is left.
pub(super) struct Left {
    /// Triangle of the input that it has come from; several may from one.
    pub source: u32,
    pub wedges: [u32; 3],
    pub places: [Vec3; 3],
}

/// The mesh that the exact driver has left.
pub(crate) fn output(
    source: &TriMesh,
    prepared: &Prepared,
    state: &State<'_>,
    index: Option<&Bvh>,
) -> TriMesh {
    let surface = &state.surface;
    let left: Vec<Left> = (0..surface.points.len())
        .filter(|&t| surface.is_alive(t))
        .map(|t| Left {
            source: prepared.source_triangle[t],
            wedges: surface.wedges[t],
            places: surface.places(t).map(|p| p.as_vec3()),
        })
        .collect();
    let attributes = state.attributes.clone();
    let wedges = prepared.source_vertex.len();
    assemble(source, (attributes, wedges), prepared.normals, &left, index)
}

/// The mesh that is left: triangles in the input's order, so that ranges stay
/// together, and the vertices they use. `attributes` are those of the wedges, and how many there are.
pub(super) fn assemble(
    source: &TriMesh,
    (attributes, wedges): (Attributes, usize),
    normals: Normals,
    left: &[Left],
    index: Option<&Bvh>,
) -> TriMesh {
    let mut order: Vec<&Left> = left.iter().collect();
    order.sort_by_key(|triangle| triangle.source);
    let mut mesh = TriMesh {
        positions: vec![Vec3::ZERO; wedges],
        triangles: source.triangles.clone(),
        attributes,
        face_attributes: source.face_attributes.clone(),
        ranges: source.ranges.clone(),
    };
    let sources: Vec<u32> = order.iter().map(|triangle| triangle.source).collect();
    mesh.gather_triangles(&sources);
    mesh.triangles = order.iter().map(|triangle| triangle.wedges).collect();
    for triangle in order {
        for (&wedge, place) in triangle.wedges.iter().zip(triangle.places) {
            mesh.positions[wedge as usize] = place;
        }
    }
    mesh.remove_unreferenced_vertices();
    normalise_skins(&mut mesh.attributes.skins);
    match (normals, index) {
        (Normals::Kept, _) => {}
        (Normals::LookedUp, Some(index)) => {
            let normals = looked_up(&mesh, source, index);
            split_by_normals(&mut mesh, &normals, ALIKE);
        }
        _ => {
            let normals: Vec<[Vec3; 3]> = own_normals(&mesh).map(|n| [n; 3]).collect();
            split_by_normals(&mut mesh, &normals, EQUAL);
        }
    }
    mesh
}

/// Makes the skin weights of every vertex sum to 1 over all sets, which those
/// of a file need not do.
fn normalise_skins(skins: &mut [Vec<SkinWeights>]) {
    for v in 0..skins.first().map_or(0, Vec::len) {
        let sum: f32 = skins.iter().flat_map(|set| set[v].weights).sum();
        if sum > 0.0 && (sum - 1.0).abs() > 1e-4 {
            let weights = skins.iter_mut().flat_map(|set| &mut set[v].weights);
            weights.for_each(|w| *w /= sum);
        }
    }
}

/// Cosine above which two normals are one: equal but for rounding.
const EQUAL: f32 = 0.99999;
/// Cosine above which two looked-up normals share a vertex: 11 degrees.
const ALIKE: f32 = 0.98;

fn own_normals(mesh: &TriMesh) -> impl Iterator<Item = Vec3> + '_ {
    (0..mesh.triangles.len()).map(|t| own_normal(mesh, t))
}

fn own_normal(mesh: &TriMesh, t: usize) -> Vec3 {
    normal_times_two_areas(mesh.corners(t))
        .normalize_or(DVec3::Z)
        .as_vec3()
}

/// The input's normal next to every corner, looked up a little inside the
/// triangle so that it is the one of the right side of a hard edge.
fn looked_up(mesh: &TriMesh, source: &TriMesh, index: &Bvh) -> Vec<[Vec3; 3]> {
    let normals = source.attributes.normals.as_deref().unwrap_or_default();
    let at = |place: DVec3| {
        let hit = index.closest(place);
        let corners = source.triangles[hit.triangle as usize];
        let part = |k: usize| normals[corners[k] as usize].as_dvec3() * hit.barycentric[k];
        (part(0) + part(1) + part(2)).normalize_or_zero().as_vec3()
    };
    let triangle = |t: usize| {
        let corners = mesh.corners(t);
        let center = (corners[0] + corners[1] + corners[2]) / 3.0;
        let own = own_normal(mesh, t);
        corners.map(|corner| {
            let found = at(corner.lerp(center, 0.1));
            if found.dot(own) > 0.2 { found } else { own }
        })
    };
    (0..mesh.triangles.len())
        .into_par_iter()
        .map(triangle)
        .collect()
}

/// Gives every corner its normal; corners at one vertex whose normals are
/// alike stay one vertex, which gets their mean.
fn split_by_normals(mesh: &mut TriMesh, normals: &[[Vec3; 3]], alike: f32) {
    let count = mesh.positions.len();
    let mut sources: Vec<u32> = (0..count as u32).collect();
    let mut first: Vec<Option<Vec3>> = vec![None; count];
    let mut sums = vec![Vec3::ZERO; count];
    let mut copies: Vec<Vec<u32>> = vec![Vec::new(); count];
    for (triangle, normals) in mesh.triangles.iter_mut().zip(normals) {
        for (corner, &normal) in triangle.iter_mut().zip(normals) {
            let v = *corner;
            let same = |&u: &u32| first[u as usize].is_none_or(|n| n.dot(normal) > alike);
            let others = &mut copies[v as usize];
            let known = std::iter::once(v).chain(others.iter().copied()).find(same);
            *corner = known.unwrap_or_else(|| {
                let new = sources.len() as u32;
                sources.push(v);
                first.push(None);
                sums.push(Vec3::ZERO);
                others.push(new);
                new
            });
            first[*corner as usize].get_or_insert(normal);
            sums[*corner as usize] += normal;
        }
    }
    mesh.gather_vertices(&sources);
    let unit = |n: Vec3| n.try_normalize().unwrap_or(Vec3::Z);
    mesh.attributes.normals = Some(sums.into_iter().map(unit).collect());
    straighten_tangents(mesh);
}

/// Makes tangents orthogonal to the new normals again.
fn straighten_tangents(mesh: &mut TriMesh) {
    let attributes = &mut mesh.attributes;
    if let (Some(normals), Some(tangents)) = (&attributes.normals, &mut attributes.tangents) {
        for (tangent, &normal) in tangents.iter_mut().zip(normals) {
            let t = tangent.truncate();
            let straight = (t - normal * normal.dot(t)).try_normalize();
            *tangent = straight
                .unwrap_or_else(|| normal.any_orthonormal_vector())
                .extend(tangent.w);
        }
    }
}
