//! The points inside every patch.

use super::curves::offset;
use super::rings::Rings;
use super::{Patches, sides};
use rayon::prelude::*;

/// Patches a thread takes at a time.
const GROUP: usize = 32;

impl Patches {
    /// Writes all values after the last step in the order of the whole mesh.
    pub(super) fn fill_grids<const N: usize>(
        &self,
        rings: &Rings<N>,
        curves: &[[f32; N]],
        to: &mut [[f32; N]],
    ) {
        let (first, mut rest) = to.split_at_mut(self.start.vertices);
        for (v, to) in first.iter_mut().enumerate() {
            *to = rings.vertex(v as u32, self.layout.depth);
        }
        let faces = self.start.faces.count();
        let mut groups: Vec<Vec<&mut [[f32; N]]>> = Vec::new();
        groups.resize_with(faces.div_ceil(GROUP), Vec::new);
        for block in &self.layout.blocks {
            let each = block.places.len();
            let count = if block.of_edges {
                self.start.edges.len()
            } else {
                faces
            };
            let (part, after) = rest.split_at_mut(each * count);
            rest = after;
            if block.of_edges {
                self.copy_curves(curves, &block.places, part);
                continue;
            }
            for (group, part) in groups.iter_mut().zip(part.chunks_mut(each * GROUP)) {
                group.push(part);
            }
        }
        let groups = groups.into_par_iter().enumerate();
        groups.for_each_init(Grid::default, |grid, (g, mut parts)| {
            for face in g * GROUP..faces.min((g + 1) * GROUP) {
                self.refine(face, curves, grid);
                self.copy_grid(&grid.now, face % GROUP, &mut parts);
            }
        });
    }

    fn copy_curves<const N: usize>(
        &self,
        curves: &[[f32; N]],
        places: &[u32],
        to: &mut [[f32; N]],
    ) {
        let (size, last) = (self.curve_size(), offset(self.layout.depth));
        let edges = to.par_chunks_exact_mut(places.len()).with_min_len(256);
        edges
            .zip(curves.par_chunks_exact(size))
            .for_each(|(to, curve)| {
                let curve = &curve[last..];
                for (to, &place) in to.iter_mut().zip(places) {
                    *to = curve[place as usize];
                }
            });
    }

    fn copy_grid<const N: usize>(
        &self,
        grid: &[[f32; N]],
        local: usize,
        parts: &mut [&mut [[f32; N]]],
    ) {
        let blocks = self.layout.blocks.iter().filter(|block| !block.of_edges);
        for (block, part) in blocks.zip(parts) {
            let each = block.places.len();
            let to = &mut part[local * each..(local + 1) * each];
            for (to, &place) in to.iter_mut().zip(&block.places) {
                *to = grid[place as usize];
            }
        }
    }

    /// Goes through all steps of one patch.
    fn refine<const N: usize>(&self, face: usize, curves: &[[f32; N]], grid: &mut Grid<N>) {
        grid.now.clear();
        grid.now.resize(4, [0.0; N]);
        self.frame(face, 0, curves, &mut grid.now);
        for step in 0..self.layout.depth {
            grid.step(1 << step);
            self.frame(face, step + 1, curves, &mut grid.now);
        }
    }

    /// Copies the four curves around a patch into the rim of its grid.
    fn frame<const N: usize>(
        &self,
        face: usize,
        step: u32,
        curves: &[[f32; N]],
        grid: &mut [[f32; N]],
    ) {
        let n = 1usize << step;
        let width = n + 1;
        for (i, (start, stride)) in sides(n).into_iter().enumerate() {
            let c = 4 * face + i;
            let e = self.start.corner_edges[c];
            let curve = &curves[e as usize * self.curve_size() + offset(step)..][..width];
            let forward = self.start.edge(e)[0] == self.start.corners[c];
            for t in 0..width {
                let place = start.wrapping_add_signed(stride * t as isize);
                grid[place] = curve[if forward { t } else { n - t }];
            }
        }
    }
}

/// The grid of one patch.
struct Grid<const N: usize> {
    now: Vec<[f32; N]>,
    next: Vec<[f32; N]>,
    /// Rows refined along themselves.
    rows: Vec<[f32; N]>,
}

impl<const N: usize> Default for Grid<N> {
    fn default() -> Self {
        Self {
            now: Vec::new(),
            next: Vec::new(),
            rows: Vec::new(),
        }
    }
}

impl<const N: usize> Grid<N> {
    /// From n x n cells to 2n x 2n: along the rows, then across them. The rim is wrong.
    fn step(&mut self, n: usize) {
        let (width, fine) = (n + 1, 2 * n + 1);
        self.rows.resize(fine * width, [0.0; N]);
        self.next.resize(fine * fine, [0.0; N]);
        let rows = self.rows.chunks_exact_mut(fine);
        for (from, to) in self.now.chunks_exact(width).zip(rows) {
            along(from, to);
        }
        let row = |r: usize| self.rows[r * fine..(r + 1) * fine].as_flattened();
        for (y, to) in self.next.chunks_exact_mut(fine).enumerate() {
            let to = to.as_flattened_mut();
            let r = y / 2;
            if y % 2 == 1 {
                for ((to, a), b) in to.iter_mut().zip(row(r)).zip(row(r + 1)) {
                    *to = 0.5 * (a + b);
                }
            } else if y > 0 && y < 2 * n {
                let around = row(r - 1).iter().zip(row(r)).zip(row(r + 1));
                for (to, ((a, b), c)) in to.iter_mut().zip(around) {
                    *to = 0.125 * (a + c) + 0.75 * b;
                }
            }
        }
        std::mem::swap(&mut self.now, &mut self.next);
    }
}

/// Cubic B-spline refinement of one row, but for its ends.
fn along<const N: usize>(from: &[[f32; N]], to: &mut [[f32; N]]) {
    let n = from.len() - 1;
    to[0] = from[0];
    let pairs = to[1..].as_chunks_mut::<2>().0;
    for (t, [odd, even]) in pairs.iter_mut().enumerate() {
        let (a, b) = (&from[t], &from[t + 1]);
        let c = &from[(t + 2).min(n)];
        for i in 0..N {
            odd[i] = 0.5 * (a[i] + b[i]);
            even[i] = 0.125 * (a[i] + c[i]) + 0.75 * b[i];
        }
    }
}
