//! Triangles that cross a plane before which nothing may be divided or rounded.
//!
//! Sutherland and Hodgman, "Reentrant polygon clipping", 1974, in homogeneous
//! coordinates.

use super::project::{Corner, corner_of};
use super::view::{Homogeneous, View};
use smallvec::SmallVec;

type Polygon = SmallVec<[Homogeneous; 9]>;

/// The part of a triangle within the near and far plane and the guard band,
/// as triangles of the same orientation.
pub(super) fn clip(view: &View, corners: [Homogeneous; 3]) -> SmallVec<[[Corner; 3]; 7]> {
    let mut polygon = Polygon::from_slice(&corners);
    for plane in 0..6 {
        polygon = cut(view, &polygon, plane);
    }
    let corners: SmallVec<[Corner; 9]> = polygon.iter().map(|h| corner_of(view, h)).collect();
    let fan = (2..corners.len()).map(|k| [corners[0], corners[k - 1], corners[k]]);
    fan.collect()
}

fn cut(view: &View, polygon: &Polygon, plane: usize) -> Polygon {
    let mut kept = Polygon::new();
    for (k, b) in polygon.iter().enumerate() {
        let a = &polygon[(k + polygon.len() - 1) % polygon.len()];
        let [inside_a, inside_b] = [a, b].map(|h| view.inside(h)[plane]);
        if (inside_a >= 0.0) != (inside_b >= 0.0) {
            kept.push(crossing((a, inside_a), (b, inside_b)));
        }
        if inside_b >= 0.0 {
            kept.push(*b);
        }
    }
    kept
}

/// From the inside to the outside whichever way the edge runs, so that the two
/// triangles at an edge get the same point.
fn crossing(a: (&Homogeneous, f64), b: (&Homogeneous, f64)) -> Homogeneous {
    let ((from, inside), (to, outside)) = if a.1 >= 0.0 { (a, b) } else { (b, a) };
    let t = inside / (inside - outside);
    let mix = |p: f64, q: f64| p + (q - p) * t;
    Homogeneous {
        x: mix(from.x, to.x),
        y: mix(from.y, to.y),
        depth: mix(from.depth, to.depth),
        w: mix(from.w, to.w),
    }
}
