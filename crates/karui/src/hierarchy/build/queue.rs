//! Vertices in the order in which they go.

use crate::hierarchy::surface::NONE;

/// What decides who goes first: the cost; where that is equal the quadric error,
/// then the length of the edge. None is negative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Price {
    pub cost: f32,
    pub error: f32,
    pub length: f32,
}

impl Price {
    /// In the order of the prices, then of `point`: floats that are not negative
    /// are ordered as their bits are.
    fn key(self, point: u32) -> u128 {
        let [cost, error, length] = [self.cost, self.error, self.length].map(f32::to_bits);
        u128::from(cost) << 96
            | u128::from(error) << 64
            | u128::from(length) << 32
            | u128::from(point)
    }
}

/// A heap of points with a price each, every one of them once at most. Four
/// children a node: they lie in one cache line.
#[derive(Debug)]
pub(super) struct Queue {
    heap: Vec<u128>,
    /// Place of every point in the heap.
    place: Vec<u32>,
}

impl Queue {
    /// The points that have a price.
    pub fn new(prices: &[Option<Price>]) -> Self {
        let keys = (0u32..)
            .zip(prices)
            .filter_map(|(p, price)| Some(price.as_ref()?.key(p)));
        let mut queue = Self {
            heap: keys.collect(),
            place: vec![NONE; prices.len()],
        };
        for i in 0..queue.heap.len() {
            queue.place[queue.heap[i] as u32 as usize] = i as u32;
        }
        for i in (0..queue.heap.len().div_ceil(4)).rev() {
            queue.sink(i);
        }
        queue
    }

    /// The cheapest point, taken out.
    pub fn pop(&mut self) -> Option<u32> {
        let point = *self.heap.first()? as u32;
        self.set(point, None);
        Some(point)
    }

    /// A new price for a point, or none.
    pub fn set(&mut self, point: u32, price: Option<Price>) {
        let at = self.place[point as usize] as usize;
        match (at == NONE as usize, price) {
            (true, None) => {}
            (true, Some(price)) => {
                self.heap.push(price.key(point));
                self.rise(self.heap.len() - 1);
            }
            (false, Some(price)) => {
                self.heap[at] = price.key(point);
                self.rise(at);
                self.sink(self.place[point as usize] as usize);
            }
            (false, None) => self.remove(at),
        }
    }

    fn remove(&mut self, at: usize) {
        let gone = self.heap.swap_remove(at) as u32;
        self.place[gone as usize] = NONE;
        if at < self.heap.len() {
            let moved = self.heap[at] as u32 as usize;
            self.place[moved] = at as u32;
            self.rise(at);
            self.sink(self.place[moved] as usize);
        }
    }

    fn rise(&mut self, mut at: usize) {
        let key = self.heap[at];
        while at > 0 && key < self.heap[(at - 1) / 4] {
            self.put(at, self.heap[(at - 1) / 4]);
            at = (at - 1) / 4;
        }
        self.put(at, key);
    }

    fn sink(&mut self, mut at: usize) {
        let key = self.heap[at];
        loop {
            let first = 4 * at + 1;
            let end = (first + 4).min(self.heap.len());
            let Some(least) = (first..end).min_by_key(|&i| self.heap[i]) else {
                break;
            };
            if key < self.heap[least] {
                break;
            }
            self.put(at, self.heap[least]);
            at = least;
        }
        self.put(at, key);
    }

    fn put(&mut self, at: usize, key: u128) {
        self.heap[at] = key;
        self.place[key as u32 as usize] = at as u32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeMap;

    fn price(cost: u8) -> Price {
        Price {
            cost: f32::from(cost),
            error: 0.0,
            length: 0.0,
        }
    }

    #[test]
    fn equal_costs_are_told_apart_in_order() {
        let of = |cost, error, length| {
            Some(Price {
                cost,
                error,
                length,
            })
        };
        let prices = [
            of(1.0, 2.0, 3.0),
            of(1.0, 2.0, 2.0),
            None,
            of(1.0, 1.0, 9.0),
            of(0.5, 9.0, 9.0),
        ];
        let mut queue = Queue::new(&prices);
        let order: Vec<u32> = std::iter::from_fn(|| queue.pop()).collect();
        assert_eq!(order, [4, 3, 1, 0]);
    }

    proptest! {
        #[test]
        fn agrees_with_an_ordered_map(
            start in prop::collection::vec(prop::option::of(0u8..9), 1..40),
            steps in prop::collection::vec((0usize..40, prop::option::of(0u8..9), any::<bool>()), 0..200),
        ) {
            let prices: Vec<_> = start.iter().map(|c| c.map(price)).collect();
            let mut queue = Queue::new(&prices);
            let mut plain: BTreeMap<usize, u8> = BTreeMap::new();
            plain.extend(start.iter().enumerate().filter_map(|(p, c)| Some((p, (*c)?))));
            for (point, cost, pops) in steps {
                if pops {
                    let least = plain.iter().map(|(&p, &c)| (c, p)).min();
                    prop_assert_eq!(queue.pop(), least.map(|l| l.1 as u32));
                    least.map(|l| plain.remove(&l.1));
                } else if point < start.len() {
                    queue.set(point as u32, cost.map(price));
                    match cost {
                        Some(cost) => plain.insert(point, cost),
                        None => plain.remove(&point),
                    };
                }
            }
        }
    }
}
