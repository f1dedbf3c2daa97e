//! How many triangles each region may keep.

use super::block::Head;
use super::borders::region_of;
use super::load::{distance, is_known};

/// A region's part.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Share {
    /// Triangles that it has.
    pub triangles: u64,
    /// Triangles that it may keep.
    pub target: u64,
}

/// Steps in which the price of a block counts.
const STEPS: f64 = (1u64 << 24) as f64;

/// Times the mean that a sample counts at most.
const MOST: f64 = 64.0;

/// Deals `target` triangles to the regions.
///
/// The error of a surface falls as the inverse of its triangles. What a block has been
/// simplified to with error e would thus, at error 1, have e times as many triangles: regions
/// get theirs in proportion, so that all end with about the same error. Before the first
/// level it is what collapses cost at first that counts, and that only half: noise of the
/// surface says little of what is below it.
pub(super) fn share(heads: &[Head], cuts: &[u64], target: u64) -> Vec<Share> {
    let dearest = heads.iter().map(|h| h.price).fold(0.0, f64::max);
    let mean = if is_known(heads) { mean(heads) } else { 0.0 };
    let mut shares = vec![Share::default(); cuts.len()];
    let mut wants = vec![0u128; cuts.len()];
    for head in heads {
        for sample in &head.samples {
            let price = if dearest > 0.0 {
                head.price / dearest
            } else if mean > 0.0 {
                (1.0 + (distance(sample) / mean).min(MOST)) / 2.0
            } else {
                1.0
            };
            let region = region_of(cuts, sample.key);
            shares[region].triangles += u64::from(sample.triangles);
            wants[region] += (1 + (price * STEPS) as u128) * u128::from(sample.triangles);
        }
    }
    deal(&mut shares, &wants, target);
    shares
}

/// Mean over all triangles of what collapses cost, model units.
fn mean(heads: &[Head]) -> f64 {
    let samples = || heads.iter().flat_map(|h| &h.samples);
    let triangles: u64 = samples().map(|s| u64::from(s.triangles)).sum();
    let sum: f64 = samples()
        .map(|s| distance(s) * f64::from(s.triangles))
        .sum();
    sum / triangles.max(1) as f64
}

/// In proportion to what is wanted; who wants more than there is keeps all, and the rest
/// is dealt to the others.
fn deal(shares: &mut [Share], wants: &[u128], target: u64) {
    let mut open: Vec<usize> = (0..shares.len()).collect();
    let mut left = u128::from(target);
    loop {
        let sum = open.iter().map(|&r| wants[r]).sum::<u128>().max(1);
        let fits = |r: usize| wants[r] * left <= u128::from(shares[r].triangles) * sum;
        let (inside, full): (Vec<usize>, Vec<usize>) = open.into_iter().partition(|&r| fits(r));
        if full.is_empty() {
            // Rounded where the sums are, so that the parts add up.
            let mut before = 0;
            for r in inside {
                let after = before + wants[r];
                shares[r].target = (after * left / sum - before * left / sum) as u64;
                before = after;
            }
            return;
        }
        for r in full {
            shares[r].target = shares[r].triangles;
            left = left.saturating_sub(u128::from(shares[r].triangles));
        }
        open = inside;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn all_is_dealt_and_nobody_gets_more_than_it_has(
            regions in prop::collection::vec((1u64..1000, 1u128..100), 1..30),
            part in 0.0f64..1.0,
        ) {
            let triangles: u64 = regions.iter().map(|r| r.0).sum();
            let target = (triangles as f64 * part) as u64;
            let share = |r: &(u64, u128)| Share { triangles: r.0, target: 0 };
            let mut shares: Vec<Share> = regions.iter().map(share).collect();
            let wants: Vec<u128> = regions.iter().map(|r| r.1 * u128::from(r.0)).collect();
            deal(&mut shares, &wants, target);
            prop_assert_eq!(shares.iter().map(|s| s.target).sum::<u64>(), target);
            // Rounding may lift one by one.
            prop_assert!(shares.iter().all(|s| s.target <= s.triangles + 1));
        }
    }
}
