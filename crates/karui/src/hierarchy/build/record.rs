//! Writes down the collapses as nodes, and which waits for which.
//!
//! A collapse is the same wherever the faces around its vertex are what they
//! were when it was found. So it waits for the last collapse that changed each
//! of them; then any set of collapses that is closed under "waits for" gives the
//! mesh that these alone, in the order in which they were found, give: a
//! manifold of the input's topology, none of its faces turned by a right angle
//! in one step. (J. Xia, A. Varshney: Dynamic view-dependent simplification for
//! polygonal models, 1996, for the like on progressive meshes.)

use super::points::Points;
use super::price::Ring;
use crate::hierarchy::node::{Bounds, Cover, Node, cone, sphere};
use crate::hierarchy::surface::{NONE, next, prev};
use glam::DVec3;

/// The nodes so far.
pub(super) struct Record {
    nodes: Vec<Node>,
    /// The node that made every point what it is.
    of_point: Vec<u32>,
    /// The node that last changed every face.
    of_face: Vec<u32>,
    /// What every node waits for but its children, node after node.
    waits: Vec<u32>,
    /// Where those of every node begin.
    starts: Vec<u32>,
    /// Faces hidden by all.
    pub faces_hidden: usize,
    scratch: Scratch,
}

#[derive(Default)]
struct Scratch {
    waits: Vec<u32>,
    places: Vec<DVec3>,
    normals: Vec<DVec3>,
}

impl Record {
    pub fn new(points: usize, faces: usize) -> Self {
        Self {
            nodes: Vec::with_capacity(points),
            of_point: vec![NONE; points],
            of_face: vec![NONE; faces],
            waits: Vec::new(),
            starts: vec![0],
            faces_hidden: 0,
            scratch: Scratch::default(),
        }
    }

    /// Writes down the collapse of `point`, around which `ring` has looked,
    /// before it happens.
    pub fn add(&mut self, all: &Points, ring: &Ring, point: u32, half_edge: u32) {
        let id = self.nodes.len() as u32;
        let sides = all.surface.sides(half_edge);
        let kept = all.surface.moves(sides).left[1];
        let children = [point, kept].map(|p| self.of_point[p as usize]);
        self.note_waits(ring, children);
        let bounds = children.map(|c| self.nodes.get(c as usize).map(|n| n.cover.bounds()));
        let cover = self.cover(all, ring, point, bounds);
        self.nodes.push(Node {
            half_edge,
            parent: NONE,
            children,
            cover,
            first_dependent: 0,
        });
        for child in children.into_iter().filter(|&c| c != NONE) {
            self.nodes[child as usize].parent = id;
        }
        self.faces_hidden += sides.faces().count();
        for &c in ring.corners() {
            self.of_face[c as usize / 3] = id;
        }
        self.of_point[kept as usize] = id;
    }

    /// The nodes that last changed the faces around, but those that others of
    /// them wait for.
    fn note_waits(&mut self, ring: &Ring, children: [u32; 2]) {
        let waits = &mut self.scratch.waits;
        waits.clear();
        let of_face = ring.corners().iter().map(|&c| self.of_face[c as usize / 3]);
        waits.extend(of_face.chain(children).filter(|&n| n != NONE));
        waits.sort_unstable();
        waits.dedup();
        let (nodes, listed, starts) = (&self.nodes, &self.waits, &self.starts);
        let waits_for = |later: u32, earlier: u32| {
            let range = starts[later as usize] as usize..starts[later as usize + 1] as usize;
            nodes[later as usize].children.contains(&earlier) || listed[range].contains(&earlier)
        };
        let implied = |i: usize| {
            waits[i + 1..]
                .iter()
                .any(|&later| waits_for(later, waits[i]))
        };
        let needed = (0..waits.len())
            .filter(|&i| !children.contains(&waits[i]) && !implied(i))
            .map(|i| waits[i]);
        let needed: smallvec::SmallVec<[u32; 16]> = needed.collect();
        self.waits.extend(needed);
        self.starts.push(self.waits.len() as u32);
    }

    fn cover(
        &mut self,
        all: &Points,
        ring: &Ring,
        point: u32,
        children: [Option<Bounds>; 2],
    ) -> Cover {
        let scratch = &mut self.scratch;
        scratch.places.clear();
        let around = ring.points().iter().chain([&point]);
        scratch
            .places
            .extend(around.map(|&p| all.points[p as usize].position()));
        scratch.normals.clear();
        scratch.normals.extend(
            ring.corners()
                .iter()
                .flat_map(|&c| [c, next(c), prev(c)])
                .map(|c| all.normal[all.vertex[c as usize] as usize]),
        );
        let below = children.into_iter().flatten();
        let (balls, cones): (smallvec::SmallVec<[_; 2]>, smallvec::SmallVec<[_; 2]>) = below
            .map(|b| ((b.center, b.radius), (b.axis, b.spread)))
            .unzip();
        let (center, radius) = sphere(&balls, &scratch.places);
        let (axis, sine) = cone(&cones, &scratch.normals);
        Cover {
            center,
            radius,
            axis,
            sine,
        }
    }

    /// The nodes, and the list of what waits for each but its parent.
    pub fn finish(mut self) -> (Vec<Node>, Vec<u32>) {
        let mut counts = vec![0u32; self.nodes.len() + 1];
        for &earlier in &self.waits {
            counts[earlier as usize + 1] += 1;
        }
        for i in 0..self.nodes.len() {
            counts[i + 1] += counts[i];
            self.nodes[i].first_dependent = counts[i];
        }
        let mut dependents = vec![0; self.waits.len()];
        for (later, range) in self.starts.windows(2).enumerate() {
            for &earlier in &self.waits[range[0] as usize..range[1] as usize] {
                let place = &mut counts[earlier as usize];
                dependents[*place as usize] = later as u32;
                *place += 1;
            }
        }
        (self.nodes, dependents)
    }
}
