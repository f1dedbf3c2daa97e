//! Vertex attributes of one or several primitives as accessors.

use super::{
    accessor::{Component, Layout},
    encode,
    json::ROOT,
    pack::{Array, Packer, Use},
    quantize::Grid,
};
use glam::{Vec3, Vec4};
use karui::mesh::{Attribute, AttributeValues, MorphTarget, SkinWeights, TriMesh};
use serde_json::{Map, Value, json};

/// Greatest deviation from length 1 that is left alone, about what bytes as
/// components cause; the validator accepts 0.0067.
const UNIT: f32 = 0.005;
/// Greatest deviation of a sum of weights from 1, for each weight that is not
/// zero (glTF 2.0, section 3.7.3.3).
const WEIGHT: f32 = 2e-7;

/// Vertices to be written: those of `mesh` that `sources` lists.
pub(super) struct Vertices<'a> {
    pub mesh: &'a TriMesh,
    pub sources: &'a [u32],
    /// Names of attributes that these primitives do not have.
    pub omit: &'a [&'a str],
    /// What the file said about an attribute, by name.
    pub hint: &'a dyn Fn(&str) -> Option<&'a Value>,
    /// How positions are quantised, if they are.
    pub grid: Option<Grid>,
    /// Whether other attributes are quantised.
    pub quantize: bool,
}

impl Vertices<'_> {
    /// Adds all attributes; returns the `attributes` and `targets` of the
    /// primitives.
    pub fn write(&self, packer: &mut Packer) -> (Value, Vec<Value>) {
        let mut attributes = Map::new();
        let mut push = |name: &str, array: Array| {
            if !self.omit.contains(&name) {
                let accessor = packer.push(array, Use::Vertices);
                attributes.insert(name.to_owned(), json!(accessor));
            }
        };
        push("POSITION", self.positions());
        self.directions(&mut push);
        self.sets(&mut push);
        self.skins(&mut push);
        let mut taken = Vec::new();
        for attribute in &self.mesh.attributes.custom {
            let name = custom_name(&attribute.name);
            if let Some(array) = self.custom(attribute)
                && !taken.contains(&name)
            {
                push(&name, array);
                taken.push(name);
            }
        }
        let morphs = self.mesh.attributes.morphs.iter();
        let targets = morphs.map(|morph| self.morph(morph, packer)).collect();
        (Value::Object(attributes), targets)
    }

    fn pick<T: Copy>(&self, values: &[T]) -> Vec<T> {
        self.sources.iter().map(|&s| values[s as usize]).collect()
    }

    fn positions(&self) -> Array {
        let positions = self.pick(&self.mesh.positions);
        match self.grid {
            Some(grid) => {
                let points: Vec<_> = positions.iter().map(|p| grid.point(*p)).collect();
                encode::grid_positions(&points)
            }
            None => encode::positions(&positions),
        }
    }

    fn directions(&self, push: &mut dyn FnMut(&str, Array)) {
        let attributes = &self.mesh.attributes;
        let Some(normals) = attributes.normals.as_ref().map(|n| self.pick(n)) else {
            return;
        };
        if self.omit.contains(&"NORMAL") {
            // Tangents mean nothing without normals.
            return;
        }
        let normals = self.unit_normals(normals);
        if let Some(tangents) = &attributes.tangents {
            let tangents = self.pick(tangents);
            let pairs = tangents.iter().zip(&normals);
            let tangents: Vec<Vec4> = pairs.map(|(t, n)| unit_tangent(*t, *n)).collect();
            let values = tangents.iter().map(|t| t.to_array());
            push("TANGENT", self.direction_array(values));
        }
        let values = normals.iter().map(|n| n.to_array());
        push("NORMAL", self.direction_array(values));
    }

    fn direction_array<const N: usize>(
        &self,
        values: impl ExactSizeIterator<Item = [f32; N]>,
    ) -> Array {
        if self.quantize {
            encode::signed_bytes(values)
        } else {
            encode::floats(values)
        }
    }

    /// Normals of length 1. Those without a direction get that of the
    /// triangles around.
    fn unit_normals(&self, mut normals: Vec<Vec3>) -> Vec<Vec3> {
        let mut around = None;
        for (normal, &source) in normals.iter_mut().zip(self.sources) {
            let length = normal.length();
            if (length - 1.0).abs() <= UNIT {
                continue;
            }
            *normal = normal.try_normalize().unwrap_or_else(|| {
                let around = around.get_or_insert_with(|| triangle_normals(self.mesh));
                around[source as usize]
            });
        }
        normals
    }

    fn sets(&self, push: &mut dyn FnMut(&str, Array)) {
        let attributes = &self.mesh.attributes;
        for (set, uvs) in attributes.uvs.iter().enumerate() {
            let name = format!("TEXCOORD_{set}");
            let wanted = self.wanted(&name);
            let uvs: Vec<[f32; 2]> = self.pick(uvs).iter().map(|v| v.to_array()).collect();
            push(&name, encode::uvs(&uvs, wanted, self.quantize));
        }
        for (set, colors) in attributes.colors.iter().enumerate() {
            let colors: Vec<[f32; 4]> = self.pick(colors).iter().map(|v| v.to_array()).collect();
            push(
                &format!("COLOR_{set}"),
                encode::colors(&colors, self.quantize),
            );
        }
    }

    /// The integer type the file stores this attribute in, if it is read as
    /// normalised.
    fn wanted(&self, name: &str) -> Option<Component> {
        let layout = Layout::parse((self.hint)(name)?, &ROOT).ok()?;
        layout.normalized.then_some(layout.component)
    }

    fn skins(&self, push: &mut dyn FnMut(&str, Array)) {
        let sets: Vec<Vec<SkinWeights>> = self
            .mesh
            .attributes
            .skins
            .iter()
            .map(|set| self.pick(set))
            .collect();
        let weights = self.weights(&sets);
        for (set, (skin, weights)) in sets.iter().zip(weights).enumerate() {
            let joints: Vec<[u16; 4]> = skin.iter().map(|s| s.joints).collect();
            push(&format!("JOINTS_{set}"), encode::joints(&joints));
            push(&format!("WEIGHTS_{set}"), weights);
        }
    }

    /// Weights of all sets; those of a vertex sum to 1.
    fn weights(&self, sets: &[Vec<SkinWeights>]) -> Vec<Array> {
        let mut floats: Vec<Vec<[f32; 4]>> = vec![Vec::new(); sets.len()];
        let mut bytes: Vec<Vec<[u8; 4]>> = vec![Vec::new(); sets.len()];
        for v in 0..self.sources.len() {
            let mut weights: Vec<f32> = sets.iter().flat_map(|s| s[v].weights).collect();
            normalize_weights(&mut weights);
            if self.quantize {
                let quanta = encode::weight_bytes(&weights);
                for (set, four) in bytes.iter_mut().zip(quanta.as_chunks::<4>().0) {
                    set.push(*four);
                }
            } else {
                for (set, four) in floats.iter_mut().zip(weights.as_chunks::<4>().0) {
                    set.push(*four);
                }
            }
        }
        if self.quantize {
            let arrays = bytes.into_iter();
            arrays
                .map(|set| encode::weights8(set.into_iter()))
                .collect()
        } else {
            let arrays = floats.into_iter();
            arrays.map(|set| encode::floats(set.into_iter())).collect()
        }
    }

    fn custom(&self, attribute: &Attribute) -> Option<Array> {
        let hint = (self.hint)(&attribute.name);
        let layout = hint.and_then(|h| Layout::parse(h, &ROOT).ok());
        let array = custom_array(attribute, self.sources)?;
        let same = layout.filter(|l| l.component == array.component);
        Some(Array {
            normalized: same.is_some_and(|l| l.normalized),
            ..array
        })
    }

    fn morph(&self, morph: &MorphTarget, packer: &mut Packer) -> Value {
        let mut target = Map::new();
        let mut push = |name: &str, array| {
            let accessor = packer.push(array, Use::Vertices);
            target.insert(name.to_owned(), json!(accessor));
        };
        let nothing = morph.normals.is_none() && morph.tangents.is_none();
        match &morph.positions {
            Some(positions) => push("POSITION", self.differences(&self.pick(positions))),
            // A target must have some attribute.
            None if nothing => {
                let still = vec![Vec3::ZERO; self.sources.len()];
                push("POSITION", self.differences(&still));
            }
            None => {}
        }
        for (name, values) in [("NORMAL", &morph.normals), ("TANGENT", &morph.tangents)] {
            if let Some(values) = values
                && !self.omit.contains(&name)
            {
                let values = self.pick(values);
                let small = values.iter().all(|v| v.abs().max_element() <= 1.0);
                let values = values.iter().map(|v| v.to_array());
                push(
                    name,
                    if self.quantize && small {
                        encode::signed_bytes(values)
                    } else {
                        encode::floats(values)
                    },
                );
            }
        }
        Value::Object(target)
    }

    fn differences(&self, values: &[Vec3]) -> Array {
        match self.grid {
            Some(grid) => {
                let steps: Vec<_> = values.iter().map(|v| grid.difference(*v)).collect();
                encode::grid_differences(&steps)
            }
            None => encode::positions(values),
        }
    }
}

/// Normals of the vertices as sums over their triangles, weighted by area.
fn triangle_normals(mesh: &TriMesh) -> Vec<Vec3> {
    let mut normals = vec![Vec3::ZERO; mesh.positions.len()];
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|v| mesh.positions[v as usize]);
        let normal = (b - a).cross(c - a);
        for &v in triangle {
            normals[v as usize] += normal;
        }
    }
    normals
        .into_iter()
        .map(|n| n.normalize_or(Vec3::Z))
        .collect()
}

fn unit_tangent(tangent: Vec4, normal: Vec3) -> Vec4 {
    let sign = if tangent.w < 0.0 { -1.0 } else { 1.0 };
    let direction = tangent.truncate();
    if (direction.length() - 1.0).abs() <= UNIT {
        return direction.extend(sign);
    }
    let unit = direction.try_normalize();
    unit.unwrap_or_else(|| normal.any_orthonormal_vector())
        .extend(sign)
}

/// Makes the weights of a vertex sum to 1 as closely as the format asks.
fn normalize_weights(weights: &mut [f32]) {
    weights.iter_mut().for_each(|w| *w = w.max(0.0));
    let sum: f32 = weights.iter().sum();
    let used = weights.iter().filter(|w| **w > 0.0).count();
    if sum <= 0.0 {
        if let Some(first) = weights.first_mut() {
            *first = 1.0;
        }
    } else if (sum - 1.0).abs() > WEIGHT * used as f32 {
        weights.iter_mut().for_each(|w| *w /= sum);
    }
}

/// Names that are not the format's own start with an underscore.
pub(super) fn custom_name(name: &str) -> String {
    if name.starts_with('_') || is_reserved(name) {
        return name.to_owned();
    }
    let letter = |c: char| match c {
        c if c.is_ascii_alphanumeric() => c.to_ascii_uppercase(),
        _ => '_',
    };
    std::iter::once('_')
        .chain(name.chars().map(letter))
        .collect()
}

/// Sets beyond those that are modelled keep their names.
fn is_reserved(name: &str) -> bool {
    let prefixes = ["TEXCOORD_", "COLOR_", "JOINTS_", "WEIGHTS_"];
    prefixes.iter().any(|p| name.starts_with(p))
}

/// Values in a type that vertex attributes may have: 32-bit integers only in
/// 16 bits or, beyond their range, as floats.
pub(super) fn custom_array(attribute: &Attribute, sources: &[u32]) -> Option<Array> {
    let components = attribute.components;
    macro_rules! array {
        ($component:ident, $values:expr, $bytes:expr) => {{
            let element = |s: &u32| {
                let first = *s as usize * components;
                $values[first..first + components].iter()
            };
            let scalars: Vec<_> = sources.iter().flat_map(element).map($bytes).collect();
            encode::custom(Component::$component, components, scalars.into_iter())
        }};
    }
    match &attribute.values {
        AttributeValues::I8(v) => array!(I8, v, |x| x.to_le_bytes()),
        AttributeValues::U8(v) => array!(U8, v, |x| x.to_le_bytes()),
        AttributeValues::I16(v) => array!(I16, v, |x| x.to_le_bytes()),
        AttributeValues::U16(v) => array!(U16, v, |x| x.to_le_bytes()),
        AttributeValues::U32(v)
            if attribute.name.starts_with("_FEATURE_ID_")
                && v.iter().all(|&x| x <= u32::from(u8::MAX)) =>
        {
            array!(U8, v, |&x| (x as u8).to_le_bytes())
        }
        AttributeValues::U32(v) if v.iter().all(|&x| x <= u32::from(u16::MAX)) => {
            array!(U16, v, |&x| (x as u16).to_le_bytes())
        }
        AttributeValues::I32(v) if v.iter().all(|&x| i16::try_from(x).is_ok()) => {
            array!(I16, v, |&x| (x as i16).to_le_bytes())
        }
        AttributeValues::U32(v) => array!(F32, v, |&x| (x as f32).to_le_bytes()),
        AttributeValues::I32(v) => array!(F32, v, |&x| (x as f32).to_le_bytes()),
        AttributeValues::F32(v) => array!(F32, v, |x| x.to_le_bytes()),
        AttributeValues::F64(v) => array!(F32, v, |&x| (x as f32).to_le_bytes()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_sum_to_one() {
        let mut weights = [0.5, 0.25, 0.0, 0.0];
        normalize_weights(&mut weights);
        assert_eq!(weights, [2.0 / 3.0, 1.0 / 3.0, 0.0, 0.0]);
        let mut weights = [0.0, -1.0];
        normalize_weights(&mut weights);
        assert_eq!(weights, [1.0, 0.0]);
    }

    #[test]
    fn custom_names_are_marked() {
        assert_eq!(custom_name("_BATCHID"), "_BATCHID");
        assert_eq!(custom_name("confidence 2"), "_CONFIDENCE_2");
        assert_eq!(custom_name("TEXCOORD_9"), "TEXCOORD_9");
    }

    #[test]
    fn directions_are_made_unit() {
        let normal = Vec3::Z;
        assert_eq!(
            unit_tangent(Vec4::new(2.0, 0.0, 0.0, 0.5), normal),
            Vec4::new(1.0, 0.0, 0.0, 1.0)
        );
        let made = unit_tangent(Vec4::new(0.0, 0.0, 0.0, -1.0), normal);
        assert!(made.truncate().dot(normal).abs() < 1e-6 && made.w == -1.0);
    }
}
