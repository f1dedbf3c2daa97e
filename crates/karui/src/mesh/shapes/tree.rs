//! A made-up tree.

use super::{super::TriMesh, quads, turn};
use crate::mesh::{MaterialRange, random::Random};
use glam::{Quat, Vec2, Vec3};

/// Segments around the trunk and rings along it.
const TRUNK: [u32; 2] = [24, 40];

/// A tree about 3 high that stands on the origin: a tapering trunk of 1,920
/// triangles (material 0) and a round crown of `leaves` loose quads with the
/// whole texture each (material 1), with normals and UVs. Same arguments, same
/// bits.
#[must_use]
pub fn tree(leaves: u32, seed: u64) -> TriMesh {
    let mut mesh = trunk();
    let bark = mesh.triangles.len() as u32;
    let mut random = Random(seed);
    for _ in 0..leaves {
        add_leaf(&mut mesh, &mut random);
    }
    let range = |material, first, count| MaterialRange {
        first,
        count,
        material: Some(material),
        source: None,
    };
    mesh.ranges = vec![range(0, 0, bark), range(1, bark, 2 * leaves)];
    mesh
}

fn trunk() -> TriMesh {
    let [segments, rings] = TRUNK;
    let mut mesh = TriMesh::default();
    let (mut normals, mut uvs) = (Vec::new(), Vec::new());
    for j in 0..=rings {
        let height = j as f32 / rings as f32;
        for i in 0..=segments {
            let (sin, cos) = turn(i, segments);
            let out = Vec3::new(cos as f32, 0.0, -sin as f32);
            let radius = 0.15 * (1.0 - 0.6 * height) + 0.01 * (20.0 * height).sin();
            mesh.positions.push(out * radius + Vec3::Y * 2.0 * height);
            normals.push(out);
            uvs.push(Vec2::new(i as f32 / segments as f32, 1.0 - height));
        }
    }
    mesh.triangles = quads(segments, rings, |i, j| j * (segments + 1) + i);
    mesh.attributes.normals = Some(normals);
    mesh.attributes.uvs = vec![uvs];
    mesh
}

fn add_leaf(mesh: &mut TriMesh, random: &mut Random) {
    let place = Vec3::Y * 2.0 + random.in_ball() * Vec3::new(1.0, 0.9, 1.0);
    let axis = random.in_ball().try_normalize().unwrap_or(Vec3::Y);
    let turn = Quat::from_axis_angle(axis, std::f32::consts::TAU * random.next());
    let size = 0.02 + 0.03 * random.next();
    let [across, along, normal] = [Vec3::X, Vec3::Y, Vec3::Z].map(|v| turn * v);
    let first = mesh.positions.len() as u32;
    let uvs = [Vec2::Y, Vec2::ONE, Vec2::X, Vec2::ZERO];
    for uv in uvs {
        let corner = across * (uv.x - 0.5) - along * (uv.y - 0.5);
        mesh.positions.push(place + corner * size);
    }
    mesh.triangles
        .extend([[0, 1, 2], [0, 2, 3]].map(|t: [u32; 3]| t.map(|v| v + first)));
    mesh.attributes
        .normals
        .iter_mut()
        .for_each(|n| n.extend([normal; 4]));
    mesh.attributes
        .uvs
        .iter_mut()
        .for_each(|set| set.extend(uvs));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Components, PositionIds};

    #[test]
    fn a_trunk_and_loose_leaves() {
        let mesh = tree(300, 1);
        mesh.validate().unwrap();
        assert_eq!(mesh.triangles.len(), 1920 + 600);
        let parts = Components::of(&mesh, &PositionIds::of_mesh(&mesh)).unwrap();
        assert_eq!(parts.count, 301);
        assert_eq!(tree(300, 1), mesh);
        assert_ne!(tree(300, 2), mesh);
    }

    #[test]
    fn leaves_and_bark_face_their_normals() {
        let mesh = tree(50, 3);
        let normals = mesh.attributes.normals.as_ref().unwrap();
        for (t, corners) in mesh.triangles.iter().enumerate() {
            let face = crate::geom::normal_times_two_areas(mesh.corners(t));
            assert!(
                corners
                    .iter()
                    .all(|&v| face.dot(normals[v as usize].as_dvec3()) > 0.0)
            );
        }
    }
}
