//! Gaussian means over the samples of a surface, at a cost a sample that does
//! not grow with their density.
//!
//! Samples are gathered in cells of a third of the Gaussian's width. A cell
//! stands for its samples with their number, the sum and the first moments of
//! their values about their centroid; where the cut goes through a cell, the
//! share inside is taken from how far its samples lie apart. The samples of a
//! cell that has few count one by one, so a coarse mesh is summed exactly.

use glam::{DVec3, IVec3, Vec3};
use rayon::prelude::*;
use std::ops::Range;

/// Where the Gaussian is cut, in its widths.
pub(super) const CUT: f64 = 2.0;
/// Cells along the edge of a block, which is one width.
const SIDE: i32 = 3;
/// Blocks either way that the cut can reach.
const REACH: i32 = 3;
/// Bits of a block's place along one axis.
const BITS: u32 = 19;
/// Bits of a cell's place in its block.
const CELL_BITS: u32 = 5;
/// As many samples in a cell, or fewer, stay on their own: so few are not
/// spread evenly, as the share of a cell that is cut supposes.
const FEW: usize = 4;
/// Blocks that one task takes.
const TASK: usize = 64;
const LANES: usize = 8;

/// For every point the mean of `values` within [`CUT`] `width` of it, weighted
/// by a Gaussian of this `width`. No point lies more than 2^18 widths from
/// `origin`, the least corner of their box; values are within f32.
pub(super) fn means(points: &[DVec3], values: &[f64], origin: DVec3, width: f64) -> Vec<f64> {
    let grid = Grid::new(points, values, origin, width);
    let tasks = grid.blocks.par_chunks(TASK);
    let found: Vec<Vec<f64>> = tasks.map(|blocks| grid.task(blocks)).collect();
    let mut means = vec![0.0; points.len()];
    for (&(_, p), mean) in grid.order.iter().zip(found.into_iter().flatten()) {
        means[p as usize] = mean;
    }
    means
}

/// Everything here is in widths from the origin.
struct Grid {
    places: Vec<DVec3>,
    /// Samples by cell.
    order: Vec<(u64, u32)>,
    cells: Vec<Cell>,
    blocks: Vec<Block>,
}

struct Cell {
    centroid: DVec3,
    count: f32,
    sum: f32,
    moment: Vec3,
    /// Inverse of the width of the samples along one direction.
    sharpness: f32,
}

struct Block {
    key: u64,
    cells: Range<usize>,
    samples: Range<usize>,
}

fn key(place: DVec3) -> u64 {
    let cell = (place * f64::from(SIDE)).as_ivec3();
    let block = cell / SIDE + IVec3::splat(REACH);
    let inner = cell % SIDE;
    let inner = (inner.z * SIDE + inner.y) * SIDE + inner.x;
    block_key(block) << CELL_BITS | inner as u64
}

/// Grows by the same amount for the same step, wherever it starts.
fn block_key(block: IVec3) -> u64 {
    (block.z as u64) << (2 * BITS) | (block.y as u64) << BITS | block.x as u64
}

fn corner(key: u64) -> DVec3 {
    let at = |shift: u32| (key >> shift & ((1 << BITS) - 1)) as f64;
    DVec3::new(at(0), at(BITS), at(2 * BITS)) - f64::from(REACH)
}

impl Grid {
    fn new(points: &[DVec3], values: &[f64], origin: DVec3, width: f64) -> Self {
        let place = |p: &DVec3| (p - origin) / width;
        let places: Vec<DVec3> = points.par_iter().map(place).collect();
        let keyed = places.par_iter().enumerate();
        let mut order: Vec<_> = keyed.map(|(i, &p)| (key(p), i as u32)).collect();
        order.par_sort_unstable();
        let mut cells = Vec::new();
        let mut blocks: Vec<Block> = Vec::new();
        for samples in order.chunk_by(|a, b| a.0 == b.0) {
            let start = blocks.last().map_or(0, |b| b.samples.end);
            let block = samples[0].0 >> CELL_BITS;
            if blocks.last().is_none_or(|b| b.key != block) {
                blocks.push(Block {
                    key: block,
                    cells: cells.len()..cells.len(),
                    samples: start..start,
                });
            }
            let together = if samples.len() > FEW {
                samples.len()
            } else {
                1
            };
            let parts = samples.chunks(together);
            cells.extend(parts.map(|part| Cell::of(part, &places, values)));
            if let Some(block) = blocks.last_mut() {
                block.cells.end = cells.len();
                block.samples.end += samples.len();
            }
        }
        Self {
            places,
            order,
            cells,
            blocks,
        }
    }

    /// Means of all samples of `blocks`, which follow each other.
    fn task(&self, blocks: &[Block]) -> Vec<f64> {
        let mut rows = Vec::new();
        for z in -REACH..=REACH {
            for y in -REACH..=REACH {
                let step = i64::from(z) << (2 * BITS);
                let step = step + (i64::from(y) << BITS) - i64::from(REACH);
                let first = blocks[0].key.wrapping_add_signed(step);
                let next = self.blocks.partition_point(|b| b.key < first);
                rows.push(Row { step, next });
            }
        }
        let mut near = Vec::new();
        let mut means = Vec::new();
        for block in blocks {
            self.gather(block, &mut rows, &mut near);
            let from = corner(block.key);
            let samples = self.order[block.samples.clone()].iter();
            let places = samples.map(|&(_, p)| (self.places[p as usize] - from).as_vec3());
            means.extend(places.map(|place| mean(&near, place)));
        }
        means
    }

    /// The cells that a sample in `home` can reach, places relative to it.
    fn gather(&self, home: &Block, rows: &mut [Row], near: &mut Vec<Batch>) {
        near.clear();
        let from = corner(home.key);
        let mut lane = LANES;
        for row in rows {
            let first = home.key.wrapping_add_signed(row.step);
            while self.blocks.get(row.next).is_some_and(|b| b.key < first) {
                row.next += 1;
            }
            let last = first + 2 * REACH as u64;
            let blocks = self.blocks[row.next..].iter();
            for block in blocks.take_while(|b| b.key <= last) {
                for cell in &self.cells[block.cells.clone()] {
                    let place = (cell.centroid - from).as_vec3();
                    let gap = place - place.clamp(Vec3::ZERO, Vec3::ONE);
                    if gap.length_squared() > Batch::FARTHEST * Batch::FARTHEST {
                        continue;
                    }
                    if lane == LANES {
                        near.push(Batch::default());
                        lane = 0;
                    }
                    if let Some(batch) = near.last_mut() {
                        batch.set(lane, place, cell);
                    }
                    lane += 1;
                }
            }
        }
    }
}

/// Blocks in a line along x, found again and again from homes that ascend.
struct Row {
    step: i64,
    next: usize,
}

impl Cell {
    fn of(samples: &[(u64, u32)], places: &[DVec3], values: &[f64]) -> Self {
        let each = || samples.iter().map(|&(_, p)| p as usize);
        let count = samples.len() as f64;
        let centroid = each().map(|p| places[p]).sum::<DVec3>() / count;
        let moments = each().map(|p| values[p] * (places[p] - centroid));
        let apart = each().map(|p| places[p].distance_squared(centroid));
        // A surface has two directions, and what is spread evenly is sqrt(12)
        // times as wide as its deviation.
        let width = (6.0 * apart.sum::<f64>() / count).sqrt();
        Self {
            centroid,
            count: count as f32,
            sum: each().map(|p| values[p]).sum::<f64>() as f32,
            moment: moments.sum::<DVec3>().as_vec3(),
            sharpness: width.max(1e-6).recip() as f32,
        }
    }
}

/// Cells side by side, for the vector unit; those left over count nothing.
#[derive(Default)]
struct Batch {
    place: [[f32; LANES]; 3],
    count: [f32; LANES],
    sum: [f32; LANES],
    moment: [[f32; LANES]; 3],
    sharpness: [f32; LANES],
}

impl Batch {
    /// Widths beyond which no part of a cell is inside the cut: half of the
    /// widest, which has sqrt(6) of its samples' deviation, half its diagonal.
    const FARTHEST: f32 = CUT as f32 + 0.75;

    fn set(&mut self, lane: usize, place: Vec3, cell: &Cell) {
        for k in 0..3 {
            self.place[k][lane] = place[k];
            self.moment[k][lane] = cell.moment[k];
        }
        self.count[lane] = cell.count;
        self.sum[lane] = cell.sum;
        self.sharpness[lane] = cell.sharpness;
    }
}

/// Lane by lane, so that the order of sums does not depend on the machine.
fn mean(near: &[Batch], at: Vec3) -> f64 {
    const CUT_SQUARED: f32 = (CUT * CUT) as f32;
    let mut sums = [0f32; LANES];
    let mut weights = [0f32; LANES];
    for batch in near {
        for l in 0..LANES {
            let [x, y, z] = [0, 1, 2].map(|k| batch.place[k][l] - at[k]);
            let squared = x * x + y * y + z * z;
            let inside = (CUT_SQUARED - squared) * (0.5 / CUT as f32) * batch.sharpness[l] + 0.5;
            let weight = gaussian(squared) * inside.clamp(0.0, 1.0);
            let [mx, my, mz] = [0, 1, 2].map(|k| batch.moment[k][l]);
            let sum = batch.sum[l] - (x * mx + y * my + z * mz);
            sums[l] += sum * weight;
            weights[l] += batch.count[l] * weight;
        }
    }
    let total = |lanes: [f32; LANES]| lanes.iter().map(|&x| f64::from(x)).sum::<f64>();
    let weight = total(weights);
    if weight > 0.0 {
        total(sums) / weight
    } else {
        0.0
    }
}

/// `exp(-squared / 2)` to 1e-5 of itself up to 2.8 widths and no more than a
/// few hundredths beyond: the eighth power of a series, without libm.
fn gaussian(squared: f32) -> f32 {
    let y = -(squared * 0.0625).min(0.5);
    let series = 1.0 / 24.0 + y * (1.0 / 120.0 + y * (1.0 / 720.0));
    let series = 1.0 + y * (1.0 + y * (0.5 + y * (1.0 / 6.0 + y * series)));
    let square = series * series;
    let fourth = square * square;
    fourth * fourth
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gaussian_is_the_library_s() {
        for i in 0..800 {
            let squared = i as f32 / 100.0;
            let exact = (-f64::from(squared) / 2.0).exp();
            let off = f64::from(gaussian(squared)) / exact - 1.0;
            assert!(off.abs() < 2e-5, "{squared}: {off}");
        }
    }

    #[test]
    fn keys_step_evenly() {
        let at = |x, y, z| key(DVec3::new(x, y, z)) >> CELL_BITS;
        assert_eq!(corner(at(3.2, 0.0, 700.5)), DVec3::new(3.0, 0.0, 700.0));
        assert_eq!(
            at(3.2, 5.0, 7.0) - at(1.9, 4.0, 7.0),
            at(2.0, 1.0, 0.0) - at(0.0, 0.0, 0.0)
        );
    }
}
