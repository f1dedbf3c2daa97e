//! How sound a triangle mesh is, in counts.

use super::sides::sorted_sides;
use crate::error::{Error, Result};
use crate::geom::normal_times_two_areas;
use crate::mesh::{PositionIds, TriMesh};
use crate::spatial::Bvh;
use glam::DVec3;
use rayon::prelude::*;

/// Counts of what is wrong or odd with a mesh, vertices at exactly one
/// position taken as one.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Quality {
    /// Distinct positions of vertices, used by triangles or not.
    pub positions: usize,
    /// Triangles, degenerate ones included.
    pub triangles: usize,
    /// Edges of one triangle only.
    pub boundary_edges: usize,
    /// Edges of three triangles or more.
    pub non_manifold_edges: usize,
    /// Triangles with two corners at one position, or a shape below 1e-6.
    pub degenerate_triangles: usize,
    /// Triangles with the corners of an earlier one, whichever way around.
    pub duplicate_triangles: usize,
    /// Triangles with a shape below 0.1, degenerate ones included.
    pub slivers: usize,
    /// Mean shape: `4 A / (sqrt(3) l^2)` with area `A` and longest side `l`, 1
    /// for equilateral triangles and 0 for degenerate ones; 0 without any.
    pub mean_shape: f64,
}

/// Counts what is wrong with `mesh`. Edges and duplicates are counted among
/// the triangles whose corners lie at three positions.
///
/// # Errors
/// [`Error::IndexOutOfRange`] for a triangle that names no vertex.
pub fn quality(mesh: &TriMesh) -> Result<Quality> {
    check_indices(mesh)?;
    let ids = PositionIds::of_mesh(mesh);
    let welded = ids.triangles(&mesh.triangles);
    let triangles = mesh.triangles.par_iter();
    let shapes: Vec<f64> = triangles.map(|&t| shape(corners(mesh, t))).collect();
    let bad = |(&t, &shape): (&[u32; 3], &f64)| !is_proper(t) || shape < 1e-6;
    let proper: Vec<[u32; 3]> = welded.iter().copied().filter(|&t| is_proper(t)).collect();
    let sides = sorted_sides(&proper);
    let sides_where = |wanted: fn(usize) -> bool| {
        let groups = sides.chunk_by(|a, b| a == b);
        groups.filter(|group| wanted(group.len())).count()
    };
    Ok(Quality {
        positions: ids.count,
        triangles: welded.len(),
        boundary_edges: sides_where(|n| n == 1),
        non_manifold_edges: sides_where(|n| n > 2),
        degenerate_triangles: welded.iter().zip(&shapes).filter(|&x| bad(x)).count(),
        duplicate_triangles: duplicates(proper),
        slivers: shapes.iter().filter(|&&shape| shape < 0.1).count(),
        mean_shape: shapes.iter().sum::<f64>() / shapes.len().max(1) as f64,
    })
}

/// Triangles of `simplified` that face away from the original: the normal of
/// the original triangle nearest to the centroid points the other way.
/// Triangles without area never count.
///
/// # Errors
/// [`Error::IndexOutOfRange`] for a triangle that names no vertex.
pub fn flipped(simplified: &TriMesh, original: &Bvh) -> Result<usize> {
    check_indices(simplified)?;
    let faces_away = |&triangle: &[u32; 3]| {
        let corners = corners(simplified, triangle);
        let [a, b, c] = corners;
        let nearest = original.closest((a + b + c) / 3.0);
        let theirs = normal_times_two_areas(original.corners(nearest.slot));
        normal_times_two_areas(corners).dot(theirs) < 0.0
    };
    Ok(simplified
        .triangles
        .par_iter()
        .filter(|t| faces_away(t))
        .count())
}

fn check_indices(mesh: &TriMesh) -> Result<()> {
    let vertices = mesh.positions.len();
    for (face, triangle) in mesh.triangles.iter().enumerate() {
        if let Some(&index) = triangle.iter().find(|&&v| v as usize >= vertices) {
            return Err(Error::IndexOutOfRange {
                face,
                index,
                vertices,
            });
        }
    }
    Ok(())
}

fn corners(mesh: &TriMesh, triangle: [u32; 3]) -> [DVec3; 3] {
    triangle.map(|v| mesh.positions[v as usize].as_dvec3())
}

fn is_proper([a, b, c]: [u32; 3]) -> bool {
    a != b && b != c && c != a
}

/// 1 for an equilateral triangle, 0 for one without area or number.
fn shape(corners: [DVec3; 3]) -> f64 {
    let [a, b, c] = corners;
    let longest = [(a, b), (b, c), (c, a)]
        .map(|(p, q)| p.distance_squared(q))
        .into_iter()
        .fold(0.0, f64::max);
    let shape = 2.0 * normal_times_two_areas(corners).length() / (3f64.sqrt() * longest);
    if shape.is_finite() { shape } else { 0.0 }
}

fn duplicates(mut triangles: Vec<[u32; 3]>) -> usize {
    triangles.iter_mut().for_each(|t| t.sort_unstable());
    triangles.par_sort_unstable();
    let all = triangles.len();
    triangles.dedup();
    all - triangles.len()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn points(list: &[[f32; 3]]) -> Vec<Vec3> {
        list.iter().map(|&p| Vec3::from(p)).collect()
    }

    #[test]
    fn a_closed_tetrahedron_is_sound() {
        let p = points(&[[1., 1., 1.], [1., -1., -1.], [-1., 1., -1.], [-1., -1., 1.]]);
        let mesh = TriMesh::new(p, vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]]);
        let found = quality(&mesh).unwrap();
        assert!((found.mean_shape - 1.0).abs() < 1e-12);
        let expected = Quality {
            positions: 4,
            triangles: 4,
            mean_shape: found.mean_shape,
            ..Quality::default()
        };
        assert_eq!(found, expected);
    }

    #[test]
    fn every_defect_is_counted() {
        let p = points(&[
            [0., 0., 0.],
            [1., 0., 0.],
            [0., 1., 0.],
            [0., -1., 0.],
            [0., 0., 1.],
            [0.5, 0.01, 3.],
            [0., 0., 3.],
            [1., 0., 3.],
            [1., 0., 0.],
        ]);
        let fan = [[0, 1, 2], [1, 0, 3], [0, 8, 4]];
        let odd = [[2, 1, 0], [5, 6, 7], [1, 8, 2], [3, 3, 3]];
        let mesh = TriMesh::new(p, [&fan[..], &odd[..]].concat());
        let found = quality(&mesh).unwrap();
        assert_eq!(found.positions, 8);
        assert_eq!(found.non_manifold_edges, 1);
        // Two sides each of the second and third, three of the sliver.
        assert_eq!(found.boundary_edges, 7);
        assert_eq!(found.degenerate_triangles, 2);
        assert_eq!(found.duplicate_triangles, 1);
        assert_eq!(found.slivers, 3);
    }

    #[test]
    fn turned_triangles_are_flipped() {
        let p = points(&[[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [1., 1., 0.1]]);
        let mesh = TriMesh::new(p, vec![[0, 1, 2], [2, 1, 3]]);
        let original = Bvh::build(&mesh).unwrap();
        assert_eq!(flipped(&mesh, &original), Ok(0));
        let mut turned = mesh.clone();
        turned.triangles[1] = [1, 2, 3];
        turned.triangles.push([0, 0, 1]);
        assert_eq!(flipped(&turned, &original), Ok(1));
    }

    #[test]
    fn bad_input_is_an_error_or_counted() {
        let stray = TriMesh::new(points(&[[0.; 3]]), vec![[0, 0, 1]]);
        assert!(matches!(
            quality(&stray),
            Err(Error::IndexOutOfRange { .. })
        ));
        let nan = TriMesh::new(vec![Vec3::NAN, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
        assert_eq!(quality(&nan).unwrap().degenerate_triangles, 1);
        assert_eq!(quality(&TriMesh::default()), Ok(Quality::default()));
    }
}
