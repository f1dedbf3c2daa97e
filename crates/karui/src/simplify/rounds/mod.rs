//! The round-based driver: the surface is cut into blocks that fit a core's
//! cache; every block prices all its edges, a threshold is taken from the
//! prices of all blocks together, and what is under it collapses, block by
//! block, in parallel. Points on the cuts stay until the next cut, which runs
//! elsewhere.
//!
//! What is chosen depends on the mesh and the options alone, so the result is
//! the same for any number of threads.

mod against;
mod block;
mod collapse;
mod fan;
mod feature;
mod hub;
mod input;
mod lanes;
mod level;
mod mend;
mod paint;
mod partition;
mod planes;
mod price;
mod record;
mod repaint;
mod repair;
mod repeat;
mod round;
mod star;
mod stream;
mod suspects;
mod sym3;
mod topology;

pub(crate) use block::Rules;
pub(crate) use input::Input;
pub(crate) use level::Level;
pub(crate) use paint::Values;
pub(crate) use record::{Collapse, Place};
pub(crate) use repeat::Repeat;

use super::exact::Target;
use super::options::{Blocked, Stopped, TopologyChanges};
use super::refused::Refused;
use crate::error::Result;
use crate::progress::{Progress, step};
use block::Block;
use partition::Cut;
use rayon::prelude::*;
use repair::Guard;
use round::{BINS, upper_end};
use topology::Limits;

/// Share of the edges looked at that may collapse in one round.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pace {
    /// Largest share of the edges in one round.
    pub share: f64,
}

/// A phase ends when this share of its triangles is left: blocks have become
/// small then and what lies between them counts.
const PHASE: f64 = 0.4;
/// Triangles to go under which blocks take turns, so as to end on the count.
const LAST: usize = 512;
/// Topology may change once the surface has come down to one in so many of
/// the input's triangles: before, next to nothing would come of it.
const EASE_FROM: usize = 5;
/// Then a phase ends when this share of its triangles is left...
const EASE_PHASE: f64 = 0.6;
/// ...or when collapses have become so many times as dear.
const EASE_PRICE: f32 = 4.0;
/// A round that collapses less than one in so many of the edges it should has moved next to
/// nothing...
const FEW_MOVED: usize = 32;
/// ...and after so many of them in a row, rounds go on with dearer edges instead: where most are
/// refused, there would else be as many rounds as collapses.
const PATIENCE: usize = 8;
/// A phase that takes less than one in so many triangles is idle: what is left to
/// collapse then is not worth a new cut.
const IDLE: usize = 512;

/// Triangles, as a multiple of the target, from which on every collapse is
/// checked against the input. What is left of what came before is mended.
const GUARDED: usize = 3;
/// Triangles below which all are checked whatever the target.
const FEW_LEFT: usize = 4096;
/// Once one in so many of the input's triangles are left, some are small
/// beside the others where the input is tangled...
const DEEP: usize = 128;
/// ...which are those whose squared side is at most this much of the mean area
/// of a triangle. To doubt how they turn would leave knots that nothing
/// dissolves, and the triangles to go would be taken from the rest.
const SMALL: f32 = 0.1;

/// How far a run came.
pub(crate) struct Ran<'a> {
    pub level: Level<'a>,
    pub error: f32,
    pub collapses: usize,
    pub stopped: Stopped,
    pub blocked: Blocked,
    pub changes: TopologyChanges,
}

struct Run<'a> {
    target: Target,
    pace: Pace,
    input: &'a Input<'a>,
    guard: Option<Guard<'a>>,
    progress: &'a dyn Progress,
    start: usize,
    /// Triangles of the input.
    whole: usize,
    error: f32,
    collapses: usize,
    refused: Refused,
    /// Largest price paid.
    paid: f32,
    /// Whether topology may change, of so few triangles.
    eases: bool,
    changes: TopologyChanges,
}

/// Simplifies `level` to `target`.
///
/// # Errors
/// [`Error::Cancelled`](crate::Error::Cancelled).
pub(crate) fn run<'a>(
    level: Level<'a>,
    target: Target,
    pace: Pace,
    rules: Rules,
    input: &Input<'_>,
    progress: &dyn Progress,
) -> Result<Ran<'a>> {
    let mut ran = collapse(level, target, pace, rules, input, progress)?;
    ran.level = input.repaired(ran.level, rules)?;
    Ok(ran)
}

fn collapse<'a>(
    mut level: Level<'a>,
    target: Target,
    pace: Pace,
    rules: Rules,
    input: &Input<'_>,
    progress: &dyn Progress,
) -> Result<Ran<'a>> {
    let mut run = Run {
        target,
        pace,
        guard: input.guard()?,
        input,
        progress,
        start: level.triangle.len(),
        whole: level.input,
        error: 0.0,
        collapses: 0,
        refused: Refused::default(),
        paid: 0.0,
        eases: false,
        changes: TopologyChanges::default(),
    };
    let mut idle = 0;
    for phase in 0.. {
        if level.triangle.len() <= target.triangles || idle == 2 {
            break;
        }
        let (before, few) = (run.collapses, level.triangle.len() / IDLE);
        run.eases = rules.ease && level.triangle.len() * EASE_FROM <= level.input;
        let cut = Cut::of(&level, phase);
        level = if cut.blocks.len() > stream::FEW && run.halfway(level.triangle.len()).is_some() {
            run.stream(level, cut, rules)?
        } else {
            let mut blocks = cut.into_blocks(&level, rules);
            run.phase(&mut blocks)?;
            level.join(&blocks)
        };
        // Of two cuts one has every point inside a block.
        idle = match run.collapses - before > few {
            true => 0,
            false => idle + 1,
        };
        if run.eases && run.ease(&mut level, &rules) {
            idle = 0;
        }
    }
    Ok(Ran {
        error: run.error,
        collapses: run.collapses,
        stopped: run.reason(level.triangle.len()),
        blocked: run.refused.blocked,
        changes: run.changes,
        level,
    })
}

impl Run<'_> {
    /// Triangles at which a phase from so many ends short of the target, if it
    /// does. Never the last of two cuts: what lies on it would stay dense.
    fn halfway(&self, start: usize) -> Option<usize> {
        let middle = (start as f64 * self.target.triangles as f64).sqrt();
        let share = if self.eases { EASE_PHASE } else { PHASE };
        let enough = middle.max(start as f64 * share) as usize;
        (enough > self.target.triangles + start / 10).then_some(enough)
    }

    /// The guard, if collapses are to be checked at so many triangles.
    fn guard_at(&self, alive: usize) -> Option<Guard<'_>> {
        let target = self.target.triangles;
        let near = alive <= FEW_LEFT.max(target.saturating_mul(GUARDED));
        let near = near || target == 0;
        self.guard.map(|guard| Guard {
            all: guard.all && near,
            ..guard
        })
    }

    /// Rounds over these blocks until the target is met, the phase's share is
    /// done or nothing happens any more. Returns what each round did.
    fn phase(&mut self, blocks: &mut [Block]) -> Result<Vec<Step>> {
        let stuck: Vec<usize> = blocks.par_iter().map(Block::stuck).collect();
        let (stuck, start) = (stuck.iter().sum::<usize>(), all_alive(blocks));
        let enough = match start - stuck {
            // The others must not come down for these: the next cut may free them.
            free if stuck > 0 && free > 0 => Some(stuck + (free as f64 * PHASE) as usize),
            _ => self.halfway(start),
        };
        let enough = enough.filter(|_| blocks.len() > 1 || self.eases);
        let dear = EASE_PRICE * self.paid;
        let least = enough.unwrap_or(0).max(self.target.triangles);
        let mut steps: Vec<Step> = Vec::new();
        let mut idle = 0;
        loop {
            let alive = all_alive(blocks);
            if alive <= least {
                break;
            }
            self.report(alive)?;
            let Some(round) = self.round(blocks, alive, idle >= PATIENCE) else {
                break;
            };
            idle = if round.few { idle + 1 } else { 0 };
            steps.push(round);
            if self.guard.is_none() && blocks.iter().any(|b| b.asks) {
                self.guard = self.input.guard_if_asked()?;
            }
            self.paid = self.paid.max(upper_end(round.bin));
            if self.eases && dear > 0.0 && self.paid > dear {
                break;
            }
        }
        self.refused = Refused::default();
        blocks.iter().for_each(|b| self.count(b));
        Ok(steps)
    }

    /// Changes the topology where that is cheap; whether it did.
    fn ease(&mut self, level: &mut Level<'_>, rules: &Rules) -> bool {
        let limits = Limits {
            price: self.paid,
            weights: level.weights(),
            error: rules.max_error,
            triangles: self.target.triangles,
            lock_borders: rules.lock_borders,
        };
        if level.triangle.len() <= limits.triangles {
            return false;
        }
        let changes = level.ease(&limits);
        self.changes.add(&changes);
        changes != TopologyChanges::default()
    }

    fn report(&self, alive: usize) -> Result<()> {
        let done = self.start.saturating_sub(alive);
        let span = (self.start - self.target.triangles.min(self.start)).max(1);
        step(self.progress, "collapse", done as f32 / span as f32)
    }

    /// Counts what a block did.
    fn count(&mut self, block: &Block) {
        self.error = self.error.max(block.error);
        self.collapses += block.collapses;
        self.refused.add(&block.refused);
    }

    /// One round, if `eager` with ever dearer edges until enough have collapsed; none if none
    /// has.
    fn round(&self, blocks: &mut [Block], alive: usize, eager: bool) -> Option<Step> {
        let small = if alive * DEEP < self.whole {
            SMALL
        } else {
            0.0
        };
        let bins: Vec<Vec<u32>> = blocks
            .par_iter_mut()
            .map(|block| {
                block.small = small * block.area / block.alive.max(1) as f32;
                let mut bins = vec![0; BINS];
                block.look(&mut bins);
                bins
            })
            .collect();
        let mut counts = vec![0; BINS];
        for bins in &bins {
            let both = counts.iter_mut().zip(bins);
            both.for_each(|(count, &own)| *count += own as usize);
        }
        let edges: usize = counts.iter().sum();
        let collapses = |blocks: &[Block]| blocks.iter().map(|b| b.collapses).sum::<usize>();
        let before = collapses(blocks);
        let excess = alive - self.target.triangles;
        let last = excess <= LAST.max(alive / 32);
        let wanted = (self.pace.share * edges as f64) as usize;
        let guard = self.guard_at(alive);
        let mut wish = if last { excess } else { wanted.min(excess / 2) }.max(1);
        let few = before + (wish / FEW_MOVED).max(1);
        // A round that moves nothing is gone on with at dearer edges.
        let enough = if eager { few } else { before + 1 };
        let mut taken = None;
        while let Some(bin) = quantile(&counts, wish) {
            let threshold = upper_end(bin);
            let under = |counts: &[usize]| counts[..=bin].iter().sum::<usize>();
            let alive = all_alive(blocks);
            let most = wish.min((alive - self.target.triangles) / 2).max(1);
            let share = (most as f64 / under(&counts).max(1) as f64).min(1.0);
            let mut step = Step {
                bin,
                share,
                few: false,
            };
            if last {
                self.take_turns(blocks, threshold, alive, guard);
            } else {
                let both = blocks.par_iter_mut().zip(&bins);
                both.for_each(|(block, bins)| step.take(block, bins, guard));
            }
            let moved = collapses(blocks);
            step.few = moved < few;
            if moved > before {
                taken = Some(step);
            }
            if moved >= enough || wish >= edges || all_alive(blocks) <= self.target.triangles {
                break;
            }
            wish *= 4;
        }
        taken
    }

    /// Collapses the cheapest edges of all blocks one after another, to end on
    /// the count asked for.
    fn take_turns(
        &self,
        blocks: &mut [Block],
        threshold: f32,
        mut alive: usize,
        guard: Option<Guard<'_>>,
    ) {
        let mut all: Vec<(u32, u32, u32)> = Vec::new();
        for (i, block) in blocks.iter().enumerate() {
            let under = block.under(threshold).into_iter();
            all.extend(under.map(|(price, half_edge)| (price, i as u32, half_edge)));
        }
        all.sort_unstable();
        for (_, i, half_edge) in all {
            if alive <= self.target.triangles {
                break;
            }
            let block = &mut blocks[i as usize];
            alive -= block.alive;
            block.attempt(half_edge, threshold, guard);
            alive += block.alive;
        }
    }

    fn reason(&self, triangles: usize) -> Stopped {
        let b = self.refused.blocked;
        if triangles <= self.target.triangles {
            Stopped::Target
        } else if self.refused.by_error >= b.flips.max(b.locked).max(b.topology).max(1) {
            Stopped::ErrorBound
        } else {
            b.reason()
        }
    }
}

/// What a round did in every block.
#[derive(Debug, Clone, Copy)]
struct Step {
    /// Bin of prices up to which edges might collapse.
    bin: usize,
    /// How many of those did at most, as a share.
    share: f64,
    /// Whether next to nothing collapsed.
    few: bool,
}

impl Step {
    fn take(self, block: &mut Block, bins: &[u32], guard: Option<Guard<'_>>) {
        let own: u32 = bins[..=self.bin].iter().sum();
        let most = (f64::from(own) * self.share).ceil() as usize;
        block.collapse_under(upper_end(self.bin), most, guard);
    }
}

fn all_alive(blocks: &[Block]) -> usize {
    blocks.iter().map(|b| b.alive).sum()
}

/// The bin up to which about `wish` edges lie; none if there is no edge.
fn quantile(counts: &[usize], wish: usize) -> Option<usize> {
    let mut sum = 0;
    let mut last = None;
    for (bin, &count) in counts.iter().enumerate().filter(|c| *c.1 > 0) {
        if last.is_some() && sum + count > wish {
            break;
        }
        sum += count;
        last = Some(bin);
    }
    last
}
