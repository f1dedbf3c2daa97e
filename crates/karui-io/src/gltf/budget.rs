//! How much a file may unfold to.

use super::json::At;
use crate::error::{ErrorKind, Result};
use std::cell::Cell;

/// Bytes any file may unfold to, however small it is.
const BASE: u64 = 96 << 20;
/// Bytes it may unfold to for each in its buffers. Reading arrays as `f32`
/// costs at most 4, a stream of the densest compression about 60.
const BUFFER_RATIO: u64 = 64;
/// Bytes it may unfold to for each of its JSON: nodes and materials.
const JSON_RATIO: u64 = 8;

/// Memory a file may still ask for. Zero-filled accessors, accessors that many
/// meshes share and compressed streams all let a small file describe a huge
/// model; honest files stay far below.
pub(super) struct Budget {
    left: Cell<u64>,
    limit: u64,
}

impl Budget {
    /// For a file with so many bytes in its buffers and its JSON.
    pub fn new(buffers: usize, json: usize) -> Self {
        let buffers = BUFFER_RATIO.saturating_mul(buffers as u64);
        let json = JSON_RATIO.saturating_mul(json as u64);
        let limit = BASE.saturating_add(buffers).saturating_add(json);
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
