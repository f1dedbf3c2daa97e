//! Which samples a triangle covers: edge functions over integers, which know no
//! rounding (Pineda, "A parallel algorithm for polygon rasterization", 1988).
//!
//! A sample on an edge belongs to the triangle whose left or top edge it is, so
//! that of triangles that share an edge exactly one has it.

use super::project::{Corner, SUB_BITS};
use std::ops::Range;

/// Columns and rows of samples.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Window {
    pub columns: Range<i32>,
    pub rows: Range<i32>,
}

/// Twice the area in sub-pixels; positive if the corners run clockwise as
/// seen in the picture, where y grows downwards.
#[inline]
pub(super) fn two_areas([a, b, c]: &[Corner; 3]) -> i64 {
    let d = |p: i32, q: i32| i64::from(p) - i64::from(q);
    d(b.x, a.x) * d(c.y, a.y) - d(b.y, a.y) * d(c.x, a.x)
}

/// The samples in the box around a triangle, as far as they lie in `within`.
#[inline]
pub(super) fn window([a, b, c]: &[Corner; 3], within: &Window) -> Window {
    let range = |p: i32, q: i32, r: i32, within: &Range<i32>| {
        let (least, most) = (p.min(q).min(r), p.max(q).max(r));
        let first = (least + ((1 << SUB_BITS) - 1)) >> SUB_BITS;
        let end = (most >> SUB_BITS) + 1;
        first.max(within.start)..end.min(within.end)
    };
    Window {
        columns: range(a.x, b.x, c.x, &within.columns),
        rows: range(a.y, b.y, c.y, &within.rows),
    }
}

impl Window {
    #[inline]
    pub(super) fn is_empty(&self) -> bool {
        self.columns.start >= self.columns.end || self.rows.start >= self.rows.end
    }
}

/// Corners in such an order that the area is positive, and whether they were
/// turned.
#[inline]
pub(super) fn oriented([a, b, c]: [Corner; 3], two_areas: i64) -> [Corner; 3] {
    if two_areas < 0 { [a, c, b] } else { [a, b, c] }
}

/// An edge function: twice the area of the triangle between the edge from `a` to
/// `b` and a sample, positive inside.
#[inline]
pub(super) fn edge(a: &Corner, b: &Corner, column: i32, row: i32) -> i64 {
    let d = |p: i32, q: i32| i64::from(p) - i64::from(q);
    let (x, y) = (i64::from(column) << SUB_BITS, i64::from(row) << SUB_BITS);
    d(b.x, a.x) * (y - i64::from(a.y)) - d(b.y, a.y) * (x - i64::from(a.x))
}

/// 0 for an edge whose samples belong to the triangle, else -1.
#[inline]
fn bias(a: &Corner, b: &Corner) -> i32 {
    let (dx, dy) = (b.x - a.x, b.y - a.y);
    // With clockwise corners and y downwards, left edges run up, top ones right.
    if dy < 0 || (dy == 0 && dx > 0) { 0 } else { -1 }
}

/// Largest extent, in samples, whose edge functions fit into 32 bits.
const SMALL: i32 = 48;

/// Calls `covered(column, row, [e1, e2])` for every sample in `window` that the
/// triangle covers, row by row. `e1` and `e2`, by twice the area, are the weights
/// of the second and third corner. The area must be positive.
#[inline]
pub(super) fn cover(
    corners: &[Corner; 3],
    window: &Window,
    covered: &mut impl FnMut(i32, i32, [f32; 2]),
) {
    let small = |p: i32, q: i32, r: i32| {
        i64::from(p.max(q).max(r)) - i64::from(p.min(q).min(r)) <= i64::from(SMALL << SUB_BITS)
    };
    let [a, b, c] = corners;
    if small(a.x, b.x, c.x) && small(a.y, b.y, c.y) {
        cover_small(corners, window, covered);
    } else {
        cover_large(corners, window, covered);
    }
}

#[inline]
fn cover_small(
    [a, b, c]: &[Corner; 3],
    window: &Window,
    covered: &mut impl FnMut(i32, i32, [f32; 2]),
) {
    let (left, top) = (window.columns.start, window.rows.start);
    let start = |p: &Corner, q: &Corner| {
        let (x, y) = ((left << SUB_BITS) - p.x, (top << SUB_BITS) - p.y);
        (q.x - p.x) * y - (q.y - p.y) * x
    };
    let mut rows = [start(b, c), start(c, a), start(a, b)];
    let right = [b.y - c.y, c.y - a.y, a.y - b.y].map(|d| d << SUB_BITS);
    let down = [c.x - b.x, a.x - c.x, b.x - a.x].map(|d| d << SUB_BITS);
    let bias = [bias(b, c), bias(c, a), bias(a, b)];
    for row in window.rows.clone() {
        let mut e = rows;
        for column in window.columns.clone() {
            if (e[0] + bias[0]) | (e[1] + bias[1]) | (e[2] + bias[2]) >= 0 {
                covered(column, row, [e[1] as f32, e[2] as f32]);
            }
            e = [e[0] + right[0], e[1] + right[1], e[2] + right[2]];
        }
        rows = [rows[0] + down[0], rows[1] + down[1], rows[2] + down[2]];
    }
}

/// Row by row the span within all three edges, found by division.
fn cover_large(
    [a, b, c]: &[Corner; 3],
    window: &Window,
    covered: &mut impl FnMut(i32, i32, [f32; 2]),
) {
    let edges = [(b, c), (c, a), (a, b)];
    let right = edges.map(|(p, q)| (i64::from(p.y) - i64::from(q.y)) << SUB_BITS);
    let bias = edges.map(|(p, q)| i64::from(bias(p, q)));
    let left = window.columns.start;
    let width = i64::from(window.columns.end) - i64::from(left);
    for row in window.rows.clone() {
        let e = edges.map(|(p, q)| edge(p, q, left, row));
        let mut span = 0..width;
        for k in 0..3 {
            narrow(&mut span, e[k] + bias[k], right[k]);
        }
        let (mut e1, mut e2) = (e[1] + right[1] * span.start, e[2] + right[2] * span.start);
        for x in span {
            covered(left + x as i32, row, [e1 as f32, e2 as f32]);
            e1 += right[1];
            e2 += right[2];
        }
    }
}

/// Keeps the steps after which `value + step * slope` is not negative.
fn narrow(span: &mut Range<i64>, value: i64, slope: i64) {
    if slope > 0 && value < 0 {
        span.start = span.start.max((-value + slope - 1) / slope);
    } else if slope < 0 {
        let end = if value < 0 { 0 } else { value / -slope + 1 };
        span.end = span.end.min(end);
    } else if slope == 0 && value < 0 {
        span.end = span.start;
    }
    span.start = span.start.min(span.end);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corner(x: i32, y: i32) -> Corner {
        Corner {
            x,
            y,
            ..Corner::default()
        }
    }

    fn covered(corners: [Corner; 3], large: bool) -> Vec<(i32, i32, [f32; 2])> {
        let within = Window {
            columns: 0..40,
            rows: 0..40,
        };
        let corners = oriented(corners, two_areas(&corners));
        let window = window(&corners, &within);
        let mut found = Vec::new();
        let mut note = |x, y, e| found.push((x, y, e));
        if large {
            cover_large(&corners, &window, &mut note);
        } else {
            cover_small(&corners, &window, &mut note);
        }
        found
    }

    /// Corners on and between samples, some of them on one line.
    fn some_corners(seed: &mut u64) -> [Corner; 3] {
        std::array::from_fn(|_| {
            let mut next = || {
                *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                ((*seed >> 40) % 40 * 256) as i32 + [0, 0, 128, 77][(*seed >> 33) as usize % 4]
            };
            corner(next(), next())
        })
    }

    #[test]
    fn both_ways_cover_the_same_samples_with_the_same_bits() {
        let mut seed = 1;
        for _ in 0..3000 {
            let corners = some_corners(&mut seed);
            if two_areas(&corners) != 0 {
                assert_eq!(covered(corners, false), covered(corners, true));
            }
        }
    }

    /// Barrycentric signs decide inside; on an edge, the triangle's samples are
    /// those that a shift by an infinitesimal amount to the right and, less so,
    /// downwards, brings inside.
    #[test]
    fn coverage_is_that_of_a_shifted_sample() {
        let mut seed = 2;
        for _ in 0..500 {
            let corners = some_corners(&mut seed);
            let area = two_areas(&corners);
            if area == 0 {
                continue;
            }
            let found = covered(corners, false);
            let [a, b, c] = oriented(corners, area);
            for (x, y) in (0..1600).map(|i| (i % 40, i / 40)) {
                let inside = [(a, b), (b, c), (c, a)].iter().all(|(p, q)| {
                    let (dx, dy) = (q.x - p.x, q.y - p.y);
                    (edge(p, q, x, y), -dy, dx) > (0, 0, 0)
                });
                assert_eq!(found.iter().any(|f| (f.0, f.1) == (x, y)), inside);
            }
        }
    }
}
