//! What meets at a vertex.

use super::store::Store;
use crate::subdiv::crease::Around;
use smallvec::SmallVec;

/// The corners at a vertex counter-clockwise, and the edges between: the edge after a
/// corner has its index, and at a boundary there is one edge more. At a boundary the first
/// edge is a boundary edge; elsewhere the first corner is that of the first place.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Ring {
    pub corners: SmallVec<[u32; 8]>,
    pub edges: SmallVec<[u32; 8]>,
}

impl Ring {
    pub fn is_open(&self) -> bool {
        self.edges.len() > self.corners.len()
    }
}

impl Store {
    /// Goes around the vertex of a corner, making the faces that are not there.
    pub fn ring(&mut self, t: usize, corner: u32) -> Ring {
        let mut ring = Ring::default();
        let mut at = corner;
        loop {
            ring.corners.push(at);
            let previous = self.tiers[t].previous(at);
            match self.across(t, previous) {
                Some(next) if next == corner => break,
                Some(next) => at = next,
                None => {
                    self.walk_back(t, corner, &mut ring);
                    break;
                }
            }
        }
        self.finish(t, &mut ring);
        ring
    }

    /// The part of an open ring before `corner`.
    fn walk_back(&mut self, t: usize, corner: u32, ring: &mut Ring) {
        let mut back: SmallVec<[u32; 8]> = SmallVec::new();
        let mut at = corner;
        while let Some(across) = self.across(t, at) {
            at = self.tiers[t].next(across);
            back.push(at);
        }
        back.reverse();
        back.extend_from_slice(&ring.corners);
        ring.corners = back;
        let last = ring.corners[ring.corners.len() - 1];
        let tier = &self.tiers[t];
        ring.edges
            .push(tier.corner_edges[tier.previous(last) as usize]);
    }

    /// Puts the first place first, and finds the edges.
    fn finish(&self, t: usize, ring: &mut Ring) {
        let tier = &self.tiers[t];
        if ring.edges.is_empty() {
            let places = ring.corners.iter().map(|&c| tier.place(c));
            let first = places.enumerate().min_by_key(|p| p.1);
            ring.corners.rotate_left(first.map_or(0, |f| f.0));
        }
        let end = ring.edges.pop();
        let edges = ring.corners.iter().map(|&c| tier.corner_edges[c as usize]);
        ring.edges = edges.chain(end).collect();
    }

    /// Sharpness of the edges of a ring.
    pub fn around(&self, t: usize, ring: &Ring) -> Around {
        let sharpness = |&e: &u32| self.tiers[t].edges[e as usize].sharpness;
        ring.edges.iter().map(sharpness).collect()
    }
}
