//! Merging the pair that is most alike, again and again (section 3.5, figure 6).
//!
//! Every cluster knows its nearest partner at the time it last looked, and a queue
//! holds these pairs. What came to be later has looked itself, so the least pair
//! of all is always there, as it is or as an older one that is no greater; Omega
//! need not be reducible for that.

use super::finder::Finder;
use super::object::Object;
use super::omega::{OmegaOptions, Seen};
use super::queue::{Pair, Queue};
use super::thresholds::Steps;
use crate::error::Result;
use crate::progress::{Progress, step};
use rayon::prelude::*;

/// Clusters that looked, or merges, between two reports.
const REPORT: usize = 1 << 14;

/// Two clusters that became one. Clusters are numbered as they come to be: first
/// the pieces, then the merges.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Merge {
    /// The older one first.
    pub members: [u32; 2],
    pub omega: f64,
    /// Number of the threshold at which it happened.
    pub level: u32,
    /// What both are together.
    pub object: Object,
}

/// All merges of `pieces` below the last threshold, in order. The pair of least
/// Omega0 comes first; of several, that whose newer member is oldest, then that
/// whose older member is oldest.
///
/// # Errors
/// [`Error::Cancelled`](crate::Error::Cancelled).
pub(super) fn agglomerate(
    pieces: &[Object],
    options: &OmegaOptions,
    steps: Steps,
    progress: &dyn Progress,
) -> Result<Vec<Merge>> {
    step(progress, "neighbours", 0.0)?;
    let seen: Vec<Seen> = pieces
        .par_iter()
        .map(|&piece| Seen::new(piece, options))
        .collect();
    let mut finder = Finder::new(&seen, options);
    drop(seen);
    let limit = steps.limit().unwrap_or(f64::INFINITY);
    let look = |finder: &Finder<'_>, cluster: u32| {
        let found = finder.nearest(cluster, limit)?;
        Some(Pair::new(found.omega, cluster, found.cluster))
    };
    let mut pairs = Vec::new();
    for start in (0..pieces.len()).step_by(REPORT) {
        step(progress, "neighbours", start as f32 / pieces.len() as f32)?;
        let end = pieces.len().min(start + REPORT);
        let clusters = (start as u32..end as u32).into_par_iter();
        pairs.par_extend(clusters.filter_map(|cluster| look(&finder, cluster)));
    }
    let mut queue = Queue::new(pairs);
    let mut rising = steps.rising();
    let mut merges: Vec<Merge> = Vec::new();
    while let Some(pair) = queue.pop(|pair| finder.is_active(pair.owner)) {
        if !finder.is_active(pair.owner) {
            continue;
        }
        if !finder.is_active(pair.partner()) {
            if let Some(next) = look(&finder, pair.owner) {
                queue.push(next);
            }
            continue;
        }
        let Some(level) = rising.until_above(pair.omega) else {
            break;
        };
        if merges.len().is_multiple_of(REPORT) {
            step(
                progress,
                "merging",
                merges.len() as f32 / pieces.len() as f32,
            )?;
        }
        let members = [pair.older, pair.newer];
        let [a, b] = members.map(|m| finder.seen(m));
        let merged = a.merged(b, options);
        merges.push(Merge {
            members,
            omega: pair.omega,
            level,
            object: merged.object,
        });
        finder.merge(members, merged);
        let newest = (pieces.len() + merges.len() - 1) as u32;
        if let Some(next) = look(&finder, newest) {
            queue.push(next);
        }
    }
    Ok(merges)
}
