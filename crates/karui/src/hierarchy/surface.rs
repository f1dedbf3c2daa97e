//! The triangles as half-edges of which some are hidden: half-edge collapse and
//! its exact inverse, the vertex split.
//!
//! Half-edge `h` starts at corner `h` of the triangle list, that is, at corner
//! `h % 3` of face `h / 3`. A hidden face keeps its corners and neighbours as they
//! were when it was hidden; that is all a split needs to know.

use bytemuck::{Pod, Zeroable};

/// "No half-edge" and "no node".
pub(super) const NONE: u32 = u32::MAX;

/// Set on a half-edge that runs from the kept vertex to the removed one, where
/// the half that starts at the removed vertex is the border's and has no face.
pub(super) const REVERSED: u32 = 1 << 31;

/// Faces around a vertex that goes at most; and that another may come to have,
/// unless it has more already: every collapse looks at all of them.
pub(super) const MOST_FACES: u32 = 255;

/// The half-edge after `h` around its face.
#[inline]
pub(super) fn next(h: u32) -> u32 {
    if h % 3 == 2 { h - 2 } else { h + 1 }
}

/// The half-edge before `h` around its face.
#[inline]
pub(super) fn prev(h: u32) -> u32 {
    if h.is_multiple_of(3) { h + 2 } else { h - 1 }
}

/// A half-edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Half {
    /// The vertex it starts at.
    pub start: u32,
    /// The other half of its edge; [`NONE`] at the border.
    pub opposite: u32,
}

/// Corners and neighbours of all faces, hidden ones included.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Surface {
    pub halves: Vec<Half>,
}

/// The half-edges of the one or two faces that a collapse hides.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Sides {
    /// Starts at the removed vertex; [`NONE`] if the border has no face there.
    pub left: u32,
    /// Its other half, which ends at the removed vertex; [`NONE`] likewise.
    pub right: u32,
}

impl Sides {
    /// The faces hidden.
    pub fn faces(self) -> impl Iterator<Item = u32> {
        [self.left, self.right]
            .into_iter()
            .filter(|&h| h != NONE)
            .map(|h| h / 3)
    }
}

/// What vertex becomes what on either side of a collapsed edge. Both are the
/// same where no seam runs along it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Moves {
    /// `[removed, kept]` on the left.
    pub left: [u32; 2],
    /// On the right.
    pub right: [u32; 2],
}

impl Moves {
    /// From what stands at the start of every half-edge.
    #[inline]
    pub fn new(sides: Sides, start: impl Fn(u32) -> u32) -> Self {
        let left = |h: u32| [start(h), start(next(h))];
        let right = |h: u32| [start(next(h)), start(h)];
        let [left, right] = match (sides.left, sides.right) {
            (NONE, r) => [right(r); 2],
            (l, NONE) => [left(l); 2],
            (l, r) => [left(l), right(r)],
        };
        Self { left, right }
    }

    /// What a vertex on either side becomes.
    #[inline]
    pub fn kept(&self, removed: u32) -> u32 {
        if removed == self.left[0] {
            self.left[1]
        } else {
            self.right[1]
        }
    }

    #[inline]
    fn removed(&self, kept: u32) -> u32 {
        if kept == self.left[1] {
            self.left[0]
        } else {
            self.right[0]
        }
    }
}

/// The corners that a collapse moves: those at the removed vertex in the faces
/// that stay, in order around it. The same before and after the collapse. There
/// is one at least: a vertex with no other face is never removed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fan {
    at: u32,
    last: u32,
    forward: bool,
}

impl Fan {
    /// Nothing where the hidden faces are all there are.
    #[inline]
    pub fn new(surface: &Surface, sides: Sides) -> Option<Self> {
        let right = match sides.right {
            NONE => NONE,
            right => surface.opposite(next(right)),
        };
        let (at, forward) = match (sides.left, right) {
            (NONE, NONE) => return None,
            (NONE, right) => (next(right), false),
            (left, _) => (surface.opposite(prev(left)), true),
        };
        (at != NONE).then_some(Self {
            at,
            last: right,
            forward,
        })
    }

    #[inline]
    pub fn next(&mut self, surface: &Surface) -> Option<u32> {
        let at = self.at;
        if at == NONE {
            return None;
        }
        self.at = if self.forward {
            let inward = prev(at);
            match inward == self.last {
                true => NONE,
                false => surface.opposite(inward),
            }
        } else {
            match surface.opposite(at) {
                NONE => NONE,
                inward => next(inward),
            }
        };
        Some(at)
    }
}

impl Surface {
    /// The vertex that `h` starts at.
    #[inline]
    pub fn start(&self, h: u32) -> u32 {
        self.halves[h as usize].start
    }

    /// The other half of the edge of `h`; [`NONE`] at the border.
    #[inline]
    pub fn opposite(&self, h: u32) -> u32 {
        self.halves[h as usize].opposite
    }

    /// The corners of a face.
    #[inline]
    pub fn corners(&self, face: u32) -> [u32; 3] {
        [0, 1, 2].map(|k| self.start(3 * face + k))
    }

    /// Whether the corners of a face differ.
    pub fn is_proper(&self, face: u32) -> bool {
        let [a, b, c] = self.corners(face);
        a != b && b != c && c != a
    }

    /// The faces on both sides of a node's half-edge.
    #[inline]
    pub fn sides(&self, half_edge: u32) -> Sides {
        let h = half_edge & !REVERSED;
        match half_edge & REVERSED {
            0 => Sides {
                left: h,
                right: self.opposite(h),
            },
            _ => Sides {
                left: NONE,
                right: h,
            },
        }
    }

    /// What a collapse of the edge makes of its vertices.
    #[inline]
    pub fn moves(&self, sides: Sides) -> Moves {
        Moves::new(sides, |h| self.start(h))
    }

    /// Collapses an edge: the faces on its sides close up, every corner at the
    /// removed vertex goes to the kept one. `moved` is told of each corner
    /// and what vertex is there now.
    #[inline]
    pub fn collapse(&mut self, half_edge: u32, mut moved: impl FnMut(u32, u32)) -> Sides {
        let sides = self.sides(half_edge);
        let moves = self.moves(sides);
        self.move_fan(sides, |v| moves.kept(v), &mut moved);
        for h in [sides.left, sides.right] {
            if h != NONE {
                let [outer, inner] = [next(h), prev(h)].map(|k| self.opposite(k));
                self.link(outer, inner);
            }
        }
        sides
    }

    /// Undoes [`Surface::collapse`].
    #[inline]
    pub fn split(&mut self, half_edge: u32, mut moved: impl FnMut(u32, u32)) -> Sides {
        let sides = self.sides(half_edge);
        let moves = self.moves(sides);
        self.move_fan(sides, |v| moves.removed(v), &mut moved);
        if sides.left != NONE {
            self.open(prev(sides.left), next(sides.left));
        }
        if sides.right != NONE {
            self.open(next(sides.right), prev(sides.right));
        }
        sides
    }

    /// Changes the vertices of the corners that a collapse or split moves.
    #[inline]
    fn move_fan(
        &mut self,
        sides: Sides,
        to: impl Fn(u32) -> u32,
        moved: &mut impl FnMut(u32, u32),
    ) {
        let mut fan = Fan::new(self, sides);
        while let Some(c) = fan.as_mut().and_then(|f| f.next(self)) {
            let corner = &mut self.halves[c as usize].start;
            *corner = to(*corner);
            moved(c, *corner);
        }
    }

    /// Puts a hidden face back between its neighbour at `inner`, the half-edge
    /// at the removed vertex, and whatever is that neighbour's neighbour now. The
    /// former stays as long as the face is hidden, the latter need not.
    fn open(&mut self, inner: u32, outer: u32) {
        let neighbor = self.opposite(inner);
        let beyond = self.opposite(neighbor);
        self.link(outer, beyond);
        self.link(inner, neighbor);
    }

    #[inline]
    fn link(&mut self, a: u32, b: u32) {
        if a != NONE {
            self.halves[a as usize].opposite = b;
        }
        if b != NONE {
            self.halves[b as usize].opposite = a;
        }
    }
}
