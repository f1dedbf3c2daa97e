//! What the checker reports.

use super::findings::Findings;
use serde::Serialize;
use std::path::PathBuf;

/// How a tileset is checked.
#[derive(Debug, Clone, PartialEq)]
pub struct CheckOptions {
    /// Whether contents are read, too. Default `true`.
    pub contents: bool,
    /// Share of a bounding volume's size by which what it encloses may stick
    /// out without a word; contents that stick out by ten times as much are an
    /// error. Default 0.001.
    pub tolerance: f64,
    /// Tiles after which checking stops, with an error: a small file can
    /// describe more tiles than there are atoms. Default 10,000,000.
    pub max_tiles: u64,
}

impl Default for CheckOptions {
    fn default() -> Self {
        Self {
            contents: true,
            tolerance: 1e-3,
            max_tiles: 10_000_000,
        }
    }
}

/// A tileset with all its external tilesets, subtrees and contents.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Report {
    /// The root file.
    pub file: PathBuf,
    /// What is wrong.
    #[serde(flatten)]
    pub findings: Findings,
    /// Versions of 3D Tiles named, in order.
    pub versions: Vec<String>,
    /// All of `extensionsUsed`, in order.
    pub extensions_used: Vec<String>,
    /// All of `extensionsRequired`, in order.
    pub extensions_required: Vec<String>,
    /// What there is.
    pub counts: Counts,
    /// Tiles by their distance from the root.
    pub levels: Vec<Level>,
}

/// What there is in a tileset.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Counts {
    /// Tiles, those of external tilesets and implicit trees included.
    pub tiles: u64,
    /// Contents of tiles, external tilesets not among them.
    pub contents: u64,
    /// Different files with contents.
    pub files: u64,
    /// Tileset files.
    pub tilesets: u64,
    /// Subtree files.
    pub subtrees: u64,
    /// Levels of tiles; 1 for a root alone.
    pub depth: u32,
    /// Bytes of all different files.
    pub bytes: u64,
    /// Triangles in all different contents, those of instances each.
    pub triangles: u64,
}

/// Tiles at one distance from the root.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Level {
    /// Tiles.
    pub tiles: u64,
    /// Contents.
    pub contents: u64,
    /// Least geometric error, metres.
    pub min_error: f64,
    /// Greatest geometric error, metres.
    pub max_error: f64,
}

impl Report {
    /// Whether no rule is broken.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.findings.error_count() == 0
    }

    /// Counts the contents of a tile at a distance from the root.
    pub(super) fn count_contents(&mut self, depth: u32, contents: u64) {
        self.counts.contents += contents;
        if let Some(level) = self.levels.get_mut(depth as usize) {
            level.contents += contents;
        }
    }

    /// Counts a tile at a distance from the root.
    pub(super) fn count(&mut self, depth: u32, error: f64) {
        let depth = depth as usize;
        if self.levels.len() <= depth {
            let empty = Level {
                tiles: 0,
                contents: 0,
                min_error: f64::INFINITY,
                max_error: 0.0,
            };
            self.levels.resize(depth + 1, empty);
            self.counts.depth = depth as u32 + 1;
        }
        let level = &mut self.levels[depth];
        level.tiles += 1;
        level.min_error = level.min_error.min(error);
        level.max_error = level.max_error.max(error);
        self.counts.tiles += 1;
    }
}
