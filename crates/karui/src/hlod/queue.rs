//! Pairs of clusters, the least first.
//!
//! A heap of millions is slow: every step is somewhere else in memory. Here pairs
//! that are far from being the least lie in no order; the next eighth of them is
//! sorted when its turn comes, and a small heap holds what comes in between.

use rayon::prelude::*;
use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

/// Least number of pairs sorted at once.
const RUN: usize = 1 << 12;

/// A pair of clusters and who of them looked for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pair {
    pub omega: f64,
    pub newer: u32,
    pub older: u32,
    pub owner: u32,
}

impl Pair {
    pub fn new(omega: f64, owner: u32, partner: u32) -> Self {
        Self {
            omega,
            newer: owner.max(partner),
            older: owner.min(partner),
            owner,
        }
    }

    pub fn partner(&self) -> u32 {
        self.newer ^ self.older ^ self.owner
    }
}

impl Eq for Pair {}

impl Ord for Pair {
    fn cmp(&self, other: &Self) -> Ordering {
        let ids = |p: &Self| (p.newer, p.older, p.owner);
        self.omega
            .total_cmp(&other.omega)
            .then_with(|| ids(self).cmp(&ids(other)))
    }
}

impl PartialOrd for Pair {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Pairs, the least first.
#[derive(Debug, Default)]
pub(super) struct Queue {
    /// Descending.
    run: Vec<Pair>,
    /// Came later, and is no greater than `last`.
    between: BinaryHeap<Reverse<Pair>>,
    /// The greatest pair of the run.
    last: Option<Pair>,
    /// What is greater, in no order.
    far: Vec<Pair>,
}

impl Queue {
    pub fn new(pairs: Vec<Pair>) -> Self {
        Self {
            far: pairs,
            ..Self::default()
        }
    }

    pub fn push(&mut self, pair: Pair) {
        if self.last.is_some_and(|last| pair <= last) {
            self.between.push(Reverse(pair));
        } else {
            self.far.push(pair);
        }
    }

    /// The least pair. Pairs for which `counts` is false may be dropped on the way.
    pub fn pop(&mut self, counts: impl Fn(&Pair) -> bool) -> Option<Pair> {
        if self.run.is_empty() && self.between.is_empty() {
            self.far.retain(counts);
            self.start_run();
        }
        match (self.run.last(), self.between.peek()) {
            (Some(next), Some(Reverse(between))) if between < next => {}
            (Some(_), _) => return self.run.pop(),
            (None, _) => {}
        }
        self.between.pop().map(|Reverse(pair)| pair)
    }

    fn start_run(&mut self) {
        let count = (self.far.len() / 8).max(RUN).min(self.far.len());
        if count < self.far.len() {
            // What comes to lie behind is less.
            let rest = self.far.len() - count;
            self.far.select_nth_unstable_by(rest, |a, b| b.cmp(a));
            self.run = self.far.split_off(rest);
        } else {
            self.run = std::mem::take(&mut self.far);
        }
        self.run.par_sort_unstable_by(|a, b| b.cmp(a));
        self.last = self.run.first().copied();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_come_out_as_out_of_a_heap() {
        let mut random = 1u64;
        let mut next = |bound: u64| {
            random = random
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (random >> 33) % bound
        };
        let mut pair = || Pair::new(next(1000) as f64, next(50) as u32, 50 + next(50) as u32);
        let start: Vec<Pair> = (0..50_000).map(|_| pair()).collect();
        let mut heap: BinaryHeap<_> = start.iter().copied().map(Reverse).collect();
        let mut queue = Queue::new(start);
        for step in 0..200_000 {
            if step % 3 == 0 && step < 150_000 {
                let more = pair();
                heap.push(Reverse(more));
                queue.push(more);
            }
            assert_eq!(queue.pop(|_| true), heap.pop().map(|Reverse(p)| p));
        }
        assert_eq!(queue.pop(|_| true), None);
    }

    #[test]
    fn what_no_longer_counts_may_go() {
        let mut queue = Queue::new((0..10).map(|i| Pair::new(1.0, i, i + 10)).collect());
        assert_eq!(queue.pop(|p| p.owner == 7).map(|p| p.owner), Some(7));
        assert_eq!(queue.pop(|_| true), None);
    }
}
