//! The state of one view: which collapses are applied, and the triangles that
//! gives.

mod best_first;
mod budget;
mod check;
#[cfg(test)]
mod definition;
mod front;
mod glide;
mod refine;
mod triangles;

pub use budget::{Budget, Change};
pub use glide::{Glide, Gliding};

use super::surface::{NONE, Surface};
use super::{Hierarchy, Vantage};
use crate::error::{Error, Result};
use crate::mesh::TriMesh;
use front::Front;
use std::collections::HashMap;
use triangles::Triangles;

/// In the state of a node: its collapse is not applied.
const ACTIVE: u16 = 1 << 15;

/// All state of one view of a [`Hierarchy`]: a node is active if its collapse is
/// not applied. Every node whose collapse is applied has all it waits for applied.
///
/// Takes 44 bytes a triangle and 6 a node.
#[derive(Debug, Clone)]
pub struct Cut<'a> {
    hierarchy: &'a Hierarchy,
    surface: Surface,
    triangles: Triangles,
    /// By node: [`ACTIVE`], and how many of those it waits for are active.
    state: Vec<u16>,
    /// By node: where it is in the list below that it is in.
    place: Vec<u32>,
    /// Collapsed, but the parent is not: half of the front.
    splittable: Front,
    /// Active, and all that they wait for collapsed: the other half.
    collapsible: Front,
    /// Nodes whose children or dependents are to be looked at.
    fresh: Vec<u32>,
    stack: Vec<u32>,
    /// What has been done since the last frame.
    done: Done,
    /// Where the last frame looked from, and what has been gone in all.
    vantage: Option<Vantage>,
    odometer: f64,
    /// Whether what is known of the front holds only if the lights stay where they
    /// are.
    still: bool,
    /// Frames since a light has moved.
    rest: u32,
}

/// Counts of a frame, and the vertices that its splits have brought back.
#[derive(Debug, Clone, Default)]
struct Done {
    splits: usize,
    collapses: usize,
    appeared: Vec<Appeared>,
}

#[derive(Debug, Clone, Copy)]
struct Appeared {
    node: u32,
    vertex: u32,
    part_of: u32,
}

impl Hierarchy {
    /// The cut with every collapse applied.
    #[must_use]
    pub fn coarsest(&self) -> Cut<'_> {
        let mut cut = self.finest();
        for node in 0..self.nodes.len() as u32 {
            cut.collapse(node);
        }
        cut.fresh.clear();
        cut.done = Done::default();
        cut.triangles.take_changed(1);
        cut
    }

    /// The cut with no collapse applied: the mesh itself.
    #[must_use]
    pub fn finest(&self) -> Cut<'_> {
        let mut state = vec![ACTIVE; self.nodes.len()];
        for (id, node) in self.nodes.iter().enumerate() {
            let children = node.children.iter().filter(|&&c| c != NONE).count();
            state[id] += children as u16;
        }
        for &later in &self.dependents {
            state[later as usize] += 1;
        }
        let mut cut = Cut {
            hierarchy: self,
            surface: self.surface.clone(),
            triangles: Triangles::new(&self.surface),
            place: vec![NONE; state.len()],
            state,
            splittable: Front::default(),
            collapsible: Front::default(),
            fresh: Vec::new(),
            stack: Vec::new(),
            done: Done::default(),
            vantage: None,
            odometer: 0.0,
            still: false,
            rest: 0,
        };
        for node in 0..cut.state.len() as u32 {
            if cut.is_collapsible(node) {
                cut.collapsible
                    .put(&mut cut.place, node, self.nodes[node as usize].cover);
            }
        }
        cut
    }
}

impl Cut<'_> {
    /// The hierarchy cut.
    #[must_use]
    pub fn hierarchy(&self) -> &Hierarchy {
        self.hierarchy
    }

    /// The triangles to draw, over the vertices of the mesh that the hierarchy was
    /// built from, in an order that depends on the path; see [`Change::ranges`]
    /// for what is new, [`Cut::triangles`] for an order that does not.
    #[must_use]
    pub fn indices(&self) -> &[[u32; 3]] {
        &self.triangles.indices
    }

    /// The triangles in the order of the mesh, each with the number of the
    /// triangle of the mesh that it was.
    #[must_use]
    pub fn triangles(&self) -> Vec<(u32, [u32; 3])> {
        let numbered = |&f: &u32| {
            let number = self.hierarchy.triangle_of_face[f as usize];
            (number, self.surface.corners(f))
        };
        let mut all: Vec<_> = self.triangles.faces().iter().map(numbered).collect();
        all.sort_unstable_by_key(|t| t.0);
        all
    }

    /// The mesh to draw, with the attributes and materials of the one the
    /// hierarchy was built from, without what is not used.
    ///
    /// # Errors
    /// [`Error::LengthMismatch`] if `mesh` has not as many vertices as that, or
    /// [`Error::IndexOutOfRange`] if it has fewer triangles.
    pub fn to_mesh(&self, mesh: &TriMesh) -> Result<TriMesh> {
        let (expected, found) = (self.hierarchy.vertices, mesh.positions.len());
        if expected != found {
            let what = "positions".into();
            return Err(Error::LengthMismatch {
                what,
                expected,
                found,
            });
        }
        let triangles = self.triangles();
        if let Some(&(number, _)) = triangles
            .last()
            .filter(|t| t.0 as usize >= mesh.triangles.len())
        {
            return Err(Error::IndexOutOfRange {
                face: number as usize,
                index: number,
                vertices: mesh.triangles.len(),
            });
        }
        let mut cut = mesh.clone();
        for &(number, corners) in &triangles {
            cut.triangles[number as usize] = corners;
        }
        let kept: Vec<u32> = triangles.iter().map(|t| t.0).collect();
        cut.gather_triangles(&kept);
        cut.remove_unreferenced_vertices();
        Ok(cut)
    }

    /// The vertices that the last [`Cut::refine`] has brought back, each with the
    /// vertex that it was part of before: `[vertex, part_of]`. A renderer that
    /// lets vertices glide starts there; see [`Gliding`].
    #[must_use]
    pub fn appeared(&self) -> Vec<[u32; 2]> {
        let came_back = self.came_back().into_iter();
        came_back.map(|a| [a.vertex, a.part_of]).collect()
    }

    fn came_back(&self) -> Vec<Appeared> {
        let mut before: HashMap<u32, u32> = HashMap::new();
        let mut all = Vec::new();
        // What a vertex was part of comes back before it.
        for a in self.done.appeared.iter().filter(|a| self.is_active(a.node)) {
            let part_of = before.get(&a.part_of).copied().unwrap_or(a.part_of);
            if before.insert(a.vertex, part_of).is_none() {
                all.push(Appeared { part_of, ..*a });
            }
        }
        all
    }

    /// Number of nodes whose collapse is not applied.
    #[must_use]
    pub fn active_count(&self) -> usize {
        self.state.iter().filter(|&&s| s & ACTIVE != 0).count()
    }

    /// Number of nodes of the front: those that can be the next to change.
    #[must_use]
    pub fn front_len(&self) -> usize {
        self.splittable.len() + self.collapsible.len()
    }

    #[inline]
    fn is_active(&self, node: u32) -> bool {
        self.state[node as usize] & ACTIVE != 0
    }

    #[inline]
    fn is_collapsible(&self, node: u32) -> bool {
        self.state[node as usize] == ACTIVE
    }

    /// Applies the collapse of a node that is collapsible. What can be collapsed
    /// then for the first time is added to `fresh`.
    fn collapse(&mut self, node: u32) {
        let hierarchy = self.hierarchy;
        let of = &hierarchy.nodes[node as usize];
        let triangles = &mut self.triangles;
        let sides = self
            .surface
            .collapse(of.half_edge, |c, v| triangles.moved(c, v));
        sides.faces().for_each(|f| triangles.hide(f));
        self.collapsible.take(&mut self.place, node);
        for &child in of.children.iter().filter(|&&c| c != NONE) {
            self.splittable.take(&mut self.place, child);
        }
        self.state[node as usize] = 0;
        self.done.collapses += 1;
        self.splittable
            .put(&mut self.place, node, hierarchy.nodes[node as usize].cover);
        for later in hierarchy.waiting(node) {
            self.state[later as usize] -= 1;
            if self.is_collapsible(later) {
                self.collapsible.put(
                    &mut self.place,
                    later,
                    hierarchy.nodes[later as usize].cover,
                );
                self.fresh.push(later);
            }
        }
    }

    /// Undoes the collapse of a node, after those of all that wait for it. What
    /// can be split then for the first time is added to `fresh`.
    fn split(&mut self, node: u32) {
        let hierarchy = self.hierarchy;
        self.stack.push(node);
        while let Some(&top) = self.stack.last() {
            if self.is_active(top) {
                self.stack.pop();
                continue;
            }
            let before = self.stack.len();
            for later in hierarchy.waiting(top) {
                if !self.is_active(later) {
                    self.stack.push(later);
                }
            }
            if self.stack.len() == before {
                self.stack.pop();
                self.split_one(top);
            }
        }
    }

    fn split_one(&mut self, node: u32) {
        let hierarchy = self.hierarchy;
        let of = &hierarchy.nodes[node as usize];
        let triangles = &mut self.triangles;
        let sides = self
            .surface
            .split(of.half_edge, |c, v| triangles.moved(c, v));
        for face in sides.faces() {
            triangles.show(face, self.surface.corners(face));
        }
        self.done.splits += 1;
        let moves = self.surface.moves(sides);
        for (i, [vertex, part_of]) in [moves.left, moves.right].into_iter().enumerate() {
            if i == 0 || moves.left != moves.right {
                let appeared = Appeared {
                    node,
                    vertex,
                    part_of,
                };
                self.done.appeared.push(appeared);
            }
        }
        self.splittable.take(&mut self.place, node);
        self.state[node as usize] = ACTIVE;
        self.collapsible
            .put(&mut self.place, node, hierarchy.nodes[node as usize].cover);
        for &child in of.children.iter().filter(|&&c| c != NONE) {
            self.splittable.put(
                &mut self.place,
                child,
                hierarchy.nodes[child as usize].cover,
            );
            self.fresh.push(child);
        }
        for later in hierarchy.waiting(node) {
            if self.is_collapsible(later) {
                self.collapsible.take(&mut self.place, later);
            }
            self.state[later as usize] += 1;
        }
    }
}
