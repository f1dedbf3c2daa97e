//! Where on a triangle a sample lies.

use super::edges::{edge, two_areas};
use super::project::{Corner, SUB_BITS};
use super::view::{Homogeneous, View};

/// Three functions of the sample's position, linear in the picture, whose ratios
/// are the weights of the corners in space.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    /// Twice the areas opposite the corners, their signs the same inside.
    edges: [f64; 3],
    /// Factors that undo the perspective.
    scales: [f64; 3],
    /// 1 by the sum of the scaled edge functions.
    by_sum: f64,
    /// Whether the corners run counter-clockwise in the picture.
    pub counter_clockwise: bool,
    /// Distance along the view.
    pub depth: f32,
}

impl Place {
    /// Of a triangle within all planes, which covers this sample: from the same
    /// integers that say so, so no weight is negative.
    #[inline]
    pub(super) fn of_corners(view: &View, corners: &[Corner; 3], column: i32, row: i32) -> Self {
        let [a, b, c] = corners;
        let area = two_areas(corners);
        let (e1, e2) = (edge(c, a, column, row), edge(a, b, column, row));
        let closeness = [a, b, c].map(|p| f64::from(p.closeness));
        let mut place = Self {
            edges: [area - e1 - e2, e1, e2].map(|e| e as f64),
            scales: if view.perspective {
                closeness
            } else {
                [1.0; 3]
            },
            by_sum: 0.0,
            counter_clockwise: area < 0,
            depth: 0.0,
        };
        place.by_sum = 1.0 / dot(place.edges, place.scales);
        place.depth = if view.perspective {
            (area as f64 * place.by_sum) as f32
        } else {
            view.depth_of((dot(place.edges, closeness) / area as f64) as f32)
        };
        place
    }

    /// Of a triangle that some plane cuts (Olano and Greer, "Triangle scan
    /// conversion using 2D homogeneous coordinates", 1997).
    pub(super) fn of_homogeneous(corners: &[Homogeneous; 3], column: i32, row: i32) -> Self {
        let (x, y) = (f64::from(column) + 0.5, f64::from(row) + 0.5);
        let lines = lines(corners);
        let edges = lines.map(|[a, b, c]| a * x + b * y + c);
        let sum = edges[0] + edges[1] + edges[2];
        let [p, ..] = corners;
        let determinant = lines[0][0] * p.x + lines[0][1] * p.y + lines[0][2] * p.w;
        let mut place = Self {
            edges,
            scales: [1.0; 3],
            by_sum: 1.0 / sum,
            counter_clockwise: determinant < 0.0,
            depth: 0.0,
        };
        let depths = corners.map(|c| c.depth);
        let weights = place.weights().map(f64::from);
        place.depth = dot(weights, depths) as f32;
        place
    }

    /// Weights of the corners; they sum to 1.
    #[inline]
    pub(super) fn weights(&self) -> [f32; 3] {
        let part = |k: usize| (self.edges[k] * self.scales[k] * self.by_sum).clamp(0.0, 1.0);
        let (b, c) = (part(1) as f32, part(2) as f32);
        if (b + c).is_nan() {
            return [1.0, 0.0, 0.0];
        }
        [(1.0 - b - c).max(0.0), b, c]
    }

    /// What a step to the right changes the weights by, and one downwards.
    pub(super) fn slopes(&self, steps: &Steps) -> [[f32; 3]; 2] {
        let weight: [f64; 3] =
            std::array::from_fn(|k| self.edges[k] * self.scales[k] * self.by_sum);
        [steps.right, steps.down].map(|step| {
            let sum = dot(step, self.scales);
            std::array::from_fn(|k| {
                ((step[k] * self.scales[k] - weight[k] * sum) * self.by_sum) as f32
            })
        })
    }

    /// Distance to the closest edge, samples.
    pub(super) fn edge_distance(&self, steps: &Steps) -> f32 {
        let distance = |k: usize| {
            let (dx, dy) = (steps.right[k], steps.down[k]);
            self.edges[k].abs() / (dx * dx + dy * dy).sqrt()
        };
        distance(0).min(distance(1)).min(distance(2)) as f32
    }
}

/// What a step of one sample to the right adds to the functions of a [`Place`], and
/// one downwards.
#[derive(Debug, Clone, Copy)]
pub(super) struct Steps {
    right: [f64; 3],
    down: [f64; 3],
}

impl Steps {
    pub(super) fn of_corners([a, b, c]: &[Corner; 3]) -> Self {
        let by_sample = |d: i32| f64::from(d) * f64::from(1u32 << SUB_BITS);
        Self {
            right: [b.y - c.y, c.y - a.y, a.y - b.y].map(by_sample),
            down: [c.x - b.x, a.x - c.x, b.x - a.x].map(by_sample),
        }
    }

    pub(super) fn of_homogeneous(corners: &[Homogeneous; 3]) -> Self {
        let lines = lines(corners);
        Self {
            right: lines.map(|l| l[0]),
            down: lines.map(|l| l[1]),
        }
    }
}

/// The lines opposite the corners.
fn lines([a, b, c]: &[Homogeneous; 3]) -> [[f64; 3]; 3] {
    [line(b, c), line(c, a), line(a, b)]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The line through two points, as the plane through them and the eye.
fn line(p: &Homogeneous, q: &Homogeneous) -> [f64; 3] {
    [
        p.y * q.w - p.w * q.y,
        p.w * q.x - p.x * q.w,
        p.x * q.y - p.y * q.x,
    ]
}
