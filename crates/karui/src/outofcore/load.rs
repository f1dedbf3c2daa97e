//! How dear and how much the work is where, told before it is done.
//!
//! Costs are VC of the paper ([`partition::vertex_costs`]), as 16 bits that keep their order.

use super::block::{COSTS, Head, Sample};
use crate::error::Result;
use crate::partition;
use glam::Vec3;

/// Bits of an `f32` that are left out.
const DROPPED: u32 = 16;

/// Cost at every vertex of a slice. On its rim planes are missing.
///
/// # Errors
/// None for triangles whose vertices exist.
pub(super) fn costs(positions: &[Vec3], triangles: &[[u32; 3]]) -> Result<Vec<u16>> {
    let costs = partition::vertex_costs(positions, triangles, 0..positions.len())?;
    // Costs are not negative, so their bits are ordered as they are; 0 says that nobody has
    // looked.
    let key = |cost: f64| ((cost.abs() as f32).to_bits() >> DROPPED).max(1) as u16;
    Ok(costs.iter().map(|c| key(c.cost)).collect())
}

/// Mean distance that a sample's collapses cost, model units.
pub(super) fn distance(sample: &Sample) -> f64 {
    let value = |key: &u16| f64::from(f32::from_bits(u32::from(*key) << DROPPED)).sqrt();
    sample.costs.iter().map(value).sum::<f64>() / COSTS as f64
}

/// Of the work on a triangle, what is done once for each, and what is done in every round
/// for those that stay, as measured on land whose one half is flat.
const ONCE: u64 = 3;
const STAYING: u64 = 4;

/// How much work every sample is likely to be if the share `gone` of all is collapsed: the
/// base value of the paper tells which vertices go. Where the paper counts these, what
/// takes time here is what stays, which is priced again in every round.
pub(super) fn loads(samples: &[Sample], gone: f64) -> Vec<u64> {
    let mut counts = vec![0u64; 1 << DROPPED];
    for sample in samples {
        for &key in &sample.costs {
            counts[usize::from(key)] += u64::from(sample.triangles);
        }
    }
    let all: u64 = counts.iter().sum();
    let place = (all as f64 * gone) as u64;
    let mut sum = 0;
    let base = counts.iter().position(|count| {
        sum += count;
        sum >= place
    });
    let base = base.unwrap_or(0);
    let stays = |s: &Sample| {
        s.costs
            .iter()
            .filter(|&&key| usize::from(key) > base)
            .count()
    };
    let load = |s: &Sample| ONCE * COSTS as u64 + STAYING * stays(s) as u64;
    samples
        .iter()
        .map(|s| u64::from(s.triangles) * load(s))
        .collect()
}

/// Whether somebody has looked.
pub(super) fn is_known(heads: &[Head]) -> bool {
    let mut samples = heads.iter().flat_map(|h| &h.samples);
    samples.any(|s| s.costs != [0; COSTS])
}
