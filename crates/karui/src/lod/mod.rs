//! Chains of levels of detail: ever coarser meshes, each with its measured
//! error and the distance from which on it may be shown.
//!
//! Every level is simplified from the original, not from the level before it:
//! the collapses of a finer target are a prefix of those of a coarser one, so
//! nothing is gained by going on, the levels do not depend on each other, and
//! they are built in parallel. Errors are measured against the original too
//! (two-sided surface distance), never summed up from estimates.

mod chain;
mod level;
mod msft;
mod options;
mod parts;
mod scale;
mod scene;
mod screen;

pub use chain::{DroppedLevel, LodChain, LodLevel, chain_mesh};
pub use level::{Measured, simplify_measured};
pub use msft::{LinkedScene, to_msft_lod};
pub use options::{Levels, LodOptions};
pub use scene::{LevelSummary, SceneChain, chain_scene};
pub use screen::Screen;
