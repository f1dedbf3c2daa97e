//! How many vertices have which cost.

use super::VertexCost;

/// Bits of an `f32` that are left out of a key: what remains are 8 bits of exponent and 8
/// of fraction, so that the costs of a bin are within 0.4 % of each other.
const DROPPED: u32 = 15;
/// Keys, those of infinity and NaN among them.
const KEYS: usize = 1 << 16;
/// Key of an infinite cost.
const INFINITE: u16 = (f32::INFINITY.to_bits() >> DROPPED) as u16;

/// Vertices by their cost, in 65,536 bins that are the same for all models.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CostHistogram {
    /// Vertices in each bin, cheapest first. Of all histograms as many.
    pub counts: Vec<u64>,
}

impl Default for CostHistogram {
    fn default() -> Self {
        Self {
            counts: vec![0; KEYS],
        }
    }
}

impl CostHistogram {
    /// The costs of a slice.
    #[must_use]
    pub fn of(costs: &[VertexCost]) -> Self {
        let mut histogram = Self::default();
        for cost in costs {
            histogram.counts[usize::from(key(cost.cost))] += 1;
        }
        histogram
    }

    /// Adds the vertices of other slices.
    pub fn merge(&mut self, other: &Self) {
        for (count, added) in self.counts.iter_mut().zip(&other.counts) {
            *count += added;
        }
    }

    /// Number of vertices.
    #[must_use]
    pub fn vertices(&self) -> u64 {
        self.counts.iter().sum()
    }

    /// The base value for deleting `share` (0 to 1) of the vertices: the cost at place
    /// floor(N share), counted from 1, when all are sorted.
    ///
    /// The paper sorts SC = max VC - VC downwards, which is VC upwards. Vertices in the
    /// bin of the base count as likely, as ties do there.
    #[must_use]
    pub fn base(&self, share: f64) -> Base {
        let vertices = self.vertices();
        // NaN becomes 0.
        let place = ((vertices as f64 * share).floor() as u64).min(vertices);
        if place == 0 {
            return Base { key: None };
        }
        let reached = self.counts.iter().scan(0, |sum, count| {
            *sum += count;
            Some(*sum)
        });
        let key = reached.take_while(|&sum| sum < place).count();
        Base {
            key: u16::try_from(key).ok(),
        }
    }
}

/// Which vertices are likely to go.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Base {
    /// The last bin of [`CostHistogram`] whose vertices are; `None` if there are none.
    pub key: Option<u16>,
}

impl Base {
    /// Whether a vertex of this cost is likely to go. One whose cost is not finite is not.
    #[must_use]
    pub fn is_likely(self, cost: f64) -> bool {
        let key = key(cost);
        key < INFINITE && self.key.is_some_and(|base| key <= base)
    }
}

/// The bin of a cost: greater costs never have lower ones.
fn key(cost: f64) -> u16 {
    if cost.is_nan() {
        return u16::MAX;
    }
    // Costs are never negative, so their bits are ordered as they are.
    ((cost as f32).abs().to_bits() >> DROPPED) as u16
}
