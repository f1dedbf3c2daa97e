//! What a `tileset.json` says, as types.
//!
//! Tiles lie in one list, parents before their children, so that nothing that
//! is done with a tileset, not even dropping it, descends as deep as its tree.

use glam::{DMat4, DVec3};
use serde_json::{Map, Value};

/// One tileset file. Positions are in metres, in the frame of the root tile's
/// parent: earth-centred, earth-fixed or local, z up.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Tileset {
    /// `asset`.
    pub asset: Asset,
    /// Error in metres if the tileset is not drawn at all.
    pub geometric_error: f64,
    /// All tiles of this file, the root first, every parent before its
    /// children. Tiles of external tilesets and of subtrees are not among them.
    pub tiles: Vec<Tile>,
    /// `extensionsUsed`.
    pub extensions_used: Vec<String>,
    /// `extensionsRequired`.
    pub extensions_required: Vec<String>,
    /// Everything else: `schema`, `schemaUri`, `statistics`, `groups`,
    /// `metadata`, `properties`, `extensions`, `extras`.
    pub other: Map<String, Value>,
}

/// `asset`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Asset {
    /// Version of 3D Tiles: `1.0` or `1.1`.
    pub version: String,
    /// `tilesetVersion`, `extensions`, `extras` and whatever else there is.
    pub other: Map<String, Value>,
}

/// One tile.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Tile {
    /// Index of the parent in [`Tileset::tiles`]; `None` for the root.
    pub parent: Option<u32>,
    /// Indices of the children.
    pub children: Vec<u32>,
    /// What encloses the content of the tile and of all tiles below it.
    pub bounding_volume: BoundingVolume,
    /// Where the viewer has to be for the tile to be asked for.
    pub viewer_request_volume: Option<BoundingVolume>,
    /// Error in metres if this tile is drawn and its children are not.
    pub geometric_error: f64,
    /// How children join in; `None` takes the parent's.
    pub refine: Option<Refine>,
    /// Takes the tile's frame to its parent's; `None` is the identity.
    pub transform: Option<DMat4>,
    /// What is drawn.
    pub contents: Vec<Content>,
    /// Whether the contents stand in `contents` rather than `content`.
    pub plural: bool,
    /// The tile is the root of an implicit tree.
    pub implicit: Option<ImplicitTiling>,
    /// Everything else: `metadata`, `extensions`, `extras`.
    pub other: Map<String, Value>,
}

/// How the children of a tile join in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub enum Refine {
    /// Drawn in addition to the parent.
    Add,
    /// Drawn instead of the parent.
    Replace,
}

/// A content of a tile.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Content {
    /// Relative to the tileset file; in an implicit tile a template with
    /// `{level}`, `{x}`, `{y}` and `{z}`.
    pub uri: String,
    /// What encloses just this content.
    pub bounding_volume: Option<BoundingVolume>,
    /// Everything else: `metadata`, `group`, `extensions`, `extras`.
    pub other: Map<String, Value>,
}

/// `implicitTiling`.
#[derive(Debug, Clone, PartialEq)]
pub struct ImplicitTiling {
    /// How a tile is divided.
    pub scheme: Scheme,
    /// Levels of one subtree file.
    pub subtree_levels: u32,
    /// Levels of the whole tree with available tiles.
    pub available_levels: u32,
    /// Template of the URIs of subtree files.
    pub subtrees: String,
    /// Everything else.
    pub other: Map<String, Value>,
}

/// How an implicit tile is divided.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub enum Scheme {
    /// In 4, along x and y or longitude and latitude.
    Quadtree,
    /// In 8.
    Octree,
}

impl Scheme {
    /// Directions in which a tile is halved.
    #[must_use]
    pub fn dimensions(self) -> u32 {
        match self {
            Self::Quadtree => 2,
            Self::Octree => 3,
        }
    }
}

/// A bounding volume: its shape, and what else was said about it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct BoundingVolume {
    /// `None` if only an extension describes it.
    pub shape: Option<Shape>,
    /// Further shapes, `extensions`, `extras`.
    pub other: Map<String, Value>,
}

impl From<Shape> for BoundingVolume {
    fn from(shape: Shape) -> Self {
        Self {
            shape: Some(shape),
            other: Map::new(),
        }
    }
}

/// The shape of a bounding volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// A box, oriented as it likes.
    Box {
        /// Centre, metres.
        center: DVec3,
        /// From the centre to the middle of three faces.
        half_axes: [DVec3; 3],
    },
    /// A sphere.
    Sphere {
        /// Centre, metres.
        center: DVec3,
        /// Radius, metres.
        radius: f64,
    },
    /// Part of the shell around the WGS 84 ellipsoid; transforms leave it
    /// where it is.
    Region(Region),
}

/// A range of longitudes, latitudes and heights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Region {
    /// Longitude where it begins, radians.
    pub west: f64,
    /// Latitude where it begins, radians.
    pub south: f64,
    /// Longitude where it ends, radians; below `west` if it crosses the
    /// antimeridian.
    pub east: f64,
    /// Latitude where it ends, radians.
    pub north: f64,
    /// Least height above the ellipsoid, metres.
    pub min_height: f64,
    /// Greatest height above the ellipsoid, metres.
    pub max_height: f64,
}

impl Tileset {
    /// The root tile; `None` only for a tileset put together without tiles.
    #[must_use]
    pub fn root(&self) -> Option<&Tile> {
        self.tiles.first()
    }

    /// The JSON pointer of a tile. In the middle of a very deep tree the
    /// beginning is left out.
    #[must_use]
    pub fn pointer(&self, tile: u32) -> String {
        super::at::tile_pointer(&self.tiles, tile)
    }
}
