//! 3D Tiles: the samples of Cesium, broken copies of a tileset that is right,
//! hostile files, and what the writer writes.

#![allow(clippy::unwrap_used, reason = "a test may panic")]
#[path = "tiles/base.rs"]
mod base;
#[path = "tiles/broken.rs"]
mod broken;
mod common;
#[path = "tiles/hostile.rs"]
mod hostile;
#[path = "tiles/samples.rs"]
mod samples;
#[path = "tiles/write.rs"]
mod write;
