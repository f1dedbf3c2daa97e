//! The nodes that can be the next to change, and when each is to be asked again.

use crate::hierarchy::node::{Bounds, Cover, Unpacked};
use crate::hierarchy::surface::NONE;
use rayon::prelude::*;

/// Nodes looked at by one task.
const BATCH: usize = 4096;

/// One half of the front. What eye and lights have gone in all is an odometer;
/// every node knows at which reading its answer may become another one.
#[derive(Debug, Clone, Default)]
pub(super) struct Front {
    nodes: Vec<u32>,
    due: Vec<f64>,
    /// What the nodes cover, here so that it is read in order.
    covers: Vec<Unpacked>,
}

impl Front {
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    pub fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// Adds a node, to be asked at once, and remembers where it is.
    #[inline]
    pub fn put(&mut self, place: &mut [u32], node: u32, cover: Cover) {
        place[node as usize] = self.nodes.len() as u32;
        self.nodes.push(node);
        self.due.push(f64::NEG_INFINITY);
        self.covers.push(cover.unpacked());
    }

    /// Takes a node out.
    #[inline]
    pub fn take(&mut self, place: &mut [u32], node: u32) {
        let at = std::mem::replace(&mut place[node as usize], NONE) as usize;
        self.nodes.swap_remove(at);
        self.due.swap_remove(at);
        self.covers.swap_remove(at);
        if let Some(&moved) = self.nodes.get(at) {
            place[moved as usize] = at as u32;
        }
    }

    /// The node at a place need not be asked before the odometer reads `due`.
    #[inline]
    pub fn put_off(&mut self, at: u32, due: f64) {
        self.due[at as usize] = due;
    }

    /// All are to be asked.
    pub fn ask_all(&mut self) {
        self.due.fill(f64::NEG_INFINITY);
    }

    /// All nodes, each with what `answer` says to what it covers. Shared among threads.
    pub fn ask_each<T: Send>(&self, answer: impl Fn(&Bounds) -> T + Sync) -> Vec<(T, u32)> {
        let each = self.nodes.par_iter().zip(&self.covers).with_min_len(BATCH);
        each.map(|(&node, cover)| (answer(&cover.bounds()), node))
            .collect()
    }

    /// The nodes to be asked when the odometer reads `now`, with what `answer`
    /// says to what they cover. Batches are shared among threads.
    pub fn ask<T: Send>(&self, now: f64, answer: impl Fn(&Bounds) -> T + Sync) -> Vec<(u32, T)> {
        let batch = |first: usize| {
            let end = (first + BATCH).min(self.len());
            let dues = self.due[first..end].iter().enumerate();
            let at = dues.filter(|d| *d.1 <= now).map(|d| first + d.0);
            at.map(|at| (self.nodes[at], answer(&self.covers[at].bounds())))
                .collect::<Vec<_>>()
        };
        if self.len() <= BATCH {
            return batch(0);
        }
        let firsts = (0..self.len().div_ceil(BATCH)).into_par_iter();
        firsts.flat_map_iter(|b| batch(b * BATCH)).collect()
    }
}
