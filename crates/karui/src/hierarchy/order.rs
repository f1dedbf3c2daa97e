//! Whether the collapses of a hierarchy can be done in their order, and whether
//! each waits for all that it must.

use super::Hierarchy;
use super::check::ensure;
use super::surface::{Fan, MOST_FACES, NONE, REVERSED, Sides, Surface, next, prev};
use crate::error::Result;

/// A hierarchy while its collapses are done again.
struct Replay<'a> {
    hierarchy: &'a Hierarchy,
    surface: Surface,
    hidden: Vec<bool>,
    /// The node that last changed every face.
    of_face: Vec<u32>,
    /// What every node waits for but its children, node after node.
    waits: Vec<u32>,
    starts: Vec<u32>,
    fan: Vec<u32>,
}

impl Hierarchy {
    /// Does all collapses, one after the other, and looks at each before. Faces
    /// and nodes must be in range.
    pub(super) fn check_order(&self) -> Result<()> {
        let (starts, waits) = self.waits();
        let faces = self.triangle_of_face.len();
        let mut replay = Replay {
            hierarchy: self,
            surface: self.surface.clone(),
            hidden: vec![false; faces],
            of_face: vec![NONE; faces],
            waits,
            starts,
            fan: Vec::new(),
        };
        (0..self.nodes.len() as u32).try_for_each(|node| replay.step(node))
    }

    /// What every node waits for but its children.
    fn waits(&self) -> (Vec<u32>, Vec<u32>) {
        let mut starts = vec![0u32; self.nodes.len() + 1];
        for &later in &self.dependents {
            starts[later as usize + 1] += 1;
        }
        for i in 0..self.nodes.len() {
            starts[i + 1] += starts[i];
        }
        let mut fill = starts.clone();
        let mut waits = vec![0; self.dependents.len()];
        for earlier in 0..self.nodes.len() as u32 {
            for &later in self.dependents(earlier) {
                let place = &mut fill[later as usize];
                waits[*place as usize] = earlier;
                *place += 1;
            }
        }
        (starts, waits)
    }
}

impl Replay<'_> {
    fn step(&mut self, node: u32) -> Result<()> {
        let half_edge = self.hierarchy.nodes[node as usize].half_edge;
        self.check_edge(half_edge, node)?;
        self.check_waits(half_edge, node)?;
        let sides = self.surface.sides(half_edge);
        for &c in &self.fan {
            self.of_face[c as usize / 3] = node;
        }
        for face in sides.faces() {
            self.hidden[face as usize] = true;
        }
        self.surface.collapse(half_edge, |_, _| {});
        let sound = self.fan.iter().all(|c| self.surface.is_proper(c / 3));
        ensure(sound, "corners differ", node as usize)
    }

    /// Whether the faces beside the edge and around its start are there.
    fn check_edge(&mut self, half_edge: u32, node: u32) -> Result<()> {
        let at = node as usize;
        let sides = self.surface.sides(half_edge);
        let there = |h: u32| !self.hidden[h as usize / 3];
        ensure(
            sides.faces().all(|f| there(3 * f)),
            "a face is hidden once",
            at,
        )?;
        if half_edge & REVERSED != 0 {
            let border = self.surface.opposite(sides.right) == NONE;
            ensure(border, "what is reversed is a border", at)?;
        }
        let moves = self.surface.moves(sides);
        let told_apart = (moves.left[0] == moves.right[0]) == (moves.left[1] == moves.right[1]);
        ensure(told_apart, "a seam has two sides", at)?;
        let ends_differ = moves.left[0] != moves.left[1] && moves.right[0] != moves.right[1];
        ensure(ends_differ, "ends differ", at)?;
        let start = Fan::new(&self.surface, sides);
        ensure(start.is_some(), "a vertex has another face", at)?;
        self.fan.clear();
        let removed = [moves.left[0], moves.right[0]];
        if let Some(mut fan) = start {
            while let Some(c) = fan.next(&self.surface) {
                let known = there(c) && removed.contains(&self.surface.start(c));
                ensure(known, "faces around a vertex are there", at)?;
                ensure(
                    self.fan.len() < MOST_FACES as usize,
                    "faces around a vertex are few",
                    at,
                )?;
                self.fan.push(c);
            }
        }
        ensure(
            fan_ends(&self.surface, &self.fan, sides),
            "faces around a vertex form one fan",
            at,
        )
    }

    /// Whether the node waits, maybe through another, for the last that changed
    /// each face around.
    fn check_waits(&self, half_edge: u32, node: u32) -> Result<()> {
        let sides = self.surface.sides(half_edge);
        let fan = self.fan.iter().map(|c| c / 3);
        let changed = fan.chain(sides.faces()).map(|f| self.of_face[f as usize]);
        let children = self.hierarchy.nodes[node as usize].children;
        let needed: smallvec::SmallVec<[u32; 16]> =
            changed.chain(children).filter(|&n| n != NONE).collect();
        let waits = |later: u32, earlier: u32| {
            let range = self.starts[later as usize]..self.starts[later as usize + 1];
            let listed = &self.waits[range.start as usize..range.end as usize];
            let children = &self.hierarchy.nodes[later as usize].children;
            children.contains(&earlier) || listed.contains(&earlier)
        };
        let known =
            |&n: &u32| waits(node, n) || needed.iter().any(|&m| m > n && m < node && waits(m, n));
        ensure(
            needed.iter().all(known),
            "a node waits for what it needs",
            node as usize,
        )?;
        let count = self.starts[node as usize + 1] - self.starts[node as usize];
        ensure(count < 1 << 14, "a node waits for few", node as usize)
    }
}

/// Whether a walk around a vertex has ended where the faces beside the edge are.
fn fan_ends(surface: &Surface, fan: &[u32], sides: Sides) -> bool {
    let Some(&last) = fan.last() else {
        return false;
    };
    match (sides.left, sides.right) {
        (NONE, _) => surface.opposite(last) == NONE,
        (_, NONE) => surface.opposite(prev(last)) == NONE,
        (_, right) => surface.opposite(prev(last)) == next(right),
    }
}
