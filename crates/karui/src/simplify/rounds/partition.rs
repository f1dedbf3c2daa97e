//! Cuts the triangles into blocks of about equal size, and tells which points
//! lie on the cuts.

use super::block::{Block, Rules};
use super::level::Level;
use glam::Vec3;
use rayon::prelude::*;
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// Triangles of a block, about: a block and its scratch then fit in a
/// second-level cache of a megabyte.
const BLOCK: usize = 8192;
/// Triangles for every block that the cuts are chosen from: sizes then differ
/// by some 6 %, and no triangle is moved more than once.
const SAMPLE: usize = 256;
/// Triangles looked at by one task.
const TASK: usize = 1 << 14;

/// An owner of no block.
const FREE: u32 = u32::MAX;
/// An owner of more than one block.
const SHARED: u32 = u32::MAX - 1;
/// Set in the entry of a point while its block is being numbered.
const NUMBERED: u32 = 1 << 31;

/// The blocks of one phase.
pub(super) struct Cut {
    /// Triangles of every block, in order.
    pub blocks: Vec<Vec<u32>>,
    owner: Vec<AtomicU32>,
}

impl Cut {
    /// Cuts lie elsewhere in an odd `phase` than in an even one, so that what
    /// lies between blocks in one is inside them in the next.
    pub fn of(level: &Level, phase: usize) -> Self {
        let tree = Tree::of(level, phase);
        let owner: Vec<AtomicU32> = (0..level.position.len())
            .into_par_iter()
            .map(|_| AtomicU32::new(FREE))
            .collect();
        let leaf_of = |points: &[u32; 3]| {
            let leaf = tree.leaf(center(level, points));
            points.iter().for_each(|&p| claim(&owner[p as usize], leaf));
            leaf
        };
        let triangles = level.triangle.par_iter().with_min_len(TASK);
        let leaves: Vec<u32> = triangles.map(leaf_of).collect();
        Self {
            blocks: dealt(&leaves, tree.leaves),
            owner,
        }
    }

    /// All triangles as one block.
    pub fn whole(level: &Level) -> Self {
        let owner = level.position.iter().map(|_| AtomicU32::new(0));
        Self {
            blocks: vec![(0..level.triangle.len() as u32).collect()],
            owner: owner.collect(),
        }
    }

    /// Takes the blocks out of the level.
    pub fn into_blocks(mut self, level: &Level, rules: Rules) -> Vec<Block> {
        std::mem::take(&mut self.blocks)
            .into_par_iter()
            .map(|triangles| Block::new(level, &self, triangles, rules))
            .collect()
    }

    /// Whether several blocks have triangles at the point.
    pub fn is_shared(&self, p: u32) -> bool {
        self.owner[p as usize].load(Relaxed) == SHARED
    }

    /// Numbers the points of one block's triangles by first appearance;
    /// returns the triangles in these numbers and the points. A point inside
    /// keeps its number in its own entry, which no other block looks at, so
    /// that this works once a block.
    pub fn numbered(&self, level: &Level, origin: &[u32]) -> (Vec<[u32; 3]>, Vec<u32>) {
        let mut global = Vec::with_capacity(origin.len() * 5 / 8);
        let mut on_cuts = HashMap::<u32, u32, BuildHasherDefault<Spread>>::default();
        let mut number = |p: u32| {
            let entry = &self.owner[p as usize];
            let known = entry.load(Relaxed);
            if known == SHARED {
                return *on_cuts.entry(p).or_insert_with(|| {
                    global.push(p);
                    global.len() as u32 - 1
                });
            }
            if known & NUMBERED != 0 {
                return known ^ NUMBERED;
            }
            let new = global.len() as u32;
            global.push(p);
            entry.store(new | NUMBERED, Relaxed);
            new
        };
        let triangles = origin
            .iter()
            .map(|&t| level.triangle[t as usize].map(&mut number))
            .collect();
        (triangles, global)
    }
}

/// A hash of one number, cheaper than the standard one and nothing to attack:
/// these tables live for one block.
#[derive(Default)]
struct Spread(u64);

impl Hasher for Spread {
    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|&b| self.write_u32(b.into()));
    }

    fn write_u32(&mut self, number: u32) {
        let mixed = (self.0 ^ u64::from(number)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        self.0 = mixed ^ mixed >> 32;
    }

    fn finish(&self) -> u64 {
        self.0
    }
}

/// The first block to claim a point owns it; the second makes it shared. The
/// outcome does not depend on who comes first.
#[inline(always)]
fn claim(owner: &AtomicU32, block: u32) {
    let known = owner.load(Relaxed);
    if known == block || known == SHARED {
        return;
    }
    let claimed = owner.compare_exchange(FREE, block, Relaxed, Relaxed);
    if claimed.is_err_and(|other| other != block) {
        owner.store(SHARED, Relaxed);
    }
}

/// Three times the centre of a triangle.
#[inline(always)]
fn center(level: &Level, points: &[u32; 3]) -> Vec3 {
    let [a, b, c] = points.map(|p| level.place(p));
    a + b + c
}

/// The triangles of every leaf.
fn dealt(leaves: &[u32], count: usize) -> Vec<Vec<u32>> {
    let mut sizes = vec![0; count];
    leaves.iter().for_each(|&leaf| sizes[leaf as usize] += 1);
    let mut blocks: Vec<Vec<u32>> = sizes.into_iter().map(Vec::with_capacity).collect();
    for (t, &leaf) in leaves.iter().enumerate() {
        blocks[leaf as usize].push(t as u32);
    }
    blocks.retain(|block| !block.is_empty());
    blocks
}

/// A cut, or a leaf.
#[derive(Clone, Copy)]
struct Node {
    /// 3 for a leaf.
    axis: u32,
    at: f32,
    /// Node of the upper half, the lower being the next one; number of a leaf.
    upper: u32,
}

/// A k-d tree (Bentley 1975) over a sample of the triangles.
struct Tree {
    nodes: Vec<Node>,
    leaves: usize,
    /// Where the cuts lie, as a share.
    share: f64,
}

impl Tree {
    fn of(level: &Level, phase: usize) -> Self {
        let count = level.triangle.len();
        let parts = count.div_ceil(BLOCK).max(1);
        let stride = (count / (parts * SAMPLE)).max(1);
        // Off the stride by a hash, lest it fall in step with a grid.
        let pick = |i: usize| {
            let hash = (i as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32;
            let t = i * stride + hash as usize % stride;
            center(level, &level.triangle[t])
        };
        let picks = if parts == 1 { 0 } else { count / stride };
        let mut sample: Vec<Vec3> = (0..picks).map(pick).collect();
        let mut tree = Self {
            nodes: Vec::with_capacity(2 * parts),
            leaves: 0,
            share: if phase.is_multiple_of(2) { 0.5 } else { 0.36 },
        };
        tree.grow(&mut sample, parts as f64);
        tree
    }

    /// Cuts the sample of `parts` blocks' worth of triangles.
    fn grow(&mut self, sample: &mut [Vec3], parts: f64) {
        if parts <= 1.0 || sample.len() < 2 {
            self.nodes.push(Node {
                axis: 3,
                at: 0.0,
                upper: self.leaves as u32,
            });
            self.leaves += 1;
            return;
        }
        let axis = longest_axis(sample);
        let lower = self.lower(parts);
        let at = (sample.len() as f64 * lower / parts) as usize;
        let by_axis = |a: &Vec3, b: &Vec3| a[axis].total_cmp(&b[axis]);
        let (_, pivot, _) = sample.select_nth_unstable_by(at, by_axis);
        let here = self.nodes.len();
        self.nodes.push(Node {
            axis: axis as u32,
            at: pivot[axis],
            upper: 0,
        });
        let (low, high) = sample.split_at_mut(at);
        self.grow(low, lower);
        self.nodes[here].upper = self.nodes.len() as u32;
        self.grow(high, parts - lower);
    }

    /// Blocks under a cut of so many: whole ones in even phases, not so in odd
    /// ones, whose cuts are off the middle.
    fn lower(&self, parts: f64) -> f64 {
        if self.share == 0.5 {
            (parts * 0.5).round()
        } else {
            parts * self.share
        }
    }

    #[inline(always)]
    fn leaf(&self, center: Vec3) -> u32 {
        let mut i = 0;
        loop {
            let node = self.nodes[i];
            let place = match node.axis {
                0 => center.x,
                1 => center.y,
                2 => center.z,
                _ => return node.upper,
            };
            let upper = node.upper as usize;
            i = if place < node.at { i + 1 } else { upper };
        }
    }
}

fn longest_axis(sample: &[Vec3]) -> usize {
    let first = sample.first().copied().unwrap_or_default();
    let (least, most) = sample.iter().fold((first, first), |(least, most), &p| {
        (least.min(p), most.max(p))
    });
    let size = most - least;
    if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes;

    fn level() -> Level<'static> {
        let mesh = shapes::terrain(200, 150, 3);
        Level {
            position: mesh.positions.into(),
            scale: 1.0,
            triangle: mesh.triangles.into(),
            ..Level::default()
        }
    }

    #[test]
    fn blocks_are_even_and_hold_every_triangle_once() {
        let level = level();
        for phase in 0..2 {
            let cut = Cut::of(&level, phase);
            assert!(cut.blocks.len() >= 8, "{phase}");
            assert!(cut.blocks.iter().all(|b| b.len() < BLOCK * 5 / 4));
            let mut all: Vec<u32> = cut.blocks.concat();
            all.sort_unstable();
            assert!(all.into_iter().eq(0..level.triangle.len() as u32));
        }
    }

    #[test]
    fn points_of_several_blocks_are_shared() {
        let level = level();
        let cut = Cut::of(&level, 0);
        let mut blocks_at = vec![Vec::new(); level.position.len()];
        for (i, block) in cut.blocks.iter().enumerate() {
            for &p in block.iter().flat_map(|&t| &level.triangle[t as usize]) {
                if blocks_at[p as usize].last() != Some(&i) {
                    blocks_at[p as usize].push(i);
                }
            }
        }
        for (p, blocks) in blocks_at.iter().enumerate() {
            assert_eq!(cut.is_shared(p as u32), blocks.len() > 1, "{p}");
        }
        // The numbers do not depend on what was numbered before.
        for block in &cut.blocks {
            let (triangles, points) = cut.numbered(&level, block);
            let back = triangles.iter().map(|t| t.map(|p| points[p as usize]));
            assert!(back.eq(block.iter().map(|&t| level.triangle[t as usize])));
        }
    }
}
