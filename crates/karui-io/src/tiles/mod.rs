//! 3D Tiles 1.1: tilesets read, checked and written.
//!
//! [`read`] gives one tileset file as a [`Tileset`]; [`check`] follows all of
//! it, external tilesets, implicit trees and contents, and reports every rule
//! of the specification that is broken. Metres and z up throughout; what glTF
//! contents hold has y up and is turned.

mod at;
mod blocks;
mod check;
mod check_implicit;
mod content;
mod cut;
mod ecef;
mod extent;
mod features;
mod findings;
mod folder;
mod hlod;
mod implicit;
mod legacy;
mod model;
mod parse;
mod parse_volume;
mod publish;
mod read;
mod report;
mod schema;
mod set;
mod solid;
mod split;
mod subtree;
mod to_json;
mod tree;
#[cfg(feature = "cloud")]
mod upload;
mod write;
mod write_content;
mod write_implicit;

pub use blocks::{write_blocks, write_blocks_implicit};
pub use check::{check, check_with};
pub use ecef::Geodetic;
pub use findings::{Finding, Findings};
pub use folder::locate;
pub use hlod::write_hlod;
pub use implicit::Cell;
pub use model::{
    Asset, BoundingVolume, Content, ImplicitTiling, Refine, Region, Scheme, Shape, Tile, Tileset,
};
pub use publish::may_write;
pub use read::{read, read_bytes};
pub use report::{CheckOptions, Counts, Level, Report};
pub use tree::{
    CellTree, TileContent, TileContents, TileTree, TilesOptions, TilesWritten, TreeNode, Up,
    VolumeKind,
};
pub use write::{write, write_with_progress};
pub use write_implicit::{write_implicit, write_implicit_with_progress};
