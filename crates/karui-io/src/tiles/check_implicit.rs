//! The rules of implicit tiles and their subtrees.

use super::{
    at::At,
    check::{Above, Checker},
    findings::{Findings, Notes},
    implicit::{Cell, MAX_LEVEL, cells, offset},
    model::{ImplicitTiling, Scheme, Shape},
    set::Set,
    solid::Solid,
    subtree::{self, Layout, MAX_LEVELS, Subtree},
};
use crate::source::load;
use serde_json::{Map, Value};
use std::{path::PathBuf, rc::Rc};

/// An implicit tree.
pub(super) struct Implicit {
    set: Rc<Set>,
    tile: u32,
    tiling: ImplicitTiling,
    above: Above,
    shape: Option<Shape>,
    /// Metadata of the tiles says where they are, instead of their cells.
    elsewhere: bool,
}

impl Implicit {
    fn layout(&self) -> Layout {
        Layout {
            scheme: self.tiling.scheme,
            levels: self.tiling.subtree_levels,
        }
    }

    /// Volume of a cell in the frame of the root.
    fn solid(&self, cell: Cell) -> Option<Solid> {
        let shape = self.shape.filter(|_| !self.elsewhere)?;
        let shape = cell.volume(shape, self.tiling.scheme)?;
        Some(Solid::new(shape, &self.above.root_from_parent))
    }
}

impl Checker<'_> {
    /// Checks the root of an implicit tree and goes on to its first subtree.
    pub fn enter_implicit(&mut self, set: &Rc<Set>, t: u32, above: Above) {
        let tile = &set.tileset.tiles[t as usize];
        let Some(tiling) = tile.implicit.clone() else {
            return;
        };
        let mut notes = Self::notes(&mut self.report.findings, &set.path);
        let at = At::Tile(&set.tileset.tiles, t);
        let mut sound = root_rules(set, t, &tiling, &at, &mut notes);
        for (i, content) in tile.contents.iter().enumerate() {
            let key = at.key(if tile.plural { "contents" } else { "content" });
            let indexed = key.index(i);
            let place = if tile.plural { indexed } else { key };
            sound &= template(&content.uri, tiling.scheme, &place.key("uri"), &mut notes);
        }
        if !sound {
            return;
        }
        let implicit = Implicit {
            elsewhere: moves_tiles(set),
            set: set.clone(),
            tile: t,
            tiling,
            above,
            shape: tile.bounding_volume.shape,
        };
        self.push_subtree(&Rc::new(implicit), Cell::ROOT);
    }

    /// Checks a subtree, its tiles, and goes on to those below.
    pub fn subtree(&mut self, implicit: &Rc<Implicit>, root: Cell) {
        let set = &implicit.set;
        let uri = root.fill(&implicit.tiling.subtrees);
        let at = At::Tile(&set.tileset.tiles, implicit.tile);
        let key = at.key("implicitTiling");
        let place = format!("{} ({root})", key.key("subtrees"));
        let Some(file) = self.resolve(set, &uri, &place) else {
            return;
        };
        let path = self.root.join(&file);
        let bytes = match load(&path, &crate::ReadOptions::default()) {
            Ok(bytes) => bytes,
            Err(error) => {
                let mut notes = Self::notes(&mut self.report.findings, &set.path);
                let found = error.to_string();
                return notes.error(place, "missing-subtree", "a subtree file", found);
            }
        };
        if self.meet(&file) {
            self.report.counts.subtrees += 1;
            self.report.counts.bytes += bytes.len() as u64;
        }
        let mut findings = Findings::default();
        let mut notes = Self::notes(&mut findings, &path);
        let contents = set.tileset.tiles[implicit.tile as usize].contents.len();
        let folder = path.parent().map(PathBuf::from).unwrap_or_default();
        let mut companion = |uri: &str, notes: &mut Notes<'_>| {
            let below = super::folder::resolve("".as_ref(), uri).ok();
            let bytes =
                below.and_then(|p| load(&folder.join(p), &crate::ReadOptions::default()).ok());
            if bytes.is_none() {
                notes.error(
                    "/buffers",
                    "missing-buffer",
                    "a file beside the subtree",
                    uri,
                );
            }
            bytes
        };
        let layout = implicit.layout();
        match subtree::read(&bytes, layout, contents, &mut notes, &mut companion) {
            Ok(subtree) => {
                let rules = Rules {
                    implicit,
                    root,
                    subtree: &subtree,
                };
                rules.check(&mut notes);
                let broken = findings.error_count() > 0;
                self.report.findings.append(findings);
                if !broken {
                    self.walk(implicit, root, &subtree);
                }
            }
            Err(error) => {
                let place = error.place.to_string();
                notes.error(
                    place,
                    "subtree-unreadable",
                    "a subtree",
                    error.kind.to_string(),
                );
                self.report.findings.append(findings);
            }
        }
    }

    /// Goes through the tiles of a subtree.
    fn walk(&mut self, implicit: &Rc<Implicit>, root: Cell, subtree: &Subtree) {
        let scheme = implicit.tiling.scheme;
        let levels = implicit.tiling.subtree_levels;
        for level in 0..levels {
            let (Some(first), Some(count)) = (offset(scheme, level), cells(scheme, level)) else {
                return;
            };
            if subtree.tiles.is_none() {
                break;
            }
            for morton in 0..count {
                if subtree.tiles.get(first + morton) {
                    if self.full() {
                        return;
                    }
                    let cell = root.descendant(scheme, level, morton);
                    self.cell(implicit, cell, subtree, first + morton);
                }
            }
        }
        if subtree.children.is_none() {
            return;
        }
        for morton in (0..implicit.layout().children()).rev() {
            if subtree.children.get(morton) {
                if self.full() {
                    return;
                }
                self.push_subtree(implicit, root.descendant(scheme, levels, morton));
            }
        }
    }

    /// One tile of an implicit tree.
    fn cell(&mut self, implicit: &Rc<Implicit>, cell: Cell, subtree: &Subtree, number: u64) {
        let set = &implicit.set;
        let tile = &set.tileset.tiles[implicit.tile as usize];
        let error = tile.geometric_error / f64::from(cell.level).exp2();
        let there = |i: usize| subtree.contents.get(i).is_some_and(|a| a.get(number));
        let depth = implicit.above.depth + cell.level;
        self.report.count(depth, error);
        let own = Above {
            error,
            depth: depth + 1,
            parent: implicit.solid(cell),
            ..implicit.above.clone()
        };
        for (i, content) in tile.contents.iter().enumerate().filter(|(i, _)| there(*i)) {
            let uri = cell.fill(&content.uri);
            let place = format!("{cell} content {i}");
            let counted = self.content(set, &uri, content, place, &own);
            self.report.count_contents(depth, counted);
        }
    }
}

/// Whether the schema lets metadata replace the volumes of tiles.
fn moves_tiles(set: &Set) -> bool {
    let Some(schema) = &set.schema else {
        return false;
    };
    let volumes = [
        "TILE_BOUNDING_BOX",
        "TILE_BOUNDING_REGION",
        "TILE_BOUNDING_SPHERE",
    ];
    let of_class = |class: &String| {
        let semantics = schema.semantics(class);
        volumes.iter().any(|v| semantics.contains(v))
    };
    schema.classes.keys().any(of_class)
}

/// The rules for the root of an implicit tree; whether it can be followed.
fn root_rules(
    set: &Set,
    t: u32,
    tiling: &ImplicitTiling,
    at: &At<'_>,
    notes: &mut Notes<'_>,
) -> bool {
    let tile = &set.tileset.tiles[t as usize];
    let mut sound = true;
    if !tile.children.is_empty() {
        let found = format!("{} children", tile.children.len());
        notes.error(
            at.key("children"),
            "implicit-children",
            "no `children`",
            found,
        );
    }
    if tile.other.contains_key("metadata") {
        notes.error(
            at.key("metadata"),
            "implicit-metadata",
            "no `metadata`",
            "metadata",
        );
    }
    if let Some(Shape::Sphere { .. }) = tile.bounding_volume.shape {
        let at = at.key("boundingVolume");
        notes.error(
            at,
            "implicit-volume",
            "a box or region, to be divided",
            "a sphere",
        );
        sound = false;
    }
    let bounds = tile.contents.iter().any(|c| c.bounding_volume.is_some());
    if bounds {
        let expected = "no `boundingVolume` of the content";
        notes.error(
            at.key("content"),
            "implicit-content-volume",
            expected,
            "one",
        );
    }
    let at = at.key("implicitTiling");
    let limit = MAX_LEVELS[usize::from(tiling.scheme == Scheme::Octree)];
    if tiling.subtree_levels > limit || tiling.available_levels > MAX_LEVEL {
        let expected = format!("at most {limit} levels a subtree and {MAX_LEVEL} in all");
        let found = format!("{} and {}", tiling.subtree_levels, tiling.available_levels);
        notes.error(at, "implicit-levels", expected, found);
        sound = false;
    }
    let at = at.key("subtrees");
    sound && template(&tiling.subtrees, tiling.scheme, &at.key("uri"), notes)
}

/// A template must tell all cells apart.
fn template(uri: &str, scheme: Scheme, at: &At<'_>, notes: &mut Notes<'_>) -> bool {
    let names = ["{level}", "{x}", "{y}", "{z}"];
    let needed = &names[..1 + scheme.dimensions() as usize];
    let missing: Vec<_> = needed
        .iter()
        .filter(|n| !uri.contains(**n))
        .copied()
        .collect();
    if missing.is_empty() {
        return true;
    }
    let expected = format!("a template with {}", missing.join(", "));
    notes.error(at, "template", expected, uri);
    false
}

/// The rules within one subtree.
struct Rules<'a> {
    implicit: &'a Implicit,
    root: Cell,
    subtree: &'a Subtree,
}

impl Rules<'_> {
    fn check(&self, notes: &mut Notes<'_>) {
        if !self.subtree.tiles.get(0) {
            let found = "no root tile in the subtree";
            notes.error(self.root, "subtree-root", "an available root tile", found);
        }
        if self.subtree.tiles != subtree::Availability::Constant(true) {
            self.parents(notes);
        }
        self.contents(notes);
        self.children(notes);
        self.levels(notes);
        self.metadata(notes);
    }

    /// A tile needs its parent.
    fn parents(&self, notes: &mut Notes<'_>) {
        let scheme = self.implicit.tiling.scheme;
        for level in 1..self.implicit.tiling.subtree_levels {
            let (Some(above), Some(first)) = (offset(scheme, level - 1), offset(scheme, level))
            else {
                return;
            };
            if self.subtree.tiles.is_none() {
                return;
            }
            for morton in 0..cells(scheme, level).unwrap_or(0) {
                let parent = above + (morton >> scheme.dimensions());
                if self.subtree.tiles.get(first + morton) && !self.subtree.tiles.get(parent) {
                    let cell = self.root.descendant(scheme, level, morton);
                    notes.error(cell, "tile-without-parent", "an available parent", "none");
                }
            }
        }
    }

    /// A content needs its tile.
    fn contents(&self, notes: &mut Notes<'_>) {
        let tiles = self.implicit.layout().tiles().unwrap_or(0);
        for (c, contents) in self.subtree.contents.iter().enumerate() {
            let plain =
                contents.is_none() || self.subtree.tiles == subtree::Availability::Constant(true);
            let wrong = |&i: &u64| contents.get(i) && !self.subtree.tiles.get(i);
            if let Some(i) = (0..tiles).filter(|_| !plain).find(wrong) {
                let place = format!("{} content {c}", self.root);
                let found = format!("tile number {i} of the subtree unavailable");
                notes.error(
                    place,
                    "content-without-tile",
                    "content in available tiles",
                    found,
                );
            }
        }
    }

    /// A subtree below needs the tile above it.
    fn children(&self, notes: &mut Notes<'_>) {
        let scheme = self.implicit.tiling.scheme;
        let levels = self.implicit.tiling.subtree_levels;
        let Some(first) = offset(scheme, levels - 1) else {
            return;
        };
        if self.subtree.children.is_none() {
            return;
        }
        for morton in 0..self.implicit.layout().children() {
            let parent = first + (morton >> scheme.dimensions());
            if self.subtree.children.get(morton) && !self.subtree.tiles.get(parent) {
                let cell = self.root.descendant(scheme, levels, morton);
                let expected = "an available tile above the subtree";
                notes.error(cell, "subtree-without-parent", expected, "none");
            }
        }
    }

    /// `availableLevels` says where the tree ends.
    fn levels(&self, notes: &mut Notes<'_>) {
        let tiling = &self.implicit.tiling;
        let scheme = tiling.scheme;
        let beyond = |level: u32| self.root.level + level >= tiling.available_levels;
        let expected = format!("{} levels", tiling.available_levels);
        for level in (0..tiling.subtree_levels).filter(|l| beyond(*l)) {
            let (Some(first), Some(count)) = (offset(scheme, level), cells(scheme, level)) else {
                return;
            };
            if !self.subtree.tiles.is_none()
                && (first..first + count).any(|i| self.subtree.tiles.get(i))
            {
                let found = format!("a tile at level {}", self.root.level + level);
                return notes.error(self.root, "available-levels", expected, found);
            }
        }
        let below = self
            .subtree
            .children
            .count(self.implicit.layout().children());
        if beyond(tiling.subtree_levels) && below > 0 {
            let found = format!(
                "{below} subtrees at level {}",
                self.root.level + tiling.subtree_levels
            );
            notes.error(self.root, "available-levels", expected, found);
        }
    }

    /// Property tables, and what names them.
    fn metadata(&self, notes: &mut Notes<'_>) {
        let json = &self.subtree.json;
        let at = At::Document;
        let tables = json.get("propertyTables").and_then(Value::as_array);
        let tables = tables.map_or(&[][..], Vec::as_slice);
        let Some(schema) = &self.implicit.set.schema else {
            if !tables.is_empty() || json.contains_key("subtreeMetadata") {
                notes.error(at, "metadata-schema", "a schema in the tileset", "none");
            }
            return;
        };
        let view = |v: usize| self.subtree.views.get(v).map(Vec::as_slice);
        let key = at.key("propertyTables");
        for (t, table) in tables.iter().enumerate() {
            schema.check_table(table, &view, &key.index(t), notes);
        }
        if let Some(metadata) = json.get("subtreeMetadata") {
            schema.check_entity(metadata, &at.key("subtreeMetadata"), notes);
        }
        let tiles = self.implicit.layout().tiles().unwrap_or(0);
        if let Some(named) = json.get("tileMetadata") {
            let rows = self.subtree.tiles.count(tiles);
            rows_match(tables, named, rows, &at.key("tileMetadata"), notes);
        }
        self.content_metadata(json, tables, tiles, notes);
    }

    fn content_metadata(
        &self,
        json: &Map<String, Value>,
        tables: &[Value],
        tiles: u64,
        notes: &mut Notes<'_>,
    ) {
        let at = At::Document;
        let at = at.key("contentMetadata");
        let named = json.get("contentMetadata").and_then(Value::as_array);
        for (i, named) in named.into_iter().flatten().enumerate() {
            let at = at.index(i);
            match self.subtree.contents.get(i) {
                Some(contents) => rows_match(tables, named, contents.count(tiles), &at, notes),
                None => {
                    let expected = format!("{} contents", self.subtree.contents.len());
                    notes.error(at, "content-metadata", expected, "more");
                }
            }
        }
    }
}

/// A table has a row for each available element.
fn rows_match(tables: &[Value], named: &Value, rows: u64, at: &At<'_>, notes: &mut Notes<'_>) {
    let table = named.as_u64().and_then(|t| tables.get(t as usize));
    let Some(table) = table else {
        let expected = format!("one of {} property tables", tables.len());
        return notes.error(at, "property-table", expected, named.to_string());
    };
    let count = table.get("count").and_then(Value::as_u64).unwrap_or(0);
    if count != rows {
        let expected = format!("{rows} rows, one for each available element");
        notes.error(at, "table-count", expected, count.to_string());
    }
}
