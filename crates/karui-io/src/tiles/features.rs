//! Feature ids and property tables of a glTF content (`EXT_mesh_features`,
//! `EXT_instance_features`, `EXT_structural_metadata`).

use super::{
    at::At,
    findings::Notes,
    parse::shown,
    schema::{Schema, schema},
};
use crate::gltf::Inspected;
use serde_json::Value;
use std::collections::BTreeSet;

/// Checks that what is said about features holds together.
pub(super) fn check(gltf: &Inspected, notes: &mut Notes<'_>) {
    let json = gltf.json();
    let root = At::Document;
    let extensions = root.key("extensions");
    let at = extensions.key("EXT_structural_metadata");
    let metadata = extension(json, "EXT_structural_metadata");
    let tables = metadata.and_then(|m| m.get("propertyTables")?.as_array());
    let tables = tables.map_or(&[][..], Vec::as_slice);
    if let Some(metadata) = metadata {
        let schema = embedded_schema(metadata, &at, notes);
        if let Some(schema) = schema {
            let at = at.key("propertyTables");
            for (t, table) in tables.iter().enumerate() {
                schema.check_table(table, &|v| gltf.view(v), &at.index(t), notes);
            }
        }
    }
    for m in 0..gltf.scene.meshes.len() {
        let meshes = root.key("meshes");
        let at = meshes.index(m);
        let at = at.key("primitives");
        for (p, primitive) in gltf.primitives(m).iter().enumerate() {
            let ids = |name: &str| gltf.feature_ids(m, p, name);
            let at = at.index(p);
            sets(primitive, "EXT_mesh_features", &ids, tables, &at, notes);
        }
    }
    let nodes = json.get("nodes").and_then(Value::as_array);
    for (n, node) in nodes.into_iter().flatten().enumerate() {
        let instancing = extension(node, "EXT_mesh_gpu_instancing");
        let ids = |name: &str| gltf.scalars(instancing?.get("attributes")?.get(name)?);
        let nodes = root.key("nodes");
        sets(
            node,
            "EXT_instance_features",
            &ids,
            tables,
            &nodes.index(n),
            notes,
        );
    }
}

fn extension<'v>(json: &'v Value, name: &str) -> Option<&'v Value> {
    json.get("extensions")?.get(name)
}

/// The schema of the file; `None` if it is elsewhere or wrong.
fn embedded_schema(metadata: &Value, at: &At<'_>, notes: &mut Notes<'_>) -> Option<Schema> {
    match (metadata.get("schema"), metadata.get("schemaUri")) {
        (Some(json), None) => Some(schema(json, &at.key("schema"), notes)),
        (None, Some(uri)) => {
            notes.warn(
                at.key("schemaUri"),
                "schema-elsewhere",
                "a schema in the file",
                shown(uri),
            );
            None
        }
        (a, _) => {
            let found = if a.is_some() { "both" } else { "neither" };
            notes.error(at, "schema-or-uri", "`schema` or `schemaUri`", found);
            None
        }
    }
}

/// Checks the feature id sets of a primitive or node.
fn sets(
    owner: &Value,
    name: &str,
    ids: &dyn Fn(&str) -> Option<Vec<f64>>,
    tables: &[Value],
    at: &At<'_>,
    notes: &mut Notes<'_>,
) {
    let Some(found) = extension(owner, name) else {
        return;
    };
    let at = at.key("extensions");
    let at = at.key(name);
    let at = at.key("featureIds");
    let sets = found.get("featureIds").and_then(Value::as_array);
    let Some(sets) = sets.filter(|s| !s.is_empty()) else {
        return notes.error(at, "feature-ids", "at least one set", "none");
    };
    for (i, set) in sets.iter().enumerate() {
        one_set(set, ids, tables, &at.index(i), notes);
    }
}

fn one_set(
    set: &Value,
    ids: &dyn Fn(&str) -> Option<Vec<f64>>,
    tables: &[Value],
    at: &At<'_>,
    notes: &mut Notes<'_>,
) {
    let number = |key: &str| set.get(key).and_then(Value::as_u64);
    let Some(count) = number("featureCount").filter(|c| *c > 0) else {
        let found = set.get("featureCount").map_or_else(|| "none".into(), shown);
        return notes.error(at.key("featureCount"), "feature-count", "at least 1", found);
    };
    let mut rows = None;
    if let Some(table) = set.get("propertyTable") {
        let found = table.as_u64().and_then(|t| tables.get(t as usize));
        rows = found.and_then(|t| t.get("count")?.as_u64());
        if found.is_none() {
            let expected = format!("one of {} property tables", tables.len());
            notes.error(
                at.key("propertyTable"),
                "property-table",
                expected,
                shown(table),
            );
        }
    }
    let Some(attribute) = set.get("attribute") else {
        return;
    };
    let name = format!("_FEATURE_ID_{attribute}");
    let Some(values) = ids(&name) else {
        let expected = format!("the attribute {name}");
        return notes.error(at.key("attribute"), "feature-attribute", expected, "none");
    };
    check_values(&values, count, rows, number("nullFeatureId"), at, notes);
}

/// `featureCount` counts the different ids there are; rows of the property
/// table are named by them.
fn check_values(
    values: &[f64],
    count: u64,
    rows: Option<u64>,
    null: Option<u64>,
    at: &At<'_>,
    notes: &mut Notes<'_>,
) {
    let mut different = BTreeSet::new();
    for &value in values {
        if value < 0.0 || value.fract() != 0.0 || value > 2f64.powi(32) {
            let found = value.to_string();
            return notes.error(at, "feature-id", "whole numbers of at least 0", found);
        }
        different.insert(value as u64);
    }
    if let Some(null) = null {
        different.remove(&null);
    }
    if different.len() as u64 > count {
        let expected = format!("at most {count} different ids, as featureCount says");
        notes.error(at, "feature-count", expected, different.len().to_string());
    }
    if let (Some(rows), Some(&last)) = (rows, different.last())
        && last >= rows
    {
        let expected = format!("ids below the {rows} rows of the property table");
        notes.error(at, "feature-id-rows", expected, last.to_string());
    }
}
