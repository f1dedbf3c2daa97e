//! `EXT_mesh_gpu_instancing`: many placements of a node's mesh.

use super::{
    GltfSource,
    accessor::{Component, Elements, Kind},
    budget::Budget,
    document::Document,
    encode, json,
    json::{At, ROOT},
    pack::{Array, Packer, Use},
    read_mesh, write_vertices,
};
use crate::error::{ErrorKind, Result};
use glam::{Quat, Vec3};
use karui::{
    Scene,
    mesh::{Attribute, Node, Placements},
};
use serde_json::{Map, Value, json};
use std::{collections::HashMap, sync::Arc};

/// Name of the extension.
pub(super) const INSTANCING: &str = "EXT_mesh_gpu_instancing";
/// Says of the instances of a node which features they are.
pub(super) const FEATURES: &str = "EXT_instance_features";

/// Bytes an entry in a list of instances takes.
const INSTANCE: usize = 80;
/// Bytes a value of a placement takes at most.
const VALUE: usize = 16;

/// Sets [`Node::placements`] of all nodes; those that name the same accessors,
/// as levels of detail do, share theirs.
pub(super) fn read_all(document: &Document, budget: &Budget, nodes: &mut [Node]) -> Result<()> {
    let raw = json::array(&document.json, "nodes", &ROOT)?;
    let mut known: HashMap<String, Arc<Placements>> = HashMap::new();
    for (n, (node, raw)) in nodes.iter_mut().zip(raw).enumerate() {
        let Some(extension) = json::extension(raw, INSTANCING) else {
            continue;
        };
        let at = ROOT.item("nodes", n);
        let at = at.key("extensions");
        let at = at.key(INSTANCING);
        let at = at.key("attributes");
        let key = extension["attributes"].to_string();
        if let Some(same) = known.get(&key) {
            budget.take(same.len(), INSTANCE, &at)?;
            node.placements = Some(same.clone());
        } else if let Some(placements) = read(document, budget, extension, &at)? {
            let placements = Arc::new(placements);
            node.placements = Some(placements.clone());
            known.insert(key, placements);
        }
    }
    Ok(())
}

fn read(
    document: &Document,
    budget: &Budget,
    extension: &Value,
    at: &At<'_>,
) -> Result<Option<Placements>> {
    let attributes = extension.get("attributes").and_then(Value::as_object);
    let mut count = None;
    let mut placements = Placements::default();
    let mut translated = false;
    for name in attributes.into_iter().flat_map(Map::keys) {
        let accessors = json::count(&document.json, "accessors");
        let index = json::required(&extension["attributes"], name, at)?;
        let at = at.key(name);
        let index = json::in_range(index, accessors, "accessor", &at)?;
        let elements = document.elements(index, budget)?;
        if count.is_none() {
            budget.take(elements.count, INSTANCE, &at)?;
        }
        let expected = *count.get_or_insert(elements.count);
        if elements.count != expected {
            let expected = format!("{expected} elements");
            return Err(at.syntax(expected, elements.count.to_string()));
        }
        budget.take(elements.count, VALUE, &at)?;
        match name.as_str() {
            "TRANSLATION" => placements.translations = vectors(&elements, &at)?,
            "ROTATION" => placements.rotations = Some(rotations(&elements, &at)?),
            "SCALE" => placements.scales = Some(vectors(&elements, &at)?),
            _ => placements.attributes.push(custom(name, &elements)),
        }
        translated |= name == "TRANSLATION";
    }
    let Some(count) = count else {
        return Ok(None);
    };
    if !translated {
        placements.translations = vec![Vec3::ZERO; count];
    }
    let valid = placements.validate();
    valid.map_err(|e| at.fail(ErrorKind::Geometry(e)))?;
    Ok(Some(placements))
}

fn vectors(elements: &Elements<'_>, at: &At<'_>) -> Result<Vec<Vec3>> {
    expect(elements, Kind::Vec3, at)?;
    let values = elements.floats([0.0; 3]).into_iter();
    Ok(values.map(Vec3::from_array).collect())
}

/// Rotations; integers are not quite of length 1 and are made so.
fn rotations(elements: &Elements<'_>, at: &At<'_>) -> Result<Vec<Quat>> {
    expect(elements, Kind::Vec4, at)?;
    let layout = elements.layout;
    let float = layout.component == Component::F32;
    if !float && !layout.normalized {
        let found = format!("{:?}", layout.component);
        return Err(at.syntax("floats or normalised integers", found));
    }
    let unit = |q: [f32; 4]| {
        let q = Quat::from_array(q);
        if float || q.length_squared() == 0.0 {
            q
        } else {
            q.normalize()
        }
    };
    Ok(elements.floats([0.0; 4]).into_iter().map(unit).collect())
}

fn expect(elements: &Elements<'_>, kind: Kind, at: &At<'_>) -> Result<()> {
    if elements.layout.kind == kind {
        return Ok(());
    }
    Err(at.syntax(kind.name(), elements.layout.kind.name()))
}

fn custom(name: &str, elements: &Elements<'_>) -> Attribute {
    let components = elements.layout.kind.components();
    Attribute {
        name: name.to_owned(),
        components,
        values: read_mesh::all_values(elements, components),
    }
}

/// What the file a scene was read from says of placements.
struct Written {
    instancing: Value,
    features: Option<Value>,
}

/// Brings the extension of all nodes in step with the scene. Placements that
/// are as they were read stay as they are, on whatever nodes they are now;
/// those that nodes share are written once.
pub(super) fn write_all(
    json: &mut Value,
    scene: &Scene,
    source: Option<&GltfSource>,
    packer: &mut Packer,
) {
    let Some(nodes) = json.get_mut("nodes").and_then(Value::as_array_mut) else {
        return;
    };
    let before = source.map_or(&[][..], |s| &s.placements);
    let mut known = of_source(nodes, before);
    for (n, (raw, node)) in nodes.iter_mut().zip(&scene.nodes).enumerate() {
        let was = before.get(n).and_then(Option::as_ref);
        let Some(placements) = &node.placements else {
            if was.is_some() {
                json::remove_extension(raw, INSTANCING);
                json::remove_extension(raw, FEATURES);
            }
            continue;
        };
        if was.is_some_and(|was| Arc::ptr_eq(was, placements)) {
            continue;
        }
        if placements.is_empty() {
            // An accessor cannot be empty; what is shown nowhere has no mesh.
            for key in ["mesh", "skin", "weights"] {
                json::remove(raw, key);
            }
            json::remove_extension(raw, INSTANCING);
            continue;
        }
        let written = known
            .entry(Arc::as_ptr(placements))
            .or_insert_with(|| Written {
                instancing: json!({ "attributes": attributes(placements, packer) }),
                features: None,
            });
        json::set_extension(raw, INSTANCING, written.instancing.clone());
        if let Some(features) = &written.features {
            json::set_extension(raw, FEATURES, features.clone());
        }
    }
}

/// The extensions of the file by the placements that were read from them.
fn of_source(
    nodes: &[Value],
    before: &[Option<Arc<Placements>>],
) -> HashMap<*const Placements, Written> {
    let pairs = nodes.iter().zip(before);
    let known = pairs.filter_map(|(raw, placements)| {
        let written = Written {
            instancing: json::extension(raw, INSTANCING)?.clone(),
            features: json::extension(raw, FEATURES).cloned(),
        };
        Some((Arc::as_ptr(placements.as_ref()?), written))
    });
    known.collect()
}

/// New accessors; what is the default for all placements is left out.
fn attributes(placements: &Placements, packer: &mut Packer) -> Value {
    let mut attributes = Map::new();
    let mut push = |name: &str, array: Array| {
        let accessor = packer.push(array, Use::Vertices);
        attributes.insert(name.to_owned(), json!(accessor));
    };
    let turned = |r: &&Vec<Quat>| r.iter().any(|&q| q != Quat::IDENTITY);
    if let Some(rotations) = placements.rotations.as_ref().filter(turned) {
        push(
            "ROTATION",
            encode::floats(rotations.iter().map(|q| q.to_array())),
        );
    }
    let scaled = |s: &&Vec<Vec3>| s.iter().any(|&s| s != Vec3::ONE);
    if let Some(scales) = placements.scales.as_ref().filter(scaled) {
        push("SCALE", encode::floats(scales.iter().map(|s| s.to_array())));
    }
    let all: Vec<u32> = (0..placements.len() as u32).collect();
    for attribute in &placements.attributes {
        if let Some(array) = write_vertices::custom_array(attribute, &all) {
            push(&write_vertices::custom_name(&attribute.name), array);
        }
    }
    let moved = placements.translations.iter().any(|&t| t != Vec3::ZERO);
    if moved || attributes.is_empty() {
        let values = placements.translations.iter().map(|t| t.to_array());
        let accessor = packer.push(encode::floats(values), Use::Vertices);
        attributes.insert("TRANSLATION".to_owned(), json!(accessor));
    }
    Value::Object(attributes)
}
