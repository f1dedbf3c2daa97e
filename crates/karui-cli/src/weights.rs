//! `--weights`: one number a vertex, from the model itself or from a text file.

use crate::failure::Failure;
use crate::input::Input;
use anyhow::Result;
use glam::Vec4;
use karui::TriMesh;
use karui::mesh::{Attribute, AttributeValues};
use std::path::Path;

/// Weights of every mesh of a model; `None` for meshes without the attribute.
pub type MeshWeights = Vec<Option<Vec<f32>>>;

/// Looks `name` up among the vertex attributes, then among the files.
pub fn load(name: &str, input: &Input) -> Result<MeshWeights> {
    let meshes = || input.scene.meshes.iter().map(|m| &m.mesh);
    let weights: MeshWeights = meshes().map(|mesh| of_attribute(mesh, name)).collect();
    if weights.iter().any(Option::is_some) {
        check(name, &weights)?;
        return Ok(weights);
    }
    if !Path::new(name).is_file() {
        return Err(unknown(name, input).into());
    }
    let counts: Vec<usize> = meshes().map(|mesh| mesh.positions.len()).collect();
    let weights = split(name, &numbers_of_file(name)?, &counts)?;
    check(name, &weights)?;
    Ok(weights)
}

fn unknown(name: &str, input: &Input) -> Failure {
    let mut names = Vec::new();
    for mesh in input.scene.meshes.iter().map(|m| &m.mesh) {
        names.extend(mesh.attributes.custom.iter().map(|a| a.name.clone()));
        names.extend((0..mesh.attributes.colors.len()).map(|i| format!("COLOR_{i}.r")));
    }
    names.sort();
    names.dedup();
    let hint = match names.is_empty() {
        true => {
            "the model has no such attributes; give a text file with one number a vertex".into()
        }
        false => format!("the model has {}", names.join(", ")),
    };
    Failure::input(format!("`{name}` is neither a vertex attribute nor a file")).hint(hint)
}

fn of_attribute(mesh: &TriMesh, name: &str) -> Option<Vec<f32>> {
    let attributes = &mesh.attributes;
    let (base, channel) = split_channel(name);
    let custom = attributes.custom.iter();
    if let Some(whole) = custom.clone().find(|a| a.name == name) {
        return component(whole, 0);
    }
    if let Some(part) = custom.clone().find(|a| a.name == base) {
        return component(part, channel);
    }
    let colors = attributes.colors.get(color_set(base)?)?;
    let value = |c: &Vec4| c.to_array()[channel.min(3)];
    Some(colors.iter().map(value).collect())
}

/// `COLOR_0.g` is channel 1 of `COLOR_0`; without a suffix it is channel 0.
fn split_channel(name: &str) -> (&str, usize) {
    let found = name.rsplit_once('.').and_then(|(base, suffix)| {
        let channel = ["r", "g", "b", "a"].iter().position(|s| *s == suffix);
        let channel = channel.or_else(|| ["x", "y", "z", "w"].iter().position(|s| *s == suffix));
        channel.map(|channel| (base, channel))
    });
    found.unwrap_or((name, 0))
}

fn color_set(base: &str) -> Option<usize> {
    let base = base.to_ascii_lowercase();
    if base == "color" || base == "colour" {
        return Some(0);
    }
    base.strip_prefix("color_")?.parse().ok()
}

fn component(attribute: &Attribute, channel: usize) -> Option<Vec<f32>> {
    if channel >= attribute.components {
        return None;
    }
    let every = attribute.components;
    macro_rules! strided {
        ($values:expr) => {
            $values
                .iter()
                .skip(channel)
                .step_by(every)
                .map(|&v| v as f32)
                .collect()
        };
    }
    Some(match &attribute.values {
        AttributeValues::I8(v) => strided!(v),
        AttributeValues::U8(v) => strided!(v),
        AttributeValues::I16(v) => strided!(v),
        AttributeValues::U16(v) => strided!(v),
        AttributeValues::I32(v) => strided!(v),
        AttributeValues::U32(v) => strided!(v),
        AttributeValues::F32(v) => strided!(v),
        AttributeValues::F64(v) => strided!(v),
    })
}

fn numbers_of_file(name: &str) -> Result<Vec<f32>> {
    let hint = "a weights file is text: one number a vertex, separated by spaces or line ends";
    let fail = |message: String| Failure::input(format!("{name}: {message}")).hint(hint);
    let text = std::fs::read_to_string(name).map_err(|e| fail(e.to_string()))?;
    let mut numbers = Vec::new();
    for (line, words) in text.lines().enumerate() {
        for word in words.split_whitespace() {
            let number = word.parse::<f32>();
            let message = || format!("line {}: `{word}` is not a number", line + 1);
            numbers.push(number.map_err(|_| fail(message()))?);
        }
    }
    Ok(numbers)
}

fn split(name: &str, numbers: &[f32], counts: &[usize]) -> Result<MeshWeights> {
    let (found, expected) = (numbers.len(), counts.iter().sum::<usize>());
    if found != expected {
        let message = format!("{name} has {found} numbers, the model has {expected} vertices");
        let hint = "`karui info` shows the vertices of each mesh, in the order expected";
        return Err(Failure::input(message).hint(hint).into());
    }
    let mut rest = numbers;
    let take = |&count: &usize| {
        let (taken, left) = rest.split_at(count);
        rest = left;
        Some(taken.to_vec())
    };
    Ok(counts.iter().map(take).collect())
}

fn check(name: &str, weights: &MeshWeights) -> Result<()> {
    let mut all = weights.iter().flatten().flatten().enumerate();
    let Some((i, bad)) = all.find(|(_, w)| !(w.is_finite() && **w >= 0.0)) else {
        return Ok(());
    };
    let message = format!("{name}: weight {i} is {bad}; weights are finite and not negative");
    Err(Failure::input(message).into())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn attribute(name: &str, components: usize, values: AttributeValues) -> Attribute {
        let name = name.to_owned();
        Attribute {
            name,
            components,
            values,
        }
    }

    #[test]
    fn attributes_by_name_and_channel() {
        let mut mesh = TriMesh::default();
        let quality = AttributeValues::U8(vec![1, 2]);
        let vector = AttributeValues::F64(vec![1.0, 2.0, 3.0, 4.0]);
        mesh.attributes.custom = vec![attribute("quality", 1, quality), attribute("_V", 2, vector)];
        mesh.attributes.colors = vec![vec![Vec4::new(0.1, 0.2, 0.3, 0.4); 2]];
        let of = |name: &str| of_attribute(&mesh, name);
        assert_eq!(of("quality"), Some(vec![1.0, 2.0]));
        assert_eq!(of("_V.y"), Some(vec![2.0, 4.0]));
        assert_eq!(of("_V.z"), None);
        assert_eq!(of("color"), Some(vec![0.1; 2]));
        assert_eq!(of("COLOR_0.b"), Some(vec![0.3; 2]));
        assert_eq!(of("COLOR_1"), None);
        assert_eq!(of("none"), None);
    }

    #[test]
    fn numbers_are_dealt_out_in_order() {
        let numbers = [1.0, 2.0, 3.0];
        let dealt = split("w", &numbers, &[2, 0, 1]).unwrap();
        assert_eq!(dealt, [Some(vec![1.0, 2.0]), Some(vec![]), Some(vec![3.0])]);
        assert!(split("w", &numbers, &[2]).is_err());
        assert!(check("w", &vec![Some(vec![-1.0])]).is_err());
        assert!(check("w", &vec![Some(vec![f32::NAN])]).is_err());
        assert!(check("w", &vec![None, Some(vec![0.0])]).is_ok());
    }
}
