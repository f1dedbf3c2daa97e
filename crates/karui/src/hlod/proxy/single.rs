//! Every triangle is of one object.

use super::join::{ids, ids_of};
use crate::mesh::TriMesh;
use std::collections::BTreeMap;

/// Gives a triangle whose corners are of several objects to that of most of them, the
/// first of equals, with corners of its own: clusters of vertices reach across objects.
pub(super) fn single(mesh: &mut TriMesh) {
    let Some(mut of) = ids_of(&mesh.attributes).map(<[u32]>::to_vec) else {
        return;
    };
    let mut copies: BTreeMap<(u32, u32), u32> = BTreeMap::new();
    let mut sources: Vec<u32> = (0..of.len() as u32).collect();
    for triangle in &mut mesh.triangles {
        let [a, b, c] = triangle.map(|v| of[v as usize]);
        let object = if b == c { b } else { a };
        for v in triangle.iter_mut().filter(|v| of[**v as usize] != object) {
            let source = *v;
            *v = *copies.entry((source, object)).or_insert_with(|| {
                sources.push(source);
                sources.len() as u32 - 1
            });
        }
        // Copies are numbered as they come.
        of.resize(sources.len(), object);
    }
    if copies.is_empty() {
        return;
    }
    mesh.positions = sources
        .iter()
        .map(|&s| mesh.positions[s as usize])
        .collect();
    mesh.attributes = mesh.attributes.gathered(&sources);
    mesh.attributes.custom = vec![ids(of)];
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn mixed_triangles_get_corners_of_their_own() {
        let positions = [0.0, 1.0, 2.0, 3.0].map(|x| Vec3::new(x, x * x, 0.0));
        let mut mesh = TriMesh::new(positions.to_vec(), vec![[0, 1, 2], [1, 3, 2], [0, 1, 3]]);
        mesh.attributes.custom = vec![ids(vec![5, 6, 6, 7])];
        let places = |mesh: &TriMesh| -> Vec<[Vec3; 3]> {
            let of = |t: &[u32; 3]| t.map(|v| mesh.positions[v as usize]);
            mesh.triangles.iter().map(of).collect()
        };
        let before = places(&mesh);
        single(&mut mesh);
        assert_eq!(mesh.validate(), Ok(()));
        assert_eq!(places(&mesh), before);
        let of = ids_of(&mesh.attributes).unwrap();
        let objects = mesh.triangles.iter().map(|t| t.map(|v| of[v as usize]));
        assert_eq!(objects.collect::<Vec<_>>(), [[6; 3], [6; 3], [5; 3]]);
    }
}
