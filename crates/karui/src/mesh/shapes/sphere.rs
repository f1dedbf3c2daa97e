//! Spheres without attributes.

use super::{super::TriMesh, quads, turn};
use glam::{DVec3, Vec3};

/// A closed unit sphere of `rings` bands from pole to pole (at least 2) and
/// `segments` around (at least 3): `2 + (rings - 1) * segments` vertices,
/// `2 * segments * (rings - 1)` triangles.
#[must_use]
pub fn uv_sphere(rings: u32, segments: u32) -> TriMesh {
    let (rings, segments) = (rings.max(2), segments.max(3));
    let mut positions = vec![sphere_point(0, 0, rings, segments)];
    for j in 1..rings {
        positions.extend((0..segments).map(|i| sphere_point(i, j, rings, segments)));
    }
    positions.push(sphere_point(0, rings, rings, segments));
    let north_pole = positions.len() as u32 - 1;
    let triangles = quads(segments, rings, |i, j| match j {
        0 => 0,
        j if j == rings => north_pole,
        j => 1 + (j - 1) * segments + i % segments,
    });
    TriMesh::new(positions, triangles)
}

/// Point `i` of `segments` around and `j` of `rings` up from the south pole.
pub(super) fn sphere_point(i: u32, j: u32, rings: u32, segments: u32) -> Vec3 {
    let (radius, minus_height) = turn(j, 2 * rings);
    let (sin, cos) = turn(i, segments);
    // Adding zero turns -0 into 0, so that points at one place have equal bits.
    (DVec3::new(radius * cos, -minus_height, -radius * sin) + 0.0).as_vec3()
}

/// A closed unit sphere made by splitting each triangle of an icosahedron in
/// four, `subdivisions` times (at most 12): `10 * 4^n + 2` vertices,
/// `20 * 4^n` triangles.
#[must_use]
pub fn icosphere(subdivisions: u32) -> TriMesh {
    let mut mesh = icosahedron();
    for _ in 0..subdivisions.min(12) {
        mesh = split_in_four(&mesh);
    }
    mesh
}

fn icosahedron() -> TriMesh {
    let golden = f64::midpoint(1.0, 5f64.sqrt());
    let mut positions = Vec::with_capacity(12);
    for (a, b) in [
        (-1.0, golden),
        (1.0, golden),
        (-1.0, -golden),
        (1.0, -golden),
    ] {
        for p in [
            DVec3::new(a, b, 0.0),
            DVec3::new(0.0, a, b),
            DVec3::new(b, 0.0, a),
        ] {
            positions.push(p.normalize().as_vec3());
        }
    }
    let triangles = nearest_triples(&positions);
    TriMesh::new(positions, triangles)
}

/// The faces of an icosahedron: all triples of vertices next to each other.
fn nearest_triples(positions: &[Vec3]) -> Vec<[u32; 3]> {
    let near = |a: usize, b: usize| positions[a].distance_squared(positions[b]) < 1.5;
    let mut triangles = Vec::with_capacity(20);
    for a in 0..positions.len() {
        for b in a + 1..positions.len() {
            for c in b + 1..positions.len() {
                if near(a, b) && near(b, c) && near(c, a) {
                    triangles.push(outward([a, b, c], positions));
                }
            }
        }
    }
    triangles
}

fn outward([a, b, c]: [usize; 3], positions: &[Vec3]) -> [u32; 3] {
    let det = positions[a].dot(positions[b].cross(positions[c]));
    let (b, c) = if det > 0.0 { (b, c) } else { (c, b) };
    [a, b, c].map(|v| v as u32)
}

fn split_in_four(mesh: &TriMesh) -> TriMesh {
    let mut edges: Vec<[u32; 2]> = mesh.triangles.iter().flat_map(edges_of).collect();
    edges.sort_unstable();
    edges.dedup();
    let mut positions = mesh.positions.clone();
    let place = |v: u32| mesh.positions[v as usize].as_dvec3();
    let middle = |&[a, b]: &[u32; 2]| (place(a) + place(b)).normalize().as_vec3();
    positions.extend(edges.iter().map(middle));
    let first = mesh.positions.len();
    let index = |edge: [u32; 2]| (first + edges.partition_point(|&e| e < edge)) as u32;
    let mut triangles = Vec::with_capacity(4 * mesh.triangles.len());
    for triangle in &mesh.triangles {
        let [a, b, c] = *triangle;
        let [ab, bc, ca] = edges_of(triangle).map(index);
        triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    TriMesh::new(positions, triangles)
}

fn edges_of(&[a, b, c]: &[u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_follow_the_formulas() {
        let sphere = uv_sphere(5, 7);
        assert_eq!(sphere.positions.len(), 2 + 4 * 7);
        assert_eq!(sphere.triangles.len(), 2 * 7 * 4);
        for n in 0..4 {
            let sphere = icosphere(n);
            assert_eq!(sphere.positions.len(), 10 * 4usize.pow(n) + 2);
            assert_eq!(sphere.triangles.len(), 20 * 4usize.pow(n));
        }
    }

    #[test]
    fn points_lie_on_the_unit_sphere() {
        for mesh in [uv_sphere(9, 14), icosphere(3)] {
            for p in mesh.positions {
                assert!((p.as_dvec3().length() - 1.0).abs() < 1e-7, "{p}");
            }
        }
    }
}
