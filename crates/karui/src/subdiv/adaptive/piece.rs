//! What may be split: faces of a tier, and between two tiers the diamonds over its edges.

use super::eye::corner_normals;
use super::store::{NONE, Shape, Store};
use crate::subdiv::INFINITELY_SHARP;
use glam::DVec3;
use smallvec::{SmallVec, smallvec};

/// A face of the √2 hierarchy.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Piece {
    /// A face of a tier: what is there after an even number of steps.
    Face(u32),
    /// The quad over an edge of a tier, between its ends and the centres of its faces.
    Diamond(u32),
}

/// Corners of a polygon, in the tier that they are positioned in.
pub(super) type Polygon = SmallVec<[u32; 4]>;

/// Largest distance of a cubic curve to its chord by the sines of the angles between that
/// and its ends.
const CUBIC: f64 = 4.0 / 27.0;
/// Pairs of corners farther apart in their polygon are not looked at.
const FARTHEST: usize = 4;

impl Store {
    /// The tier of the corners of [`Store::polygons`].
    pub const fn tier_of(t: usize, piece: Piece) -> usize {
        match piece {
            Piece::Face(_) => t,
            Piece::Diamond(_) => t + 1,
        }
    }

    /// What a piece is drawn as if all around it is as fine: one polygon, or two if an edge
    /// between them stays sharp. All that it needs has to have been made.
    pub fn polygons(&self, t: usize, piece: Piece) -> SmallVec<[Polygon; 2]> {
        let e = match piece {
            Piece::Face(f) => return smallvec![self.tiers[t].corners_of(f).collect()],
            Piece::Diamond(e) => e,
        };
        let sides = self.known_sides(t, e);
        let halves = sides.iter().map(|&c| self.half(t, c));
        let mut halves: SmallVec<[[u32; 3]; 2]> = halves.collect();
        if sides.len() == 2 && !self.is_ridge(t, e) {
            let [[a, b, right], [_, _, left]] = [halves[0], halves[1]];
            return smallvec![smallvec![a, left, b, right]];
        }
        halves
            .drain(..)
            .map(|half| Polygon::from_slice(&half))
            .collect()
    }

    /// The triangle between an edge's ends and the centre of the face in which it starts at
    /// `corner`, as corners of the next tier.
    pub fn half(&self, t: usize, corner: u32) -> [u32; 3] {
        let tier = &self.tiers[t];
        let [a, b] = [corner, tier.next(corner)].map(|c| 4 * tier.child(c));
        [a, b, a + 2]
    }

    /// Whether the surface, or what goes with it, has an edge along edge `e`.
    pub fn is_ridge(&self, t: usize, e: u32) -> bool {
        let edge = &self.tiers[t].edges[e as usize];
        edge.open || edge.seam || edge.sharpness >= INFINITELY_SHARP
    }

    /// What is known of a piece.
    pub fn shape(&self, t: usize, piece: Piece) -> &Shape {
        match piece {
            Piece::Face(f) => self.tiers[t].face_shapes.get(f as usize),
            Piece::Diamond(e) => self.tiers[t].edge_shapes.get(e as usize),
        }
        .unwrap_or(&Shape::UNKNOWN)
    }

    /// Finds the shape of a piece and its limits, once.
    pub fn measure(&mut self, t: usize, piece: Piece) {
        if self.shape(t, piece).error >= 0.0 {
            return;
        }
        if let Piece::Diamond(e) = piece {
            for c in self.sides(t, e) {
                self.children(t, self.tiers[t].face_of(c));
            }
        }
        let tier = Self::tier_of(t, piece);
        let mut corners = Corners::default();
        for polygon in self.polygons(t, piece) {
            self.add(tier, &polygon, piece, &mut corners);
        }
        let tier = &mut self.tiers[t];
        let (shapes, count, id) = match piece {
            Piece::Face(f) => (&mut tier.face_shapes, tier.faces.len(), f),
            Piece::Diamond(e) => (&mut tier.edge_shapes, tier.edges.len(), e),
        };
        if shapes.len() <= id as usize {
            shapes.resize(count, Shape::UNKNOWN);
        }
        shapes[id as usize] = corners.shape();
    }

    /// Adds a polygon. Its distance to the limit surface is found as if that were made of
    /// cubic curves between its corners; and, as those may turn back within, as far as what
    /// its corners still have to go in their tier tells.
    fn add(&mut self, t: usize, polygon: &[u32], piece: Piece, to: &mut Corners) {
        let n = polygon.len();
        let first = to.limits.len();
        let mut way = 0f64;
        for &c in polygon {
            let wedge = self.wedge(t, c);
            let (limit, normal) = self.limit(wedge);
            way = way.max(limit.distance(self.corner_position(t, c)));
            to.limits.push(limit);
            to.normals.push(normal);
            to.wedges.push(wedge);
            to.points.push(self.wedges[wedge as usize].point);
        }
        to.error = to.error.max(way * way_factor(piece, n));
        for i in 0..n {
            for k in 1..=FARTHEST.min(n / 2) {
                let [i, j] = [first + i, first + (i + k) % n];
                let chord = to.limits[j] - to.limits[i];
                let slopes = chord.dot(to.normals[i]).abs() + chord.dot(to.normals[j]).abs();
                to.error = to.error.max(CUBIC * slopes);
                to.side = if k == 1 {
                    to.side.max(chord.length())
                } else {
                    to.side
                };
            }
        }
        let limits: SmallVec<[DVec3; 4]> = to.limits[first..].into();
        to.normals
            .extend(corner_normals(&limits).map(DVec3::normalize_or_zero));
    }

    /// Limit position and normal of a wedge.
    pub fn limit(&self, wedge: u32) -> (DVec3, DVec3) {
        let wedge = &self.wedges[wedge as usize];
        (wedge.limit.as_dvec3(), wedge.normal.as_dvec3())
    }

    /// As [`Store::limit`], of a corner whose wedge is known.
    pub fn corner_limit(&self, t: usize, corner: u32) -> (DVec3, DVec3) {
        let wedge = self.tiers[t].wedges[corner as usize];
        debug_assert_ne!(wedge, NONE, "limits are found before they are asked for");
        self.limit(wedge)
    }
}

/// What is found of the corners of a piece.
#[derive(Debug, Default)]
struct Corners {
    limits: SmallVec<[DVec3; 8]>,
    normals: SmallVec<[DVec3; 16]>,
    points: SmallVec<[u32; 8]>,
    wedges: SmallVec<[u32; 8]>,
    error: f64,
    side: f64,
}

impl Corners {
    fn shape(&self) -> Shape {
        let center = self.limits.iter().sum::<DVec3>() / self.limits.len() as f64;
        let reach = self
            .limits
            .iter()
            .map(|p| p.distance(center))
            .fold(0.0, f64::max);
        let axis = self.normals.iter().sum::<DVec3>().normalize_or_zero();
        let normals = self.normals.iter().filter(|n| **n != DVec3::ZERO);
        let cosine = normals.map(|n| n.dot(axis)).fold(1.0, f64::min);
        let spread = if cosine > 0.0 {
            (1.0 - cosine * cosine).max(0.0).sqrt()
        } else {
            2.0
        };
        Shape {
            center: center.as_vec3(),
            // The surface goes beyond its corners by about as much as it is off the chords.
            radius: (reach + 2.0 * self.error) as f32,
            axis: axis.as_vec3(),
            spread: spread as f32,
            error: self.error as f32,
            side: self.side as f32,
            points: match self.points[..] {
                [a, b, c] => [a, b, c, c],
                [a, b, c, d] => [a, b, c, d],
                _ => [NONE; 4],
            },
            wedges: self.wedges[..].try_into().unwrap_or([NONE; 4]),
        }
    }
}

/// Sagitta of the chord over an edge, by the way from a vertex of a cubic B-spline to its
/// limit: second differences are six times the way, and sagittas an eighth of those; a
/// diamond's edge is √2 times as long as those of its tier, a half's is twice.
fn way_factor(piece: Piece, corners: usize) -> f64 {
    match piece {
        Piece::Face(_) => 0.75,
        Piece::Diamond(_) if corners == 4 => 1.5,
        Piece::Diamond(_) => 3.0,
    }
}
