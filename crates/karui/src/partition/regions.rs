//! Regions of equal load.

use super::{Division, Grid, Load, LoadHistogram};
use crate::{Error, Result};
use glam::Vec3;

/// Bits by which the cells of one level of an octree differ.
const OCTANT: u32 = 3;
/// Cells along all axes together, as bits.
const CELL_BITS: u32 = 30;

/// Places grouped into regions; every position belongs to exactly one, which integers
/// decide.
#[derive(Debug, Clone, PartialEq)]
pub struct Regions {
    /// What the places are.
    pub grid: Grid,
    /// First code of each region, ascending; the first is 0.
    pub starts: Vec<u32>,
    /// What each region holds.
    pub loads: Vec<Load>,
}

impl Regions {
    /// At most `regions` regions with as many edges likely to be collapsed each (step 4 of
    /// the paper); with as many vertices if no edge is likely to be.
    ///
    /// Where the paper ends a region once it has more than its share, so that what is too
    /// much adds up against the last, a region here ends as near as possible to where its
    /// share of the whole ends. Regions are cut between slabs; a slab is never cut.
    #[must_use]
    pub fn load_aware(histogram: &LoadHistogram, regions: usize) -> Self {
        if histogram.total().edges == 0 {
            return Self::equal_vertices(histogram, regions);
        }
        Self::cut(histogram, regions, |load| load.edges)
    }

    /// At most `regions` regions of as many vertices each, for comparison.
    #[must_use]
    pub fn equal_vertices(histogram: &LoadHistogram, regions: usize) -> Self {
        Self::cut(histogram, regions, |load| load.vertices)
    }

    /// Cells of an octree over a [`Division::Cells`], each split until it has at most
    /// `most` vertices; only a cell of the finest level, a 1024th of the model's side, may
    /// have more.
    ///
    /// # Errors
    /// [`Error::BadOption`] for a histogram along an axis.
    pub fn cells(histogram: &LoadHistogram, most: u64) -> Result<Self> {
        if histogram.grid.division != Division::Cells {
            return Err(Error::BadOption {
                option: "grid",
                found: format!("{:?}", histogram.grid.division),
                expected: "one of cells",
            });
        }
        let loads: Vec<_> = histogram.loads.iter().map(|(&c, &l)| (c, l)).collect();
        let mut starts = Vec::new();
        split(&loads, CELL_BITS, most, &mut starts);
        Ok(Self::from_starts(histogram, starts))
    }

    /// The region of a position, below [`Regions::len`].
    #[must_use]
    pub fn region_of(&self, position: Vec3) -> u32 {
        self.region_of_code(self.grid.code(position))
    }

    /// Number of regions, at least 1.
    #[must_use]
    pub fn len(&self) -> usize {
        self.starts.len()
    }

    /// Never: one region is there even without vertices.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.starts.is_empty()
    }

    fn region_of_code(&self, code: u32) -> u32 {
        let after = self.starts.partition_point(|&start| start <= code);
        after.saturating_sub(1) as u32
    }

    fn cut(histogram: &LoadHistogram, regions: usize, weight: impl Fn(&Load) -> u64) -> Self {
        let mut sum = 0;
        let sums: Vec<(u32, u64)> = histogram
            .loads
            .iter()
            .map(|(&code, load)| {
                sum += weight(load);
                (code, sum)
            })
            .collect();
        let regions = regions.clamp(1, sums.len().max(1));
        let mut starts = Vec::new();
        for k in 1..regions {
            // Rounded down, so that it is a whole number, as sums are.
            let target = (u128::from(sum) * k as u128 / regions as u128) as u64;
            let past = sums.partition_point(|&(_, s)| s < target);
            let before = past.checked_sub(1).map_or(0, |i| sums[i].1);
            let reached = sums.get(past).map_or(sum, |s| s.1);
            let ends = if target - before < reached - target {
                past
            } else {
                past + 1
            };
            starts.extend(sums.get(ends).map(|&(code, _)| code));
        }
        Self::from_starts(histogram, starts)
    }

    fn from_starts(histogram: &LoadHistogram, mut starts: Vec<u32>) -> Self {
        starts.push(0);
        starts.sort_unstable();
        starts.dedup();
        let first = histogram.loads.keys().next().copied();
        // A region before the first vertex would be empty.
        if starts.get(1).is_some_and(|&second| Some(second) <= first) {
            starts.remove(1);
        }
        let mut regions = Self {
            grid: histogram.grid,
            loads: vec![Load::default(); starts.len()],
            starts,
        };
        for (&code, &load) in &histogram.loads {
            let region = regions.region_of_code(code);
            regions.loads[region as usize].add(load);
        }
        regions
    }
}

/// Adds the first codes of the leaves of the octree over `loads`, whose codes agree but
/// for the lowest `bits`.
fn split(loads: &[(u32, Load)], bits: u32, most: u64, starts: &mut Vec<u32>) {
    let Some(&(first, _)) = loads.first() else {
        return;
    };
    let vertices: u64 = loads.iter().map(|(_, load)| load.vertices).sum();
    if vertices <= most || bits == 0 {
        starts.push(first >> bits << bits);
        return;
    }
    let bits = bits - OCTANT;
    for octant in loads.chunk_by(|(a, _), (b, _)| a >> bits == b >> bits) {
        split(octant, bits, most, starts);
    }
}
