//! How much work is where.

use super::{Base, Grid, VertexCost};
use crate::{Error, Result};
use glam::Vec3;
use std::collections::BTreeMap;

/// Edges of one vertex that count. The work of a vertex with very many is done at their
/// other ends, which are elsewhere and counted there.
const EDGES: u32 = 64;

/// What is in a place.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Load {
    /// Vertices (V).
    pub vertices: u64,
    /// Vertices that are likely to go (QV).
    pub likely: u64,
    /// Edges of these (QL), at most 64 a vertex.
    pub edges: u64,
}

impl Load {
    /// Adds another place.
    pub fn add(&mut self, other: Self) {
        self.vertices += other.vertices;
        self.likely += other.likely;
        self.edges += other.edges;
    }

    /// Share of the vertices to delete (step 5 of the paper), 0 to 1.
    #[must_use]
    pub fn ratio(self) -> f64 {
        self.likely as f64 / self.vertices.max(1) as f64
    }
}

/// Load by place.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadHistogram {
    /// What the places are.
    pub grid: Grid,
    /// Load at each code of the grid that has a vertex.
    pub loads: BTreeMap<u32, Load>,
}

impl LoadHistogram {
    /// No vertices yet.
    #[must_use]
    pub fn empty(grid: Grid) -> Self {
        let loads = BTreeMap::new();
        Self { grid, loads }
    }

    /// The vertices of a slice; positions beyond the costs, or costs beyond the positions,
    /// are left aside.
    #[must_use]
    pub fn of(grid: Grid, positions: &[Vec3], costs: &[VertexCost], base: Base) -> Self {
        let mut histogram = Self::empty(grid);
        for (&position, cost) in positions.iter().zip(costs) {
            let is_likely = base.is_likely(cost.cost);
            let load = histogram.loads.entry(grid.code(position)).or_default();
            load.add(Load {
                vertices: 1,
                likely: is_likely.into(),
                edges: u64::from(is_likely) * u64::from(cost.edges.min(EDGES)),
            });
        }
        histogram
    }

    /// Adds the vertices of other slices.
    ///
    /// # Errors
    /// [`Error::BadOption`] if they were counted on another grid.
    pub fn merge(&mut self, other: &Self) -> Result<()> {
        if self.grid != other.grid {
            return Err(Error::BadOption {
                option: "grid",
                found: format!("{:?}", other.grid),
                expected: "the same for all slices",
            });
        }
        for (&code, &load) in &other.loads {
            self.loads.entry(code).or_default().add(load);
        }
        Ok(())
    }

    /// All of it.
    #[must_use]
    pub fn total(&self) -> Load {
        let mut total = Load::default();
        self.loads.values().for_each(|&load| total.add(load));
        total
    }
}
