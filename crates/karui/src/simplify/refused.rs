//! What both drivers count: candidates refused, by reason.

use super::candidate::Refusal;
use super::options::Blocked;

/// Number of candidates refused, by reason.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Refused {
    pub blocked: Blocked,
    pub by_error: usize,
}

impl Refused {
    pub fn count(&mut self, refusal: Refusal) {
        match refusal {
            Refusal::Locked => self.blocked.locked += 1,
            Refusal::Topology => self.blocked.topology += 1,
            Refusal::Seams => self.blocked.seams += 1,
            Refusal::Flips => self.blocked.flips += 1,
            Refusal::Error => self.by_error += 1,
        }
    }

    pub fn add(&mut self, other: &Self) {
        self.blocked.locked += other.blocked.locked;
        self.blocked.topology += other.blocked.topology;
        self.blocked.seams += other.blocked.seams;
        self.blocked.flips += other.blocked.flips;
        self.by_error += other.by_error;
    }
}
