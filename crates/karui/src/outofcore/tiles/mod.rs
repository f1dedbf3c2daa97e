//! Levels that are kept: a tree of cells, each with a mesh of bounded size.
//!
//! Leaves are the input's triangles, each in the cell where its centre lies; cells are
//! halved along all three axes until their triangles fit a tile. From the deepest cells up,
//! the meshes of a cell's children together are simplified to its own. Vertices that another
//! cell of the same depth (or a larger leaf) uses are held, as they have been at all depths
//! below: two cells side by side share their border to the bit, whatever level either shows.
//!
//! The error of a leaf is 0, that of a cell is the largest of its children's plus the
//! two-sided distance between its mesh and theirs, measured at samples.
//!
//! With [`TileCut::aligned`] triangles are cut at the faces of the smallest cells first,
//! which are then all of one size, so that every mesh lies within its cell.

mod cell;
mod cut;
mod divide;
mod edges;
mod gather;
mod next;
mod parent;
mod pieces;
mod tree;

pub(super) use edges::edges;
pub(super) use gather::leaf;
pub(super) use next::{after, following};
pub(super) use parent::parent;
pub(super) use pieces::pieces;
pub use tree::{TileNode, TileTree, tile_mesh, tile_sample, tile_tree};

use serde::{Deserialize, Serialize};

/// How a model is cut into tiles whose levels are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct TileCut {
    /// Triangles of a tile, about, at least 16; at most an eighth of a block, as all
    /// children of a cell are worked on together. Default: 50,000.
    pub triangles: u64,
    /// Whether triangles are cut at the faces of the smallest cells, so that every mesh lies
    /// within its cell. Default: no; triangles stay whole, in the cell of their centre.
    pub aligned: bool,
}

impl Default for TileCut {
    fn default() -> Self {
        Self {
            triangles: 50_000,
            aligned: false,
        }
    }
}
