//! Models larger than memory: read in slices, simplified in blocks.
//!
//! Source: Shioya, Matsuyama, Konno & Tokuyama, after Yoshida, Konno & Tokuyama 2008.

mod error;
mod source;

pub use error::{Error, Result};
pub use source::{Memory, Source, Vertices};
