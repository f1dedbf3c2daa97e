//! The front under a budget: what is largest on the screen first.
//!
//! A node is worth its area on the screen if the criteria want it kept, else
//! nothing; so what is worth more than a given floor, with all that waits for it,
//! is one cut, and a lower floor gives a finer one. The cut wanted is the one of
//! the lowest floor that the budget allows. Two queues find it from any other,
//! as in M. Duchaineau et al.: ROAMing Terrain, 1997.

use super::front::Front;
use super::{Budget, Change, Cut};
use crate::hierarchy::criteria::Keep;
use crate::hierarchy::node::Bounds;
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::time::Instant;

/// Changes between two looks at the clock.
const STRIDE: usize = 32;

/// Worth, as the bits of a float that is not negative, and the node.
type Entry = (u64, u32);

struct Queues {
    /// Collapsible nodes, the least worth first.
    low: BinaryHeap<Reverse<Entry>>,
    /// Splittable nodes, the most worth first.
    high: BinaryHeap<Entry>,
    floor: u64,
    tests: usize,
}

impl Cut<'_> {
    pub(super) fn refine_within(
        &mut self,
        frame: &impl Keep,
        budget: Budget,
        started: Instant,
    ) -> Change {
        let most = budget.triangles.unwrap_or(usize::MAX);
        let late = |step: usize| {
            step.is_multiple_of(STRIDE) && budget.time.is_some_and(|t| started.elapsed() >= t)
        };
        let mut queues = self.queues(frame);
        let mut steps = 0;
        let mut complete = true;
        loop {
            if late(steps) {
                complete = false;
                break;
            }
            steps += 1;
            if !self.lower(frame, most, &mut queues) && !self.raise(frame, &mut queues) {
                break;
            }
        }
        Change {
            complete,
            floor: f64::from_bits(queues.floor),
            tests: queues.tests,
            ..Change::default()
        }
    }

    fn queues(&self, frame: &impl Keep) -> Queues {
        let all = |front: &Front| front.ask_each(|bounds| worth(frame, bounds));
        let low = all(&self.collapsible).into_iter().map(Reverse);
        let high = all(&self.splittable).into_iter().filter(|e| e.0 > 0);
        Queues {
            low: low.collect(),
            high: high.collect(),
            floor: 0,
            tests: self.front_len(),
        }
    }

    /// Collapses one node that is worth no more than the floor, or, over budget,
    /// the one worth least, to which the floor rises. Whether there was one.
    fn lower(&mut self, frame: &impl Keep, most: usize, queues: &mut Queues) -> bool {
        let over = self.triangles.indices.len() > most;
        while let Some(&Reverse((worth, node))) = queues.low.peek() {
            if !self.is_collapsible(node) {
                queues.low.pop();
                continue;
            }
            if worth > queues.floor && !over {
                return false;
            }
            queues.low.pop();
            queues.floor = queues.floor.max(worth);
            self.collapse(node);
            self.look_again(frame, queues);
            return true;
        }
        false
    }

    /// Splits the node that is worth most, if that is more than the floor.
    fn raise(&mut self, frame: &impl Keep, queues: &mut Queues) -> bool {
        while let Some((worth, node)) = queues.high.pop() {
            if worth <= queues.floor {
                return false;
            }
            if self.is_active(node) || self.place[node as usize] == super::NONE {
                continue;
            }
            self.split(node);
            queues.low.push(Reverse((worth, node)));
            self.look_again(frame, queues);
            return true;
        }
        false
    }

    /// Enters what has come to the front.
    fn look_again(&mut self, frame: &impl Keep, queues: &mut Queues) {
        while let Some(node) = self.fresh.pop() {
            queues.tests += 1;
            let worth = worth(frame, &self.node(node).cover.bounds());
            if self.is_active(node) {
                queues.low.push(Reverse((worth, node)));
            } else if worth > 0 {
                queues.high.push((worth, node));
            }
        }
    }
}

fn worth(frame: &impl Keep, bounds: &Bounds) -> u64 {
    if frame.keep(bounds) {
        // Above 0 even where nothing is to be seen of it.
        frame.area(bounds).max(f64::MIN_POSITIVE).to_bits()
    } else {
        0
    }
}
