//! The mesh of what has been split, in an order that does not depend on what was made when.

use super::mesh::AdaptiveMesh;
use super::store::Store;
use crate::mesh::PolyMesh;

/// One frame's drawing.
pub(super) struct Drawing<'a> {
    pub store: &'a mut Store,
    pub frame: u32,
    pub limit: bool,
    /// Wedges that have become vertices.
    pub wedges: &'a mut Vec<u32>,
    pub to: &'a mut AdaptiveMesh,
}

impl Drawing<'_> {
    pub fn draw(&mut self) {
        self.to.clear();
        self.wedges.clear();
        for face in 0..self.store.tiers[0].faces.len() as u32 {
            if !self.store.is_hole(0, face) {
                self.draw_face(0, face, face);
            }
        }
        self.place_vertices();
    }

    fn draw_face(&mut self, t: usize, face: u32, base: u32) {
        let corners = self.store.tiers[t].corners_of(face);
        if self.store.tiers[t].faces[face as usize].split != self.frame {
            for c in corners {
                self.push_corner(t, c);
            }
            return self.end_face(base, 2 * t);
        }
        for c in corners.clone() {
            let e = self.store.tiers[t].corner_edges[c as usize];
            if !self.store.is_split(t, e, self.frame) {
                self.draw_diamond(t, c, e, base);
            }
        }
        for c in corners {
            self.draw_child(t, c, base);
        }
    }

    /// The diamond over the edge after a corner, or this side of it.
    fn draw_diamond(&mut self, t: usize, corner: u32, e: u32, base: u32) {
        let [a, b, center] = self.store.half(t, corner);
        let mut corners = [a, b, center, center];
        let mut count = 3;
        if self.store.is_merged(t, e, self.frame) {
            let edge = &mut self.store.tiers[t].edges[e as usize];
            if edge.drawn == self.frame {
                return;
            }
            edge.drawn = self.frame;
            let other = usize::from(edge.corners[0] == corner);
            let across = edge.corners[other];
            corners = [a, self.store.half(t, across)[2], b, center];
            count = 4;
        }
        for &c in &corners[..count] {
            self.push_corner(t + 1, c);
        }
        self.end_face(base, 2 * t + 1);
    }

    /// The child at a corner, if both diamonds beside it have been split, or the half of it
    /// that has.
    fn draw_child(&mut self, t: usize, corner: u32, base: u32) {
        let [before, after] = self
            .store
            .beside(t, corner)
            .map(|e| self.store.is_split(t, e, self.frame));
        let child = self.store.tiers[t].child(corner);
        let half = match [before, after] {
            [true, true] => return self.draw_face(t + 1, child, base),
            [true, false] => [0, 2, 3],
            [false, true] => [0, 1, 2],
            [false, false] => return,
        };
        for i in half {
            self.push_corner(t + 1, 4 * child + i);
        }
        self.end_face(base, 2 * t + 2);
    }

    fn push_corner(&mut self, t: usize, corner: u32) {
        let found = self.store.wedge(t, corner);
        let wedge = &mut self.store.wedges[found as usize];
        let point = &mut self.store.points[wedge.point as usize];
        if wedge.frame != self.frame {
            (wedge.frame, wedge.drawn) = (self.frame, self.wedges.len() as u32);
            self.wedges.push(found);
        }
        if point.frame != self.frame || point.place[0] < t as u32 {
            let v = self.store.tiers[t].corners[corner as usize];
            (point.frame, point.place) = (self.frame, [t as u32, v]);
        }
        self.to.mesh.indices.push(wedge.drawn);
    }

    fn end_face(&mut self, base: u32, depth: usize) {
        let PolyMesh {
            indices, offsets, ..
        } = &mut self.to.mesh;
        offsets.push(indices.len() as u32);
        self.to.parents.push(base);
        self.to.depths.push(depth as u8);
    }

    fn place_vertices(&mut self) {
        let mut normals = self.to.mesh.attributes.normals.take().unwrap_or_default();
        for &wedge in self.wedges.iter() {
            let wedge = self.store.wedges[wedge as usize];
            let point = self.store.points[wedge.point as usize];
            let [t, v] = point.place;
            let position = match self.limit {
                true => point.limit,
                false => self.store.position(t as usize, v).as_vec3(),
            };
            self.to.mesh.positions.push(position);
            self.to.points.push(wedge.point);
            normals.push(wedge.normal);
        }
        self.to.mesh.attributes.normals = Some(normals);
    }
}
