//! What threads note at pieces and points while they choose and split them side by side.
//!
//! Every note carries the frame or pass it was made in, so that none ever has to be wiped.
//! Which thread is first does not matter: what is noted in the end is the same.

use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};

/// The frames in which a piece was last split, and offered to be split.
#[derive(Debug, Default)]
pub(super) struct Stamps {
    split: AtomicU32,
    offered: AtomicU32,
}

impl Stamps {
    pub fn is_split(&self, frame: u32) -> bool {
        self.split.load(Ordering::Acquire) == frame
    }

    /// Says whether it had been split in this frame.
    pub fn split(&self, frame: u32) -> bool {
        self.split.swap(frame, Ordering::AcqRel) == frame
    }

    /// Says whether it had been offered in this frame.
    pub fn offer(&self, frame: u32) -> bool {
        self.offered.swap(frame, Ordering::AcqRel) == frame
    }
}

impl Clone for Stamps {
    fn clone(&self) -> Self {
        let copy = |stamp: &AtomicU32| AtomicU32::new(stamp.load(Ordering::Relaxed));
        Self {
            split: copy(&self.split),
            offered: copy(&self.offered),
        }
    }
}

/// Flags that were left at a point, and in which pass.
#[derive(Debug, Default)]
pub(super) struct Mark(AtomicU64);

impl Mark {
    /// Adds flags to those of the pass; passes count up.
    pub fn add(&self, pass: u32, flags: u32) {
        let empty = u64::from(pass) << 32;
        let wanted = empty | u64::from(flags);
        let found = self.0.load(Ordering::Relaxed);
        // Most points have it from the piece before.
        if found & wanted == wanted && found >> 32 == u64::from(pass) {
            return;
        }
        if found < empty {
            self.0.fetch_max(empty, Ordering::Relaxed);
        }
        self.0.fetch_or(u64::from(flags), Ordering::Relaxed);
    }

    /// The flags of the last pass in which there were any.
    pub fn flags(&self) -> u32 {
        self.0.load(Ordering::Relaxed) as u32
    }
}

impl Clone for Mark {
    fn clone(&self) -> Self {
        Self(AtomicU64::new(self.0.load(Ordering::Relaxed)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags_are_those_of_the_pass() {
        let mark = Mark::default();
        mark.add(1, 0b01);
        mark.add(1, 0b10);
        mark.add(1, 0b10);
        assert_eq!(mark.flags(), 0b11);
        mark.add(2, 0b100);
        assert_eq!(mark.flags(), 0b100);
        mark.add(3, 0);
        assert_eq!(mark.clone().flags(), 0);
    }

    #[test]
    fn a_piece_is_split_and_offered_once_a_frame() {
        let stamps = Stamps::default();
        assert!(!stamps.is_split(1));
        assert!(!stamps.split(1) && stamps.split(1) && stamps.is_split(1));
        assert!(!stamps.offer(1) && stamps.offer(1));
        assert!(!stamps.is_split(2) && !stamps.split(2) && !stamps.clone().offer(2));
    }
}
