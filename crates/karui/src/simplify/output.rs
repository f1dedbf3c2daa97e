//! From the simplified surface back to a mesh.

use super::state::State;
use super::wedges::Prepared;
use crate::geom::normal_times_two_areas;
use crate::mesh::TriMesh;
use glam::Vec3;

/// The mesh that is left: triangles in the input's order, so that ranges stay
/// together, and the vertices they use.
pub(crate) fn output(source: &TriMesh, prepared: &Prepared, state: &State<'_>) -> TriMesh {
    let surface = &state.surface;
    let mut mesh = TriMesh {
        positions: vec![Vec3::ZERO; prepared.source_vertex.len()],
        triangles: vec![[0; 3]; source.triangles.len()],
        attributes: state.attributes.clone(),
        face_attributes: source.face_attributes.clone(),
        ranges: source.ranges.clone(),
    };
    let mut alive = vec![false; source.triangles.len()];
    for (t, &from) in prepared.source_triangle.iter().enumerate() {
        if surface.is_alive(t) {
            alive[from as usize] = true;
            mesh.triangles[from as usize] = surface.wedges[t];
            for (&wedge, &point) in surface.wedges[t].iter().zip(&surface.points[t]) {
                mesh.positions[wedge as usize] = surface.position[point as usize].as_vec3();
            }
        }
    }
    mesh.retain_triangles(|t| alive[t]);
    mesh.remove_unreferenced_vertices();
    if prepared.flat {
        shade_flat(&mut mesh);
    }
    mesh
}

/// Gives every triangle its own normal; vertices whose triangles agree stay
/// shared.
fn shade_flat(mesh: &mut TriMesh) {
    let count = mesh.positions.len();
    let mut sources: Vec<u32> = (0..count as u32).collect();
    let mut normals: Vec<Option<Vec3>> = vec![None; count];
    let mut copies: Vec<Vec<u32>> = vec![Vec::new(); count];
    for t in 0..mesh.triangles.len() {
        let normal = normal_times_two_areas(mesh.corners(t))
            .normalize_or(glam::DVec3::Z)
            .as_vec3();
        for k in 0..3 {
            let v = mesh.triangles[t][k] as usize;
            let same = |&u: &u32| normals[u as usize].is_none_or(|n| n.dot(normal) > 0.99999);
            let known = std::iter::once(v as u32)
                .chain(copies[v].iter().copied())
                .find(same);
            let vertex = known.unwrap_or_else(|| {
                let new = sources.len() as u32;
                sources.push(v as u32);
                normals.push(None);
                copies[v].push(new);
                new
            });
            normals[vertex as usize].get_or_insert(normal);
            mesh.triangles[t][k] = vertex;
        }
    }
    mesh.gather_vertices(&sources);
    mesh.attributes.normals = Some(normals.into_iter().map(|n| n.unwrap_or(Vec3::Z)).collect());
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
