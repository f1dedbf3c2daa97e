//! Where a document names accessors and buffer views outside of those lists
//! themselves.

use super::{
    draco::DRACO,
    json::{At, ROOT},
    primitive::triangle_mode,
};
use crate::error::Result;
use serde_json::Value;

/// What a number refers to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Target {
    Accessor,
    View,
}

/// Called with every reference.
pub(super) type Visit<'v> = dyn FnMut(Target, &mut Value, &At<'_>) -> Result<()> + 'v;

/// Extensions of triangle primitives that list vertices or indices; they mean
/// nothing once triangles change.
pub(super) const OF_TRIANGLES: [&str; 3] = [
    DRACO,
    "CESIUM_primitive_outline",
    "EXT_mesh_primitive_edge_visibility",
];

/// Visits all references except those of triangle primitives.
pub(super) fn visit_all(json: &mut Value, visit: &mut Visit<'_>) -> Result<()> {
    visit_outside_meshes(json, visit)?;
    visit_primitives(json, false, visit)
}

/// Visits the references of primitives, of those with or without triangles.
pub(super) fn visit_primitives(
    json: &mut Value,
    triangles: bool,
    visit: &mut Visit<'_>,
) -> Result<()> {
    for (m, mesh) in items(json, "meshes") {
        let at = ROOT.item("meshes", m);
        for (p, primitive) in items(mesh, "primitives") {
            if triangle_mode(primitive).is_some() == triangles {
                visit_primitive(primitive, &at.item("primitives", p), visit)?;
            }
        }
    }
    Ok(())
}

fn items<'v>(value: &'v mut Value, key: &str) -> impl Iterator<Item = (usize, &'v mut Value)> {
    let items = value.get_mut(key).and_then(Value::as_array_mut);
    items.into_iter().flatten().enumerate()
}

/// Visits every entry of an object that maps names to references.
fn entries(
    value: Option<&mut Value>,
    target: Target,
    at: &At<'_>,
    visit: &mut Visit<'_>,
) -> Result<()> {
    for (name, entry) in value.and_then(Value::as_object_mut).into_iter().flatten() {
        visit(target, entry, &at.key(name))?;
    }
    Ok(())
}

/// Visits the references of one primitive.
pub(super) fn visit_primitive(
    primitive: &mut Value,
    at: &At<'_>,
    visit: &mut Visit<'_>,
) -> Result<()> {
    let attributes = primitive.get_mut("attributes");
    entries(attributes, Target::Accessor, &at.key("attributes"), visit)?;
    if let Some(indices) = primitive.get_mut("indices") {
        visit(Target::Accessor, indices, &at.key("indices"))?;
    }
    for (t, target) in items(primitive, "targets") {
        entries(
            Some(target),
            Target::Accessor,
            &at.item("targets", t),
            visit,
        )?;
    }
    visit_extensions(primitive, at, visit)
}

/// Visits the references of everything but meshes and images (whose bytes the
/// scene holds).
pub(super) fn visit_outside_meshes(json: &mut Value, visit: &mut Visit<'_>) -> Result<()> {
    for (s, skin) in items(json, "skins") {
        if let Some(matrices) = skin.get_mut("inverseBindMatrices") {
            let at = ROOT.item("skins", s);
            visit(Target::Accessor, matrices, &at.key("inverseBindMatrices"))?;
        }
    }
    for (a, animation) in items(json, "animations") {
        let at = ROOT.item("animations", a);
        for (s, sampler) in items(animation, "samplers") {
            let at = at.item("samplers", s);
            for key in ["input", "output"] {
                if let Some(accessor) = sampler.get_mut(key) {
                    visit(Target::Accessor, accessor, &at.key(key))?;
                }
            }
        }
    }
    let Some(root) = json.as_object_mut() else {
        return Ok(());
    };
    for (key, value) in root {
        match key.as_str() {
            "extensions" => in_extension(value, &ROOT.key(key), visit)?,
            "accessors" | "bufferViews" => {}
            _ => {
                let elements = value.as_array_mut().into_iter().flatten();
                for (i, element) in elements.enumerate() {
                    visit_extensions(element, &ROOT.item(key, i), visit)?;
                }
            }
        }
    }
    Ok(())
}

fn visit_extensions(element: &mut Value, at: &At<'_>, visit: &mut Visit<'_>) -> Result<()> {
    match element.get_mut("extensions") {
        Some(extensions) => in_extension(extensions, &at.key("extensions"), visit),
        None => Ok(()),
    }
}

/// Visits what extensions refer to. Known ones by their definition; in others
/// the keys `bufferView` and `accessor` are taken to mean what they do in the
/// core format.
fn in_extension(value: &mut Value, at: &At<'_>, visit: &mut Visit<'_>) -> Result<()> {
    match value {
        Value::Array(elements) => {
            for (i, element) in elements.iter_mut().enumerate() {
                in_extension(element, &at.item("", i), visit)?;
            }
        }
        Value::Object(members) => {
            for (key, member) in members {
                let at = at.key(key);
                match key.as_str() {
                    "extras" | DRACO => {}
                    "EXT_mesh_gpu_instancing" => {
                        let attributes = member.get_mut("attributes");
                        entries(attributes, Target::Accessor, &at.key("attributes"), visit)?;
                    }
                    "propertyTables" | "featureTables" => property_tables(member, &at, visit)?,
                    "CESIUM_primitive_outline" => {
                        if let Some(indices) = member.get_mut("indices") {
                            visit(Target::Accessor, indices, &at.key("indices"))?;
                        }
                    }
                    "bufferView" if member.is_u64() => visit(Target::View, member, &at)?,
                    "accessor" if member.is_u64() => visit(Target::Accessor, member, &at)?,
                    _ => in_extension(member, &at, visit)?,
                }
            }
        }
        _ => {}
    }
    Ok(())
}

/// Keys of a property of `EXT_structural_metadata` and its predecessor
/// `EXT_feature_metadata` that name buffer views.
const PROPERTY_VIEWS: [&str; 6] = [
    "values",
    "arrayOffsets",
    "stringOffsets",
    "bufferView",
    "arrayOffsetBufferView",
    "stringOffsetBufferView",
];

fn property_tables(tables: &mut Value, at: &At<'_>, visit: &mut Visit<'_>) -> Result<()> {
    let tables: Vec<&mut Value> = match tables {
        Value::Array(tables) => tables.iter_mut().collect(),
        Value::Object(tables) => tables.values_mut().collect(),
        _ => return Ok(()),
    };
    for (t, table) in tables.into_iter().enumerate() {
        let at = at.item("", t);
        let properties = table.get_mut("properties").and_then(Value::as_object_mut);
        for (name, property) in properties.into_iter().flatten() {
            let at = at.key(name);
            for key in PROPERTY_VIEWS {
                if let Some(view) = property.get_mut(key).filter(|v| v.is_u64()) {
                    visit(Target::View, view, &at.key(key))?;
                }
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn finds_references_wherever_they_are() {
        let mut json = json!({
            "accessors": [{"bufferView": 99}],
            "bufferViews": [{"extensions": {"X": {"bufferView": 98}}}],
            "meshes": [{"primitives": [
                {"attributes": {"POSITION": 1}, "indices": 2},
                {"mode": 0, "attributes": {"POSITION": 3}, "targets": [{"POSITION": 4}]}]}],
            "skins": [{"inverseBindMatrices": 5}],
            "animations": [{"samplers": [{"input": 6, "output": 7}]}],
            "nodes": [{"extensions": {"EXT_mesh_gpu_instancing":
                {"attributes": {"TRANSLATION": 8}}}, "extras": {"bufferView": 97}}],
            "extensions": {
                "EXT_structural_metadata": {"propertyTables": [{"properties":
                    {"a": {"values": 51, "stringOffsets": 52}}}]},
                "VENDOR_sound": {"audio": [{"bufferView": 53}]}}
        });
        let mut found = Vec::new();
        let mut visit = |target, value: &mut Value, _: &At<'_>| {
            found.push((target == Target::View, value.as_u64().unwrap()));
            Ok(())
        };
        visit_all(&mut json, &mut visit).unwrap();
        visit_primitives(&mut json, true, &mut visit).unwrap();
        let numbers = |views| {
            let mut n: Vec<_> = found.iter().filter(|f| f.0 == views).map(|f| f.1).collect();
            n.sort_unstable();
            n
        };
        assert_eq!(numbers(false), [1, 2, 3, 4, 5, 6, 7, 8]);
        assert_eq!(numbers(true), [51, 52, 53]);
    }
}
