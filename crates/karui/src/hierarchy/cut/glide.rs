//! Vertices that come back glide to their places instead of popping up, and glide
//! to where they will be part of another before they go (geomorphs: H. Hoppe,
//! Progressive Meshes, 1996).

use super::{Budget, Change, Cut};
use crate::error::Result;
use crate::hierarchy::criteria::Criteria;
use std::collections::{BTreeMap, BTreeSet};

/// The vertices of one [`Cut`] that are on their way.
#[derive(Debug, Clone)]
pub struct Gliding {
    frames: u32,
    /// By node and vertex.
    moving: BTreeMap<(u32, u32), Moving>,
}

/// A vertex on its way: it is drawn at `from + weight * (own - from)`, where `from`
/// and `own` are the positions of the two vertices.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Glide {
    /// The vertex.
    pub vertex: u32,
    /// The vertex that it was part of, or will be.
    pub from: u32,
    /// 0 to 1; 1 is its own place, and not listed any more.
    pub weight: f32,
}

#[derive(Debug, Clone, Copy)]
struct Moving {
    from: u32,
    /// Frames from there.
    age: u32,
}

impl Gliding {
    /// A way takes so many frames; 1 or 0: none.
    #[must_use]
    pub fn over(frames: u32) -> Self {
        Self {
            frames: frames.max(1),
            moving: BTreeMap::new(),
        }
    }

    /// [`Cut::refine`], in place of it: vertices that it brings back start on their
    /// way, those that are not wanted any more turn round, and go once they are
    /// there. So detail goes level by level, and a cut is what the criteria ask for
    /// only after a few frames without a change: [`Change::complete`]. Under a
    /// budget, vertices go at once.
    ///
    /// # Errors
    /// Those of [`Cut::refine`].
    pub fn refine<C: Criteria>(
        &mut self,
        cut: &mut Cut<'_>,
        criteria: &C,
        budget: Budget,
    ) -> Result<Change> {
        let mut leaving = BTreeSet::new();
        let moving = &self.moving;
        let change = cut.refine_but(criteria, budget, |node| {
            let mut ways = moving.range((node, 0)..=(node, u32::MAX)).peekable();
            let is_there =
                self.frames == 1 || (ways.peek().is_some() && ways.all(|m| m.1.age == 0));
            if !is_there {
                leaving.insert(node);
            }
            !is_there
        })?;
        self.advance(cut, &leaving);
        Ok(change)
    }

    /// All move on by a frame.
    fn advance(&mut self, cut: &Cut<'_>, leaving: &BTreeSet<u32>) {
        let frames = self.frames;
        for &node in leaving {
            for [vertex, from] in cut.vertices_of(node) {
                let there = Moving { from, age: frames };
                self.moving.entry((node, vertex)).or_insert(there);
            }
        }
        self.moving.retain(|&(node, _), m| {
            m.age = match leaving.contains(&node) {
                true => m.age.saturating_sub(1),
                false => m.age + 1,
            };
            m.age < frames && cut.is_active(node)
        });
        for a in cut.came_back().into_iter().filter(|_| frames > 1) {
            let new = Moving {
                from: a.part_of,
                age: 0,
            };
            self.moving.entry((a.node, a.vertex)).or_insert(new);
        }
    }

    /// All that are on their way, in the order of the collapses that they go by.
    pub fn glides(&self) -> impl Iterator<Item = Glide> {
        self.moving.iter().map(|(&(_, vertex), m)| Glide {
            vertex,
            from: m.from,
            weight: m.age as f32 / self.frames as f32,
        })
    }
}

impl Cut<'_> {
    /// The vertices that a collapsible node takes away, each with the one that it
    /// becomes part of: `[vertex, part_of]`; two on a seam.
    fn vertices_of(&self, node: u32) -> impl Iterator<Item = [u32; 2]> {
        let sides = self.surface.sides(self.node(node).half_edge);
        let moves = self.surface.moves(sides);
        let second = (moves.left != moves.right).then_some(moves.right);
        std::iter::once(moves.left).chain(second)
    }
}
