//! Cuts a model into regions, by how many triangles have which keys.

use super::block::{Head, Sample};
use super::keys::{BITS, Scheme};
use super::load::loads;

/// First key of every region, the first of them 0. Regions have at most `limit` triangles,
/// unless more have the same key.
pub(super) fn cut(heads: &[Head], limit: u64, scheme: Scheme, level: u32, gone: f64) -> Vec<u64> {
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
        Scheme::Slabs => counts.swept(limit, level, &counts.before),
        Scheme::Sweep => {
            let sums = loads(&samples, gone).into_iter().scan(0, |sum, load| {
                *sum += load;
                Some(*sum)
            });
            let before: Vec<u64> = std::iter::once(0).chain(sums).collect();
            counts.swept(limit, level, &before)
        }
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

    /// As few slabs of equal weight as keep the limit, if any number does; `before` has
    /// the weight before each sample, and all. Slabs of odd levels begin with half a one.
    fn swept(&self, limit: u64, level: u32, before: &[u64]) -> Vec<u64> {
        let fewest = self.total().div_ceil(limit.max(1));
        let mut slabs = fewest;
        loop {
            let cuts = self.slabs(slabs, u64::from(level % 2), before);
            if self.largest(&cuts) <= limit || slabs >= MOST_SLABS * fewest {
                return cuts;
            }
            slabs += slabs.div_ceil(8);
        }
    }

    fn slabs(&self, slabs: u64, half: u64, before: &[u64]) -> Vec<u64> {
        let all = u128::from(before[before.len() - 1]);
        let mut cuts = vec![0];
        for slab in 1..slabs + half {
            let rank = (all * u128::from(2 * slab - half) / u128::from(2 * slabs)) as u64;
            let at = before.partition_point(|&b| b < rank);
            if let Some(&key) = self.keys.get(at).filter(|&&key| key > cuts[cuts.len() - 1]) {
                cuts.push(key);
            }
        }
        cuts
    }

    /// Triangles of the largest region.
    fn largest(&self, cuts: &[u64]) -> u64 {
        let ends = cuts.iter().skip(1).copied().chain([u64::MAX]);
        let sizes = cuts.iter().zip(ends);
        let sizes = sizes.map(|(&first, end)| self.below(end) - self.below(first));
        sizes.max().unwrap_or(0)
    }
}

/// How many times as many slabs as are needed at least are tried.
const MOST_SLABS: u64 = 16;

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
        let sample = |&key: &u64| Sample {
            key,
            triangles: 1,
            costs: [(key % 7) as u16; 8],
        };
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
            which in 0usize..3,
            level in 0u32..3,
        ) {
            let keys: Vec<u64> = keys.into_iter().collect();
            let scheme = [Scheme::Cells, Scheme::Slabs, Scheme::Sweep][which];
            let cuts = cut(&heads(&keys), limit, scheme, level, 0.5);
            prop_assert_eq!(cuts[0], 0);
            prop_assert!(cuts.is_sorted_by(|a, b| a < b));
            for (i, &first) in cuts.iter().enumerate() {
                let end = cuts.get(i + 1).copied().unwrap_or(u64::MAX);
                let inside = keys.iter().filter(|k| (first..end).contains(k)).count() as u64;
                prop_assert!(which > 0 || inside <= limit, "{} of {}", inside, limit);
                prop_assert!(inside < keys.len() as u64 || keys.len() as u64 <= limit.max(2));
            }
        }
    }

    #[test]
    fn equal_keys_stay_together() {
        let heads = heads(&[5; 100]);
        assert_eq!(cut(&heads, 10, Scheme::Cells, 0, 0.5).len(), 1);
        assert_eq!(cut(&heads, 10, Scheme::Slabs, 0, 0.5), [0, 5]);
    }
}
