//! From the JSON of a tileset to its model. Everything that is wrong is noted
//! and replaced by a harmless value, so that one run finds all of it.

use super::{
    at::At,
    cut::{Piece, Pieces, cut},
    findings::Notes,
    model::{Asset, BoundingVolume, Content, ImplicitTiling, Refine, Scheme, Tile, Tileset},
    parse_volume::volume,
};
use crate::error::Result;
use glam::DMat4;
use serde_json::{Map, Value};

type Object = Map<String, Value>;

/// Reads a tileset file that lies in memory.
///
/// # Errors
/// If it is no JSON; everything else is noted.
pub(super) fn parse(text: &[u8], notes: &mut Notes<'_>) -> Result<Tileset> {
    let Pieces {
        mut document,
        tiles: pieces,
        strangers,
    } = cut(text)?;
    let at = At::Document;
    let mut tileset = Tileset {
        asset: asset(&mut document, notes),
        geometric_error: error(&mut document, &at, notes),
        extensions_used: strings(&mut document, "extensionsUsed", notes),
        extensions_required: strings(&mut document, "extensionsRequired", notes),
        ..Tileset::default()
    };
    if let Some(root) = document.shift_remove("root").filter(|r| !r.is_null()) {
        wrong(&at.key("root"), "an object", &root, notes);
    } else if pieces.is_empty() {
        notes.error(at, "required", "`root`", "none");
    }
    tileset.other = document;
    read_tiles(&mut tileset, pieces, notes);
    for (parent, index) in strangers {
        let at = At::Tile(&tileset.tiles, parent);
        let at = at.key("children");
        notes.error(at.index(index), "type", "a tile", "no object");
    }
    Ok(tileset)
}

/// Tiles are linked first, so that places can be told.
fn read_tiles(tileset: &mut Tileset, pieces: Vec<Piece>, notes: &mut Notes<'_>) {
    let mut jsons = Vec::with_capacity(pieces.len());
    for piece in pieces {
        let empty = piece.children.as_ref().is_some_and(Vec::is_empty);
        jsons.push((piece.json, empty));
        tileset.tiles.push(Tile {
            parent: piece.parent,
            children: piece.children.unwrap_or_default(),
            ..Tile::default()
        });
    }
    for (t, (mut json, no_children)) in jsons.into_iter().enumerate() {
        let at = At::Tile(&tileset.tiles, t as u32);
        if no_children {
            notes.error(
                at.key("children"),
                "children-empty",
                "a child or no `children`",
                "none",
            );
        } else if let Some(children) = json.shift_remove("children") {
            wrong(&at.key("children"), "an array of tiles", &children, notes);
        }
        let read = tile(json, &at, notes);
        let links = &mut tileset.tiles[t];
        *links = Tile {
            parent: links.parent,
            children: std::mem::take(&mut links.children),
            ..read
        };
    }
}

fn tile(mut json: Object, at: &At<'_>, notes: &mut Notes<'_>) -> Tile {
    let root = matches!(at, At::Tile(_, 0));
    let refine = refine(&mut json, at, notes);
    if root && refine.is_none() {
        notes.error(at, "refine-of-root", "`refine` of the root tile", "none");
    }
    let mut tile = Tile {
        bounding_volume: BoundingVolume::default(),
        geometric_error: error(&mut json, at, notes),
        refine,
        transform: transform(&mut json, at, notes),
        ..Tile::default()
    };
    match json.shift_remove("boundingVolume") {
        Some(value) => tile.bounding_volume = volume(value, &at.key("boundingVolume"), notes),
        None => notes.error(at, "required", "`boundingVolume`", "none"),
    }
    if let Some(value) = json.shift_remove("viewerRequestVolume") {
        let read = volume(value, &at.key("viewerRequestVolume"), notes);
        tile.viewer_request_volume = Some(read);
    }
    contents(&mut json, &mut tile, at, notes);
    if let Some(value) = json.shift_remove("implicitTiling") {
        tile.implicit = implicit(value, &at.key("implicitTiling"), notes);
    }
    tile.other = json;
    tile
}

fn asset(document: &mut Object, notes: &mut Notes<'_>) -> Asset {
    let at = At::Document;
    let mut asset = Asset::default();
    let Some(mut other) = object(document, "asset", &at, notes) else {
        notes.error(at, "required", "`asset`", "none");
        return asset;
    };
    let at = at.key("asset");
    let version = text(&mut other, "version", &at, notes);
    match version.as_deref() {
        Some("1.0" | "1.1") => {}
        Some(found) => notes.error(at.key("version"), "version", "1.0 or 1.1", found),
        None => notes.error(at, "required", "`version`", "none"),
    }
    asset.version = version.unwrap_or_default();
    asset.other = other;
    asset
}

/// `geometricError`, which has to be there; 0 if it is wrong.
fn error(json: &mut Object, at: &At<'_>, notes: &mut Notes<'_>) -> f64 {
    let key = "geometricError";
    let Some(value) = json.shift_remove(key) else {
        notes.error(at, "required", "`geometricError`", "none");
        return 0.0;
    };
    match value.as_f64().filter(|e| e.is_finite()) {
        Some(error) if error >= 0.0 => error,
        Some(error) => {
            let found = error.to_string();
            notes.error(at.key(key), "geometric-error-negative", "at least 0", found);
            0.0
        }
        None => {
            wrong(&at.key(key), "a number", &value, notes);
            0.0
        }
    }
}

fn refine(json: &mut Object, at: &At<'_>, notes: &mut Notes<'_>) -> Option<Refine> {
    let found = text(json, "refine", at, notes)?;
    match found.as_str() {
        "ADD" => Some(Refine::Add),
        "REPLACE" => Some(Refine::Replace),
        _ => {
            notes.error(at.key("refine"), "refine", "ADD or REPLACE", found);
            None
        }
    }
}

fn transform(json: &mut Object, at: &At<'_>, notes: &mut Notes<'_>) -> Option<DMat4> {
    let value = json.shift_remove("transform")?;
    let at = at.key("transform");
    let numbers: [f64; 16] = numbers(&value, &at, notes)?.try_into().ok().or_else(|| {
        wrong(&at, "16 numbers", &value, notes);
        None
    })?;
    let matrix = DMat4::from_cols_array(&numbers);
    let last = matrix.row(3);
    if last.to_array() != [0.0, 0.0, 0.0, 1.0] {
        let rule = "transform-affine";
        notes.error(at, rule, "a last row of 0, 0, 0, 1", format!("{last}"));
        return None;
    }
    let determinant = matrix.determinant();
    if determinant == 0.0 || !determinant.is_finite() {
        let rule = "transform-invertible";
        notes.error(
            at,
            rule,
            "an invertible matrix",
            format!("determinant {determinant}"),
        );
        return None;
    }
    Some(matrix)
}

fn contents(json: &mut Object, tile: &mut Tile, at: &At<'_>, notes: &mut Notes<'_>) {
    let single = json.shift_remove("content");
    let plural = json.shift_remove("contents");
    if single.is_some() && plural.is_some() {
        notes.error(at, "content-or-contents", "`content` or `contents`", "both");
    }
    if let Some(value) = single {
        tile.contents
            .extend(content(value, &at.key("content"), notes));
    }
    let Some(value) = plural else { return };
    tile.plural = true;
    let at = at.key("contents");
    match value {
        Value::Array(items) if items.is_empty() => {
            notes.error(at, "contents-empty", "a content or no `contents`", "none");
        }
        Value::Array(items) => {
            let read = |(i, value)| content(value, &at.index(i), notes);
            let read: Vec<_> = items.into_iter().enumerate().filter_map(read).collect();
            tile.contents.extend(read);
        }
        other => wrong(&at, "an array of contents", &other, notes),
    }
}

fn content(value: Value, at: &At<'_>, notes: &mut Notes<'_>) -> Option<Content> {
    let mut json = into_object(value, at, notes)?;
    let Some(uri) = text(&mut json, "uri", at, notes) else {
        let found = if json.contains_key("url") {
            "`url`, of before 1.0"
        } else {
            "none"
        };
        notes.error(at, "required", "`uri`", found);
        return None;
    };
    let bounds = json.shift_remove("boundingVolume");
    Some(Content {
        uri,
        bounding_volume: bounds.map(|v| volume(v, &at.key("boundingVolume"), notes)),
        other: json,
    })
}

fn implicit(value: Value, at: &At<'_>, notes: &mut Notes<'_>) -> Option<ImplicitTiling> {
    let mut json = into_object(value, at, notes)?;
    let scheme = text(&mut json, "subdivisionScheme", at, notes);
    let scheme = match scheme.as_deref() {
        Some("QUADTREE") => Some(Scheme::Quadtree),
        Some("OCTREE") => Some(Scheme::Octree),
        found => {
            let found = found.unwrap_or("none");
            let at = at.key("subdivisionScheme");
            notes.error(at, "subdivision-scheme", "QUADTREE or OCTREE", found);
            None
        }
    };
    let subtree_levels = levels(&mut json, "subtreeLevels", at, notes);
    let available_levels = levels(&mut json, "availableLevels", at, notes);
    let subtrees = object(&mut json, "subtrees", at, notes);
    let subtrees = subtrees.and_then(|mut s| text(&mut s, "uri", &at.key("subtrees"), notes));
    if subtrees.is_none() {
        notes.error(at.key("subtrees"), "required", "`uri`", "none");
    }
    Some(ImplicitTiling {
        scheme: scheme?,
        subtree_levels: subtree_levels?,
        available_levels: available_levels?,
        subtrees: subtrees?,
        other: json,
    })
}

/// A number of levels, at least 1.
fn levels(json: &mut Object, key: &str, at: &At<'_>, notes: &mut Notes<'_>) -> Option<u32> {
    let Some(value) = json.shift_remove(key) else {
        notes.error(at, "required", format!("`{key}`"), "none");
        return None;
    };
    let whole = value.as_u64().and_then(|n| u32::try_from(n).ok());
    if whole.is_none_or(|n| n == 0) {
        let at = at.key(key);
        notes.error(
            at,
            "implicit-levels",
            "a whole number of at least 1",
            shown(&value),
        );
        return None;
    }
    whole
}

fn strings(document: &mut Object, key: &str, notes: &mut Notes<'_>) -> Vec<String> {
    let at = At::Document;
    let at = at.key(key);
    match document.shift_remove(key) {
        None => Vec::new(),
        Some(Value::Array(items)) => {
            let mut names: Vec<String> = Vec::new();
            for (i, item) in items.iter().enumerate() {
                match item.as_str() {
                    Some(name) => names.push(name.to_owned()),
                    None => wrong(&at.index(i), "a text", item, notes),
                }
            }
            names
        }
        Some(other) => {
            wrong(&at, "an array of texts", &other, notes);
            Vec::new()
        }
    }
}

/// Finite numbers of an array; notes what is none.
pub(super) fn numbers(value: &Value, at: &At<'_>, notes: &mut Notes<'_>) -> Option<Vec<f64>> {
    let Some(items) = value.as_array() else {
        wrong(at, "an array of numbers", value, notes);
        return None;
    };
    let mut found = Vec::with_capacity(items.len());
    for (i, item) in items.iter().enumerate() {
        match item.as_f64().filter(|x| x.is_finite()) {
            Some(x) => found.push(x),
            None => {
                wrong(&at.index(i), "a finite number", item, notes);
                return None;
            }
        }
    }
    Some(found)
}

/// Takes an object out of another; `None` if it is missing or none.
fn object(json: &mut Object, key: &str, at: &At<'_>, notes: &mut Notes<'_>) -> Option<Object> {
    let value = json.shift_remove(key)?;
    into_object(value, &at.key(key), notes)
}

pub(super) fn into_object(value: Value, at: &At<'_>, notes: &mut Notes<'_>) -> Option<Object> {
    match value {
        Value::Object(object) => Some(object),
        other => {
            wrong(at, "an object", &other, notes);
            None
        }
    }
}

fn text(json: &mut Object, key: &str, at: &At<'_>, notes: &mut Notes<'_>) -> Option<String> {
    match json.shift_remove(key)? {
        Value::String(text) => Some(text),
        other => {
            wrong(&at.key(key), "a text", &other, notes);
            None
        }
    }
}

/// Notes a value of the wrong type.
pub(super) fn wrong(at: &At<'_>, expected: &str, found: &Value, notes: &mut Notes<'_>) {
    notes.error(at, "type", expected, shown(found));
}

/// A value in a message.
pub(super) fn shown(value: &Value) -> String {
    match value {
        Value::Array(items) => format!("an array of {}", items.len()),
        Value::Object(_) => "an object".into(),
        Value::String(text) if text.chars().count() > 40 => "a long text".into(),
        other => other.to_string(),
    }
}
