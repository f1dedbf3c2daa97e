//! √3-subdivision of triangle meshes.
//!
//! Kobbelt, "√3-subdivision", 2000: a point in every triangle, joined to its corners; then
//! every old edge is turned to join the points on its sides. Boundaries wait for every second
//! step, which divides their edges in three.

use super::cage::Cage;
use super::crease::Rule;
use super::level::Level;
use super::options::{Boundary, SubdivOptions};
use super::sum::Sum;
use crate::error::Result;
use crate::geom::sin_cos;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// One step: the triangles before it, and what it makes.
#[derive(Debug, Clone)]
pub(super) struct Step {
    level: Level,
    /// What becomes of every face: a point inside, or two on its boundary edge, which starts
    /// at this corner.
    points: Vec<Point>,
    vertices: usize,
    divides_boundary: bool,
}

#[derive(Debug, Clone, Copy)]
enum Point {
    Inside(u32),
    OnEdge { first: u32, corner: u32 },
}

impl Step {
    /// The step after `before` others.
    pub fn new(level: Level, before: u32) -> Self {
        let divides_boundary = before % 2 == 1;
        let mut vertices = level.vertices;
        let mut points = Vec::with_capacity(level.faces.count());
        for f in 0..level.faces.count() {
            let open = |&c: &usize| level.edge_corners(level.corner_edges[c]).len() < 2;
            let first = vertices as u32;
            let corner = level
                .faces
                .corners(f)
                .find(open)
                .filter(|_| divides_boundary);
            points.push(match corner {
                Some(corner) => Point::OnEdge {
                    first,
                    corner: corner as u32,
                },
                None => Point::Inside(first),
            });
            vertices += 1 + usize::from(corner.is_some());
        }
        Self {
            level,
            points,
            vertices,
            divides_boundary,
        }
    }

    pub fn vertex_count(&self) -> usize {
        self.vertices
    }

    /// The triangles after the step.
    pub fn corners(&self) -> Vec<u32> {
        let level = &self.level;
        let mut corners = Vec::with_capacity(3 * level.corners.len());
        for e in 0..level.edges.len() as u32 {
            let at = |c: u32| level.corners[c as usize];
            match *level.edge_corners(e) {
                [left, right] if !level.odd_edges[e as usize] => {
                    let [a, b] = [left, right].map(at);
                    let [l, r] = [left, right].map(|c| self.point(c));
                    corners.extend([a, r, l, b, l, r]);
                }
                ref all => {
                    for &c in all {
                        let [a, b] = [c, level.faces.next(c)].map(at);
                        match self.points[level.faces.of_corner(c) as usize] {
                            Point::OnEdge { first, corner } if corner == c => {
                                let top = at(level.faces.previous(c));
                                corners.extend([first, first + 1, top]);
                            }
                            _ => corners.extend([a, b, self.point(c)]),
                        }
                    }
                }
            }
        }
        corners
    }

    /// The point beyond the edge that starts at corner `c`, in the face of that corner.
    fn point(&self, c: u32) -> u32 {
        let faces = &self.level.faces;
        match self.points[faces.of_corner(c) as usize] {
            Point::Inside(point) => point,
            Point::OnEdge { first, corner } => first + u32::from(faces.next(corner) == c),
        }
    }

    /// The face before the step that each one after it lies in, half of it if it lies in two.
    pub fn parents(&self) -> Vec<u32> {
        let level = &self.level;
        let edges = (0..level.edges.len() as u32).map(|e| level.edge_corners(e));
        edges.flatten().map(|&c| level.faces.of_corner(c)).collect()
    }

    /// Values after the step.
    pub fn evaluate<const N: usize>(&self, from: &[[f32; N]], to: &mut [[f32; N]]) {
        let (old, new) = to.split_at_mut(self.level.vertices);
        let old = old.par_iter_mut().with_min_len(2048).enumerate();
        old.for_each(|(v, to)| *to = self.vertex(v as u32, from).value());
        let mut new = new.iter_mut();
        for (f, &point) in self.points.iter().enumerate() {
            match point {
                Point::Inside(_) => {
                    new.by_ref().take(1).for_each(|to| {
                        *to = super::masks::face_point(&self.level, f, from).value();
                    });
                }
                Point::OnEdge { corner, .. } => {
                    for (third, to) in new.by_ref().take(2).enumerate() {
                        *to = self.third(corner, third == 1, from).value();
                    }
                }
            }
        }
    }

    fn vertex<const N: usize>(&self, v: u32, from: &[[f32; N]]) -> Sum<N> {
        let level = &self.level;
        let mut sum = Sum::ZERO;
        let mut own = 1.0;
        let mut add = |e: u32, weight: f64| {
            sum.add(weight, &from[level.other_end(e, v) as usize]);
            own -= weight;
        };
        match level.rule(v) {
            Rule::Smooth => {
                let edges = level.vertex_edges(v);
                let n = edges.len() as f64;
                let alpha = (4.0 - 2.0 * sin_cos(TAU / n).1) / 9.0;
                edges.iter().for_each(|&e| add(e, alpha / n));
            }
            Rule::Crease if self.divides_boundary => {
                let ends = level.crease_ends(v, false);
                ends.into_iter().for_each(|e| add(e, 4.0 / 27.0));
            }
            Rule::Crease | Rule::Corner => {}
        }
        sum.add(own, &from[v as usize]);
        sum
    }

    /// The point a third along the boundary edge that starts at `corner`, or two thirds.
    fn third<const N: usize>(&self, corner: u32, second: bool, from: &[[f32; N]]) -> Sum<N> {
        let level = &self.level;
        let e = level.corner_edges[corner as usize];
        let next = level.faces.next(corner);
        let [near, far] = if second {
            [next, corner]
        } else {
            [corner, next]
        }
        .map(|c| level.corners[c as usize]);
        let mut sum = Sum::ZERO;
        let open = |&&at: &&u32| at != e && level.edge_corners(at).len() < 2;
        let before = level.vertex_edges(near).iter().find(open);
        match before {
            Some(&before) if level.rule(near) == Rule::Crease => {
                sum.add(1.0 / 27.0, &from[level.other_end(before, near) as usize]);
                sum.add(16.0 / 27.0, &from[near as usize]);
                sum.add(10.0 / 27.0, &from[far as usize]);
            }
            _ => {
                sum.add(2.0 / 3.0, &from[near as usize]);
                sum.add(1.0 / 3.0, &from[far as usize]);
            }
        }
        sum
    }

    /// The level after the step.
    pub fn next_level(&self, options: &SubdivOptions) -> Result<Level> {
        let indices = self.corners();
        let faces = indices.len() as u32 / 3;
        let cage = Cage {
            vertices: self.vertices,
            offsets: (0..=faces).map(|f| 3 * f).collect(),
            indices,
            ..Cage::default()
        };
        let options = SubdivOptions {
            boundary: Boundary::EdgeOnly,
            ..*options
        };
        let mut level = Level::of_cage(&cage, &options)?;
        // What was a corner of the cage stays one, and nothing else becomes one.
        for (v, sharpness) in level.vertex_sharpness.iter_mut().enumerate() {
            *sharpness = self.level.vertex_sharpness.get(v).copied().unwrap_or(0.0);
        }
        level.find_rules();
        Ok(level)
    }
}
