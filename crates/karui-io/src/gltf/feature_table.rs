//! Features: what the ids of a mesh's vertices or of its placements stand for
//! (`EXT_mesh_features`, `EXT_instance_features`, `EXT_structural_metadata`).

use super::{instancing, json, pack::Packer};
use crate::error::{Error, ErrorKind, Place, Result};
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;

/// Name of the vertex attribute with the ids.
const ATTRIBUTE: &str = "_FEATURE_ID_0";
/// Whole numbers that 32-bit floats, the widest type of a vertex attribute,
/// can hold.
const MOST: u64 = 1 << 24;

pub(super) const MESH_FEATURES: &str = "EXT_mesh_features";
pub(super) const STRUCTURAL: &str = "EXT_structural_metadata";

/// A property table: one row a feature.
///
/// It is about the vertices of all meshes with an attribute `_FEATURE_ID_0` of
/// one component ([`Attributes::custom`](karui::mesh::Attributes::custom)), and
/// about all placements with one
/// ([`Placements::attributes`](karui::mesh::Placements::attributes)), whose values
/// are numbers of rows.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FeatureTable {
    /// Id of the class: letters, digits and `_`, not beginning with a digit.
    pub class: String,
    /// Columns, of equal length of at least 1.
    pub columns: Vec<FeatureColumn>,
}

/// A column of a [`FeatureTable`].
#[derive(Debug, Clone, PartialEq)]
pub struct FeatureColumn {
    /// Id of the property, of characters as that of the class.
    pub name: String,
    /// One a row.
    pub values: FeatureValues,
}

/// The values of a column.
#[derive(Debug, Clone, PartialEq)]
pub enum FeatureValues {
    /// `STRING`.
    Text(Vec<String>),
    /// `SCALAR` of `UINT32`.
    U32(Vec<u32>),
    /// `SCALAR` of `FLOAT64`.
    F64(Vec<f64>),
}

impl FeatureValues {
    /// Number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Text(v) => v.len(),
            Self::U32(v) => v.len(),
            Self::F64(v) => v.len(),
        }
    }

    /// Whether there are no rows.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn property(&self) -> Value {
        match self {
            Self::Text(_) => json!({ "type": "STRING" }),
            Self::U32(_) => json!({ "type": "SCALAR", "componentType": "UINT32" }),
            Self::F64(_) => json!({ "type": "SCALAR", "componentType": "FLOAT64" }),
        }
    }

    fn pack(&self, packer: &mut Packer) -> Value {
        let mut view = |bytes: Vec<u8>| packer.push_view(json!({}), bytes);
        match self {
            Self::U32(v) => {
                json!({ "values": view(v.iter().flat_map(|x| x.to_le_bytes()).collect()) })
            }
            Self::F64(v) => {
                json!({ "values": view(v.iter().flat_map(|x| x.to_le_bytes()).collect()) })
            }
            Self::Text(v) => {
                let mut offsets = vec![0u64];
                let mut text = Vec::new();
                for value in v {
                    text.extend(value.bytes());
                    offsets.push(text.len() as u64);
                }
                let wide = text.len() as u64 > u64::from(u32::MAX);
                let offsets: Vec<u8> = if wide {
                    offsets.iter().flat_map(|o| o.to_le_bytes()).collect()
                } else {
                    offsets
                        .iter()
                        .flat_map(|o| (*o as u32).to_le_bytes())
                        .collect()
                };
                if text.is_empty() {
                    // A buffer view must hold something.
                    text.push(0);
                }
                let mut column = json!({ "values": view(text), "stringOffsets": view(offsets) });
                if wide {
                    column["stringOffsetType"] = json!("UINT64");
                }
                column
            }
        }
    }
}

impl FeatureTable {
    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |c| c.values.len())
    }

    fn check(&self) -> karui::Result<()> {
        let names = self.columns.iter().map(|c| &c.name).chain([&self.class]);
        let bad = |found: &str, expected| karui::Error::BadOption {
            option: "features",
            found: found.to_owned(),
            expected,
        };
        for name in names {
            if !is_id(name) {
                return Err(bad(
                    name,
                    "ids of letters, digits and _, not beginning with a digit",
                ));
            }
        }
        let different: BTreeSet<&String> = self.columns.iter().map(|c| &c.name).collect();
        if different.len() < self.columns.len() {
            return Err(bad(&self.class, "a class whose columns differ in name"));
        }
        let rows = self.rows();
        if rows == 0 || rows as u64 > MOST {
            return Err(bad(&format!("{rows} rows"), "1 to 16,777,216 rows"));
        }
        for column in &self.columns {
            if column.values.len() != rows {
                return Err(karui::Error::LengthMismatch {
                    what: format!("column {}", column.name),
                    expected: rows,
                    found: column.values.len(),
                });
            }
        }
        Ok(())
    }
}

fn is_id(name: &str) -> bool {
    let letter = |c: char| c.is_ascii_alphanumeric() || c == '_';
    name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') && name.chars().all(letter)
}

/// Extensions that were written.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Declared {
    pub vertices: bool,
    pub instances: bool,
}

impl Declared {
    /// The names of the extensions.
    pub fn names(self) -> impl Iterator<Item = &'static str> {
        let any = self.vertices || self.instances;
        let names = [
            (self.vertices, MESH_FEATURES),
            (self.instances, instancing::FEATURES),
            (any, STRUCTURAL),
        ];
        names.into_iter().filter(|n| n.0).map(|n| n.1)
    }
}

/// Writes the table, and declares the ids of all primitives and of all placements that
/// have them.
pub(super) fn write(
    json: &mut Value,
    packer: &mut Packer,
    table: &FeatureTable,
) -> Result<Declared> {
    let fail = |error: karui::Error| Error::new(Place::File, ErrorKind::Geometry(error));
    table.check().map_err(fail)?;
    let declared = Declared {
        vertices: declare_vertices(json, packer, table.rows()).map_err(fail)?,
        instances: declare_instances(json, packer, table.rows()).map_err(fail)?,
    };
    if declared != Declared::default() {
        let content = structural(packer, table);
        json::set_extension(json, STRUCTURAL, content);
    }
    Ok(declared)
}

fn declare_vertices(json: &mut Value, packer: &Packer, rows: usize) -> karui::Result<bool> {
    let mut any = false;
    let meshes = json.get_mut("meshes").and_then(Value::as_array_mut);
    for (m, mesh) in meshes.into_iter().flatten().enumerate() {
        let primitives = mesh.get_mut("primitives").and_then(Value::as_array_mut);
        for primitive in primitives.into_iter().flatten() {
            let ids = ids(&primitive["attributes"], packer);
            if let Some(set) = ids.map(|ids| set(&ids, rows, "mesh", m)).transpose()? {
                json::set_extension(primitive, MESH_FEATURES, json!({ "featureIds": [set] }));
                any = true;
            }
        }
    }
    Ok(any)
}

fn declare_instances(json: &mut Value, packer: &Packer, rows: usize) -> karui::Result<bool> {
    let mut any = false;
    let nodes = json.get_mut("nodes").and_then(Value::as_array_mut);
    for (n, node) in nodes.into_iter().flatten().enumerate() {
        let placed = json::extension(node, instancing::INSTANCING);
        let ids = placed.and_then(|p| ids(p.get("attributes")?, packer));
        if let Some(set) = ids.map(|ids| set(&ids, rows, "node", n)).transpose()? {
            let content = json!({ "featureIds": [set] });
            json::set_extension(node, instancing::FEATURES, content);
            any = true;
        }
    }
    Ok(any)
}

/// The ids that attributes have.
fn ids(attributes: &Value, packer: &Packer) -> Option<Vec<f64>> {
    packer.scalars(attributes.get(ATTRIBUTE)?.as_u64()? as usize)
}

fn set(ids: &[f64], rows: usize, what: &'static str, index: usize) -> karui::Result<Value> {
    let count = different(ids, rows, what, index)?;
    Ok(json!({ "featureCount": count, "attribute": 0, "propertyTable": 0 }))
}

fn structural(packer: &mut Packer, table: &FeatureTable) -> Value {
    let mut properties = Map::new();
    let mut columns = Map::new();
    for column in &table.columns {
        properties.insert(column.name.clone(), column.values.property());
        columns.insert(column.name.clone(), column.values.pack(packer));
    }
    let mut classes = Map::new();
    classes.insert(table.class.clone(), json!({ "properties": properties }));
    json!({
        "schema": { "id": "karui", "classes": classes },
        "propertyTables": [{
            "class": table.class, "count": table.rows(), "properties": columns
        }],
    })
}

/// How many different ids there are, all of which must name rows.
fn different(ids: &[f64], rows: usize, what: &'static str, index: usize) -> karui::Result<usize> {
    let mut found = BTreeSet::new();
    for &id in ids {
        if id < 0.0 || id.fract() != 0.0 || id >= rows as f64 {
            return Err(karui::Error::BadReference {
                what,
                index,
                target: "feature",
                to: id.max(0.0) as usize,
                problem: "has no row in the table",
            });
        }
        found.insert(id as u64);
    }
    Ok(found.len())
}
