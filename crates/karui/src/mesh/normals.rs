//! Vertex normals from the triangles around each vertex.

use super::{PositionIds, TriMesh};
use crate::error::Result;
use crate::geom;
use glam::{DVec3, Vec3};

/// How much each triangle counts for the normal of its corners.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum NormalWeight {
    /// By its angle at the corner, so that the result does not depend on how a
    /// flat face is cut into triangles (Thürmer and Wüthrich, "Computing
    /// Vertex Normals from Polygonal Facets", 1998).
    #[default]
    Angle,
    /// By its area.
    Area,
}

/// Unit normal of every vertex of `mesh`. Vertices with one id share their
/// normal: link them with [`PositionIds::of_mesh`] for a smooth surface across
/// seams, with [`PositionIds::distinct`] to keep seams sharp. Where no triangle
/// with an area meets, or all cancel out, the normal is +z.
///
/// # Errors
/// [`Error::IndexOutOfRange`](crate::Error::IndexOutOfRange) or, if `ids`
/// belong to another mesh, [`Error::LengthMismatch`](crate::Error::LengthMismatch).
pub fn vertex_normals(
    mesh: &TriMesh,
    ids: &PositionIds,
    weight: NormalWeight,
) -> Result<Vec<Vec3>> {
    ids.validate_for(mesh)?;
    let mut sums = vec![DVec3::ZERO; ids.count];
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        let corners = mesh.corners(t);
        let two_areas = geom::normal_times_two_areas(corners);
        for (k, &v) in triangle.iter().enumerate() {
            let share = match weight {
                NormalWeight::Area => two_areas,
                NormalWeight::Angle => two_areas.normalize_or_zero() * angle_at(corners, k),
            };
            sums[ids.of_vertex[v as usize] as usize] += share;
        }
    }
    let unit = |id: &u32| {
        sums[*id as usize]
            .try_normalize()
            .unwrap_or(DVec3::Z)
            .as_vec3()
    };
    Ok(ids.of_vertex.iter().map(unit).collect())
}

fn angle_at(corners: [DVec3; 3], k: usize) -> f64 {
    let from = corners[k];
    let (a, b) = (corners[(k + 1) % 3] - from, corners[(k + 2) % 3] - from);
    a.cross(b).length().atan2(a.dot(b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes;

    #[test]
    fn normals_of_a_fine_sphere_point_away_from_its_centre() {
        for weight in [NormalWeight::Angle, NormalWeight::Area] {
            let mesh = shapes::textured_sphere(60, 120);
            let ids = PositionIds::of_mesh(&mesh);
            let normals = vertex_normals(&mesh, &ids, weight).unwrap();
            for (n, p) in normals.iter().zip(&mesh.positions) {
                assert!(n.distance(*p) < 0.01, "{weight:?} {n} {p}");
            }
        }
    }

    #[test]
    fn corners_of_a_cube_do_not_depend_on_its_diagonals() {
        let mesh = shapes::cube(1);
        let ids = PositionIds::of_mesh(&mesh);
        let normals = vertex_normals(&mesh, &ids, NormalWeight::Angle).unwrap();
        for (n, p) in normals.iter().zip(&mesh.positions) {
            assert!(n.distance(p.normalize()) < 1e-6, "{n} {p}");
        }
        let apart = PositionIds::distinct(mesh.positions.len());
        let normals = vertex_normals(&mesh, &apart, NormalWeight::Area).unwrap();
        assert_eq!(Some(normals), mesh.attributes.normals);
    }

    #[test]
    fn every_normal_is_a_unit_vector() {
        for (name, mesh) in shapes::zoo() {
            let ids = PositionIds::of_mesh(&mesh);
            for n in vertex_normals(&mesh, &ids, NormalWeight::Angle).unwrap() {
                assert!((n.length() - 1.0).abs() < 1e-6, "{name}");
            }
        }
    }
}
