//! Everything a collapse reads and changes.

use super::features::{Feature, PointClass, classify};
use super::options::{Border, Cost, SimplifyOptions};
use super::quadric::Quadric;
use super::signal::Signal;
use super::surface::{Marks, Surface};
use super::wedges::{Normals, Prepared};
use crate::geom::normal_times_two_areas;
use crate::mesh::{Attributes, TriMesh};
use glam::DVec3;

/// Weight of the lines that hold a feature edge in place, relative to the
/// planes of the surface.
pub(crate) const LINE_WEIGHT: f64 = 2.0;

/// Unit normal and area of a triangle.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Facet {
    /// Unit normal; zero for a triangle without area.
    pub normal: DVec3,
    /// Area, model units squared.
    pub area: f64,
}

/// The surface and what is known about its points, wedges and triangles.
pub(crate) struct State<'a> {
    /// Triangles, points and wedges.
    pub surface: Surface,
    /// Attributes of every wedge.
    pub attributes: Attributes,
    /// The scaled attributes that count.
    pub signal: Signal,
    /// Material range of every triangle.
    pub range_of: Vec<u32>,
    /// How every point may move.
    pub class: Vec<PointClass>,
    /// Points that neither move nor vanish.
    pub locked: Vec<bool>,
    /// Weight of every point; empty if all are 1.
    pub weight: Vec<f32>,
    /// Planes of the input that every point stands for.
    pub quadric: Vec<Quadric>,
    /// Planes and lines around every point as they are now, seen from it;
    /// empty if the cost does not use them.
    pub star: Vec<Quadric>,
    /// Sum of the input's area normals that every point stands for.
    pub facing: Vec<DVec3>,
    /// Normal and area of every triangle.
    pub facets: Vec<Facet>,
    /// Scratch set of points.
    pub marks: Marks,
    /// The caller's wishes.
    pub options: &'a SimplifyOptions<'a>,
}

impl<'a> State<'a> {
    /// Gathers what the options need from a prepared mesh.
    pub fn new(mesh: &TriMesh, prepared: &Prepared, options: &'a SimplifyOptions<'a>) -> Self {
        let surface = prepared.surface.clone();
        let points = surface.position.len();
        let mut attributes = mesh.attributes.clone();
        attributes.gather(&prepared.source_vertex);
        let ranges = mesh.range_of_triangles();
        let range_of: Vec<u32> = prepared
            .source_triangle
            .iter()
            .map(|&t| ranges[t as usize])
            .collect();
        let facets = (0..surface.points.len())
            .map(|t| facet(surface.places(t)))
            .collect();
        let signal = Signal::of(
            mesh,
            &prepared.source_vertex,
            &options.attributes,
            prepared.normals == Normals::Kept,
        );
        let mut state = Self {
            attributes,
            signal,
            range_of,
            class: vec![PointClass::Interior; points],
            locked: vec![false; points],
            weight: Vec::new(),
            quadric: vec![Quadric::default(); points],
            star: Vec::new(),
            facing: vec![DVec3::ZERO; points],
            facets,
            marks: Marks::new(points),
            options,
            surface,
        };
        state.classify_all();
        state.read_wishes(prepared);
        state.sum_quadrics();
        if options.cost == Cost::Memoryless {
            state.star = (0..points as u32).map(|p| state.star_of(p)).collect();
        }
        state
    }

    fn classify_all(&mut self) {
        let mut ring = Vec::new();
        for p in 0..self.class.len() as u32 {
            self.classify(p, &mut ring);
        }
    }

    /// Looks at point `p` anew; `ring` is scratch.
    pub fn classify(&mut self, p: u32, ring: &mut Vec<u32>) {
        self.surface.neighbours(p, &mut self.marks, ring);
        self.class[p as usize] = classify(&self.surface, &self.range_of, p, ring);
    }

    fn read_wishes(&mut self, prepared: &Prepared) {
        if self.options.weights.is_some() {
            self.weight = vec![0.0; self.class.len()];
        }
        let triangles = self.surface.points.iter().zip(&self.surface.wedges);
        for (points, wedges) in triangles {
            for (&p, &w) in points.iter().zip(wedges) {
                let vertex = prepared.source_vertex[w as usize] as usize;
                if let Some(weights) = self.options.weights {
                    let known = &mut self.weight[p as usize];
                    *known = known.max(weights[vertex]);
                }
                self.locked[p as usize] |= self.options.locks.is_some_and(|l| l[vertex]);
            }
        }
        if self.options.border == Border::Lock {
            self.lock_borders();
        }
    }

    fn lock_borders(&mut self) {
        for p in 0..self.class.len() as u32 {
            let on_border = match self.class[p as usize] {
                PointClass::Interior => false,
                PointClass::Line(feature) => feature == Feature::Border,
                PointClass::Corner { .. } => {
                    self.feature_edges(p).iter().any(|e| e.1 == Feature::Border)
                }
            };
            self.locked[p as usize] |= on_border;
        }
    }

    fn sum_quadrics(&mut self) {
        for t in 0..self.surface.points.len() {
            let Facet { normal, area } = self.facets[t];
            let points = self.surface.points[t];
            let plane = Quadric::plane(
                normal,
                normal.dot(self.surface.position[points[1] as usize]),
                area / 3.0,
            );
            for p in points {
                self.quadric[p as usize] += plane;
                self.facing[p as usize] += normal * area;
            }
        }
        for p in 0..self.class.len() as u32 {
            let here = self.surface.position[p as usize];
            for (n, feature) in self.feature_edges(p) {
                let there = self.surface.position[n as usize];
                if self.holds(feature) {
                    self.quadric[p as usize] += line(here, there - here, 0.5 * LINE_WEIGHT);
                }
            }
        }
    }

    /// Brings the planes around `p` up to date.
    pub fn renew_star(&mut self, p: u32) {
        if !self.star.is_empty() {
            self.star[p as usize] = self.star_of(p);
        }
    }

    /// Whether constraint planes hold edges of this kind.
    pub fn holds(&self, feature: Feature) -> bool {
        feature != Feature::Border || self.options.border != Border::Free
    }

    /// Feature edges at `p`: the point at the other end and the kind.
    pub fn feature_edges(&self, p: u32) -> smallvec::SmallVec<[(u32, Feature); 4]> {
        let mut found = smallvec::SmallVec::new();
        if self.class[p as usize] == PointClass::Interior {
            return found;
        }
        for corner in self.surface.corners(p) {
            let [_, q, r] = self.surface.turned(corner);
            for n in [q, r] {
                if found.iter().any(|&(known, _)| known == n) {
                    continue;
                }
                let info = super::features::edge_info(&self.surface, &self.range_of, p, n);
                found.extend(info.feature(0).map(|f| (n, f)));
            }
        }
        found
    }

    /// Mean weight of two points.
    pub fn mean_weight(&self, a: u32, b: u32) -> f64 {
        match self.weight.is_empty() {
            true => 1.0,
            false => 0.5 * f64::from(self.weight[a as usize] + self.weight[b as usize]),
        }
    }
}

/// Normal and area of the triangle with these corners.
pub(crate) fn facet(corners: [DVec3; 3]) -> Facet {
    let n = normal_times_two_areas(corners);
    let length = n.length();
    Facet {
        normal: if length > 0.0 {
            n / length
        } else {
            DVec3::ZERO
        },
        area: 0.5 * length,
    }
}

/// Squared distance to the line through `point` along `edge`, weighted by
/// `weight` times the edge's squared length.
pub(crate) fn line(point: DVec3, edge: DVec3, weight: f64) -> Quadric {
    let mut quadric = Quadric::default();
    if let Some(along) = edge.try_normalize() {
        let (u, v) = along.any_orthonormal_pair();
        let weight = weight * edge.length_squared();
        quadric += Quadric::plane(u, u.dot(point), weight);
        quadric += Quadric::plane(v, v.dot(point), weight);
        // A line, though made of two planes, weighs once.
        quadric.weight = weight;
    }
    quadric
}
