//! How much a file may unfold to.

use super::json::At;
use crate::error::{ErrorKind, Result};
use std::cell::Cell;

/// Bytes any file may unfold to, however small it is.
const BASE: u64 = 96 << 20;
/// Bytes it may unfold to for each of its own. Reading arrays as `f32` costs at
/// most 4, a stream of the densest compression about 60.
const RATIO: u64 = 64;

/// Memory a file may still ask for. Zero-filled accessors, accessors that many
/// meshes share and compressed streams all let a small file describe a huge
/// model; honest files stay far below.
pub(super) struct Budget {
    left: Cell<u64>,
    limit: u64,
}

impl Budget {
    /// For a file that has `bytes` bytes, companions included.
    pub fn new(bytes: usize) -> Self {
        let limit = BASE + RATIO.saturating_mul(bytes as u64);
        let left = Cell::new(limit);
        Self { left, limit }
    }

    /// Takes `count` elements of `size` bytes.
    ///
    /// # Errors
    /// [`ErrorKind::TooLarge`] if that is more than what is left.
    pub fn take(&self, count: usize, size: usize, at: &At<'_>) -> Result<()> {
        let wanted = (count as u64).saturating_mul(size as u64);
        let left = self.left.get();
        if wanted > left {
            let found = (self.limit - left).saturating_add(wanted);
            return Err(at.fail(ErrorKind::TooLarge {
                what: "memory the file asks for in bytes",
                found,
                limit: self.limit,
            }));
        }
        self.left.set(left - wanted);
        Ok(())
    }

    /// Bytes left.
    pub fn left(&self) -> u64 {
        self.left.get()
    }
}
