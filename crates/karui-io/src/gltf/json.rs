//! Numbers, texts and references out of JSON; every error names the place by
//! its JSON pointer.

use crate::error::{Error, ErrorKind, Place, Result};
use serde::de::{Deserialize, Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_json::Value;
use std::fmt;

/// A place in the document. The pointer is put together only for an error.
#[derive(Clone, Copy)]
pub(super) struct At<'a> {
    parent: Option<&'a At<'a>>,
    key: &'a str,
    index: Option<usize>,
}

/// The document itself.
pub(super) const ROOT: At<'static> = At {
    parent: None,
    key: "",
    index: None,
};

impl<'a> At<'a> {
    /// The property `key` of this place.
    pub fn key(&'a self, key: &'a str) -> Self {
        At {
            parent: Some(self),
            key,
            index: None,
        }
    }

    /// Element `index` of the array `key` of this place.
    pub fn item(&'a self, key: &'a str, index: usize) -> Self {
        At {
            parent: Some(self),
            key,
            index: Some(index),
        }
    }

    /// An error at this place.
    pub fn fail(&self, kind: ErrorKind) -> Error {
        Error::new(Place::Pointer(self.to_string()), kind)
    }

    /// A rule of the format that is broken at this place.
    pub fn syntax(&self, expected: impl Into<String>, found: impl Into<String>) -> Error {
        self.fail(ErrorKind::syntax(expected, found))
    }
}

impl fmt::Display for At<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(parent) = self.parent else {
            return Ok(());
        };
        write!(f, "{parent}")?;
        // An element of an array that is itself an element has no key.
        if !self.key.is_empty() {
            write!(f, "/{}", self.key.replace('~', "~0").replace('/', "~1"))?;
        }
        match self.index {
            Some(index) => write!(f, "/{index}"),
            None => Ok(()),
        }
    }
}

/// A short rendering of a value for messages.
fn shown(value: &Value) -> String {
    match value {
        Value::Array(items) => format!("an array of {}", items.len()),
        Value::Object(_) => "an object".into(),
        Value::String(text) if text.len() > 40 => "a long text".into(),
        other => other.to_string(),
    }
}

/// A non-negative whole number; `8.0` counts as one.
fn whole(value: &Value) -> Option<usize> {
    if let Some(n) = value.as_u64() {
        return usize::try_from(n).ok();
    }
    let f = value.as_f64()?;
    (f.fract() == 0.0 && (0.0..9.0e15).contains(&f)).then_some(f as usize)
}

/// The whole number `key`, if present.
pub(super) fn number(value: &Value, key: &str, at: &At<'_>) -> Result<Option<usize>> {
    let Some(found) = value.get(key) else {
        return Ok(None);
    };
    match whole(found) {
        Some(n) => Ok(Some(n)),
        None => Err(at
            .key(key)
            .syntax("a non-negative whole number", shown(found))),
    }
}

/// The whole number `key`, which must be present.
pub(super) fn required(value: &Value, key: &str, at: &At<'_>) -> Result<usize> {
    number(value, key, at)?.ok_or_else(|| at.syntax(format!("`{key}`"), "none"))
}

/// Checks that `index` names one of `count` elements.
pub(super) fn in_range(
    index: usize,
    count: usize,
    what: &'static str,
    at: &At<'_>,
) -> Result<usize> {
    if index < count {
        return Ok(index);
    }
    let index = index as i64;
    Err(at.fail(ErrorKind::IndexOutOfRange { what, index, count }))
}

/// The index `key` into `count` elements of kind `what`, if present.
pub(super) fn index(
    value: &Value,
    key: &str,
    count: usize,
    what: &'static str,
    at: &At<'_>,
) -> Result<Option<usize>> {
    let found = number(value, key, at)?;
    found
        .map(|n| in_range(n, count, what, &at.key(key)))
        .transpose()
}

/// The array `key`; empty if absent.
pub(super) fn array<'v>(value: &'v Value, key: &str, at: &At<'_>) -> Result<&'v [Value]> {
    match value.get(key) {
        None => Ok(&[]),
        Some(Value::Array(items)) => Ok(items),
        Some(other) => Err(at.key(key).syntax("an array", shown(other))),
    }
}

/// The indices in the array `key`, each into `count` elements.
pub(super) fn indices(
    value: &Value,
    key: &str,
    count: usize,
    what: &'static str,
    at: &At<'_>,
) -> Result<Vec<u32>> {
    let items = array(value, key, at)?;
    let checked = |(i, item): (usize, &Value)| {
        let at = at.item(key, i);
        let index = whole(item).ok_or_else(|| at.syntax("an index", shown(item)))?;
        Ok(in_range(index, count, what, &at)? as u32)
    };
    items.iter().enumerate().map(checked).collect()
}

/// The text `key`, if present and a text.
pub(super) fn text<'v>(value: &'v Value, key: &str) -> Option<&'v str> {
    value.get(key)?.as_str()
}

/// The name of an element, if it has one.
pub(super) fn name(value: &Value) -> Option<String> {
    text(value, "name").map(str::to_owned)
}

fn finite(value: &Value, at: &At<'_>) -> Result<f32> {
    let Some(f) = value.as_f64() else {
        return Err(at.syntax("a number", shown(value)));
    };
    let f = f as f32;
    if f.is_finite() {
        Ok(f)
    } else {
        Err(at.fail(ErrorKind::NotFinite { what: "the number" }))
    }
}

/// The number `key`, if present.
pub(super) fn float(value: &Value, key: &str, at: &At<'_>) -> Result<Option<f32>> {
    let found = value.get(key);
    found.map(|v| finite(v, &at.key(key))).transpose()
}

/// The `N` numbers `key`, if present.
pub(super) fn floats<const N: usize>(
    value: &Value,
    key: &str,
    at: &At<'_>,
) -> Result<Option<[f32; N]>> {
    if value.get(key).is_none() {
        return Ok(None);
    }
    let items = array(value, key, at)?;
    if items.len() != N {
        let found = items.len().to_string();
        return Err(at.key(key).syntax(format!("{N} numbers"), found));
    }
    let mut numbers = [0.0; N];
    for (i, (number, item)) in numbers.iter_mut().zip(items).enumerate() {
        *number = finite(item, &at.item(key, i))?;
    }
    Ok(Some(numbers))
}

/// The extension `name` of an element.
pub(super) fn extension<'v>(value: &'v Value, name: &str) -> Option<&'v Value> {
    value.get("extensions")?.get(name)
}

/// Sets the extension `name` of an element.
pub(super) fn set_extension(value: &mut Value, name: &str, content: Value) {
    if !value["extensions"].is_object() {
        value["extensions"] = Value::Object(serde_json::Map::new());
    }
    value["extensions"][name] = content;
}

/// Removes the key, keeping the order of the others.
pub(super) fn remove(value: &mut Value, key: &str) -> Option<Value> {
    value.as_object_mut()?.shift_remove(key)
}

/// Removes the extension `name`, and `extensions` if nothing is left in it.
pub(super) fn remove_extension(value: &mut Value, name: &str) {
    let Some(extensions) = value.get_mut("extensions") else {
        return;
    };
    remove(extensions, name);
    if extensions
        .as_object()
        .is_some_and(serde_json::Map::is_empty)
    {
        remove(value, "extensions");
    }
}

/// Number of entries of the top-level array `key`.
pub(super) fn count(json: &Value, key: &str) -> usize {
    json.get(key).and_then(Value::as_array).map_or(0, Vec::len)
}

/// Most elements of kinds that files have few of (materials, images, ...).
const FEW: u64 = 100_000;
/// Most elements of kinds that files may have many of (nodes, accessors, ...).
const MANY: u64 = 4_000_000;

/// Lengths of the top-level arrays, counted without building anything.
#[derive(serde::Deserialize)]
#[serde(default, rename_all = "camelCase")]
#[derive(Default)]
struct Lengths {
    animations: Length,
    cameras: Length,
    images: Length,
    materials: Length,
    samplers: Length,
    scenes: Length,
    skins: Length,
    textures: Length,
    accessors: Length,
    buffer_views: Length,
    buffers: Length,
    meshes: Length,
    nodes: Length,
}

impl Lengths {
    fn check(&self) -> Result<()> {
        let limits = [
            ("animations", &self.animations, FEW),
            ("cameras", &self.cameras, FEW),
            ("images", &self.images, FEW),
            ("materials", &self.materials, FEW),
            ("samplers", &self.samplers, FEW),
            ("scenes", &self.scenes, FEW),
            ("skins", &self.skins, FEW),
            ("textures", &self.textures, FEW),
            ("buffers", &self.buffers, FEW),
            ("accessors", &self.accessors, MANY),
            ("bufferViews", &self.buffer_views, MANY),
            ("meshes", &self.meshes, MANY),
            ("nodes", &self.nodes, MANY),
        ];
        for (what, &Length(found), limit) in limits {
            if found > limit {
                return Err(ROOT
                    .key(what)
                    .fail(ErrorKind::TooLarge { what, found, limit }));
            }
        }
        Ok(())
    }
}

/// The length of an array, its content skipped.
#[derive(Default)]
struct Length(u64);

impl<'de> Deserialize<'de> for Length {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(LengthVisitor)
    }
}

struct LengthVisitor;

impl<'de> Visitor<'de> for LengthVisitor {
    type Value = Length;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an array")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Length, A::Error> {
        let mut found = 0;
        while items.next_element::<IgnoredAny>()?.is_some() {
            found += 1;
        }
        Ok(Length(found))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Length, A::Error> {
        while entries.next_entry::<IgnoredAny, IgnoredAny>()?.is_some() {}
        Ok(Length(0))
    }
}

/// Parses the document, refusing absurd numbers of elements before anything
/// is built from them.
pub(super) fn parse(text: &[u8]) -> Result<Value> {
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    let lengths: Lengths = serde_json::from_slice(text).map_err(json_error)?;
    lengths.check()?;
    let json: Value = serde_json::from_slice(text).map_err(json_error)?;
    check_version(&json)?;
    Ok(json)
}

fn json_error(error: serde_json::Error) -> Error {
    let kind = if error.is_eof() {
        ErrorKind::truncated("the rest of the JSON", "the end")
    } else {
        ErrorKind::syntax("a glTF document in JSON", error.to_string())
    };
    Error::new(Place::Line(error.line() as u64), kind)
}

fn check_version(json: &Value) -> Result<()> {
    let at = ROOT.key("asset");
    let Some(asset) = json.get("asset") else {
        return Err(ROOT.syntax("`asset`", "none"));
    };
    let version = text(asset, "minVersion").or_else(|| text(asset, "version"));
    match version {
        Some(version) if version == "2" || version.starts_with("2.") => Ok(()),
        Some(other) => Err(at.fail(ErrorKind::unsupported(format!("glTF version {other}")))),
        None => Err(at.syntax("`version`", "none")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn pointers_are_escaped() {
        let meshes = ROOT.item("meshes", 3);
        let at = meshes.key("a/b~c");
        assert_eq!(at.to_string(), "/meshes/3/a~1b~0c");
        assert_eq!(ROOT.to_string(), "");
    }

    #[test]
    fn whole_numbers_only() {
        let value = json!({"a": 3, "b": 4.0, "c": -1, "d": 1.5, "e": "x", "f": 1e300});
        assert_eq!(number(&value, "a", &ROOT).unwrap(), Some(3));
        assert_eq!(number(&value, "b", &ROOT).unwrap(), Some(4));
        assert_eq!(number(&value, "z", &ROOT).unwrap(), None);
        for key in ["c", "d", "e", "f"] {
            assert!(number(&value, key, &ROOT).is_err(), "{key}");
        }
    }

    #[test]
    fn million_materials_are_refused_before_they_are_built() {
        let text = format!(
            r#"{{"asset":{{"version":"2.0"}},"materials":[{}{{}}]}}"#,
            "{},".repeat(1_000_000)
        );
        let error = parse(text.as_bytes()).unwrap_err();
        assert!(matches!(
            *error.kind,
            ErrorKind::TooLarge {
                found: 1_000_001,
                ..
            }
        ));
    }

    #[test]
    fn nesting_is_bounded() {
        let deep = format!(
            r#"{{"asset":{{"version":"2.0"}},"extras":{}{}}}"#,
            "[".repeat(100_000),
            "]".repeat(100_000)
        );
        assert!(parse(deep.as_bytes()).is_err());
    }
}
