//! What is to be written as a tileset.

use super::{
    ecef::Geodetic,
    implicit::Cell,
    model::{Refine, Scheme},
};
use crate::{FeatureTable, GltfOptions, error::Result};
use glam::DVec3;
use karui::Scene;

/// A tree of tiles.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TileTree {
    /// The nodes; the first is the root, and every parent comes before its
    /// children.
    pub nodes: Vec<TreeNode>,
}

/// A node of a tree of tiles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TreeNode {
    /// Index of the parent, below that of the node; `None` for the root only.
    pub parent: Option<u32>,
    /// Least corner of what the node shows, metres.
    pub min: DVec3,
    /// Greatest corner of what the node shows, metres.
    pub max: DVec3,
    /// Largest distance between what the node shows and what it stands for,
    /// metres; 0 for the original.
    pub error: f64,
    /// How children join in.
    pub refine: Refine,
}

/// Cells of an implicit tree.
#[derive(Debug, Clone, PartialEq)]
pub struct CellTree {
    /// How a cell is divided.
    pub scheme: Scheme,
    /// Least corner of the root cell, metres.
    pub min: DVec3,
    /// Greatest corner of the root cell, metres.
    pub max: DVec3,
    /// Error of the root in metres; every level halves it.
    pub error: f64,
    /// How children join in.
    pub refine: Refine,
    /// Cells with content, in any order. In a scene with y up, the `y` of a
    /// cell still counts northwards (-z) and its `z` upwards (y).
    pub cells: Vec<Cell>,
    /// Levels of a subtree file, 1 to 8.
    pub subtree_levels: u32,
}

/// The content of a tile.
#[derive(Debug, Clone, Default)]
pub struct TileContent {
    /// What is drawn, relative to the origin that was asked for.
    pub scene: Scene,
    /// What its features are, if it has feature ids.
    pub features: Option<FeatureTable>,
}

/// Where the contents of tiles come from, one at a time.
pub trait TileContents: Sync {
    /// The content of a node (of a cell, by its index in
    /// [`CellTree::cells`]), with coordinates relative to `origin`: as these
    /// are small, 32 bits hold them precisely. Called once a node, from
    /// several threads.
    ///
    /// # Errors
    /// Ends the writing; nothing is left behind.
    fn content(&self, node: u32, origin: DVec3) -> Result<Option<TileContent>>;
}

impl<F> TileContents for F
where
    F: Fn(u32, DVec3) -> Result<Option<TileContent>> + Sync,
{
    fn content(&self, node: u32, origin: DVec3) -> Result<Option<TileContent>> {
        self(node, origin)
    }
}

/// Which axis points up.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Up {
    /// y, as in glTF.
    #[default]
    Y,
    /// z, as in 3D Tiles.
    Z,
}

/// Kinds of bounding volumes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum VolumeKind {
    /// Boxes along the axes of the scene.
    #[default]
    Box,
    /// Spheres.
    Sphere,
    /// Ranges of longitude, latitude and height; need a place on the earth.
    Region,
}

/// How a tileset is written.
#[derive(Debug, Clone, PartialEq)]
pub struct TilesOptions {
    /// The axis that points up in bounds and contents. Default y.
    pub up: Up,
    /// Kind of bounding volumes. Default boxes. Implicit tilesets have boxes.
    pub volume: VolumeKind,
    /// Where on the earth the origin lies, x pointing east and the up axis
    /// away from the ellipsoid. Default `None`: a frame of its own.
    pub place: Option<Geodetic>,
    /// Tiles of one tileset file; branches beyond go to external tilesets.
    /// At least 2. Default 2,000.
    pub tiles_per_file: usize,
    /// Replaces a tileset that Karui wrote. Default `false`.
    pub overwrite: bool,
    /// How contents are written.
    pub gltf: GltfOptions,
}

impl Default for TilesOptions {
    fn default() -> Self {
        Self {
            up: Up::Y,
            volume: VolumeKind::Box,
            place: None,
            tiles_per_file: 2000,
            overwrite: false,
            gltf: GltfOptions::default(),
        }
    }
}

/// What was written.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize)]
pub struct TilesWritten {
    /// Tiles, each counted once.
    pub tiles: u64,
    /// Tiles with content.
    pub contents: u64,
    /// Tileset files.
    pub tilesets: u64,
    /// Subtree files.
    pub subtrees: u64,
    /// Bytes of all files.
    pub bytes: u64,
    /// Nodes whose error was below that of a child and was raised to it.
    pub raised_errors: u64,
}
