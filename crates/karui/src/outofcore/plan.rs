//! What is to be done, decided before anything is read.

use super::join::{SCATTERED, reach};
use super::keys::Scheme;
use super::tiles::TileCut;
use super::{Error, Result, Source, Store};
use serde::{Deserialize, Serialize};

/// How a model is to be simplified out of core. What comes out depends on these, on the
/// input and on nothing else.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlanOptions {
    /// Triangles of the result; with `ratio`, whichever is more. Default: none.
    pub triangles: Option<u64>,
    /// Triangles of the result as a share of the input's, `0..=1`. Default: none.
    pub ratio: Option<f64>,
    /// Bound on the error as the simplifier estimates it, summed over all levels, model
    /// units. Default: none.
    pub error: Option<f64>,
    /// Triangles that a task works on at a time, about. Default: 1,048,576, which takes some
    /// 500 MB.
    pub block_triangles: u64,
    /// How regions are cut. Default: [`Scheme::Cells`].
    pub scheme: Scheme,
    /// Keeps all levels as a tree of tiles ([`super::tile_tree`]) instead of making one mesh;
    /// the other targets then do not count. Needs [`Scheme::Cells`]. Default: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tiles: Option<TileCut>,
}

impl Default for PlanOptions {
    fn default() -> Self {
        Self {
            triangles: None,
            ratio: None,
            error: None,
            block_triangles: 1 << 20,
            scheme: Scheme::default(),
            tiles: None,
        }
    }
}

/// Bytes a task takes for each triangle of a block at most, attributes aside.
const WORKING_SET: u64 = 560;
/// Blocks that should fit the memory at the same time.
const AT_ONCE: u64 = 2;

impl PlanOptions {
    /// The largest blocks of which two fit so many bytes.
    #[must_use]
    pub fn block_triangles_for(memory: u64) -> u64 {
        (memory / (AT_ONCE * WORKING_SET)).clamp(1 << 12, 1 << 24)
    }

    /// Tasks that may run at the same time within so many bytes; at least one.
    #[must_use]
    pub fn workers_for(&self, memory: u64) -> usize {
        (memory / (self.block_triangles.max(1) * WORKING_SET)).max(1) as usize
    }

    /// Triangles wanted of so many; none if only the error counts.
    pub(super) fn target(&self, whole: u64) -> u64 {
        let by_ratio = self.ratio.map(|r| (r * whole as f64).round() as u64);
        let counts = self.triangles.into_iter().chain(by_ratio);
        counts.max().unwrap_or(0).min(whole)
    }

    fn check(&self) -> Result<()> {
        let bad = |option, found: String, expected| {
            Err(Error::Block(crate::Error::BadOption {
                option,
                found,
                expected,
            }))
        };
        match (self.ratio, self.error) {
            (Some(ratio), _) if !(0.0..=1.0).contains(&ratio) => {
                bad("ratio", ratio.to_string(), "between 0 and 1")
            }
            (_, Some(error)) if !(0.0..=f64::MAX).contains(&error) => {
                bad("error", error.to_string(), "0 or more")
            }
            _ if !(LEAST_BLOCK..=MOST_BLOCK).contains(&self.block_triangles) => bad(
                "block_triangles",
                self.block_triangles.to_string(),
                "between 64 and 2^28",
            ),
            _ => self.check_tiles(),
        }
    }

    fn check_tiles(&self) -> Result<()> {
        let Some(cut) = self.tiles else {
            return Ok(());
        };
        let most = self.block_triangles / 8;
        let (option, found, expected) = match self.scheme {
            Scheme::Cells if (LEAST_TILE..=most).contains(&cut.triangles) => return Ok(()),
            Scheme::Cells => (
                "tiles.triangles",
                cut.triangles.to_string(),
                "between 16 and an eighth of block_triangles",
            ),
            other => ("scheme", format!("{other:?}"), "cells for tiles"),
        };
        Err(Error::Block(crate::Error::BadOption {
            option,
            found,
            expected,
        }))
    }
}

/// Triangles of a tile at least.
const LEAST_TILE: u64 = 16;

/// Portions that are looked at to tell whether a model is scattered.
const LOOKS: u64 = 8;

fn is_scattered(source: &dyn Source) -> Result<bool> {
    let chunks = source.chunks();
    let looks = chunks.min(LOOKS);
    let [mut used, mut passed] = [0, 0];
    for look in 0..looks {
        let reach = reach(&source.read_triangles(look * chunks / looks)?);
        used += reach.used;
        passed += reach.passed;
    }
    Ok(passed > SCATTERED * used)
}

const LEAST_BLOCK: u64 = 64;
const MOST_BLOCK: u64 = 1 << 28;

/// A model, what is to be made of it, and how.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// Version of everything in the store: 1.
    pub version: u32,
    /// Where the model is; whoever runs a task opens it there.
    pub source: String,
    /// Vertices of the model.
    pub vertices: u64,
    /// Portions its faces come in.
    pub chunks: u64,
    /// Whether triangles use vertices from all over the model, so that these are brought
    /// to them by sorting.
    pub scattered: bool,
    /// What is to be done.
    pub options: PlanOptions,
}

/// Name of the plan in the store.
pub const PLAN: &str = "plan.json";
const VERSION: u32 = 1;

impl Plan {
    /// What to do with `source`, which is found at `uri`. Reads some portions of its faces.
    ///
    /// # Errors
    /// [`crate::Error::BadOption`] for an option out of its range; those of the source.
    pub fn new(source: &dyn Source, uri: &str, options: PlanOptions) -> Result<Self> {
        options.check()?;
        Ok(Self {
            version: VERSION,
            source: uri.to_owned(),
            vertices: source.vertices(),
            chunks: source.chunks(),
            scattered: is_scattered(source)?,
            options,
        })
    }

    /// Puts the plan into an empty store, or makes sure that the store holds the same.
    ///
    /// # Errors
    /// [`Error::OtherPlan`]; those of the store.
    pub fn save(&self, store: &dyn Store) -> Result<()> {
        match Self::load(store) {
            Ok(found) => self.same_as(&found),
            Err(Error::Missing { .. }) => {
                let text = serde_json::to_string_pretty(self).unwrap_or_default();
                store.put(PLAN, text.as_bytes())
            }
            Err(error) => Err(error),
        }
    }

    /// Reads the plan in a store.
    ///
    /// # Errors
    /// [`Error::Manifest`] if it makes no sense; those of the store.
    pub fn load(store: &dyn Store) -> Result<Self> {
        let bytes = store.get(PLAN)?;
        let bad = |line, problem| Error::Manifest {
            name: PLAN.into(),
            line,
            problem,
        };
        let plan: Self =
            serde_json::from_slice(&bytes).map_err(|e| bad(e.line(), e.to_string()))?;
        if plan.version != VERSION {
            let found = plan.version;
            return Err(bad(1, format!("version {found}; only {VERSION} is known")));
        }
        plan.options.check()?;
        Ok(plan)
    }

    /// Triangles before a level of so many at first, as far as can be told beforehand.
    pub(super) fn triangles_before(&self, triangles: f64, level: u32) -> f64 {
        let wanted = self.options.target(triangles as u64) as f64;
        // A quarter of the way, as ratios go, is left at each level.
        (0..level).fold(triangles, |before, _| {
            wanted.max(1.0) * (before / wanted.max(1.0)).sqrt().sqrt()
        })
    }

    fn same_as(&self, found: &Self) -> Result<()> {
        let differs = |what, found: String, expected: String| {
            Err(Error::OtherPlan {
                what,
                found,
                expected,
            })
        };
        let size = |plan: &Self| format!("{} vertices, {} portions", plan.vertices, plan.chunks);
        if self.source != found.source {
            differs("source", found.source.clone(), self.source.clone())
        } else if size(self) != size(found) {
            differs("size", size(found), size(self))
        } else if self.options != found.options {
            let text = |plan: &Self| serde_json::to_string(&plan.options).unwrap_or_default();
            differs("options", text(found), text(self))
        } else {
            Ok(())
        }
    }
}
