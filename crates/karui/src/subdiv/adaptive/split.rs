//! Splitting pieces, so that no edge is ever cut.
//!
//! A face is cut into triangles around its centre; where the face across an edge is cut as
//! well, the edge goes and two triangles become a diamond. A diamond is cut around the point
//! of its edge; where both diamonds beside a spoke of a face are cut, the spoke goes and two
//! triangles become a face of the next tier. So a piece can be split once it is whole.
//!
//! What is split in the end does not depend on the order, so that threads may split pieces
//! side by side: each is stamped by one of them, which counts and offers what that makes.

use super::piece::Piece;
use super::store::{NONE, Store};

/// What came of wanting to split a piece.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Outcome {
    Split,
    /// What is around it is too coarse.
    Refused,
    /// Something has to be made first: [`Cut::grow`].
    Missing,
}

/// What a thread has split: pieces that may be split next, with their depths, and how many
/// more faces are drawn for it.
#[derive(Debug, Default)]
pub(super) struct Yield {
    pub offers: Vec<(u32, u32)>,
    pub faces: i64,
    /// The same, if none of them had become one with another.
    pub most: i64,
}

/// How pieces are split in one frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cut {
    pub frame: u32,
    /// Whether pieces around are split so that a piece becomes whole.
    pub spread: bool,
}

impl Cut {
    pub fn split(self, store: &Store, t: usize, piece: Piece, to: &mut Yield) -> Outcome {
        match piece {
            Piece::Face(f) => self.split_face(store, t, f, to),
            Piece::Diamond(e) => self.split_diamond(store, t, e, to),
        }
    }

    fn split_face(self, store: &Store, t: usize, f: u32, to: &mut Yield) -> Outcome {
        let (tier, stamps) = (&store.tiers[t], &store.tiers[t].face_stamps[f as usize]);
        if stamps.is_split(self.frame) {
            return Outcome::Split;
        }
        let face = &tier.faces[f as usize];
        if t > 0 {
            for e in store.beside(t - 1, face.parent) {
                let diamond = self.require(store, t - 1, Piece::Diamond(e), to);
                if diamond != Outcome::Split {
                    return diamond;
                }
            }
        }
        // The centre is going to be drawn.
        if face.children == NONE || !store.has_wedge(t + 1, 4 * face.children + 2) {
            return Outcome::Missing;
        }
        if stamps.split(self.frame) {
            return Outcome::Split;
        }
        let corners = tier.corners_of(f);
        to.add(corners.len() as i64 - 1);
        for c in corners {
            let e = tier.corner_edges[c as usize];
            // Offered before by the face across: two triangles are one now.
            let again = self.offer(store, t, Piece::Diamond(e), to);
            to.faces -= i64::from(again && store.is_merged(t, e, self.frame));
        }
        Outcome::Split
    }

    fn split_diamond(self, store: &Store, t: usize, e: u32, to: &mut Yield) -> Outcome {
        let (tier, stamps) = (&store.tiers[t], &store.tiers[t].edge_stamps[e as usize]);
        if stamps.is_split(self.frame) {
            return Outcome::Split;
        }
        let edge = &tier.edges[e as usize];
        if !edge.open && edge.corners[1] == NONE {
            return Outcome::Missing;
        }
        let sides = store.known_sides(t, e);
        for &c in &sides {
            let face = self.require(store, t, Piece::Face(tier.face_of(c)), to);
            if face != Outcome::Split {
                return face;
            }
        }
        let drawn = |&c: &u32| store.has_wedge(t + 1, 4 * tier.child(c) + 1);
        if !sides.iter().all(drawn) {
            return Outcome::Missing;
        }
        if stamps.split(self.frame) {
            return Outcome::Split;
        }
        to.add(match store.is_ridge(t, e) {
            true => sides.len() as i64,
            false => 3,
        });
        for c in sides {
            for corner in [c, tier.next(c)] {
                // Offered before by the diamond on its other side.
                let again = self.offer(store, t + 1, Piece::Face(tier.child(corner)), to);
                to.faces -= i64::from(again);
            }
        }
        Outcome::Split
    }

    /// Splits a piece that another needs to be split, or looks whether it is.
    fn require(self, store: &Store, t: usize, piece: Piece, to: &mut Yield) -> Outcome {
        if self.spread {
            return self.split(store, t, piece, to);
        }
        match store.stamps(t, piece).is_split(self.frame) {
            true => Outcome::Split,
            false => Outcome::Refused,
        }
    }

    /// Puts a piece among those of its depth, once a frame. Says whether it had been offered.
    pub fn offer(self, store: &Store, t: usize, piece: Piece, to: &mut Yield) -> bool {
        if store.stamps(t, piece).offer(self.frame) {
            return true;
        }
        let (depth, id) = match piece {
            Piece::Face(f) => (2 * t as u32, f),
            Piece::Diamond(e) => (2 * t as u32 + 1, e),
        };
        if !matches!(piece, Piece::Face(f) if store.is_hole(t, f)) {
            to.offers.push((depth, id));
        }
        false
    }

    /// Makes what has to be there to split a piece.
    pub fn grow(self, store: &mut Store, t: usize, piece: Piece) {
        if store.stamps(t, piece).is_split(self.frame) {
            return;
        }
        match piece {
            Piece::Face(f) => self.grow_face(store, t, f),
            Piece::Diamond(e) => self.grow_diamond(store, t, e),
        }
    }

    fn grow_face(self, store: &mut Store, t: usize, f: u32) {
        if t > 0 && self.spread {
            let parent = store.tiers[t].faces[f as usize].parent;
            for e in store.beside(t - 1, parent) {
                self.grow(store, t - 1, Piece::Diamond(e));
            }
        }
        let child = store.children(t, f);
        store.wedge(t + 1, 4 * child + 2);
    }

    fn grow_diamond(self, store: &mut Store, t: usize, e: u32) {
        for c in store.sides(t, e) {
            let face = store.tiers[t].face_of(c);
            if self.spread {
                self.grow(store, t, Piece::Face(face));
            }
            if store.tiers[t].faces[face as usize].children != NONE {
                let child = store.tiers[t].child(c);
                store.wedge(t + 1, 4 * child + 1);
            }
        }
    }
}

impl Yield {
    fn add(&mut self, faces: i64) {
        self.faces += faces;
        self.most += faces;
    }
}

impl Store {
    /// The edges before and after a corner.
    pub fn beside(&self, t: usize, corner: u32) -> [u32; 2] {
        let tier = &self.tiers[t];
        [tier.previous(corner), corner].map(|c| tier.corner_edges[c as usize])
    }

    /// Whether the diamond over an edge has been split in a frame.
    pub fn is_split(&self, t: usize, e: u32, frame: u32) -> bool {
        self.tiers[t].edge_stamps[e as usize].is_split(frame)
    }

    /// Whether both faces of an edge have been cut in a frame, and it has gone.
    pub fn is_merged(&self, t: usize, e: u32, frame: u32) -> bool {
        let tier = &self.tiers[t];
        let cut = |c: u32| {
            let face = tier.face_of(c);
            tier.face_stamps[face as usize].is_split(frame) && !self.is_hole(t, face)
        };
        let sides = tier.edges[e as usize].corners;
        !self.is_ridge(t, e) && !sides.contains(&NONE) && sides.into_iter().all(cut)
    }
}
