//! Making children, and finding what lies across an edge.

use super::stamp::Stamps;
use super::store::{Edge, Face, NONE, Origin, Point, Store, Tier, Vertex};
use crate::subdiv::crease::{decayed, decayed_around};
use crate::subdiv::options::CreaseMethod;
use smallvec::SmallVec;

impl Store {
    /// The first child of a face, made if need be.
    pub fn children(&mut self, t: usize, face: u32) -> u32 {
        let made = self.tiers[t].faces[face as usize].children;
        if made != NONE {
            return made;
        }
        if self.tiers.len() == t + 1 {
            self.tiers.push(Tier::quads());
        }
        let corners = self.tiers[t].corners_of(face);
        for c in corners.clone() {
            self.divide(t, self.tiers[t].corner_edges[c as usize]);
        }
        let center = self.new_vertex(t + 1, Origin::Face(face), 0.0);
        let inner = self.new_inner_edges(t, corners.clone(), center);
        let first = self.tiers[t + 1].faces.len() as u32;
        self.tiers[t].faces[face as usize].children = first;
        let n = corners.len() as u32;
        for i in 0..n {
            let before = inner + (i + n - 1) % n;
            self.new_child(t, corners.start + i, [center, inner + i, before]);
        }
        first
    }

    /// Edges from a face's centre to the points of its edges.
    fn new_inner_edges(&mut self, t: usize, corners: std::ops::Range<u32>, center: u32) -> u32 {
        let [tier, next] = self.pair(t);
        let first = next.edges.len() as u32;
        for c in corners {
            let edge = tier.corner_edges[c as usize];
            let ends = [center, tier.edges[edge as usize].point];
            next.push_edge(Edge::new(ends, NONE, 0.0, false));
        }
        first
    }

    /// The child of a corner: from the corner's vertex over the edge after it, the centre
    /// and the edge before it.
    fn new_child(&mut self, t: usize, corner: u32, [center, after, before]: [u32; 3]) {
        let [tier, next] = self.pair(t);
        let previous = tier.previous(corner);
        let old = tier.corners[corner as usize];
        let [leading, trailing] = [corner, previous].map(|c| tier.corner_edges[c as usize]);
        let half = |e: u32| {
            let edge = &tier.edges[e as usize];
            edge.halves + u32::from(edge.ends[0] != old)
        };
        let point = |e: u32| tier.edges[e as usize].point;
        let vertex = tier.vertices[old as usize].child;
        let vertices = [vertex, point(leading), center, point(trailing)];
        let edges = [half(leading), after, before, half(trailing)];
        let place = match t {
            0 => u64::from(corner),
            _ => tier.place(corner) << 2 | u64::from(corner & 3),
        };
        next.faces.push(Face::new(corner, place));
        next.face_stamps.push(Stamps::default());
        for (v, e) in vertices.into_iter().zip(edges) {
            let c = next.corners.len() as u32;
            next.corners.push(v);
            next.corner_edges.push(e);
            next.wedges.push(NONE);
            next.vertices[v as usize].corner = c;
            let slots = &mut next.edges[e as usize].corners;
            slots[usize::from(slots[0] != NONE)] = c;
        }
    }

    /// Gives an edge its point and halves.
    fn divide(&mut self, t: usize, e: u32) {
        let edge = self.tiers[t].edges[e as usize];
        if edge.point != NONE {
            return;
        }
        let sharpness = self.half_sharpness(t, e);
        let point = self.new_vertex(t + 1, Origin::Edge(e), 0.0);
        let ends = edge.ends.map(|v| self.child_vertex(t, v));
        let [tier, next] = self.pair(t);
        let to = &mut tier.edges[e as usize];
        (to.point, to.halves) = (point, next.edges.len() as u32);
        for (end, sharpness) in ends.into_iter().zip(sharpness) {
            let half = Edge::new([point, end], e, sharpness, edge.open);
            next.push_edge(Edge {
                seam: edge.seam,
                ..half
            });
        }
    }

    /// Sharpness of both halves of an edge.
    fn half_sharpness(&mut self, t: usize, e: u32) -> [f32; 2] {
        let edge = self.tiers[t].edges[e as usize];
        if edge.sharpness <= 0.0 || self.creases == CreaseMethod::Uniform {
            return [decayed(edge.sharpness); 2];
        }
        edge.ends.map(|v| self.later_sharpness(t, e, v))
    }

    /// Sharpness of the half of an edge at its end `v` one tier later, by Chaikin's rule.
    pub fn later_sharpness(&mut self, t: usize, e: u32, v: u32) -> f32 {
        let own = self.tiers[t].edges[e as usize].sharpness;
        if self.tiers[t].vertices[v as usize].odd {
            return decayed(own);
        }
        let ring = self.ring(t, self.tiers[t].vertices[v as usize].corner);
        let later = decayed_around(&self.around(t, &ring), self.creases);
        let found = ring.edges.iter().position(|&at| at == e);
        found.map_or(0.0, |i| later[i])
    }

    fn child_vertex(&mut self, t: usize, v: u32) -> u32 {
        let vertex = self.tiers[t].vertices[v as usize];
        if vertex.child != NONE {
            return vertex.child;
        }
        let child = self.new_vertex(t + 1, Origin::Vertex(v), decayed(vertex.sharpness));
        let to = &mut self.tiers[t + 1].vertices[child as usize];
        (to.point, to.odd) = (vertex.point, vertex.odd);
        self.tiers[t].vertices[v as usize].child = child;
        child
    }

    fn new_vertex(&mut self, t: usize, origin: Origin, sharpness: f32) -> u32 {
        let mut point = NONE;
        if !matches!(origin, Origin::Vertex(_)) {
            point = self.points.len() as u32;
            self.points.push(Point::NEW);
        }
        let vertices = &mut self.tiers[t].vertices;
        vertices.push(Vertex::new(origin, point, sharpness, false));
        vertices.len() as u32 - 1
    }

    /// A tier and the next one.
    fn pair(&mut self, t: usize) -> [&mut Tier; 2] {
        let (before, after) = self.tiers.split_at_mut(t + 1);
        [&mut before[t], &mut after[0]]
    }

    /// The corner at which the other face of the edge after `corner` starts along it, the
    /// face made if need be.
    pub fn across(&mut self, t: usize, corner: u32) -> Option<u32> {
        let tier = &self.tiers[t];
        let edge = &tier.edges[tier.corner_edges[corner as usize] as usize];
        if edge.open {
            return None;
        }
        let other = usize::from(edge.corners[0] == corner);
        if edge.corners[other] != NONE {
            return Some(edge.corners[other]);
        }
        let e = tier.corner_edges[corner as usize];
        let (parent, from) = (
            edge.parent,
            tier.faces[tier.face_of(corner) as usize].parent,
        );
        let above = &self.tiers[t - 1];
        let own = above.face_of(from);
        let mut starts = above.edges[parent as usize].corners.into_iter();
        let along = starts.find(|&c| c != NONE && above.face_of(c) == own);
        let there = self.across(t - 1, along?)?;
        self.children(t - 1, self.tiers[t - 1].face_of(there));
        Some(self.tiers[t].edges[e as usize].corners[other])
    }

    /// The corners at which an edge starts in its faces, by place, the faces made if need be.
    pub fn sides(&mut self, t: usize, e: u32) -> SmallVec<[u32; 2]> {
        let first = self.tiers[t].edges[e as usize].corners[0];
        self.across(t, first);
        self.known_sides(t, e)
    }

    /// As [`Store::sides`], of those that have been made.
    pub fn known_sides(&self, t: usize, e: u32) -> SmallVec<[u32; 2]> {
        let tier = &self.tiers[t];
        let [a, b] = tier.edges[e as usize].corners;
        if b == NONE {
            return SmallVec::from_slice(&[a]);
        }
        let swap = tier.place(a) > tier.place(b);
        SmallVec::from_buf(if swap { [b, a] } else { [a, b] })
    }
}

impl Tier {
    fn push_edge(&mut self, edge: Edge) {
        self.edges.push(edge);
        self.edge_stamps.push(Stamps::default());
    }
}
