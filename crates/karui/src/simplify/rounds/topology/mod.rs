//! Changes of topology between two phases, which nobody sees: where they cost
//! no more than the collapses that have been paid for already. Edge collapse
//! alone keeps every part's last tetrahedron, every hole's last three edges
//! and every handle's last ring, and the triangles that they hold are missing
//! elsewhere.
//!
//! - I. Guskov, Z. Wood: Topological Noise Removal, Graphics Interface 2001.
//! - J. El-Sana, A. Varshney: Controlled Simplification of Genus for Polygonal
//!   Models, IEEE Visualization 1997.

mod handles;
mod holes;
mod net;
mod parts;

use super::level::Level;
use crate::simplify::options::TopologyChanges;
use glam::Vec3;
use net::Net;

/// What a change may cost.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    /// Largest price: area times squared distance, for every two triangles
    /// that it saves, as for a collapse.
    pub price: f32,
    pub weights: Weights,
    /// Largest distance, scaled units.
    pub error: f32,
    /// Triangles to be left.
    pub triangles: usize,
    /// Whether open borders may not be touched.
    pub lock_borders: bool,
}

/// Prices of collapses are weighted, and so must be what they are compared
/// with. Rings of three edges are next to nothing and in the way wherever they
/// are: they have the least weight. Whole parts are seen to go: they have their
/// own, but no less than the mean, or else the prices of a few heavy points
/// would buy all that weigh little.
#[derive(Debug, Clone, Copy)]
pub(super) struct Weights {
    least: f32,
    mean: f32,
}

impl Weights {
    const NONE: Self = Self {
        least: 1.0,
        mean: 1.0,
    };
}

impl Limits {
    /// Whether so large an area may be off by `distance`.
    fn allow(&self, area: f32, distance: f32) -> bool {
        distance <= self.error && area * distance * distance <= self.price
    }
}

impl Level<'_> {
    /// Removes parts, closes holes and cuts handles within the limits.
    pub(super) fn ease(&mut self, limits: &Limits) -> TopologyChanges {
        let parts = self.let_go(limits);
        let mut net = Net::of(&self.triangle);
        let holes = self.close_holes(&net, limits);
        if holes > 0 {
            net = Net::of(&self.triangle);
        }
        TopologyChanges {
            parts,
            holes,
            handles: self.cut_handles(&net, limits),
        }
    }

    /// Keeps the triangles for which `keep` holds.
    fn retain(&mut self, keep: impl Fn(usize) -> bool) {
        let kept: Vec<usize> = (0..self.triangle.len()).filter(|&t| keep(t)).collect();
        self.triangle = kept.iter().map(|&t| self.triangle[t]).collect();
        if !self.source.is_empty() {
            self.source = kept.iter().map(|&t| self.source[t]).collect();
        }
        if !self.wedge.is_empty() {
            self.wedge = kept.iter().map(|&t| self.wedge[t]).collect();
            self.range = kept.iter().map(|&t| self.range[t]).collect();
        }
    }

    /// Adds a triangle that looks like `model` and has these wedges.
    fn add_triangle(&mut self, points: [u32; 3], model: u32, wedges: [u32; 3]) {
        let source = self.source_of(model);
        self.triangle.to_mut().push(points);
        self.source.push(source);
        if !self.wedge.is_empty() {
            self.wedge.push(wedges);
            self.range.push(self.range[model as usize]);
        }
    }

    /// Wedge of a triangle at a point; 0 if there are no wedges.
    fn wedge_of(&self, t: u32, p: u32) -> u32 {
        let corner = self.triangle[t as usize].iter().position(|&q| q == p);
        let wedges = self.wedge.get(t as usize);
        wedges.zip(corner).map_or(0, |(wedges, k)| wedges[k])
    }

    /// Weights of all points, in short.
    pub(super) fn weights(&self) -> Weights {
        let sum: f64 = self.weight.iter().map(|&w| f64::from(w)).sum();
        match self.weight.len() {
            0 => Weights::NONE,
            count => Weights {
                least: self.weight.iter().copied().fold(f32::INFINITY, f32::min),
                mean: (sum / count as f64) as f32,
            },
        }
    }

    /// Area of a triangle, at the least weight, and half its longest side.
    fn extent(&self, points: [u32; 3], limits: &Limits) -> (f32, f32) {
        let [a, b, c] = points.map(|p| self.place(p));
        let area = 0.5 * (b - a).cross(c - a).length() * limits.weights.least;
        let longest =
            |p: Vec3, q: Vec3, r: Vec3| p.distance(q).max(q.distance(r)).max(r.distance(p));
        (area, 0.5 * longest(a, b, c))
    }
}
