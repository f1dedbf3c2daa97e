//! Splitting pieces, so that no edge is ever cut.
//!
//! A face is cut into triangles around its centre; where the face across an edge is cut as
//! well, the edge goes and two triangles become a diamond. A diamond is cut around the point
//! of its edge; where both diamonds beside a spoke of a face are cut, the spoke goes and two
//! triangles become a face of the next tier. So a piece can be split once it is whole.

use super::piece::Piece;
use super::store::{NONE, Store};

/// What is split in one frame, and what that offers to be split next.
pub(super) struct Cut<'a> {
    pub store: &'a mut Store,
    pub frame: u32,
    /// Whether pieces around are split so that a piece becomes whole.
    pub spread: bool,
    /// Pieces of every depth below the deepest: faces at even ones, diamonds at odd ones.
    pub offers: &'a mut [Vec<u32>],
    /// Number of faces drawn.
    pub faces: usize,
}

impl Cut<'_> {
    pub fn split(&mut self, t: usize, piece: Piece) -> bool {
        match piece {
            Piece::Face(f) => self.split_face(t, f),
            Piece::Diamond(e) => self.split_diamond(t, e),
        }
    }

    fn split_face(&mut self, t: usize, f: u32) -> bool {
        let face = &self.store.tiers[t].faces[f as usize];
        if face.split == self.frame {
            return true;
        }
        if t > 0 {
            let parent = face.parent;
            for e in self.store.beside(t - 1, parent) {
                if !self.require_diamond(t - 1, e) {
                    return false;
                }
            }
        }
        let child = self.store.children(t, f);
        // The centre is going to be drawn.
        self.store.wedge(t + 1, 4 * child + 2);
        self.store.tiers[t].faces[f as usize].split = self.frame;
        let corners = self.store.tiers[t].corners_of(f);
        self.faces += corners.len() - 1;
        for c in corners {
            let e = self.store.tiers[t].corner_edges[c as usize];
            // Offered before by the face across: two triangles are one now.
            let again = self.offer(t, Piece::Diamond(e));
            self.faces -= usize::from(again && self.store.is_merged(t, e, self.frame));
        }
        true
    }

    fn split_diamond(&mut self, t: usize, e: u32) -> bool {
        if self.store.tiers[t].edges[e as usize].split == self.frame {
            return true;
        }
        let sides = self.store.sides(t, e);
        for &c in &sides {
            let face = self.store.tiers[t].face_of(c);
            if !self.require_face(t, face) {
                return false;
            }
        }
        self.store.tiers[t].edges[e as usize].split = self.frame;
        self.faces += if self.store.is_ridge(t, e) {
            sides.len()
        } else {
            3
        };
        for c in sides {
            let child = self.store.tiers[t].child(c);
            self.store.wedge(t + 1, 4 * child + 1);
            for corner in [c, self.store.tiers[t].next(c)] {
                let child = self.store.tiers[t].child(corner);
                // Offered before by the diamond on its other side.
                let again = self.offer(t + 1, Piece::Face(child));
                self.faces -= usize::from(again);
            }
        }
        true
    }

    fn require_diamond(&mut self, t: usize, e: u32) -> bool {
        if self.spread {
            return self.split_diamond(t, e);
        }
        self.store.is_split(t, e, self.frame)
    }

    fn require_face(&mut self, t: usize, f: u32) -> bool {
        if self.spread {
            return self.split_face(t, f);
        }
        self.store.tiers[t].faces[f as usize].split == self.frame
    }

    /// Puts a piece among those of its depth, once a frame, if there is such a depth. Says
    /// whether it had been offered.
    pub fn offer(&mut self, t: usize, piece: Piece) -> bool {
        let (depth, id) = match piece {
            Piece::Face(f) => (2 * t, f),
            Piece::Diamond(e) => (2 * t + 1, e),
        };
        let tier = &mut self.store.tiers[t];
        let offered = match piece {
            Piece::Face(f) => &mut tier.faces[f as usize].offered,
            Piece::Diamond(e) => &mut tier.edges[e as usize].offered,
        };
        if std::mem::replace(offered, self.frame) == self.frame {
            return true;
        }
        let hole = matches!(piece, Piece::Face(f) if self.store.is_hole(t, f));
        if let Some(offers) = self.offers.get_mut(depth).filter(|_| !hole) {
            offers.push(id);
        }
        false
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
        self.tiers[t].edges[e as usize].split == frame
    }

    /// Whether both faces of an edge have been cut in a frame, and it has gone.
    pub fn is_merged(&self, t: usize, e: u32, frame: u32) -> bool {
        let tier = &self.tiers[t];
        let cut = |c: u32| {
            let face = tier.face_of(c);
            tier.faces[face as usize].split == frame && !self.is_hole(t, face)
        };
        let sides = tier.edges[e as usize].corners;
        !self.is_ridge(t, e) && !sides.contains(&NONE) && sides.into_iter().all(cut)
    }
}
