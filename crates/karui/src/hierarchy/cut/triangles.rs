//! The index buffer of a cut: the visible faces without gaps, and where it has
//! changed.

use crate::hierarchy::surface::{NONE, Surface};
use std::ops::Range;

/// Visible faces in slots. A face that goes leaves its slot to the last one.
#[derive(Debug, Clone)]
pub(super) struct Triangles {
    pub indices: Vec<[u32; 3]>,
    face: Vec<u32>,
    slot: Vec<u32>,
    /// A bit a slot.
    dirty: Vec<u64>,
    /// The words of `dirty` that are not 0.
    words: Vec<u32>,
}

impl Triangles {
    /// All faces visible, in order.
    pub fn new(surface: &Surface) -> Self {
        let count = surface.halves.len() as u32 / 3;
        Self {
            indices: (0..count).map(|f| surface.corners(f)).collect(),
            face: (0..count).collect(),
            slot: (0..count).collect(),
            dirty: vec![0; (count as usize).div_ceil(64)],
            words: Vec::new(),
        }
    }

    #[inline]
    fn mark(&mut self, slot: u32) {
        let word = &mut self.dirty[slot as usize / 64];
        if *word == 0 {
            self.words.push(slot / 64);
        }
        *word |= 1 << (slot % 64);
    }

    pub fn show(&mut self, face: u32, corners: [u32; 3]) {
        let slot = self.indices.len() as u32;
        self.slot[face as usize] = slot;
        self.indices.push(corners);
        self.face.push(face);
        self.mark(slot);
    }

    pub fn hide(&mut self, face: u32) {
        let slot = std::mem::replace(&mut self.slot[face as usize], NONE);
        self.indices.swap_remove(slot as usize);
        self.face.swap_remove(slot as usize);
        if let Some(&moved) = self.face.get(slot as usize) {
            self.slot[moved as usize] = slot;
            self.mark(slot);
        }
    }

    /// A corner has another vertex now.
    #[inline]
    pub fn moved(&mut self, corner: u32, vertex: u32) {
        let slot = self.slot[corner as usize / 3];
        self.indices[slot as usize][corner as usize % 3] = vertex;
        self.mark(slot);
    }

    /// The faces visible, in no order.
    pub fn faces(&self) -> &[u32] {
        &self.face
    }

    pub fn is_visible(&self, face: u32) -> bool {
        self.slot[face as usize] != NONE
    }

    /// The slots that have changed since this was last asked, those less than
    /// `gap` apart in one range.
    pub fn take_changed(&mut self, gap: u32) -> Vec<Range<u32>> {
        self.words.sort_unstable();
        let mut ranges: Vec<Range<u32>> = Vec::new();
        let end = self.indices.len() as u32;
        for word in self.words.drain(..) {
            let mut bits = std::mem::take(&mut self.dirty[word as usize]);
            while bits != 0 {
                let slot = word * 64 + bits.trailing_zeros();
                bits &= bits - 1;
                match ranges.last_mut() {
                    _ if slot >= end => break,
                    Some(range) if slot - range.end < gap => range.end = slot + 1,
                    _ => ranges.push(slot..slot + 1),
                }
            }
        }
        ranges
    }
}
