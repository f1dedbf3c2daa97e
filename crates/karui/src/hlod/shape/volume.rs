//! What a closed surface encloses.

use crate::geom::DVec3;
use crate::mesh::{PositionIds, TriMesh};

/// Volume within the triangles, by the theorem of Gauss; `None` unless every edge
/// is run through as often one way as the other, which is what the theorem asks
/// of a surface. `center` is somewhere near, for precision.
pub(super) fn enclosed(mesh: &TriMesh, ids: &PositionIds, center: DVec3) -> Option<f64> {
    if mesh.triangles.is_empty() || !is_closed(&ids.triangles(&mesh.triangles)) {
        return None;
    }
    let six_volumes = |t| {
        let [a, b, c] = mesh.corners(t).map(|p| p - center);
        a.dot(b.cross(c))
    };
    let sum: f64 = (0..mesh.triangles.len()).map(six_volumes).sum();
    Some(sum.abs() / 6.0)
}

fn is_closed(triangles: &[[u32; 3]]) -> bool {
    let ways = triangles
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    // The edge, and whether it is run through from its lesser end.
    let mut edges: Vec<([u32; 2], bool)> = ways
        .filter(|[a, b]| a != b)
        .map(|[a, b]| ([a.min(b), a.max(b)], a < b))
        .collect();
    edges.sort_unstable();
    let same = |a: &([u32; 2], bool), b: &([u32; 2], bool)| a.0 == b.0;
    let balanced = |edge: &[([u32; 2], bool)]| {
        2 * edge.iter().filter(|(_, forth)| *forth).count() == edge.len()
    };
    edges.chunk_by(same).all(balanced)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes;

    fn volume(mesh: &TriMesh) -> Option<f64> {
        enclosed(mesh, &PositionIds::of_mesh(mesh), DVec3::ONE)
    }

    #[test]
    fn closed_shapes_have_their_volume() {
        let torus = volume(&shapes::torus(2.0, 0.5, 300, 300)).unwrap();
        assert!(
            (torus - std::f64::consts::PI.powi(2)).abs() < 0.01,
            "{torus}"
        );
        // Closed but for a seam of its texture.
        let sphere = volume(&shapes::textured_sphere(100, 200)).unwrap();
        assert!((sphere - 4.0 / 3.0 * std::f64::consts::PI).abs() < 0.01);
        let mut inside_out = shapes::closed_cube(3);
        inside_out.triangles.iter_mut().for_each(|t| t.swap(0, 1));
        assert!((volume(&inside_out).unwrap() - 1.0).abs() < 1e-6);
    }

    #[test]
    fn what_is_open_encloses_nothing() {
        for mesh in [
            shapes::triangle(),
            shapes::moebius(24, 4),
            shapes::flipped_face(),
            shapes::grid(3, 3),
            shapes::empty(),
        ] {
            assert_eq!(volume(&mesh), None);
        }
    }
}
