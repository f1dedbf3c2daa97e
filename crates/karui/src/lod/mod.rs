//! Chains of levels of detail: ever coarser meshes, each with its measured
//! error and the distance from which on it may be shown.
//!
//! The collapses of a finer target are a prefix of those of a coarser one, so
//! levels that are bounded by counts come out of one run of the simplifier;
//! levels that are bounded by their measured error do not depend on each other
//! and are built in parallel. Errors are measured against the original
//! (two-sided surface distance), never summed up from estimates. Where a level is
//! switched to may be decided by pictures instead ([`chain_seen`]).

mod chain;
mod level;
mod method;
mod msft;
mod options;
mod parts;
mod scale;
mod scene;
mod screen;
mod seen;

pub use chain::{DroppedLevel, LodChain, LodLevel, Removed, chain_mesh};
pub use level::{Measured, chain_measured, simplify_measured};
pub use method::Method;
pub use msft::{LinkedScene, to_msft_lod};
pub use options::{Levels, LodOptions};
pub use scene::{LevelSummary, SceneChain, chain_scene};
pub use screen::Screen;
pub use seen::{Reached, Seen, SeenOptions, chain_seen, seen_distance, seen_flip};
