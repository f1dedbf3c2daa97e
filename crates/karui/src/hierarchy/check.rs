//! Whether a hierarchy holds together.

use super::Hierarchy;
use super::node::Node;
use super::surface::{NONE, REVERSED};
use crate::error::{Error, Result};

impl Hierarchy {
    /// Checks that all ids are in range, that the bounds of a node hold those of
    /// its children, that all collapses can be done in their order, and that each
    /// waits for those that it needs. What passes can be cut.
    ///
    /// # Errors
    /// [`Error::Broken`] naming the node or half-edge.
    pub fn validate(&self) -> Result<()> {
        self.check_surface()?;
        let first = self
            .nodes
            .first()
            .map_or(self.dependents.len(), |n| n.first_dependent as usize);
        ensure(first == 0, "every dependent is some node's", 0)?;
        (0..self.nodes.len()).try_for_each(|id| self.check_node(id))?;
        self.check_order()
    }

    fn check_surface(&self) -> Result<()> {
        let halves = &self.surface.halves;
        let mut numbers = self.triangle_of_face.clone();
        numbers.sort_unstable();
        let twice = numbers.windows(2).any(|w| w[0] == w[1]);
        ensure(!twice, "a triangle is one face", 0)?;
        let faces = self.triangle_of_face.len();
        ensure(halves.len() == 3 * faces, "a face has three corners", faces)?;
        ensure(
            halves.len() < REVERSED as usize,
            "half-edges have 31 bits",
            faces,
        )?;
        for (h, half) in halves.iter().enumerate() {
            let exists = (half.start as usize) < self.vertices;
            ensure(exists, "a corner is a vertex", h)?;
            if half.opposite == NONE {
                continue;
            }
            let back = halves.get(half.opposite as usize).map(|o| o.opposite);
            ensure(back == Some(h as u32), "halves know each other", h)?;
            let other_face = half.opposite as usize / 3 != h / 3;
            ensure(other_face, "halves are of two faces", h)?;
        }
        let wrong = (0..faces).find(|&f| !self.surface.is_proper(f as u32));
        ensure(wrong.is_none(), "corners differ", wrong.unwrap_or_default())
    }

    fn check_node(&self, id: usize) -> Result<()> {
        let node = &self.nodes[id];
        let h = node.half_edge & !REVERSED;
        let halves = self.surface.halves.len() as u32;
        ensure(h < halves, "a node has a half-edge", id)?;
        let cover = &node.cover;
        let finite = cover.center.is_finite() && cover.radius.is_finite();
        let sound = finite && cover.radius >= 0.0 && cover.sine >= 0.0;
        ensure(sound, "bounds are finite", id)?;
        let parent = node.parent as usize;
        ensure(
            node.parent == NONE || (parent > id && parent < self.nodes.len()),
            "a parent comes later",
            id,
        )?;
        if let Some(parent) = self.nodes.get(parent) {
            ensure(
                parent.children.contains(&(id as u32)),
                "a parent knows its children",
                id,
            )?;
        }
        let [first, second] = node.children;
        ensure(first != second || first == NONE, "children differ", id)?;
        for &child in node.children.iter().filter(|&&c| c != NONE) {
            ensure((child as usize) < id, "a child comes earlier", id)?;
            let child = &self.nodes[child as usize];
            ensure(child.parent == id as u32, "a child knows its parent", id)?;
            ensure(holds(node, child), "bounds hold those of children", id)?;
        }
        let end = self
            .nodes
            .get(id + 1)
            .map_or(self.dependents.len(), |n| n.first_dependent as usize);
        let range = node.first_dependent as usize..end;
        let dependents = self.dependents.get(range);
        ensure(dependents.is_some(), "dependents follow each other", id)?;
        let later = |&d: &u32| d as usize > id && (d as usize) < self.nodes.len();
        ensure(
            dependents.unwrap_or_default().iter().all(later),
            "what waits comes later",
            id,
        )
    }
}

/// Whether the bounds of `outer` hold those of `inner`, but for rounding.
fn holds(outer: &Node, inner: &Node) -> bool {
    let (outer, inner) = (outer.cover.bounds(), inner.cover.bounds());
    let reach = outer.center.distance(inner.center) + inner.radius;
    let finite = reach.is_finite() && outer.radius.is_finite();
    let in_sphere = finite && reach <= outer.radius * (1.0 + 1e-9) + f64::MIN_POSITIVE;
    let in_cone = match (outer.spread, inner.spread) {
        (None, _) => true,
        (Some(_), None) => false,
        (Some(o), Some(i)) => {
            let between = outer.axis.dot(inner.axis).clamp(-1.0, 1.0);
            let across = (1.0 - between * between).max(0.0).sqrt();
            let sum = between * i[1] - across * i[0];
            sum >= o[1] - 1e-6
        }
    };
    in_sphere && in_cone
}

pub(super) fn ensure(holds: bool, rule: &'static str, index: usize) -> Result<()> {
    if holds {
        return Ok(());
    }
    Err(Error::Broken { rule, index })
}
