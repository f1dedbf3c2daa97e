//! The points around every vertex, step by step.

use super::super::crease::{Around, Rule, blend};
use super::super::sum::Sum;
use super::{Patches, after};
use rayon::prelude::*;

/// For every vertex and step: the vertex, its neighbours along edges, those across faces.
#[derive(Debug, Clone)]
pub(super) struct Rings<const N: usize> {
    values: Vec<[f32; N]>,
    /// Where a vertex's values start; they go on for `depth + 1` steps.
    starts: Vec<usize>,
    /// Values of one step of a vertex.
    sizes: Vec<usize>,
}

impl<const N: usize> Default for Rings<N> {
    fn default() -> Self {
        Self {
            values: Vec::new(),
            starts: Vec::new(),
            sizes: Vec::new(),
        }
    }
}

impl<const N: usize> Rings<N> {
    /// Goes through all steps from the values of the start.
    pub fn fill(&mut self, patches: &Patches, from: &[[f32; N]]) {
        let (start, steps) = (&patches.start, patches.layout.depth as usize + 1);
        let size = |v: u32| 1 + start.vertex_edges(v).len() + start.vertex_corners(v).len();
        self.sizes.clear();
        self.sizes.extend((0..start.vertices as u32).map(size));
        self.starts.clear();
        let mut end = 0;
        for size in &self.sizes {
            self.starts.push(end);
            end += size * steps;
        }
        self.values.resize(end, [0.0; N]);
        let mut rest = &mut self.values[..];
        let mut parts = Vec::with_capacity(start.vertices);
        for size in &self.sizes {
            let (part, after) = rest.split_at_mut(size * steps);
            parts.push(part);
            rest = after;
        }
        let parts = parts.into_par_iter().with_min_len(64).enumerate();
        parts.for_each(|(v, part)| fill(patches, v as u32, from, part));
    }

    /// Vertex `v` after `step` steps.
    pub fn vertex(&self, v: u32, step: u32) -> [f32; N] {
        self.values[self.at(v, step)]
    }

    /// The neighbour along the edge at this place of the ring, cyclically.
    pub fn neighbour(&self, patches: &Patches, v: u32, place: usize, step: u32) -> [f32; N] {
        let edges = patches.start.vertex_edges(v).len();
        self.values[self.at(v, step) + 1 + place % edges]
    }

    fn at(&self, v: u32, step: u32) -> usize {
        self.starts[v as usize] + self.sizes[v as usize] * step as usize
    }
}

fn fill<const N: usize>(patches: &Patches, v: u32, from: &[[f32; N]], to: &mut [[f32; N]]) {
    let start = &patches.start;
    let (edges, corners) = (start.vertex_edges(v), start.vertex_corners(v));
    to[0] = from[v as usize];
    let ends = edges.iter().map(|&e| start.other_end(e, v));
    let across = corners
        .iter()
        .map(|&c| start.corners[(c & !3 | (c + 2) & 3) as usize]);
    for (to, v) in to[1..].iter_mut().zip(ends.chain(across)) {
        *to = from[v as usize];
    }
    let size = 1 + edges.len() + corners.len();
    for step in 0..patches.layout.depth {
        let (before, next) = to[size * step as usize..].split_at_mut(size);
        let sharpness: Around = start.around(v).iter().map(|&s| after(s, step)).collect();
        let ring = Ring {
            center: &before[0],
            edges: &before[1..=edges.len()],
            faces: &before[1 + edges.len()..],
            sharpness: &sharpness,
        };
        ring.step(after(start.vertex_sharpness(v), step), start.creases, next);
    }
}

/// One vertex with what is around it.
struct Ring<'a, const N: usize> {
    center: &'a [f32; N],
    edges: &'a [[f32; N]],
    faces: &'a [[f32; N]],
    sharpness: &'a [f32],
}

impl<const N: usize> Ring<'_, N> {
    fn step(&self, own: f32, method: super::CreaseMethod, to: &mut [[f32; N]]) {
        let n = self.edges.len();
        for i in 0..self.faces.len() {
            to[1 + n + i] = self.face_point(i).value();
        }
        for i in 0..n {
            to[1 + i] = self.edge_point(i).value();
        }
        let blend = blend(own, self.sharpness, method);
        let mut center = self.by(blend.before, 0.0);
        if blend.before != blend.after {
            center = center.mixed(self.by(blend.after, 1.0), blend.share);
        }
        to[0] = center.value();
    }

    fn face_point(&self, i: usize) -> Sum<N> {
        let mut sum = Sum::ZERO;
        let next = &self.edges[(i + 1) % self.edges.len()];
        for value in [self.center, &self.edges[i], &self.faces[i], next] {
            sum.add(0.25, value);
        }
        sum
    }

    fn edge_point(&self, i: usize) -> Sum<N> {
        let mut middle = Sum::ZERO;
        middle.add(0.5, self.center);
        middle.add(0.5, &self.edges[i]);
        if self.sharpness[i] >= 1.0 {
            return middle;
        }
        let before = (i + self.faces.len() - 1) % self.faces.len();
        let mut smooth = Sum::ZERO;
        smooth.add_sum(0.5, middle);
        smooth.add_sum(0.25, self.face_point(before));
        smooth.add_sum(0.25, self.face_point(i));
        middle.mixed(smooth, self.sharpness[i])
    }

    /// Where the vertex goes; edges sharper than `least` are its curve.
    fn by(&self, rule: Rule, least: f32) -> Sum<N> {
        let mut sum = Sum::ZERO;
        match rule {
            Rule::Corner => sum.add(1.0, self.center),
            Rule::Crease => {
                let sharp = |s: &f32| *s > least;
                let ends = [
                    self.sharpness.iter().position(sharp),
                    self.sharpness.iter().rposition(sharp),
                ];
                for end in ends.into_iter().flatten() {
                    sum.add(0.125, &self.edges[end]);
                }
                sum.add(0.75, self.center);
            }
            Rule::Smooth => {
                let n = self.faces.len() as f64;
                let outer = 1.0 / (n * n);
                for i in 0..self.faces.len() {
                    sum.add_sum(outer, self.face_point(i));
                    sum.add(outer, &self.edges[i]);
                }
                sum.add((n - 2.0) / n, self.center);
            }
        }
        sum
    }
}
