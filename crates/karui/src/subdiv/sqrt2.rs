//! √2-subdivision: Catmull-Clark in two steps, each of which doubles the faces.
//!
//! Miura, Adachi and Ikedo, "√2-subdivision: adaptive refinement by two-stepped
//! Catmull-Clark subdivision", 2002. The odd step joins a face point to the corners of its
//! face and takes every old edge away, which leaves one quad an edge; the edge's point is
//! kept for the even step, which does the same around it and moves nothing. Unlike the
//! paper's, boundaries are exact: a boundary edge keeps its triangle in the odd step, and its
//! point lies on it, so that the even step makes the two halves of the edge.

use super::level::{Faces, Level};
use super::masks;
use super::split::Kind;

/// The mesh between two levels of Catmull-Clark: the vertices of one, then its face points;
/// one face an edge.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Odd {
    /// Faces: quads, and triangles at boundaries.
    pub faces: Faces,
    /// Vertex of every corner.
    pub corners: Vec<u32>,
    /// Number of vertices.
    pub vertices: usize,
    /// The edge of the level before whose point a face carries.
    pub carried: Vec<u32>,
    /// Number of the first face point.
    first_face_point: u32,
    /// For every corner, the corner of the level before whose line to the point of its face
    /// is the side from here to the next corner; `None` for a side that is a boundary.
    sides: Vec<Option<u32>>,
}

/// Values after an odd step.
#[derive(Debug, Clone, PartialEq)]
pub struct OddValues<const N: usize> {
    /// Of the vertices.
    pub vertices: Vec<[f32; N]>,
    /// Points that edges of the level before carry to the even step.
    pub carried: Vec<[f32; N]>,
}

impl Odd {
    /// The odd step of `level`: connectivity.
    #[must_use]
    pub fn new(level: &Level) -> Self {
        let mut odd = Self {
            faces: Faces::Uniform { size: 4, count: 0 },
            corners: Vec::with_capacity(2 * level.corners.len()),
            vertices: level.vertices + level.faces.count(),
            carried: Vec::with_capacity(level.edges.len()),
            first_face_point: level.vertices as u32,
            sides: Vec::with_capacity(2 * level.corners.len()),
        };
        let mut offsets = vec![0];
        for e in 0..level.edges.len() as u32 {
            match *level.edge_corners(e) {
                [left, right] if !level.odd_edges[e as usize] => {
                    odd.quad(level, left, right);
                    offsets.push(odd.corners.len() as u32);
                }
                // At a boundary, and where sheets meet, every face keeps its triangle.
                ref all => all.iter().for_each(|&c| {
                    odd.triangle(level, c);
                    offsets.push(odd.corners.len() as u32);
                }),
            }
        }
        odd.faces = Faces::of_offsets(&offsets);
        odd
    }

    /// The quad of an edge that starts at corner `left` in one face, at `right` in the other.
    fn quad(&mut self, level: &Level, left: u32, right: u32) {
        let point = |c: u32| self.first_face_point + level.faces.of_corner(c);
        let ends = [left, right].map(|c| level.corners[c as usize]);
        self.corners
            .extend([ends[0], point(right), ends[1], point(left)]);
        let [after_left, after_right] = [left, right].map(|c| Some(level.faces.next(c)));
        self.sides
            .extend([after_right, Some(right), after_left, Some(left)]);
        self.carried.push(level.corner_edges[left as usize]);
    }

    fn triangle(&mut self, level: &Level, c: u32) {
        let next = level.faces.next(c);
        let point = self.first_face_point + level.faces.of_corner(c);
        let ends = [c, next].map(|c| level.corners[c as usize]);
        self.corners.extend([ends[0], ends[1], point]);
        self.sides.extend([None, Some(next), Some(c)]);
        self.carried.push(level.corner_edges[c as usize]);
    }

    /// Values after the odd step, from those of `level`, which this was made of.
    #[must_use]
    pub fn evaluate<const N: usize>(&self, level: &Level, from: &[[f32; N]]) -> OddValues<N> {
        let mut vertices = vec![[0.0; N]; self.vertices + level.edges.len()];
        masks::step(level, Kind::CATMULL_CLARK, from, &mut vertices);
        let carried = vertices.split_off(self.vertices);
        OddValues { vertices, carried }
    }

    /// The faces after the even step: the triangles around every carried point, joined in
    /// pairs across the sides of the odd mesh. The carried points become vertices after all
    /// others, in order of edges.
    #[must_use]
    pub fn even(&self) -> Vec<[u32; 4]> {
        let count = self
            .sides
            .iter()
            .flatten()
            .max()
            .map_or(0, |&c| c as usize + 1);
        let mut quads = vec![[u32::MAX; 4]; count];
        for (f, &edge) in self.carried.iter().enumerate() {
            let carried = self.vertices as u32 + edge;
            for i in self.faces.corners(f) {
                // The side that is a boundary has the point on it: its triangle is flat.
                let Some(side) = self.sides[i] else { continue };
                let from = self.corners[i];
                let to = self.corners[self.faces.next(i as u32) as usize];
                let quad = &mut quads[side as usize];
                if from < self.first_face_point {
                    quad[3] = carried;
                } else {
                    (quad[0], quad[1], quad[2]) = (to, carried, from);
                }
            }
        }
        quads
    }
}
