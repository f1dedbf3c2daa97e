//! Attributes as a list of named columns, which is how blocks hold them.

use crate::mesh::{Attribute, AttributeValues, Attributes, MorphTarget, SkinWeights};
use glam::{Vec2, Vec3, Vec4};

/// A name of the file's own begins with this.
const CUSTOM: char = '=';

/// Every array of `attributes` as a column.
pub(super) fn columns(attributes: Attributes) -> Vec<Attribute> {
    let mut columns = Vec::new();
    let mut push = |name: String, components, values| {
        columns.push(Attribute {
            name,
            components,
            values,
        });
    };
    let floats = |values: Vec<f32>| AttributeValues::F32(values);
    if let Some(normals) = attributes.normals {
        push("normal".into(), 3, floats(flat(&normals)));
    }
    if let Some(tangents) = attributes.tangents {
        push("tangent".into(), 4, floats(flat(&tangents)));
    }
    for set in attributes.uvs {
        push("uv".into(), 2, floats(flat(&set)));
    }
    for set in attributes.colors {
        push("color".into(), 4, floats(flat(&set)));
    }
    for set in attributes.skins {
        let joints = set.iter().flat_map(|s| s.joints).collect();
        push("joints".into(), 4, AttributeValues::U16(joints));
        let weights = set.iter().flat_map(|s| s.weights).collect();
        push("weights".into(), 4, floats(weights));
    }
    for morph in attributes.morphs {
        push("morph".into(), 0, floats(Vec::new()));
        let parts = [
            ("morph position", morph.positions),
            ("morph normal", morph.normals),
            ("morph tangent", morph.tangents),
        ];
        for (name, values) in parts {
            if let Some(values) = values {
                push(name.into(), 3, floats(flat(&values)));
            }
        }
    }
    for custom in attributes.custom {
        push(
            format!("{CUSTOM}{}", custom.name),
            custom.components,
            custom.values,
        );
    }
    columns
}

/// The attributes that [`columns`] has made columns of; those of other names are left out.
pub(super) fn attributes(columns: Vec<Attribute>) -> Attributes {
    let mut attributes = Attributes::default();
    let mut joints = Vec::new();
    for column in columns {
        if let Some(name) = column.name.strip_prefix(CUSTOM) {
            attributes.custom.push(Attribute {
                name: name.into(),
                ..column
            });
            continue;
        }
        match (column.name.as_str(), column.values) {
            ("joints", AttributeValues::U16(values)) => joints = values,
            ("weights", AttributeValues::F32(values)) => {
                attributes.skins.push(skins(&joints, &values));
            }
            (name, AttributeValues::F32(values)) => add(&mut attributes, name, &values),
            _ => {}
        }
    }
    attributes
}

fn add(attributes: &mut Attributes, name: &str, values: &[f32]) {
    let vectors = || -> Vec<Vec3> { wide(values) };
    let morph = attributes.morphs.last_mut();
    match (name, morph) {
        ("normal", _) => attributes.normals = Some(vectors()),
        ("tangent", _) => attributes.tangents = Some(wide::<4, Vec4>(values)),
        ("uv", _) => attributes.uvs.push(wide::<2, Vec2>(values)),
        ("color", _) => attributes.colors.push(wide::<4, Vec4>(values)),
        ("morph", _) => attributes.morphs.push(MorphTarget::default()),
        ("morph position", Some(morph)) => morph.positions = Some(vectors()),
        ("morph normal", Some(morph)) => morph.normals = Some(vectors()),
        ("morph tangent", Some(morph)) => morph.tangents = Some(vectors()),
        _ => {}
    }
}

fn skins(joints: &[u16], weights: &[f32]) -> Vec<SkinWeights> {
    let (joints, _) = joints.as_chunks::<4>();
    let (weights, _) = weights.as_chunks::<4>();
    let both = joints.iter().zip(weights);
    both.map(|(&joints, &weights)| SkinWeights { joints, weights })
        .collect()
}

fn flat<T: bytemuck::Pod>(vectors: &[T]) -> Vec<f32> {
    bytemuck::cast_slice(vectors).to_vec()
}

fn wide<const N: usize, T: From<[f32; N]>>(values: &[f32]) -> Vec<T> {
    let (vectors, _) = values.as_chunks::<N>();
    vectors.iter().map(|&v| T::from(v)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_kinds_come_back() {
        let two = [Vec3::X, Vec3::new(1.0, -2.0, f32::NAN)];
        let skin = SkinWeights {
            joints: [1, 2, 3, 4],
            weights: [0.5, 0.25, 0.25, 0.0],
        };
        let all = Attributes {
            normals: Some(vec![Vec3::X, Vec3::Y]),
            tangents: Some(vec![Vec4::X, Vec4::NEG_W]),
            uvs: vec![vec![Vec2::X; 2], vec![Vec2::Y; 2]],
            colors: vec![vec![Vec4::ONE; 2]],
            skins: vec![vec![skin; 2], vec![SkinWeights::default(); 2]],
            morphs: vec![
                MorphTarget::default(),
                MorphTarget {
                    positions: Some(two[..1].repeat(2)),
                    normals: None,
                    tangents: Some(vec![Vec3::Z; 2]),
                },
            ],
            custom: vec![Attribute {
                name: "normal".into(),
                components: 2,
                values: AttributeValues::I16(vec![1, -2, 3, -4]),
            }],
        };
        assert_eq!(attributes(columns(all.clone())), all);
        assert_eq!(
            attributes(columns(Attributes::default())),
            Attributes::default()
        );
    }
}
