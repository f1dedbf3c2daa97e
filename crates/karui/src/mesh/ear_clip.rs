//! Triangulation of one plane polygon by cutting ears.
//!
//! Every corner is kept, also those on straight edges (dropping them would
//! open cracks), so n corners always give n - 2 triangles. Polygons that cross
//! themselves may run out of ears; the rest is then cut as a fan.
//!
//! Meisters, Polygons Have Ears, 1975. Only reflex corners can lie in an ear;
//! a grid finds those near it. The work is limited, see [`work_limit`].

use glam::DVec2;

/// Corners from which on reflex corners are looked up in a grid.
const GRID_FROM: usize = 32;

/// Units of work (a corner looked at, a cell visited) before the rest of a
/// polygon is cut as a fan. Real outlines need about 20 a corner; the limit
/// only keeps hostile ones from quadratic time.
fn work_limit(corners: usize) -> usize {
    256 * corners.max(1024)
}

/// Cuts the polygon, counter-clockwise, into triangles of corner indices.
pub(super) fn ear_clip(points: &[DVec2], mut triangle: impl FnMut([usize; 3])) {
    let mut ring = Ring::new(points);
    let mut left = points.len();
    let mut corner = 0;
    for allow_flat in [false, true] {
        let mut tried = 0;
        while left > 3 && tried < left && ring.work_left > 0 {
            if !ring.is_ear(corner, allow_flat) {
                corner = ring.next[corner];
                tried += 1;
                continue;
            }
            triangle(ring.cut(corner));
            left -= 1;
            tried = 0;
            // Going on after the next corner makes fewer slivers.
            corner = ring.next[ring.next[corner]];
        }
    }
    fan(&ring, corner, left, triangle);
}

fn fan(ring: &Ring<'_>, first: usize, left: usize, mut triangle: impl FnMut([usize; 3])) {
    let mut b = ring.next[first];
    for _ in 2..left {
        let c = ring.next[b];
        triangle([first, b, c]);
        b = c;
    }
}

/// The corners that are left, linked in a ring.
struct Ring<'a> {
    points: &'a [DVec2],
    next: Vec<usize>,
    previous: Vec<usize>,
    /// Corners that were not convex at the start; corners never turn reflex
    /// by cutting ears, so this holds all that may ever lie in one.
    reflex: Grid,
    gone: Vec<bool>,
    work_left: usize,
}

impl<'a> Ring<'a> {
    fn new(points: &'a [DVec2]) -> Self {
        let n = points.len();
        let mut ring = Self {
            points,
            next: (0..n).map(|i| (i + 1) % n).collect(),
            previous: (0..n).map(|i| (i + n - 1) % n).collect(),
            reflex: Grid::default(),
            gone: vec![false; n],
            work_left: work_limit(n),
        };
        let reflex = (0..n).filter(|&i| ring.turn(i) <= 0.0).collect();
        ring.reflex = Grid::new(points, reflex);
        ring
    }

    fn corners(&self, i: usize) -> [usize; 3] {
        [self.previous[i], i, self.next[i]]
    }

    /// Positive for a convex corner, 0 for a straight one.
    fn turn(&self, i: usize) -> f64 {
        turn(self.corners(i).map(|c| self.points[c]))
    }

    fn is_ear(&mut self, i: usize, allow_flat: bool) -> bool {
        self.work_left = self.work_left.saturating_sub(1);
        let turn = self.turn(i);
        if turn < 0.0 || (turn == 0.0 && !allow_flat) {
            return false;
        }
        let ear = self.corners(i);
        let shape = ear.map(|c| self.points[c]);
        let mut work = 0;
        let blocked = self.reflex.any_near(shape, &mut work, |c| {
            !self.gone[c] && !ear.contains(&c) && blocks(shape, self.points[c])
        });
        self.work_left = self.work_left.saturating_sub(work);
        !blocked
    }

    fn cut(&mut self, i: usize) -> [usize; 3] {
        let [before, _, after] = self.corners(i);
        self.next[before] = after;
        self.previous[after] = before;
        self.gone[i] = true;
        [before, i, after]
    }
}

fn turn([a, b, c]: [DVec2; 3]) -> f64 {
    (b - a).perp_dot(c - b)
}

/// Whether a reflex corner at `p` forbids the ear. One that coincides with a
/// corner of the ear does not: outlines with holes touch themselves there.
fn blocks(ear: [DVec2; 3], p: DVec2) -> bool {
    let [a, b, c] = ear;
    if ear.contains(&p) {
        return false;
    }
    turn([a, b, p]) >= 0.0 && turn([b, c, p]) >= 0.0 && turn([c, a, p]) >= 0.0
}

/// Points in square cells, or one cell if they are few.
#[derive(Default)]
struct Grid {
    origin: DVec2,
    cells_per_unit: DVec2,
    side: usize,
    /// Cell `c` holds `items[starts[c]..starts[c + 1]]`.
    starts: Vec<u32>,
    items: Vec<u32>,
}

impl Grid {
    fn new(points: &[DVec2], members: Vec<usize>) -> Self {
        let side = if members.len() < GRID_FROM {
            1
        } else {
            (members.len() as f64).sqrt() as usize
        };
        let corner = |fold: fn(DVec2, DVec2) -> DVec2, start: f64| {
            let positions = members.iter().map(|&m| points[m]);
            positions.fold(DVec2::splat(start), fold)
        };
        let origin = corner(DVec2::min, f64::INFINITY);
        let size = corner(DVec2::max, f64::NEG_INFINITY) - origin;
        let mut grid = Self {
            origin,
            cells_per_unit: side as f64 / size.max(DVec2::splat(f64::MIN_POSITIVE)),
            side,
            starts: vec![0; side * side + 1],
            items: vec![0; members.len()],
        };
        grid.fill(points, &members);
        grid
    }

    fn fill(&mut self, points: &[DVec2], members: &[usize]) {
        let cells: Vec<usize> = members
            .iter()
            .map(|&m| {
                let [x, y] = self.cell(points[m]);
                y * self.side + x
            })
            .collect();
        for &cell in &cells {
            self.starts[cell + 1] += 1;
        }
        for cell in 1..self.starts.len() {
            self.starts[cell] += self.starts[cell - 1];
        }
        let mut slots = self.starts.clone();
        for (&member, &cell) in members.iter().zip(&cells) {
            self.items[slots[cell] as usize] = member as u32;
            slots[cell] += 1;
        }
    }

    fn cell(&self, p: DVec2) -> [usize; 2] {
        // Casts saturate, and NaN (from an empty grid) becomes 0.
        let cell = (p - self.origin) * self.cells_per_unit;
        [cell.x, cell.y].map(|c| (c as usize).min(self.side - 1))
    }

    /// Whether `found` holds for a member in the cells the triangle's box
    /// touches. Adds what was looked at to `work`.
    fn any_near(
        &self,
        [a, b, c]: [DVec2; 3],
        work: &mut usize,
        found: impl Fn(usize) -> bool,
    ) -> bool {
        if self.items.is_empty() {
            return false;
        }
        let [x0, y0] = self.cell(a.min(b).min(c));
        let [x1, y1] = self.cell(a.max(b).max(c));
        for y in y0..=y1 {
            let row = y * self.side;
            let first = self.starts[row + x0] as usize;
            let end = self.starts[row + x1 + 1] as usize;
            *work += 1 + end - first;
            if self.items[first..end].iter().any(|&m| found(m as usize)) {
                return true;
            }
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cut(points: &[DVec2]) -> Vec<[usize; 3]> {
        let mut triangles = Vec::new();
        ear_clip(points, |t| triangles.push(t));
        assert_eq!(triangles.len(), points.len() - 2);
        triangles
    }

    fn area(points: &[DVec2], triangles: &[[usize; 3]]) -> [f64; 2] {
        let areas = triangles.iter().map(|t| 0.5 * turn(t.map(|c| points[c])));
        let (sum, absolute) = areas.fold((0.0, 0.0), |(s, a), x: f64| (s + x, a + x.abs()));
        [sum, absolute]
    }

    fn shoelace(points: &[DVec2]) -> f64 {
        let n = points.len();
        let pairs = (0..n).map(|i| points[i].perp_dot(points[(i + 1) % n]));
        0.5 * pairs.sum::<f64>()
    }

    /// No triangle is turned over and together they cover the polygon.
    fn assert_covers(points: &[DVec2]) {
        let triangles = cut(points);
        let [sum, absolute] = area(points, &triangles);
        let expected = shoelace(points);
        assert!(
            (sum - expected).abs() <= 1e-9 * expected,
            "{sum} {expected}"
        );
        assert!(
            (absolute - sum).abs() <= 1e-9 * expected,
            "{absolute} {sum}"
        );
    }

    fn star(n: usize) -> Vec<DVec2> {
        let point = |i: usize| {
            let angle = i as f64 / n as f64 * std::f64::consts::TAU;
            DVec2::from_angle(angle) * if i.is_multiple_of(2) { 1.0 } else { 0.6 }
        };
        (0..n).map(point).collect()
    }

    #[test]
    fn simple_outlines_are_covered_exactly() {
        let l = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]];
        let l = l.map(|[x, y]| DVec2::new(f64::from(x), f64::from(y)));
        assert_covers(&l);
        assert_covers(&star(10));
        assert_covers(&star(1000));
        let mut comb: Vec<_> = (0..401)
            .map(|i| DVec2::new(f64::from(i), if i % 2 == 0 { 1.0 } else { 50.0 }))
            .collect();
        comb.reverse();
        comb.extend([DVec2::ZERO, DVec2::new(400.0, 0.0)]);
        assert_covers(&comb);
    }

    #[test]
    fn straight_corners_are_kept() {
        let square: Vec<_> = (0..40)
            .map(|i| {
                let t = f64::from(i % 10);
                [[t, 0.0], [10.0, t], [10.0 - t, 10.0], [0.0, 10.0 - t]][i as usize / 10].into()
            })
            .collect();
        assert_covers(&square);
        let mut used = [false; 40];
        cut(&square).iter().flatten().for_each(|&c| used[c] = true);
        assert!(used.iter().all(|&u| u));
    }

    #[test]
    fn outline_with_a_bridged_hole() {
        let outer = [[0, 0], [4, 0], [4, 4], [0, 4], [0, 0]];
        let hole = [[1, 1], [1, 3], [3, 3], [3, 1], [1, 1]];
        let points: Vec<_> = outer
            .iter()
            .chain(&hole)
            .map(|&[x, y]| DVec2::new(f64::from(x), f64::from(y)))
            .collect();
        assert_covers(&points);
    }

    #[test]
    fn hopeless_outlines_still_give_all_triangles() {
        cut(&[DVec2::ZERO; 9]);
        cut(&star(7).into_iter().rev().collect::<Vec<_>>());
        let crossed: Vec<_> = (0..7)
            .map(|i| DVec2::from_angle(f64::from(i) * 3.0 / 7.0 * std::f64::consts::TAU))
            .collect();
        cut(&crossed);
    }

    #[test]
    fn huge_outlines_take_no_quadratic_time() {
        // It would be seen as a test that hangs.
        assert_covers(&star(100_000));
        let noise: Vec<_> = (0..100_000u64)
            .map(|i| {
                let h = i.wrapping_mul(0x9E37_79B9_7F4A_7C15);
                DVec2::new((h >> 40) as f64, (h >> 16 & 0xff_ffff) as f64)
            })
            .collect();
        cut(&noise);
    }
}
