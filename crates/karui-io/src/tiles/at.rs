//! Places in a tileset, put together only when something is said about them.

use super::model::Tile;
use std::fmt;

/// Levels that the pointer of a tile shows, from the tile upwards.
const SHOWN: usize = 32;

/// A place in a JSON document.
#[derive(Clone, Copy)]
pub(super) enum At<'a> {
    /// The document.
    Document,
    /// A tile.
    Tile(&'a [Tile], u32),
    /// A property of another place.
    Key(&'a At<'a>, &'a str),
    /// An element of another place.
    Index(&'a At<'a>, usize),
}

impl<'a> At<'a> {
    pub fn key(&'a self, key: &'a str) -> Self {
        At::Key(self, key)
    }

    pub fn index(&'a self, index: usize) -> Self {
        At::Index(self, index)
    }
}

impl fmt::Display for At<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            At::Document => Ok(()),
            At::Tile(tiles, tile) => f.write_str(&tile_pointer(tiles, *tile)),
            At::Key(parent, key) => {
                write!(f, "{parent}/{}", key.replace('~', "~0").replace('/', "~1"))
            }
            At::Index(parent, index) => write!(f, "{parent}/{index}"),
        }
    }
}

/// JSON pointer of a tile; a long one keeps its end only.
pub(super) fn tile_pointer(tiles: &[Tile], tile: u32) -> String {
    let mut parts = Vec::new();
    let mut at = tile;
    while let Some(parent) = tiles.get(at as usize).and_then(|t| t.parent) {
        if parts.len() == SHOWN {
            parts.push("/..".to_owned());
            break;
        }
        let siblings = tiles.get(parent as usize).map(|t| &t.children);
        let index = siblings.and_then(|s| s.binary_search(&at).ok());
        parts.push(format!("/children/{}", index.unwrap_or_default()));
        at = parent;
    }
    parts.push("/root".to_owned());
    parts.reverse();
    parts.concat()
}
