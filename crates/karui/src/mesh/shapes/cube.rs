//! Cubes, with and without seams.

use super::{super::TriMesh, quads};
use glam::{IVec3, Vec2, Vec3};

/// Right, up and outward direction of each face.
const FACES: [[IVec3; 3]; 6] = [
    [IVec3::NEG_Z, IVec3::Y, IVec3::X],
    [IVec3::Z, IVec3::Y, IVec3::NEG_X],
    [IVec3::X, IVec3::NEG_Z, IVec3::Y],
    [IVec3::X, IVec3::Z, IVec3::NEG_Y],
    [IVec3::X, IVec3::Y, IVec3::Z],
    [IVec3::NEG_X, IVec3::Y, IVec3::NEG_Z],
];

/// The cube from -0.5 to 0.5, `n` quads (at least 1) along every edge, each
/// face with its own vertices, normals and the whole UV square: `6 (n + 1)^2`
/// vertices (24 for `n` = 1), `12 n^2` triangles.
#[must_use]
pub fn cube(n: u32) -> TriMesh {
    let n = n.max(1);
    let mut mesh = TriMesh::default();
    let (mut normals, mut uvs) = (Vec::new(), Vec::new());
    for face in FACES {
        let first = mesh.positions.len() as u32;
        for (i, j) in lattice(n) {
            mesh.positions.push(on_face(face, i, j, n));
            normals.push(face[2].as_vec3());
            uvs.push(Vec2::new(i as f32, (n - j) as f32) / n as f32);
        }
        let triangles = quads(n, n, |i, j| first + j * (n + 1) + i);
        mesh.triangles.extend(triangles);
    }
    mesh.attributes.normals = Some(normals);
    mesh.attributes.uvs = vec![uvs];
    mesh
}

fn lattice(n: u32) -> impl Iterator<Item = (u32, u32)> {
    (0..=n).flat_map(move |j| (0..=n).map(move |i| (i, j)))
}

/// Computed from whole numbers, so that faces meet exactly.
fn on_face([right, up, out]: [IVec3; 3], i: u32, j: u32, n: u32) -> Vec3 {
    let centred = |k: u32| 2 * k as i32 - n as i32;
    let doubled = right * centred(i) + up * centred(j) + out * n as i32;
    doubled.as_vec3() / (2 * n) as f32
}

/// The same cube without attributes, every position one vertex: `6 n^2 + 2`
/// vertices.
#[must_use]
pub fn closed_cube(n: u32) -> TriMesh {
    let seamed = cube(n);
    let bits = |p: Vec3| p.to_array().map(f32::to_bits);
    let mut order: Vec<usize> = (0..seamed.positions.len()).collect();
    order.sort_by_key(|&v| bits(seamed.positions[v]));
    let mut vertex = vec![0u32; order.len()];
    let mut positions: Vec<Vec3> = Vec::new();
    for v in order {
        let p = seamed.positions[v];
        if positions.last() != Some(&p) {
            positions.push(p);
        }
        vertex[v] = positions.len() as u32 - 1;
    }
    let welded = |t: &[u32; 3]| t.map(|v| vertex[v as usize]);
    TriMesh::new(positions, seamed.triangles.iter().map(welded).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_follow_the_formulas() {
        assert_eq!(cube(1).positions.len(), 24);
        for n in 1..5 {
            let cells = (n * n) as usize;
            assert_eq!(cube(n).triangles.len(), 12 * cells);
            assert_eq!(closed_cube(n).positions.len(), 6 * cells + 2);
        }
    }
}
