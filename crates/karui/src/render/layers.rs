//! Blended surfaces, sorted at every sample.

use super::band::{Band, key, samples, within};
use super::bins::Kind;
use super::pass::Pass;

/// Most blended surfaces seen at a sample; of more, the closest count.
pub(super) const MAX_LAYERS: usize = 32;

/// A blended surface at a sample of a band. The order is that of samples, then
/// from back to front.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Layer {
    pub slot: u32,
    pub key: u64,
}

/// All layers of a band that nothing solid hides, sorted.
pub(super) fn collect(layers: &mut Vec<Layer>, pass: &Pass<'_>, band: &Band, index: usize) {
    layers.clear();
    let limit = 2 * MAX_LAYERS * band.keys.len();
    let within = within(pass, index);
    for entry in pass.binned(index, Kind::Blended).flatten() {
        samples(pass, entry, &within, &mut |x, y, closeness| {
            let slot = band.slot(x, y);
            let key = key(closeness, entry.triangle);
            if key > band.keys[slot] {
                let slot = slot as u32;
                layers.push(Layer { slot, key });
            }
        });
        if layers.len() > limit {
            keep_closest(layers);
        }
    }
    keep_closest(layers);
}

/// Sorts, and drops what too many surfaces lie in front of. Which ones go does
/// not depend on when this is called.
fn keep_closest(layers: &mut Vec<Layer>) {
    layers.sort_unstable();
    layers.dedup();
    let (mut kept, mut start) = (0, 0);
    while start < layers.len() {
        let slot = layers[start].slot;
        let end = start + layers[start..].partition_point(|layer| layer.slot == slot);
        let first = start.max(end.saturating_sub(MAX_LAYERS));
        layers.copy_within(first..end, kept);
        kept += end - first;
        start = end;
    }
    layers.truncate(kept);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_closest_are_kept_whenever_the_rest_is_dropped() {
        let layer = |i: u64| Layer {
            slot: (i % 3) as u32,
            key: i * 7919 % 1009,
        };
        let mut at_once: Vec<Layer> = (0..600).map(layer).collect();
        let mut bit_by_bit = Vec::new();
        for i in 0..600 {
            bit_by_bit.push(layer(i));
            if i % 50 == 0 {
                keep_closest(&mut bit_by_bit);
            }
        }
        keep_closest(&mut at_once);
        keep_closest(&mut bit_by_bit);
        assert_eq!(at_once, bit_by_bit);
        assert_eq!(at_once.len(), 3 * MAX_LAYERS);
        assert!(at_once.is_sorted());
    }
}
