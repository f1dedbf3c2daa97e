//! Models larger than memory: read in slices, simplified in blocks.
//!
//! Source: Shioya, Matsuyama, Konno & Tokuyama, after Yoshida, Konno & Tokuyama 2008.
//!
//! The work is a sequence of phases, each a bag of tasks that do not need each other
//! ([`Manifest`]). A task reads and writes a [`Store`] and nothing else, but for the input;
//! run twice, anywhere, it makes the same bytes. [`next()`] says what is to be done,
//! [`run_task`] does one row of it, [`Manifest::commit`] closes a phase; [`run`] does all of
//! that in this process.
//!
//! - *bounds*: the box around the vertices;
//! - *scan*, *fetch*: where faces use vertices from all over, these are sorted by range and
//!   brought to them, so that the input is read from front to back;
//! - *read*: portions of faces, joined with their vertices, sorted by a key of their place;
//! - *borders*: places that several regions (ranges of keys) share;
//! - *simplify*: each region, its borders held.
//!
//! The last two are repeated with borders elsewhere, so that what was held is simplified
//! the next time, until what is left is one region, or the third time over. Regions have
//! about the same number of triangles at every level, whatever the size of the model.

mod block;
mod borders;
mod bytes;
mod checksum;
mod columns;
mod cut;
mod drive;
mod error;
mod fans;
mod join;
mod keys;
mod load;
mod manifest;
mod next;
mod pack;
mod plan;
mod read;
mod region;
mod sections;
mod share;
mod source;
mod store;
mod task;
mod tiles;
mod weld;
mod write;

pub use block::verify_block;
pub use checksum::checksum;
pub use drive::{RunOptions, rebuild, run, verify};
pub use error::{Error, Result};
pub use keys::Scheme;
pub use manifest::{Kind, Manifest, Phase, Row, RowResult};
pub use next::{Next, manifests, next};
pub use plan::{PLAN, Plan, PlanOptions};
pub use source::{Memory, Source, Vertices};
pub use store::{Folder, Store};
pub use task::{run_task, verify_task};
pub use tiles::{TileCut, TileNode, TileTree, tile_mesh, tile_sample, tile_tree};
pub use write::{Sink, Summary, write};
