//! Attributes of a new vertex, mixed from three old ones.

use crate::mesh::{Attribute, AttributeValues, Attributes, SkinWeights};
use glam::{Vec2, Vec3, Vec4};
use smallvec::SmallVec;
use std::ops::{Add, Mul};

/// Three vertices and their shares, which sum to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Mix {
    /// The vertices mixed.
    pub sources: [u32; 3],
    /// Their shares.
    pub shares: [f64; 3],
}

impl Mix {
    /// The source with the largest share, for what cannot be mixed.
    pub fn nearest(&self) -> u32 {
        let largest = (1..3).fold(0, |best, k| {
            if self.shares[k] > self.shares[best] {
                k
            } else {
                best
            }
        });
        self.sources[largest]
    }

    fn of<T>(&self, values: &[T]) -> T
    where
        T: Copy + Add<Output = T> + Mul<f32, Output = T>,
    {
        let [a, b, c] = self.sources.map(|s| values[s as usize]);
        let [x, y, z] = self.shares.map(|s| s as f32);
        a * x + b * y + c * z
    }
}

/// Overwrites vertex `target` by the mixture. Normals and tangents come out
/// with unit length, skin weights with sum 1.
pub(crate) fn blend(attributes: &mut Attributes, target: u32, mix: &Mix) {
    let t = target as usize;
    if let Some(normals) = &mut attributes.normals {
        normals[t] = unit_or(mix.of(normals), normals[mix.nearest() as usize]);
    }
    if let Some(tangents) = &mut attributes.tangents {
        tangents[t] = blend_tangent(tangents, mix);
    }
    attributes
        .uvs
        .iter_mut()
        .for_each(|v| v[t] = mix.of::<Vec2>(v));
    attributes
        .colors
        .iter_mut()
        .for_each(|v| v[t] = mix.of::<Vec4>(v));
    blend_skins(&mut attributes.skins, t, mix);
    for morph in &mut attributes.morphs {
        let parts = [
            &mut morph.positions,
            &mut morph.normals,
            &mut morph.tangents,
        ];
        for part in parts.into_iter().flatten() {
            part[t] = mix.of::<Vec3>(part);
        }
    }
    attributes
        .custom
        .iter_mut()
        .for_each(|c| blend_custom(c, t, mix));
}

fn unit_or(v: Vec3, fallback: Vec3) -> Vec3 {
    v.try_normalize().unwrap_or(fallback)
}

fn blend_tangent(tangents: &[Vec4], mix: &Mix) -> Vec4 {
    let nearest = tangents[mix.nearest() as usize];
    let direction = unit_or(mix.of(tangents).truncate(), nearest.truncate());
    direction.extend(nearest.w)
}

fn blend_skins(skins: &mut [Vec<SkinWeights>], target: usize, mix: &Mix) {
    let mut influences = SmallVec::<[(u16, f32); 16]>::new();
    for set in skins.iter() {
        for (&source, &share) in mix.sources.iter().zip(&mix.shares) {
            let skin = set[source as usize];
            for (&joint, &weight) in skin.joints.iter().zip(&skin.weights) {
                add_influence(&mut influences, joint, weight * share as f32);
            }
        }
    }
    influences.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    influences.truncate(4 * skins.len());
    let sum: f32 = influences.iter().map(|i| i.1).sum();
    for (s, set) in skins.iter_mut().enumerate() {
        set[target] = skin_of(influences.get(4 * s..).unwrap_or_default(), sum);
    }
}

fn add_influence(influences: &mut SmallVec<[(u16, f32); 16]>, joint: u16, weight: f32) {
    if weight <= 0.0 {
        return;
    }
    match influences.iter_mut().find(|i| i.0 == joint) {
        Some(known) => known.1 += weight,
        None => influences.push((joint, weight)),
    }
}

fn skin_of(influences: &[(u16, f32)], sum: f32) -> SkinWeights {
    let mut skin = SkinWeights::default();
    for (k, &(joint, weight)) in influences.iter().take(4).enumerate() {
        skin.joints[k] = joint;
        skin.weights[k] = if sum > 0.0 { weight / sum } else { 0.0 };
    }
    skin
}

/// Real numbers are mixed, whole ones (ids, flags) taken from the nearest.
fn blend_custom(attribute: &mut Attribute, target: usize, mix: &Mix) {
    let n = attribute.components;
    match &mut attribute.values {
        AttributeValues::F32(v) => mix_wide(v, n, target, mix, |x, s| (f64::from(x) * s) as f32),
        AttributeValues::F64(v) => mix_wide(v, n, target, mix, |x, s| x * s),
        AttributeValues::I8(v) => copy_wide(v, n, target, mix),
        AttributeValues::U8(v) => copy_wide(v, n, target, mix),
        AttributeValues::I16(v) => copy_wide(v, n, target, mix),
        AttributeValues::U16(v) => copy_wide(v, n, target, mix),
        AttributeValues::I32(v) => copy_wide(v, n, target, mix),
        AttributeValues::U32(v) => copy_wide(v, n, target, mix),
    }
}

fn mix_wide<T>(values: &mut [T], n: usize, target: usize, mix: &Mix, scaled: impl Fn(T, f64) -> T)
where
    T: Copy + Add<Output = T>,
{
    for i in 0..n {
        let part = |k: usize| scaled(values[mix.sources[k] as usize * n + i], mix.shares[k]);
        values[target * n + i] = part(0) + part(1) + part(2);
    }
}

fn copy_wide<T: Copy>(values: &mut [T], n: usize, target: usize, mix: &Mix) {
    let from = mix.nearest() as usize * n;
    values.copy_within(from..from + n, target * n);
}

#[cfg(test)]
mod tests {
    use super::*;

    const MIX: Mix = Mix {
        sources: [0, 1, 2],
        shares: [0.5, 0.25, 0.25],
    };

    #[test]
    fn normals_stay_unit_and_uvs_are_linear() {
        let mut a = Attributes {
            normals: Some(vec![Vec3::X, Vec3::Y, Vec3::Y]),
            uvs: vec![vec![Vec2::ZERO, Vec2::X, Vec2::Y]],
            ..Attributes::default()
        };
        blend(&mut a, 2, &MIX);
        let n = a.normals.unwrap()[2];
        assert!((n.length() - 1.0).abs() < 1e-6);
        assert_eq!(a.uvs[0][2], Vec2::new(0.25, 0.25));
    }

    #[test]
    fn skin_weights_sum_to_one_over_the_strongest_joints() {
        let skin = |joints, weights| SkinWeights { joints, weights };
        let mut a = Attributes {
            skins: vec![vec![
                skin([0, 1, 2, 3], [0.25; 4]),
                skin([4, 5, 0, 0], [0.5, 0.5, 0.0, 0.0]),
                skin([4, 0, 0, 0], [1.0, 0.0, 0.0, 0.0]),
            ]],
            ..Attributes::default()
        };
        blend(&mut a, 0, &MIX);
        let mixed = a.skins[0][0];
        assert_eq!(mixed.joints[0], 4);
        assert!((mixed.weights.iter().sum::<f32>() - 1.0).abs() < 1e-6);
        assert!(mixed.weights.windows(2).all(|w| w[0] >= w[1]));
    }

    #[test]
    fn whole_numbers_are_not_mixed() {
        let mut a = Attributes {
            custom: vec![
                Attribute {
                    name: "id".into(),
                    components: 1,
                    values: AttributeValues::U16(vec![7, 9, 9]),
                },
                Attribute {
                    name: "heat".into(),
                    components: 1,
                    values: AttributeValues::F64(vec![1.0, 2.0, 4.0]),
                },
            ],
            ..Attributes::default()
        };
        blend(&mut a, 1, &MIX);
        assert_eq!(a.custom[0].values, AttributeValues::U16(vec![7, 7, 9]));
        assert_eq!(
            a.custom[1].values,
            AttributeValues::F64(vec![1.0, 2.0, 4.0])
        );
    }
}
