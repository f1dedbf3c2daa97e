//! Which cells are leaves, by how many triangles have which keys.

use super::super::block::{Head, Sample};
use super::super::next::pages;
use super::cell::{Cell, DEEPEST};

/// Leaves of a model, in order, with the triangles that begin in each.
pub(super) fn divide(heads: &[Head], stop: Stop) -> Vec<(Cell, u64)> {
    let counts = Counts::of(heads);
    let mut leaves = Vec::new();
    counts.divide(Cell::ROOT, stop, &mut leaves);
    leaves
}

/// When a cell is not halved any more.
#[derive(Clone, Copy)]
pub(super) enum Stop {
    /// At so many triangles.
    Triangles(u64),
    /// At this depth.
    Depth(u32),
}

struct Counts<'a> {
    heads: &'a [Head],
    /// For each block, triangles before each of its samples, and all.
    before: Vec<Vec<u64>>,
}

impl<'a> Counts<'a> {
    fn of(heads: &'a [Head]) -> Self {
        let before = |head: &Head| {
            let sum = |sum: &mut u64, sample: &Sample| {
                *sum += u64::from(sample.triangles);
                Some(*sum)
            };
            let sums = head.samples.iter().scan(0, sum);
            std::iter::once(0).chain(sums).collect()
        };
        Self {
            heads,
            before: heads.iter().map(before).collect(),
        }
    }

    /// Triangles of samples that begin in a cell, and of those that may reach into it.
    fn within(&self, cell: Cell) -> [u64; 2] {
        let [mut begin, mut most] = [0, 0];
        for (head, before) in self.heads.iter().zip(&self.before) {
            if pages(head, [cell.first, cell.end()]).is_none() {
                continue;
            }
            let at = |key| head.samples.partition_point(|s| s.key < key);
            let [first, end] = [at(cell.first), at(cell.end())];
            begin += before[end] - before[first];
            most += before[end] - before[first.saturating_sub(1)];
        }
        [begin, most]
    }

    fn divide(&self, cell: Cell, stop: Stop, leaves: &mut Vec<(Cell, u64)>) {
        let [begin, most] = self.within(cell);
        if most == 0 {
            return;
        }
        let is_leaf = match stop {
            // Where many blocks may reach in, what begins in the cell decides.
            Stop::Triangles(limit) => most <= limit || begin <= limit / 2,
            Stop::Depth(depth) => cell.depth == depth,
        };
        if is_leaf || cell.depth == DEEPEST {
            leaves.push((cell, begin));
            return;
        }
        let children = cell.children().into_iter();
        children.for_each(|child| self.divide(child, stop, leaves));
    }
}
