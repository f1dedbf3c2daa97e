//! Spheres that carry attributes.

use super::{super::TriMesh, quads, sphere::sphere_point};
use crate::mesh::{Attribute, AttributeValues, MaterialRange, MorphTarget, SkinWeights};
use glam::{Vec2, Vec3, Vec4};

/// The unit sphere as one UV chart with a seam from pole to pole: normals, one
/// UV set and weights of two joints that blend from bottom to top.
/// `(rings + 1) * (segments + 1)` vertices; see [`uv_sphere`](super::uv_sphere)
/// for the arguments.
#[must_use]
pub fn textured_sphere(rings: u32, segments: u32) -> TriMesh {
    let (rings, segments) = (rings.max(2), segments.max(3));
    let mut mesh = TriMesh::default();
    let mut uvs = Vec::new();
    for j in 0..=rings {
        for i in 0..=segments {
            mesh.positions.push(sphere_point(i, j, rings, segments));
            uvs.push(Vec2::new(
                i as f32 / segments as f32,
                1.0 - j as f32 / rings as f32,
            ));
        }
    }
    mesh.triangles = quads(segments, rings, |i, j| j * (segments + 1) + i);
    // At a pole one triangle of each quad has two corners in the same place.
    mesh.triangles.retain(|t| {
        let [a, b, c] = t.map(|v| mesh.positions[v as usize]);
        a != b && b != c && c != a
    });
    mesh.attributes.normals = Some(mesh.positions.iter().map(|p| p.normalize()).collect());
    mesh.attributes.skins = vec![mesh.positions.iter().map(|p| blend(p.y)).collect()];
    mesh.attributes.uvs = vec![uvs];
    mesh.remove_unreferenced_vertices();
    mesh
}

fn blend(y: f32) -> SkinWeights {
    let upper = (0.5 + 0.5 * y).clamp(0.0, 1.0);
    SkinWeights {
        joints: [0, 1, 0, 0],
        weights: [1.0 - upper, upper, 0.0, 0.0],
    }
}

/// [`textured_sphere`] with everything else a mesh can carry: tangents, a
/// second UV set, colours, a morph target, custom values per vertex and per
/// face, and two material ranges (southern and northern half).
#[must_use]
pub fn loaded_sphere(rings: u32, segments: u32) -> TriMesh {
    let mut mesh = textured_sphere(rings, segments);
    let positions = &mesh.positions;
    let attributes = &mut mesh.attributes;
    attributes.tangents = Some(attributes.uvs[0].iter().map(|uv| eastward(uv.x)).collect());
    attributes
        .uvs
        .push(positions.iter().map(|p| Vec2::new(p.x, p.z)).collect());
    let color = |p: &Vec3| (*p * 0.5 + 0.5).extend(1.0);
    attributes.colors = vec![positions.iter().map(color).collect()];
    attributes.morphs = vec![MorphTarget {
        positions: Some(positions.iter().map(|p| *p * 0.1).collect()),
        normals: Some(vec![Vec3::ZERO; positions.len()]),
        tangents: Some(vec![Vec3::ZERO; positions.len()]),
    }];
    let heights = positions.iter().flat_map(|p| [p.y, p.y * p.y]).collect();
    attributes.custom = vec![custom("heights", 2, AttributeValues::F32(heights))];
    let numbers = (0..mesh.triangles.len() as u32).collect();
    mesh.face_attributes = vec![custom("number", 1, AttributeValues::U32(numbers))];
    mesh.ranges = halves(mesh.triangles.len() as u32);
    mesh
}

fn custom(name: &str, components: usize, values: AttributeValues) -> Attribute {
    Attribute {
        name: name.into(),
        components,
        values,
    }
}

fn eastward(u: f32) -> Vec4 {
    let (sin, cos) = (std::f32::consts::TAU * u).sin_cos();
    Vec4::new(-sin, 0.0, -cos, 1.0)
}

fn halves(triangles: u32) -> Vec<MaterialRange> {
    let range = |material, first, count| MaterialRange {
        first,
        count,
        material: Some(material),
        source: None,
    };
    let half = triangles / 2;
    vec![range(0, 0, half), range(1, half, triangles - half)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seam_repeats_positions_bit_for_bit() {
        let mesh = textured_sphere(6, 9);
        let uvs = &mesh.attributes.uvs[0];
        let on_seam = |u: f32| -> Vec<Vec3> {
            let keep = |v: &usize| uvs[*v].x == u && (0.01..0.99).contains(&uvs[*v].y);
            (0..uvs.len())
                .filter(keep)
                .map(|v| mesh.positions[v])
                .collect()
        };
        assert_eq!(on_seam(0.0).len(), 5);
        assert_eq!(on_seam(0.0), on_seam(1.0));
    }

    #[test]
    fn skin_weights_sum_to_one() {
        for skin in &textured_sphere(6, 9).attributes.skins[0] {
            assert!((skin.weights.iter().sum::<f32>() - 1.0).abs() < 1e-6);
        }
    }
}
