//! Where vertices end after infinitely many steps, and how the surface lies there.
//!
//! Catmull-Clark: Halstead, Kass and DeRose, "Efficient, fair interpolation using
//! Catmull-Clark surfaces", 1993; boundaries: Biermann, Levin and Zorin, "Piecewise smooth
//! subdivision surfaces with normal control", 2000. Loop: Loop 1987; boundaries: Schweitzer,
//! "Analysis and application of subdivision surfaces", 1996. Scales are OpenSubdiv's.
//!
//! Tangents across a boundary are OpenSubdiv's as well. They are those of Biermann's modified
//! rules, which neither library steps by: exact where two faces of quads (three triangles)
//! meet, else they turn a little from level to level. From four faces on the plain rules have
//! no tangent plane there: the subdivision matrix has 1/2 as an eigenvalue twice.

use super::crease::Rule;
use super::level::Level;
use super::loop_::neighbour_weight;
use super::split::Kind;
use super::sum::Sum;
use crate::geom::sin_cos;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// The surface at the vertices.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Limits {
    /// Points of the surface.
    pub positions: Vec<Vec3>,
    /// Two directions along the surface, the first towards the first edge of the vertex or
    /// along its boundary or crease; zero at vertices of no face.
    pub tangents: Vec<[Vec3; 2]>,
    /// Unit normals; zero where the tangents are one direction as far as single precision
    /// tells, e.g. where two sheets lie on one another.
    pub normals: Vec<Vec3>,
    /// Whether a normal is that of one side only: on a crease or at a corner inside the
    /// surface, and where more than two faces meet, there are several, and the faces that
    /// come first around the vertex decide.
    pub one_sided: Vec<bool>,
}

/// Position and both tangents.
type Three = [Sum<3>; 3];

impl Level {
    /// The limits of its vertices, which are at `from`; at the cage only if its faces are
    /// what the scheme makes.
    pub(super) fn limits(&self, kind: Kind, from: &[[f32; 3]]) -> Limits {
        let vertices = (0..self.vertices as u32).into_par_iter().with_min_len(1024);
        let found: Vec<(Vec3, [Vec3; 2], Vec3, bool)> = vertices
            .map(|v| {
                let (three, noise) = self.limit(kind, v, from);
                let [position, first, second] = three.map(Sum::precise);
                let normal = normal(first, second, noise);
                let tangents = [first, second].map(|t| DVec3::from(t).as_vec3());
                let position = DVec3::from(position).as_vec3();
                (position, tangents, normal, self.is_one_sided(kind, v))
            })
            .collect();
        let mut limits = Limits::default();
        for (position, tangents, normal, one_sided) in found {
            limits.positions.push(position);
            limits.tangents.push(tangents);
            limits.normals.push(normal);
            limits.one_sided.push(one_sided);
        }
        limits
    }

    fn is_one_sided(&self, kind: Kind, v: u32) -> bool {
        let edges = self.vertex_edges(v).len();
        let inside = edges == self.vertex_corners(v).len();
        self.odd_vertices[v as usize]
            || inside && (kind.linear || edges < 3 || self.rule(v) != Rule::Smooth)
    }

    /// The limits of `v`, and how far off rounded values may make a tangent.
    fn limit(&self, kind: Kind, v: u32, from: &[[f32; 3]]) -> (Three, f64) {
        let edges = self.vertex_edges(v).iter();
        let ring = Ring {
            center: &from[v as usize],
            edges: edges
                .map(|&e| &from[self.other_end(e, v) as usize])
                .collect(),
            faces: self.opposite(v).map(|v| &from[v as usize]).collect(),
        };
        let sharp: Vec<usize> = (0..ring.edges.len())
            .filter(|&i| self.edge_sharpness(self.vertex_edges(v)[i]) > 0.0)
            .collect();
        let three = match (self.rule(v), sharp.as_slice()) {
            (Rule::Smooth, _) if kind.linear => ring.corner(),
            (Rule::Smooth, _) if kind.triangles => ring.smooth_triangles(),
            (Rule::Smooth, _) if ring.edges.len() < 3 => ring.corner(),
            (Rule::Smooth, _) => ring.smooth_quads(),
            (Rule::Crease, &[first, .., last]) if !kind.linear => {
                ring.crease(first, last, kind.triangles)
            }
            _ => ring.corner(),
        };
        (three, ring.noise())
    }

    /// Vertices across the faces around `v`.
    fn opposite(&self, v: u32) -> impl Iterator<Item = u32> {
        let faces = &self.faces;
        let corners = self.vertex_corners(v).iter();
        corners.map(|&c| self.corners[faces.next(faces.next(c)) as usize])
    }
}

fn normal(a: [f64; 3], b: [f64; 3], noise: f64) -> Vec3 {
    let (a, b) = (DVec3::from(a), DVec3::from(b));
    let cross = a.cross(b);
    if cross.length() <= noise * (a.length() + b.length()) {
        return Vec3::ZERO;
    }
    cross.normalize_or_zero().as_vec3()
}

struct Ring<'a> {
    center: &'a [f32; 3],
    edges: Vec<&'a [f32; 3]>,
    faces: Vec<&'a [f32; 3]>,
}

impl Ring<'_> {
    /// Values are rounded to single precision; weights of tangents are at most about 4, and
    /// what is off at random adds up by the root of their number.
    fn noise(&self) -> f64 {
        let values = self.edges.iter().chain(&self.faces).copied();
        let largest = values
            .chain([self.center])
            .flatten()
            .fold(0.0, |m, c| c.abs().max(m));
        let count = (self.edges.len() + self.faces.len() + 1) as f64;
        4.0 * f64::from(f32::EPSILON) * f64::from(largest) * count.sqrt()
    }

    fn own(&self, weight: f64) -> Sum<3> {
        let mut sum = Sum::ZERO;
        sum.add(weight, self.center);
        sum
    }

    /// A vertex that stays: along the edges of its first face.
    fn corner(&self) -> Three {
        let towards = |i: usize| {
            let mut sum = self.own(-1.0);
            self.edges.get(i).map_or(Sum::ZERO, |end| {
                sum.add(1.0, end);
                sum
            })
        };
        [self.own(1.0), towards(0), towards(1)]
    }

    fn smooth_quads(&self) -> Three {
        let n = self.edges.len() as f64;
        let theta = TAU / n;
        let (_, cos) = sin_cos(theta);
        let (_, half) = sin_cos(theta / 2.0);
        let lambda = (5.0 + cos + half * (2.0 * (9.0 + cos)).sqrt()) / 16.0;
        let face = 1.0 / (4.0 * lambda - 1.0);
        let outer = 1.0 / (n * (n + 5.0));
        let [mut position, mut first, mut second] =
            [self.own(1.0 - 5.0 * n * outer), Sum::ZERO, Sum::ZERO];
        for (i, (end, across)) in self.edges.iter().zip(&self.faces).enumerate() {
            let (s, c) = sin_cos(i as f64 * theta);
            let (next_s, next_c) = sin_cos((i + 1) as f64 * theta);
            position.add(4.0 * outer, end);
            position.add(outer, across);
            first.add(4.0 * c, end);
            first.add(face * (c + next_c), across);
            second.add(4.0 * s, end);
            second.add(face * (s + next_s), across);
        }
        [position, first, second]
    }

    fn smooth_triangles(&self) -> Three {
        let n = self.edges.len();
        let weight = 1.0 / (n as f64 + 0.375 / neighbour_weight(n));
        let mut three = [self.own(1.0 - weight * n as f64), Sum::ZERO, Sum::ZERO];
        for (i, end) in self.edges.iter().enumerate() {
            let (s, c) = sin_cos(i as f64 * TAU / n as f64);
            for (sum, weight) in three.iter_mut().zip([weight, c, s]) {
                sum.add(weight, end);
            }
        }
        three
    }

    /// A vertex of the curve from edge `first` to edge `last`, and the faces between them.
    fn crease(&self, first: usize, last: usize, triangles: bool) -> Three {
        let mut position = self.own(2.0 / 3.0);
        let mut along = Sum::ZERO;
        for (end, sign) in [(first, 1.0), (last, -1.0)] {
            position.add(1.0 / 6.0, self.edges[end]);
            along.add(if triangles { 1.5 } else { 0.5 } * sign, self.edges[end]);
        }
        let faces = last - first;
        let inwards = if faces == 1 {
            self.inwards([-6.0, 3.0], first, last)
        } else if triangles {
            self.inwards_triangles(first, last)
        } else {
            self.inwards_quads(first, last)
        };
        [position, along, inwards]
    }

    /// The vertex and both ends of the curve.
    fn inwards(&self, [own, ends]: [f64; 2], first: usize, last: usize) -> Sum<3> {
        let mut sum = self.own(own);
        sum.add(ends, self.edges[first]);
        sum.add(ends, self.edges[last]);
        sum
    }

    fn inwards_quads(&self, first: usize, last: usize) -> Sum<3> {
        let k = (last - first) as f64;
        let theta = PI / k;
        let (sin, cos) = sin_cos(theta);
        let scale = 1.0 / (k * (3.0 + cos));
        let r = (cos + 1.0) / sin;
        let weights = [4.0 * r * (cos - 1.0), -r * (1.0 + 2.0 * cos)];
        let mut sum = self.inwards(weights.map(|w| w * scale), first, last);
        for i in 0..last - first {
            let [(s, _), (next, _)] = [i, i + 1].map(|i| sin_cos(i as f64 * theta));
            if i > 0 {
                sum.add(4.0 * s * scale, self.edges[first + i]);
            }
            if let Some(across) = self.faces.get(first + i) {
                sum.add((s + next) * scale, across);
            }
        }
        sum
    }

    fn inwards_triangles(&self, first: usize, last: usize) -> Sum<3> {
        let between = &self.edges[first + 1..last];
        let theta = PI / (last - first) as f64;
        let (sin, cos) = sin_cos(theta);
        let root = 3f64.sqrt();
        let ends = match between.len() {
            1 => [-3.0, 0.0],
            2 => [-root, -root / 2.0],
            _ => [0.0, -3.0 * sin],
        };
        let mut sum = self.inwards(ends, first, last);
        for (i, end) in between.iter().enumerate() {
            let weight = match between.len() {
                1 => 3.0,
                2 => root,
                _ => 6.0 * (1.0 - cos) * sin_cos((i + 1) as f64 * theta).0,
            };
            sum.add(weight, end);
        }
        sum
    }
}
