//! Metadata: schemas, classes, and what claims to be of a class (3D Metadata
//! Specification, used by 3D Tiles 1.1 and `EXT_structural_metadata` alike).

use super::{
    at::At,
    findings::Notes,
    parse::{shown, wrong},
};
use serde_json::{Map, Value};
use std::collections::{BTreeMap, BTreeSet};

/// Classes and enums of a schema.
#[derive(Debug, Default)]
pub(super) struct Schema {
    pub classes: BTreeMap<String, Class>,
}

/// Properties by id.
pub(super) type Class = BTreeMap<String, Property>;

/// A property of a class.
#[derive(Debug, Clone)]
pub(super) struct Property {
    pub kind: Kind,
    pub array: bool,
    /// Elements of an array of fixed length.
    pub count: Option<u64>,
    pub required: bool,
    pub semantic: Option<String>,
    /// Bytes of a component or enum value.
    pub component: u64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Number { components: u64 },
    Text,
    Boolean,
    Enum,
}

const COMPONENTS: [(&str, u64); 10] = [
    ("INT8", 1),
    ("UINT8", 1),
    ("INT16", 2),
    ("UINT16", 2),
    ("INT32", 4),
    ("UINT32", 4),
    ("INT64", 8),
    ("UINT64", 8),
    ("FLOAT32", 4),
    ("FLOAT64", 8),
];

const NUMBERS: [(&str, u64); 7] = [
    ("SCALAR", 1),
    ("VEC2", 2),
    ("VEC3", 3),
    ("VEC4", 4),
    ("MAT2", 4),
    ("MAT3", 9),
    ("MAT4", 16),
];

fn lookup(table: &[(&str, u64)], name: Option<&str>) -> Option<u64> {
    let name = name?;
    table
        .iter()
        .find(|(n, _)| *n == name)
        .map(|(_, value)| *value)
}

/// Reads a schema; what is wrong is noted and left out.
pub(super) fn schema(json: &Value, at: &At<'_>, notes: &mut Notes<'_>) -> Schema {
    let mut schema = Schema::default();
    if json.get("id").and_then(Value::as_str).is_none() {
        notes.error(at, "schema-id", "`id`", "none");
    }
    let enums = enums(json, &at.key("enums"), notes);
    let at = at.key("classes");
    for (name, class) in members(json.get("classes")) {
        let at = at.key(name);
        let at = at.key("properties");
        let mut properties = Class::new();
        for (id, raw) in members(class.get("properties")) {
            if let Some(property) = property(raw, &enums, &at.key(id), notes) {
                properties.insert(id.clone(), property);
            }
        }
        schema.classes.insert(name.clone(), properties);
    }
    schema
}

/// Bytes of the values of every enum.
fn enums(json: &Value, at: &At<'_>, notes: &mut Notes<'_>) -> BTreeMap<String, u64> {
    let mut found = BTreeMap::new();
    for (name, raw) in members(json.get("enums")) {
        let kind = raw
            .get("valueType")
            .and_then(Value::as_str)
            .unwrap_or("UINT16");
        let size = lookup(&COMPONENTS[..8], Some(kind));
        let at = at.key(name);
        if size.is_none() {
            notes.error(at.key("valueType"), "enum", "an integer type", kind);
        }
        if raw
            .get("values")
            .and_then(Value::as_array)
            .is_none_or(Vec::is_empty)
        {
            notes.error(at.key("values"), "enum", "values", "none");
        }
        found.insert(name.clone(), size.unwrap_or(2));
    }
    found
}

fn members(value: Option<&Value>) -> impl Iterator<Item = (&String, &Value)> {
    value.and_then(Value::as_object).into_iter().flatten()
}

fn property(
    raw: &Value,
    enums: &BTreeMap<String, u64>,
    at: &At<'_>,
    notes: &mut Notes<'_>,
) -> Option<Property> {
    let text = |key: &str| raw.get(key).and_then(Value::as_str);
    let name = text("type");
    let (kind, component) = match (name, lookup(&NUMBERS, name)) {
        (_, Some(components)) => {
            let component = lookup(&COMPONENTS, text("componentType"));
            if component.is_none() {
                let found = text("componentType").unwrap_or("none");
                notes.error(at, "property-component-type", "a componentType", found);
            }
            (Kind::Number { components }, component?)
        }
        (Some("STRING"), _) => (Kind::Text, 1),
        (Some("BOOLEAN"), _) => (Kind::Boolean, 1),
        (Some("ENUM"), _) => {
            let size = text("enumType").and_then(|e| enums.get(e));
            if size.is_none() {
                let found = text("enumType").unwrap_or("none");
                notes.error(at, "property-enum-type", "an enum of the schema", found);
            }
            (Kind::Enum, *size?)
        }
        (found, _) => {
            let found = found.unwrap_or("none");
            notes.error(
                at.key("type"),
                "property-type",
                "a type of 3D Metadata",
                found,
            );
            return None;
        }
    };
    let flag = |key: &str| raw.get(key).and_then(Value::as_bool).unwrap_or(false);
    Some(Property {
        kind,
        array: flag("array"),
        count: raw.get("count").and_then(Value::as_u64),
        required: flag("required"),
        semantic: text("semantic").map(str::to_owned),
        component,
    })
}

impl Schema {
    /// The class that `json` names.
    fn class(&self, json: &Value, at: &At<'_>, notes: &mut Notes<'_>) -> Option<&Class> {
        let name = json.get("class").and_then(Value::as_str);
        let found = name.and_then(|n| self.classes.get(n));
        if found.is_none() {
            let names: Vec<&str> = self.classes.keys().map(String::as_str).take(8).collect();
            let expected = format!("a class of the schema ({})", names.join(", "));
            notes.error(
                at.key("class"),
                "metadata-class",
                expected,
                name.unwrap_or("none"),
            );
        }
        found
    }

    /// Checks that the properties named are those of the class.
    fn names(
        class: &Class,
        properties: Option<&Map<String, Value>>,
        at: &At<'_>,
        notes: &mut Notes<'_>,
    ) {
        let at = at.key("properties");
        let there = |id: &str| properties.is_some_and(|p| p.contains_key(id));
        for (id, _) in properties.into_iter().flatten() {
            if !class.contains_key(id) {
                notes.error(
                    at.key(id),
                    "metadata-property",
                    "a property of the class",
                    id,
                );
            }
        }
        for (id, property) in class {
            if property.required && !there(id) {
                notes.error(at, "metadata-required", format!("`{id}`"), "none");
            }
        }
    }

    /// Checks an object with a `class` and values of its `properties`.
    pub fn check_entity(&self, json: &Value, at: &At<'_>, notes: &mut Notes<'_>) {
        let Some(class) = self.class(json, at, notes) else {
            return;
        };
        let properties = json.get("properties").and_then(Value::as_object);
        Self::names(class, properties, at, notes);
        let at = at.key("properties");
        for (id, value) in properties.into_iter().flatten() {
            if let Some(property) = class.get(id)
                && !fits(property, value)
            {
                notes.error(
                    at.key(id),
                    "metadata-value",
                    describe(property),
                    shown(value),
                );
            }
        }
    }

    /// Checks a property table: its class, and that its columns have as many
    /// rows as it says.
    pub fn check_table<'v>(
        &self,
        json: &Value,
        view: &dyn Fn(usize) -> Option<&'v [u8]>,
        at: &At<'_>,
        notes: &mut Notes<'_>,
    ) {
        let Some(class) = self.class(json, at, notes) else {
            return;
        };
        let Some(rows) = json.get("count").and_then(Value::as_u64).filter(|c| *c > 0) else {
            let found = json.get("count").map_or_else(|| "none".into(), shown);
            return notes.error(at.key("count"), "table-count", "at least 1", found);
        };
        let columns = json.get("properties").and_then(Value::as_object);
        Self::names(class, columns, at, notes);
        let at = at.key("properties");
        for (id, column) in columns.into_iter().flatten() {
            if let Some(property) = class.get(id) {
                check_column(property, column, rows, view, &at.key(id), notes);
            }
        }
    }

    /// Semantics of a class.
    pub fn semantics(&self, class: &str) -> BTreeSet<&str> {
        let properties = self.classes.get(class).into_iter().flatten();
        properties
            .filter_map(|(_, p)| p.semantic.as_deref())
            .collect()
    }
}

fn describe(property: &Property) -> String {
    let one = match property.kind {
        Kind::Number { components: 1 } => "a number".to_owned(),
        Kind::Number { components } => format!("{components} numbers"),
        Kind::Text => "a text".to_owned(),
        Kind::Boolean => "true or false".to_owned(),
        Kind::Enum => "the name of an enum value".to_owned(),
    };
    match (property.array, property.count) {
        (false, _) => one,
        (true, None) => format!("an array, each {one}"),
        (true, Some(count)) => format!("an array of {count}, each {one}"),
    }
}

fn fits(property: &Property, value: &Value) -> bool {
    if !property.array {
        return fits_one(property.kind, value);
    }
    let Some(items) = value.as_array() else {
        return false;
    };
    let length = property.count.is_none_or(|c| c == items.len() as u64);
    length && items.iter().all(|item| fits_one(property.kind, item))
}

fn fits_one(kind: Kind, value: &Value) -> bool {
    match kind {
        // Numbers beyond 53 bits may be given as texts.
        Kind::Number { components: 1 } => value.is_number() || value.is_string(),
        Kind::Number { components } => value.as_array().is_some_and(|items| {
            items.len() as u64 == components && items.iter().all(Value::is_number)
        }),
        Kind::Text | Kind::Enum => value.is_string(),
        Kind::Boolean => value.is_boolean(),
    }
}

/// Checks the lengths of the buffer views of a column.
fn check_column<'v>(
    property: &Property,
    column: &Value,
    rows: u64,
    view: &dyn Fn(usize) -> Option<&'v [u8]>,
    at: &At<'_>,
    notes: &mut Notes<'_>,
) {
    let get = |key: &str, notes: &mut Notes<'_>| {
        let named = column.get(key)?;
        let found = named.as_u64().and_then(|v| view(v as usize));
        if found.is_none() {
            wrong(&at.key(key), "a buffer view", named, notes);
        }
        found
    };
    let Some(values) = get("values", notes) else {
        if column.get("values").is_none() {
            notes.error(at, "required", "`values`", "none");
        }
        return;
    };
    let mut elements = rows.checked_mul(property.count.unwrap_or(1));
    if property.array && property.count.is_none() {
        let kind = column.get("arrayOffsetType");
        let offsets = get("arrayOffsets", notes);
        elements = check_offsets(offsets, kind, rows, &at.key("arrayOffsets"), notes);
    }
    if property.kind == Kind::Text {
        let kind = column.get("stringOffsetType");
        let offsets = get("stringOffsets", notes);
        let at = at.key("stringOffsets");
        elements = elements.and_then(|e| check_offsets(offsets, kind, e, &at, notes));
    }
    let Some(elements) = elements else { return };
    let needed = match property.kind {
        Kind::Boolean => Some(elements.div_ceil(8)),
        Kind::Number { components } => elements.checked_mul(components * property.component),
        Kind::Text | Kind::Enum => elements.checked_mul(property.component),
    };
    if needed.is_none_or(|n| (values.len() as u64) < n) {
        let expected = format!(
            "{rows} rows in at least {} bytes",
            needed.unwrap_or(u64::MAX)
        );
        let found = format!("{} bytes", values.len());
        notes.error(at.key("values"), "table-rows", expected, found);
    }
}

/// Offsets must be one more than the rows and must not fall; the last is the
/// number of elements (or bytes of text).
fn check_offsets(
    bytes: Option<&[u8]>,
    kind: Option<&Value>,
    rows: u64,
    at: &At<'_>,
    notes: &mut Notes<'_>,
) -> Option<u64> {
    let name = kind.map_or(Some("UINT32"), Value::as_str);
    let size = lookup(&COMPONENTS, name).filter(|_| name.is_some_and(|n| n.starts_with('U')));
    let (Some(bytes), Some(size)) = (bytes, size) else {
        notes.error(at, "table-offsets", "unsigned offsets", "none");
        return None;
    };
    let there = bytes.len() as u64 / size;
    if there < rows.saturating_add(1) {
        let expected = format!("{} offsets", rows.saturating_add(1));
        notes.error(at, "table-rows", expected, there.to_string());
        return None;
    }
    let read = |row: &[u8]| row.iter().rev().fold(0u64, |n, &b| n << 8 | u64::from(b));
    let offsets = bytes
        .chunks_exact(size as usize)
        .take(rows as usize + 1)
        .map(read);
    let mut last = 0;
    for (i, offset) in offsets.enumerate() {
        if offset < last {
            let expected = format!("offset {i} of at least {last}");
            notes.error(at, "table-offsets", expected, offset.to_string());
            return None;
        }
        last = offset;
    }
    Some(last)
}
