//! One tileset file within a check: read, with the rules that concern the
//! file as a whole.

use super::{
    at::At,
    findings::Notes,
    folder::resolve,
    model::Tileset,
    parse::shown,
    schema::{Schema, schema},
};
use serde_json::Value;
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

/// Extensions of tilesets that change nothing the checker relies on, or that
/// it knows of.
const KNOWN: [&str; 8] = [
    "3DTILES_content_gltf",
    "3DTILES_metadata",
    "3DTILES_bounding_volume_S2",
    "3DTILES_bounding_volume_cylinder",
    "3DTILES_ellipsoid",
    "EXT_mesh_features",
    "EXT_structural_metadata",
    "EXT_mesh_gpu_instancing",
];

/// A tileset file and what is needed of it on the way down.
#[derive(Debug)]
pub(super) struct Set {
    pub tileset: Tileset,
    /// The file on disk.
    pub path: PathBuf,
    /// Its folder, relative to that of the root file.
    pub folder: PathBuf,
    /// Files this one was reached through, itself the last.
    pub chain: Vec<PathBuf>,
    pub schema: Option<Schema>,
}

impl Set {
    /// Checks what concerns the file as a whole.
    pub fn check(&mut self, root: &Path, notes: &mut Notes<'_>) {
        extensions(&self.tileset, notes);
        self.schema = self.read_schema(root, notes);
        let at = At::Document;
        let other = &self.tileset.other;
        if let Some(metadata) = other.get("metadata") {
            self.entity(metadata, &at.key("metadata"), notes);
        }
        let at = at.key("groups");
        match other.get("groups") {
            Some(Value::Array(groups)) => {
                for (i, group) in groups.iter().enumerate() {
                    self.entity(group, &at.index(i), notes);
                }
            }
            Some(found) => notes.error(at, "type", "an array", shown(found)),
            None => {}
        }
        for t in 0..self.tileset.tiles.len() as u32 {
            self.check_tile(t, notes);
        }
    }

    fn check_tile(&self, t: u32, notes: &mut Notes<'_>) {
        let tile = &self.tileset.tiles[t as usize];
        let at = At::Tile(&self.tileset.tiles, t);
        if let Some(metadata) = tile.other.get("metadata") {
            self.entity(metadata, &at.key("metadata"), notes);
        }
        let old = self.tileset.asset.version == "1.0";
        for (feature, there) in [
            ("contents", tile.plural),
            ("implicitTiling", tile.implicit.is_some()),
        ] {
            if old && there {
                notes.warn(
                    at.key(feature),
                    "version-feature",
                    "asset.version 1.1",
                    "1.0",
                );
            }
        }
        for (i, content) in tile.contents.iter().enumerate() {
            let place = if tile.plural {
                at.key("contents")
            } else {
                at.key("content")
            };
            let indexed = place.index(i);
            let place = if tile.plural { indexed } else { place };
            if let Some(metadata) = content.other.get("metadata") {
                self.entity(metadata, &place.key("metadata"), notes);
            }
            if let Some(group) = content.other.get("group") {
                let groups = self.tileset.other.get("groups").and_then(Value::as_array);
                let count = groups.map_or(0, Vec::len);
                if group.as_u64().is_none_or(|g| g >= count as u64) {
                    let expected = format!("one of {count} groups");
                    notes.error(place.key("group"), "content-group", expected, shown(group));
                }
            }
        }
    }

    /// Checks what claims to be of a class.
    fn entity(&self, json: &Value, at: &At<'_>, notes: &mut Notes<'_>) {
        match &self.schema {
            Some(schema) => schema.check_entity(json, at, notes),
            None => notes.error(at, "metadata-schema", "a schema", "none"),
        }
    }

    fn read_schema(&self, root: &Path, notes: &mut Notes<'_>) -> Option<Schema> {
        let at = At::Document;
        let other = &self.tileset.other;
        if let Some(uri) = other.get("schemaUri") {
            let at = at.key("schemaUri");
            if other.contains_key("schema") {
                notes.error(at, "schema-or-uri", "`schema` or `schemaUri`", "both");
            }
            let path = uri.as_str().and_then(|u| resolve(&self.folder, u).ok());
            let text = path.and_then(|p| std::fs::read(root.join(p)).ok());
            let json = text.and_then(|t| serde_json::from_slice::<Value>(&t).ok());
            if json.is_none() {
                notes.error(at, "schema-file", "a JSON file of the tileset", shown(uri));
            }
            return json.map(|j| schema(&j, &At::Document, notes));
        }
        other
            .get("schema")
            .map(|j| schema(j, &at.key("schema"), notes))
    }
}

fn extensions(tileset: &Tileset, notes: &mut Notes<'_>) {
    let at = At::Document;
    let at = at.key("extensionsRequired");
    let used: BTreeSet<&str> = tileset.extensions_used.iter().map(String::as_str).collect();
    for (i, name) in tileset.extensions_required.iter().enumerate() {
        let at = at.index(i);
        if !used.contains(name.as_str()) {
            notes.error(at, "extension-not-used", "a name in extensionsUsed", name);
        }
        if !KNOWN.contains(&name.as_str()) {
            notes.warn(at, "extension-unknown", "a known extension", name);
        }
    }
}
