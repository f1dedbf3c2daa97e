//! Cuts a model into regions, by how many triangles have which keys.

use super::block::{Head, Sample};
use super::keys::{BITS, Scheme};

/// First key of every region, the first of them 0. Regions have at most `limit` triangles,
/// unless more have the same key.
pub(super) fn cut(heads: &[Head], limit: u64, scheme: Scheme, level: u32) -> Vec<u64> {
    let mut samples: Vec<Sample> = heads.iter().flat_map(|h| h.samples.clone()).collect();
    samples.sort_unstable();
    let counts = Counts::of(&samples);
    if counts.total() <= limit {
        return vec![0];
    }
    match scheme {
        Scheme::Cells => {
            let mut cells = Vec::new();
            counts.halve(0, BITS, limit, &mut cells);
            joined(&cells, limit)
        }
        Scheme::Sweep => counts.swept(limit, level),
    }
}

struct Counts {
    keys: Vec<u64>,
    /// Triangles before each key, and all.
    before: Vec<u64>,
}

impl Counts {
    fn of(samples: &[Sample]) -> Self {
        let mut before = vec![0];
        let mut sum = 0;
        for sample in samples {
            sum += u64::from(sample.triangles);
            before.push(sum);
        }
        Self {
            keys: samples.iter().map(|s| s.key).collect(),
            before,
        }
    }

    fn total(&self) -> u64 {
        self.before[self.keys.len()]
    }

    /// Triangles with keys before this.
    fn below(&self, key: u64) -> u64 {
        self.before[self.keys.partition_point(|&k| k < key)]
    }

    /// Halves the cell of keys that agree with `first` but for so many bits until the limit
    /// is kept; adds first key and triangles of what is not empty.
    fn halve(&self, first: u64, bits: u32, limit: u64, cells: &mut Vec<(u64, u64)>) {
        let triangles = self.below(first + (1 << bits)) - self.below(first);
        if triangles == 0 {
            return;
        }
        if triangles <= limit || bits == 0 {
            cells.push((first, triangles));
            return;
        }
        self.halve(first, bits - 1, limit, cells);
        self.halve(first + (1 << (bits - 1)), bits - 1, limit, cells);
    }

    /// Slabs of equal count; those of odd levels begin with half a one.
    fn swept(&self, limit: u64, level: u32) -> Vec<u64> {
        let slabs = self.total().div_ceil(limit.max(1));
        let half = u64::from(level % 2);
        let mut cuts = vec![0];
        for slab in 1..slabs + half {
            let rank = self.total() * (2 * slab - half) / (2 * slabs);
            let at = self.before.partition_point(|&b| b < rank);
            if let Some(&key) = self.keys.get(at).filter(|&&key| key > cuts[cuts.len() - 1]) {
                cuts.push(key);
            }
        }
        cuts
    }
}

/// Neighbours that are small together become one region.
fn joined(cells: &[(u64, u64)], limit: u64) -> Vec<u64> {
    let mut cuts = Vec::new();
    let mut sum = u64::MAX;
    for &(first, triangles) in cells {
        if sum.saturating_add(triangles) > limit / 2 {
            cuts.push(first);
            sum = 0;
        }
        sum += triangles;
    }
    cuts[0] = 0;
    cuts
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn heads(keys: &[u64]) -> Vec<Head> {
        let sample = |&key: &u64| Sample { key, triangles: 1 };
        let head = |keys: &[u64]| Head {
            samples: keys.iter().map(sample).collect(),
            ..Head::default()
        };
        keys.chunks(7).map(head).collect()
    }

    proptest! {
        #[test]
        fn regions_keep_the_limit_and_leave_nothing_out(
            keys in prop::collection::btree_set(0u64..1 << BITS, 1..200),
            limit in 1u64..40,
            sweep: bool,
            level in 0u32..3,
        ) {
            let keys: Vec<u64> = keys.into_iter().collect();
            let scheme = if sweep { Scheme::Sweep } else { Scheme::Cells };
            let cuts = cut(&heads(&keys), limit, scheme, level);
            prop_assert_eq!(cuts[0], 0);
            prop_assert!(cuts.is_sorted_by(|a, b| a < b));
            for (i, &first) in cuts.iter().enumerate() {
                let end = cuts.get(i + 1).copied().unwrap_or(u64::MAX);
                let inside = keys.iter().filter(|k| (first..end).contains(k)).count() as u64;
                prop_assert!(inside <= limit + 1, "{} of {}", inside, limit);
            }
        }
    }

    #[test]
    fn equal_keys_stay_together() {
        let heads = heads(&[5; 100]);
        assert_eq!(cut(&heads, 10, Scheme::Cells, 0).len(), 1);
        assert_eq!(cut(&heads, 10, Scheme::Sweep, 0), [0, 5]);
    }
}
