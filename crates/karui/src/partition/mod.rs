//! Where to cut a model, so that every part is as much work as the others.
//!
//! The load-aware partition of Shioya, Matsuyama, Konno & Tokuyama, "A New Large Scale
//! Segmentation Algorithm for Decreasing Calculation Costs of Distributed Simplification":
//! a vertex is likely to go if its cost ([`vertex_costs`]) is among the lowest of the whole
//! model, and every region gets the same number of edges of such vertices ([`Regions`]).
//!
//! The paper sorts all costs on one machine. Here they are counted in histograms of fixed
//! bins ([`CostHistogram`], [`LoadHistogram`]) that are made of slices of the model and
//! merge by addition of integers: in any order, on any machine, the same to the bit.
//!
//! In two passes over the slices:
//! ```
//! use karui::{geom::Aabb, mesh::shapes, partition::{self, CostHistogram, Grid, LoadHistogram, Regions}};
//!
//! let slice = shapes::landscape(64, 32, 1);
//! let bounds = Aabb::of(slice.positions.iter().copied());
//! let costs = partition::vertex_costs(&slice.positions, &slice.triangles, 0..slice.positions.len())?;
//! let base = CostHistogram::of(&costs).base(0.9);
//!
//! let loads = LoadHistogram::of(Grid::along_longest(bounds), &slice.positions, &costs, base);
//! let regions = Regions::load_aware(&loads, 8);
//! let region = regions.region_of(slice.positions[0]);
//! assert!(regions.loads[region as usize].ratio() > 0.0);
//! # Ok::<(), karui::Error>(())
//! ```

mod cost_histogram;
mod grid;
mod load_histogram;
mod plane_sum;
mod regions;
mod vertex_cost;

pub use cost_histogram::{Base, CostHistogram};
pub use grid::{Division, Grid};
pub use load_histogram::{Load, LoadHistogram};
pub use plane_sum::PlaneSum;
pub use regions::Regions;
pub use vertex_cost::{VertexCost, vertex_costs};
