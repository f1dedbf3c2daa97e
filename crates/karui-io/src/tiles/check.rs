//! A whole tileset, checked against the rules of the specification (OGC
//! 22-025r4, 3D Tiles 1.1) that clients rely on.
//!
//! One thing is a warning on purpose: the specification asks for *contents* to
//! lie within the volumes of all tiles above, not for volumes to lie within
//! volumes ("Bounding volume spatial coherence").

use super::{
    CheckOptions, Report,
    at::At,
    check_implicit::Implicit,
    content::{Job, Kind, sniff},
    findings::{Finding, Findings, Notes},
    folder::{Away, parent, resolve},
    implicit::Cell,
    model::{Content, Shape, Tileset},
    parse::parse,
    set::Set,
    solid::Solid,
};
use crate::{
    error::{Error, ErrorKind, Result},
    source::load,
};
use glam::DMat4;
use rayon::prelude::*;
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
    rc::Rc,
};

/// Contents looked at together.
const BATCH: usize = 32;
/// Volumes of tiles above that a content is held against besides its own.
const ANCESTORS: usize = 16;
/// External tilesets within each other that are followed.
const NESTING: usize = 256;

/// Checks a tileset with all its external tilesets, subtrees and contents.
///
/// # Errors
/// If the file cannot be read or is no JSON; everything else is in the report.
pub fn check(path: impl AsRef<Path>) -> Result<Report> {
    check_with(path, &CheckOptions::default())
}

/// [`check`] with options.
///
/// # Errors
/// As [`check`].
pub fn check_with(path: impl AsRef<Path>, options: &CheckOptions) -> Result<Report> {
    let path = path.as_ref();
    let mut checker = Checker {
        root: parent(path),
        options,
        report: Report {
            file: path.to_owned(),
            ..Report::default()
        },
        stack: Vec::new(),
        jobs: Vec::new(),
        known: BTreeSet::new(),
        stopped: false,
    };
    let text = load(path, &crate::ReadOptions::default())?;
    let name = PathBuf::from(path.file_name().unwrap_or_default());
    let mut findings = Findings::default();
    let mut notes = Checker::notes(&mut findings, path);
    let tileset = parse(&text, &mut notes).map_err(|e| e.in_file(path))?;
    let file = (name, text.len());
    checker.enter(tileset, findings, file, Vec::new(), Above::default());
    while let Some(visit) = checker.stack.pop() {
        if checker.full() {
            break;
        }
        match visit {
            Visit::Tile(set, tile, above) => checker.tile(&set, tile, &above),
            Visit::Subtree(implicit, cell) => checker.subtree(&implicit, cell),
        }
    }
    checker.look_at_contents();
    Ok(checker.report)
}

/// What is still to be looked at.
enum Visit {
    Tile(Rc<Set>, u32, Box<Above>),
    Subtree(Rc<Implicit>, Cell),
}

/// What a tile has above it.
#[derive(Clone)]
pub(super) struct Above {
    /// Takes the parent's frame to the root's.
    pub root_from_parent: DMat4,
    /// Error of the parent, metres.
    pub error: f64,
    /// Tiles above.
    pub depth: u32,
    /// The parent's volume.
    pub parent: Option<Solid>,
    /// Volumes further up that may not contain those below them.
    pub uncovered: Rc<[Solid]>,
}

impl Default for Above {
    fn default() -> Self {
        Self {
            root_from_parent: DMat4::IDENTITY,
            error: f64::INFINITY,
            depth: 0,
            parent: None,
            uncovered: Rc::new([]),
        }
    }
}

pub(super) struct Checker<'a> {
    /// Folder of the root file.
    pub root: PathBuf,
    pub options: &'a CheckOptions,
    pub report: Report,
    stack: Vec<Visit>,
    jobs: Vec<Job>,
    /// Files met, relative to the root folder.
    known: BTreeSet<PathBuf>,
    stopped: bool,
}

impl Checker<'_> {
    pub fn notes<'n>(findings: &'n mut Findings, file: &'n Path) -> Notes<'n> {
        Notes { file, findings }
    }

    /// Whether there are more tiles than are looked at.
    pub fn full(&mut self) -> bool {
        let limit = self.options.max_tiles;
        if self.report.counts.tiles >= limit && !self.stopped {
            self.stopped = true;
            self.report.findings.push_first(Finding {
                file: self.report.file.clone(),
                place: String::new(),
                rule: "too-many-tiles",
                expected: format!("at most {limit} tiles"),
                found: "more".into(),
            });
        }
        self.stopped
    }

    /// Notes a file; whether it is new.
    pub fn meet(&mut self, file: &Path) -> bool {
        self.known.insert(file.to_owned())
    }

    pub fn push_subtree(&mut self, implicit: &Rc<Implicit>, cell: Cell) {
        self.stack.push(Visit::Subtree(implicit.clone(), cell));
    }

    /// Puts the root of a tileset file on the stack; `findings` are those of
    /// reading it.
    fn enter(
        &mut self,
        tileset: Tileset,
        mut findings: Findings,
        (file, bytes): (PathBuf, usize),
        mut chain: Vec<PathBuf>,
        above: Above,
    ) {
        let first = self.meet(&file);
        chain.push(file.clone());
        let path = self.root.join(&file);
        let mut set = Set {
            tileset,
            folder: parent(&file),
            chain,
            schema: None,
            path: path.clone(),
        };
        set.check(&self.root, &mut Self::notes(&mut findings, &path));
        if first {
            self.report.findings.append(findings);
            self.count_file(&set, bytes);
        }
        let Some(root) = set.tileset.root() else {
            return;
        };
        if above.parent.is_none() && root.geometric_error > set.tileset.geometric_error {
            let mut notes = Self::notes(&mut self.report.findings, &path);
            let expected = format!("at least the root's {}", root.geometric_error);
            let found = set.tileset.geometric_error.to_string();
            let place = "/geometricError";
            notes.warn(place, "geometric-error-of-tileset", expected, found);
        }
        self.stack
            .push(Visit::Tile(Rc::new(set), 0, Box::new(above)));
    }

    fn count_file(&mut self, set: &Set, bytes: usize) {
        let report = &mut self.report;
        report.counts.tilesets += 1;
        report.counts.bytes += bytes as u64;
        add(
            &mut report.versions,
            std::slice::from_ref(&set.tileset.asset.version),
        );
        add(&mut report.extensions_used, &set.tileset.extensions_used);
        add(
            &mut report.extensions_required,
            &set.tileset.extensions_required,
        );
    }

    fn tile(&mut self, set: &Rc<Set>, t: u32, above: &Above) {
        let tile = &set.tileset.tiles[t as usize];
        let at = At::Tile(&set.tileset.tiles, t);
        let implicit = tile.implicit.is_some();
        if !implicit {
            self.report.count(above.depth, tile.geometric_error);
        }
        let root_from_tile = above.root_from_parent * tile.transform.unwrap_or(DMat4::IDENTITY);
        let solid = tile
            .bounding_volume
            .shape
            .map(|s| Solid::new(s, &root_from_tile));
        self.error_falls(set, &at, tile.geometric_error, above.error);
        let uncovered = self.volume_inside(set, &at, solid.as_ref(), above);
        let own = Above {
            root_from_parent: root_from_tile,
            error: tile.geometric_error,
            depth: above.depth + 1,
            parent: solid.or(above.parent),
            uncovered,
        };
        if implicit {
            let depth = above.depth;
            return self.enter_implicit(set, t, Above { depth, ..own });
        }
        for (i, content) in tile.contents.iter().enumerate() {
            let key = at.key(if tile.plural { "contents" } else { "content" });
            let indexed = key.index(i);
            let place = if tile.plural { indexed } else { key };
            self.content_volume(set, &place, content, &own);
            let place = place.key("uri").to_string();
            let counted = self.content(set, &content.uri, content, place, &own);
            self.report.count_contents(above.depth, counted);
        }
        let children = tile.children.iter().rev();
        let visits = children.map(|&c| Visit::Tile(set.clone(), c, Box::new(own.clone())));
        self.stack.extend(visits);
    }

    /// A tile must not have a larger error than its parent.
    fn error_falls(&mut self, set: &Set, at: &At<'_>, error: f64, parent: f64) {
        if error > parent {
            let mut notes = Self::notes(&mut self.report.findings, &set.path);
            let expected = format!("at most the parent's {parent}");
            let at = at.key("geometricError");
            notes.error(at, "geometric-error-grows", expected, error.to_string());
        }
    }

    /// Tells volumes that stick out of their parent's; returns the volumes
    /// that contents below must be held against besides that of their tile.
    fn volume_inside(
        &mut self,
        set: &Set,
        at: &At<'_>,
        solid: Option<&Solid>,
        above: &Above,
    ) -> Rc<[Solid]> {
        let (Some(solid), Some(outer)) = (solid, &above.parent) else {
            return above.uncovered.clone();
        };
        let beyond = outer.beyond(solid);
        let allowed = self.allowed(outer);
        if beyond > allowed {
            let mut notes = Self::notes(&mut self.report.findings, &set.path);
            let found = format!("one that sticks out by {beyond:.6} m");
            let expected = format!("a volume within {allowed:.3e} m of the parent's");
            notes.warn(
                at.key("boundingVolume"),
                "child-volume-outside",
                expected,
                found,
            );
        }
        // What lies inside by its corners lies inside, unless it is the
        // curved earth.
        let inside = beyond <= 0.0 && !outer.is_region();
        let room = above.uncovered.len() < ANCESTORS;
        if inside || !room {
            return above.uncovered.clone();
        }
        above.uncovered.iter().copied().chain([*outer]).collect()
    }

    fn allowed(&self, solid: &Solid) -> f64 {
        self.options.tolerance * solid.size() + 1e-12 * solid.reach()
    }

    fn content_volume(&mut self, set: &Set, at: &At<'_>, content: &Content, own: &Above) {
        let shape = content.bounding_volume.as_ref().and_then(|v| v.shape);
        let (Some(shape), Some(outer)) = (shape, &own.parent) else {
            return;
        };
        let beyond = outer.beyond(&Solid::new(shape, &own.root_from_parent));
        let allowed = self.allowed(outer);
        if beyond > allowed {
            let mut notes = Self::notes(&mut self.report.findings, &set.path);
            let found = format!("one that sticks out by {beyond:.6} m");
            let expected = format!("a volume within {allowed:.3e} m of the tile's");
            notes.warn(
                at.key("boundingVolume"),
                "content-volume-outside",
                expected,
                found,
            );
        }
    }

    /// Follows the URI of a content; returns how many contents that is: 0 for
    /// an external tileset.
    pub fn content(
        &mut self,
        set: &Rc<Set>,
        uri: &str,
        content: &Content,
        place: String,
        own: &Above,
    ) -> u64 {
        let Some(file) = self.resolve(set, uri, &place) else {
            return 1;
        };
        let path = self.root.join(&file);
        let mut notes = Self::notes(&mut self.report.findings, &set.path);
        let kind = match sniff(&path) {
            Ok(kind) => kind,
            Err(error) => {
                let found = Error::file(&path, ErrorKind::Io(error)).to_string();
                notes.error(place, "missing-file", "a file that can be read", found);
                return 1;
            }
        };
        match kind {
            Kind::Json => return self.json(set, &path, file, place, own),
            Kind::Unknown => {
                let known = "glTF, a tileset, b3dm, i3dm, cmpt or pnts";
                notes.warn(place, "content-unknown", known, "other bytes");
            }
            Kind::Model => {
                let shape = content.bounding_volume.as_ref().and_then(|v| v.shape);
                self.model(set, file, path, shape, place, own);
            }
        }
        1
    }

    /// The file that a URI names, relative to the root's folder.
    pub fn resolve(&mut self, set: &Set, uri: &str, place: &str) -> Option<PathBuf> {
        let mut notes = Self::notes(&mut self.report.findings, &set.path);
        match resolve(&set.folder, uri) {
            Ok(file) => Some(file),
            Err(Away::Remote) => {
                notes.warn(
                    place,
                    "uri-remote",
                    "a file of the tileset, to be checked",
                    uri,
                );
                None
            }
            Err(Away::Outside) => {
                notes.error(
                    place,
                    "uri-outside",
                    "a file below the tileset's folder",
                    uri,
                );
                None
            }
        }
    }

    fn model(
        &mut self,
        set: &Set,
        file: PathBuf,
        path: PathBuf,
        shape: Option<Shape>,
        place: String,
        own: &Above,
    ) {
        let first = self.meet(&file);
        if !self.options.contents {
            self.report.counts.files += u64::from(first);
            return;
        }
        let mut volumes = Vec::new();
        let own_volume = shape.map(|s| Solid::new(s, &own.root_from_parent));
        volumes.extend(own_volume.map(|s| (s, "content-outside-its-volume")));
        volumes.extend(own.parent.map(|s| (s, "content-outside-tile")));
        let above = own.uncovered.iter();
        volumes.extend(above.map(|s| (*s, "content-outside-ancestor")));
        self.jobs.push(Job {
            path,
            owner: set.path.clone(),
            place,
            root_from_tile: own.root_from_parent,
            volumes,
            first,
            tolerance: self.options.tolerance,
        });
        if self.jobs.len() >= BATCH {
            self.look_at_contents();
        }
    }

    /// JSON as content: an external tileset, or something unknown. Returns how
    /// many contents that is.
    fn json(
        &mut self,
        set: &Rc<Set>,
        path: &Path,
        file: PathBuf,
        place: String,
        own: &Above,
    ) -> u64 {
        let mut notes = Self::notes(&mut self.report.findings, &set.path);
        if set.chain.contains(&file) {
            let found = format!("{} again", file.display());
            notes.error(place, "external-cycle", "tilesets without a cycle", found);
            return 0;
        }
        if set.chain.len() >= NESTING {
            let expected = format!("at most {NESTING} tilesets within each other");
            notes.error(place, "external-depth", expected, "more");
            return 0;
        }
        let mut findings = Findings::default();
        let text = match load(path, &crate::ReadOptions::default()) {
            Ok(text) if !is_tileset(&text) => {
                notes.warn(place, "content-unknown", "a tileset", "other JSON");
                return 1;
            }
            text => text,
        };
        let bytes = text.as_ref().map_or(0, Vec::len);
        let tileset = text.and_then(|t| parse(&t, &mut Self::notes(&mut findings, path)));
        match tileset {
            Ok(tileset) => {
                let chain = set.chain.clone();
                self.enter(tileset, findings, (file, bytes), chain, own.clone());
            }
            Err(error) => {
                notes.error(place, "tileset-unreadable", "a tileset", error.to_string());
            }
        }
        0
    }

    /// Looks at the contents gathered, all cores at once; what is found is
    /// told in the order they were met.
    fn look_at_contents(&mut self) {
        let jobs = std::mem::take(&mut self.jobs);
        let facts: Vec<_> = jobs.par_iter().map(Job::run).collect();
        for (job, facts) in jobs.iter().zip(facts) {
            if job.first {
                self.report.counts.files += 1;
                self.report.counts.bytes += facts.bytes;
                self.report.counts.triangles += facts.triangles;
            }
            self.report.findings.append(facts.findings);
        }
    }
}

/// Whether JSON may be a tileset rather than anything else.
fn is_tileset(text: &[u8]) -> bool {
    let has = |key: &[u8]| memchr::memmem::find(text, key).is_some();
    has(b"\"root\"") || has(b"\"asset\"")
}

/// Adds what is not there yet, in order.
fn add(list: &mut Vec<String>, more: &[String]) {
    for name in more {
        if let Err(place) = list.binary_search(name) {
            list.insert(place, name.clone());
        }
    }
}
