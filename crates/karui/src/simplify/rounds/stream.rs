//! A phase of a surface of very many blocks: thresholds are taken from a
//! sample of them, and the others go by these, each through all rounds at once
//! while it is in the cache, a group after another. Few blocks are there at
//! any time, and of a block that is done only what is left.

use super::block::{Block, Rules};
use super::level::{Joint, Level};
use super::partition::Cut;
use super::repair::Guard;
use super::round::BINS;
use super::{Run, Step};
use crate::error::Result;
use crate::progress::Silent;
use crate::simplify::exact::Target;
use crate::simplify::refused::Refused;
use rayon::prelude::*;

/// Blocks up to which all are looked at together.
pub(super) const FEW: usize = 64;
/// Blocks that the thresholds are taken from.
const SAMPLE: usize = 32;
/// Blocks at work at a time, for every thread.
const GROUP: usize = 16;

impl Run<'_> {
    /// One phase, which ends about halfway to the target.
    pub(super) fn stream<'a>(
        &mut self,
        mut level: Level<'a>,
        mut cut: Cut,
        rules: Rules,
    ) -> Result<Level<'a>> {
        let (sample, mut rest) = sampled(std::mem::take(&mut cut.blocks));
        self.refused = Refused::default();
        let mut joint = Joint::of(&level);
        let mut alive = level.triangle.len();
        let take = |level: &Level, origin| Block::new(level, &cut, origin, rules);

        let mut blocks: Vec<Block> = sample
            .into_par_iter()
            .map(|origin| take(&level, origin))
            .collect();
        let steps = self.sample_phase(&mut blocks, alive)?;
        let looked_at = blocks.iter().map(|b| b.triangle.len()).sum::<usize>();
        let times = alive as f64 / looked_at.max(1) as f64;
        alive -= self.join(&mut joint, &mut level, &blocks);
        joint.reserve(times);
        drop(blocks);
        let size = GROUP * rayon::current_num_threads();
        // In the same order for groups of any size.
        rest.reverse();
        while !rest.is_empty() {
            self.report(alive)?;
            let group = rest.split_off(rest.len().saturating_sub(size));
            let guard = self.guard_at(alive);
            let run = |bins: &mut Vec<u32>, origin| {
                let mut block = take(&level, origin);
                block.follow(&steps, bins, guard);
                block
            };
            let blocks: Vec<Block> = group
                .into_par_iter()
                .rev()
                .map_init(|| vec![0; BINS], run)
                .collect();
            alive -= self.join(&mut joint, &mut level, &blocks);
        }
        Ok(joint.done(level))
    }

    /// The rounds of the phase over some blocks of a surface of `all`
    /// triangles.
    fn sample_phase(&mut self, blocks: &mut [Block], all: usize) -> Result<Vec<Step>> {
        let start = blocks.iter().map(|b| b.alive).sum::<usize>();
        let share = start as f64 / all as f64;
        let mut part = Run {
            target: Target {
                triangles: (self.target.triangles as f64 * share) as usize,
                ..self.target
            },
            progress: &Silent,
            start,
            ..*self
        };
        let steps = part.phase(blocks)?;
        self.guard = part.guard;
        Ok(steps)
    }

    /// Joins blocks that are done; returns how many triangles are gone.
    fn join(&mut self, joint: &mut Joint, level: &mut Level, blocks: &[Block]) -> usize {
        joint.add(level, blocks);
        blocks.iter().for_each(|block| self.count(block));
        blocks.iter().map(|b| b.triangle.len() - b.alive).sum()
    }
}

/// Some blocks from all over the surface, and the others.
fn sampled(blocks: Vec<Vec<u32>>) -> (Vec<Vec<u32>>, Vec<Vec<u32>>) {
    let stride = (blocks.len() / SAMPLE).max(1);
    let (mut sample, mut rest) = (Vec::new(), Vec::new());
    for (i, block) in blocks.into_iter().enumerate() {
        if i % stride == stride / 2 {
            sample.push(block);
        } else {
            rest.push(block);
        }
    }
    (sample, rest)
}

impl Block {
    /// Goes through the rounds that others went through.
    fn follow(&mut self, steps: &[Step], bins: &mut [u32], guard: Option<Guard<'_>>) {
        for step in steps {
            bins.fill(0);
            self.look(bins);
            step.take(self, bins, guard);
        }
    }
}
