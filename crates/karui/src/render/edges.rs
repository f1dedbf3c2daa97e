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

/// The box around a triangle, sub-pixels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Extent {
    x: [i32; 2],
    y: [i32; 2],
}

impl Extent {
    #[inline]
    pub(super) fn new([a, b, c]: &[Corner; 3]) -> Self {
        let range = |p: i32, q: i32, r: i32| [p.min(q).min(r), p.max(q).max(r)];
        Self {
            x: range(a.x, b.x, c.x),
            y: range(a.y, b.y, c.y),
        }
    }

    /// The samples in it, as far as they lie in `within`.
    #[inline]
    pub(super) fn window(&self, within: &Window) -> Window {
        let range = |[least, most]: [i32; 2], within: &Range<i32>| {
            let first = (least + ((1 << SUB_BITS) - 1)) >> SUB_BITS;
            let end = (most >> SUB_BITS) + 1;
            first.max(within.start)..end.min(within.end)
        };
        Window {
            columns: range(self.x, &within.columns),
            rows: range(self.y, &within.rows),
        }
    }

    /// Whether edge functions fit into 32 bits.
    #[inline]
    pub(super) fn is_small(&self) -> bool {
        let longest = (self.x[1] - self.x[0]).max(self.y[1] - self.y[0]);
        longest <= SMALL << SUB_BITS
    }
}

impl Window {
    #[inline]
    pub(super) fn is_empty(&self) -> bool {
        self.columns.start >= self.columns.end || self.rows.start >= self.rows.end
    }

    /// The sample, if it is the only one.
    #[inline]
    pub(super) fn only(&self) -> Option<(i32, i32)> {
        let (x, y) = (self.columns.start, self.rows.start);
        (self.columns.end == x + 1 && self.rows.end == y + 1).then_some((x, y))
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

/// Whether a triangle of positive area covers a sample.
#[inline]
pub(super) fn covers([a, b, c]: &[Corner; 3], column: i32, row: i32) -> bool {
    let side = |p: &Corner, q: &Corner| edge(p, q, column, row) + i64::from(bias(p, q));
    (side(b, c) | side(c, a) | side(a, b)) >= 0
}

/// Largest extent, in samples, whose edge functions fit into 32 bits.
const SMALL: i32 = 48;

/// An edge function over samples, in 32 bits.
#[derive(Clone, Copy)]
struct Slope {
    value: i32,
    right: i32,
    down: i32,
    bias: i32,
}

impl Slope {
    /// Its bias included, at a sample.
    #[inline]
    fn new(p: &Corner, q: &Corner, column: i32, row: i32) -> Self {
        let (dx, dy) = (q.x - p.x, q.y - p.y);
        let (x, y) = ((column << SUB_BITS) - p.x, (row << SUB_BITS) - p.y);
        let bias = bias(p, q);
        Self {
            value: dx * y - dy * x + bias,
            right: -(dy << SUB_BITS),
            down: dx << SUB_BITS,
            bias,
        }
    }
}

/// Calls `covered(column, row, [e1, e2])` for every sample in `window` that the
/// triangle covers, row by row. `e1` and `e2`, by twice the area, are the weights
/// of the second and third corner. The area must be positive and the triangle small;
/// see [`Extent::is_small`].
#[inline]
pub(super) fn cover_small(
    [a, b, c]: &[Corner; 3],
    window: &Window,
    covered: &mut impl FnMut(i32, i32, [f32; 2]),
) {
    let (left, top) = (window.columns.start, window.rows.start);
    let mut s0 = Slope::new(b, c, left, top);
    let mut s1 = Slope::new(c, a, left, top);
    let mut s2 = Slope::new(a, b, left, top);
    for row in top..window.rows.end {
        let (mut e0, mut e1, mut e2) = (s0.value, s1.value, s2.value);
        for column in left..window.columns.end {
            if e0 | e1 | e2 >= 0 {
                covered(column, row, [(e1 - s1.bias) as f32, (e2 - s2.bias) as f32]);
            }
            e0 += s0.right;
            e1 += s1.right;
            e2 += s2.right;
        }
        s0.value += s0.down;
        s1.value += s1.down;
        s2.value += s2.down;
    }
}

/// The same for any triangle: row by row the span within all three edges, found by
/// division.
pub(super) fn cover_large(
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
        let window = Extent::new(&corners).window(&within);
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

    /// Barycentric signs decide inside; on an edge, the triangle's samples are
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
                assert_eq!(covers(&[a, b, c], x, y), inside);
            }
        }
    }
}
