//! The chain of one mesh.

use super::level::{Measured, Measuring};
use super::options::{LodOptions, Surroundings};
use super::parts::Parts;
use super::{SceneChain, chain_scene};
use crate::error::Result;
use crate::mesh::{Scene, TriMesh};
use crate::metrics::{Surface, SurfaceDistance};
use crate::simplify::{Blocked, CollapseLog, PruneOptions, SimplifyOptions, Stop, Stopped, prune};
use std::borrow::Cow;
use std::ops::Range;

/// A mesh's levels of detail, the original not among them.
#[derive(Debug, Clone)]
pub struct LodChain {
    /// The levels, finest first.
    pub levels: Vec<LodLevel>,
    /// Levels asked for that would have been no coarser than those before.
    pub dropped: Vec<DroppedLevel>,
    /// Length in the world of a length of 1 in the mesh, at most: the largest
    /// stretch over all instances. Skins are left aside.
    pub scale: f64,
    /// Radius of a sphere around the original, in the world's unit.
    pub radius: f64,
    /// Area of the original, model units squared.
    pub area: f64,
    /// Instances of the mesh in the scene.
    pub instances: usize,
    /// Parts pruned before any level was made.
    pub pruned: Removed,
}

/// Parts that were pruned.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Removed {
    /// Number of parts.
    pub components: usize,
    /// Triangles of theirs.
    pub triangles: usize,
    /// Size of the largest, in the unit of the mesh.
    pub error: f64,
}

/// One level of detail.
#[derive(Debug, Clone)]
pub struct LodLevel {
    /// The mesh.
    pub mesh: TriMesh,
    /// What was asked for, in the unit of the mesh.
    pub asked: Stop,
    /// Why simplification went no further.
    pub stopped: Stopped,
    /// Why edge collapse had stopped, if clustering has taken over
    /// ([`Method::CollapseElseCluster`](super::Method)).
    pub fallback: Option<Stopped>,
    /// What stood in its way.
    pub blocked: Blocked,
    /// What collapsed, if it was asked for; none if parts were pruned before.
    pub log: Option<CollapseLog>,
    /// The simplifier's own estimate of the error, in the unit of the mesh.
    pub estimate: f64,
    /// Measured distance between the original (`a`) and this level (`b`), in
    /// the unit of the mesh. Parts that were pruned are not measured; the
    /// maximum is their size if that is larger.
    pub distance: SurfaceDistance,
    /// Largest error this level is taken to have, in the world's unit: the
    /// largest measured one of this level and all finer ones.
    pub error: f64,
    /// Distance from the eye beyond which this level may be shown, in the
    /// world's unit; never less than that of a finer level.
    pub switch_distance: f64,
}

/// A level that is not there.
#[derive(Debug, Clone, PartialEq)]
pub struct DroppedLevel {
    /// What was asked for, in the unit of the mesh.
    pub asked: Stop,
    /// The triangles it would have had.
    pub triangles: usize,
    /// Why simplification went no further.
    pub stopped: Stopped,
    /// What stood in its way.
    pub blocked: Blocked,
}

/// Builds the levels of a single mesh that stands in the world as it is.
///
/// # Errors
/// As [`chain_scene`]; [`Error::Empty`](crate::Error::Empty) for a mesh
/// without triangles.
pub fn chain_mesh(mesh: &TriMesh, options: &LodOptions<'_>) -> Result<LodChain> {
    if mesh.triangles.is_empty() {
        return Err(crate::Error::Empty { what: "mesh" });
    }
    let SceneChain { chains, .. } = chain_scene(&Scene::from_mesh(mesh.clone()), options)?;
    let chain = chains.into_iter().flatten().next();
    chain.ok_or(crate::Error::Empty { what: "mesh" })
}

/// A mesh on its way to become a chain.
pub(super) struct Job<'a> {
    pub mesh: Cow<'a, TriMesh>,
    /// What it was before it was pruned.
    pub original: &'a TriMesh,
    pub pruned: Removed,
    pub surface: Surface,
    pub around: Surroundings,
    pub instances: usize,
    pub weights: Option<Cow<'a, [f32]>>,
    pub locks: Option<Cow<'a, [bool]>>,
    pub stops: Vec<Stop>,
}

impl Job<'_> {
    /// Without the parts up to this size in the world. Shares of the triangles
    /// stay those of the original.
    pub fn pruned(mut self, size: Option<f64>) -> Result<Self> {
        let Some(size) = size else { return Ok(self) };
        let options = PruneOptions::error(size / self.around.scale);
        let pruned = prune(self.original, &options)?;
        if pruned.components == 0 {
            return Ok(self);
        }
        self.surface = Surface::new(&pruned.mesh)?;
        self.weights = self
            .weights
            .map(|w| Cow::Owned(chosen(&w, &pruned.vertices)));
        self.locks = self.locks.map(|l| Cow::Owned(chosen(&l, &pruned.vertices)));
        for stop in &mut self.stops {
            let share = |ratio: f64| (ratio * self.original.triangles.len() as f64).round();
            let of_ratio = stop.ratio.take().map(|ratio| share(ratio) as usize);
            stop.triangles = stop.triangles.max(of_ratio);
        }
        self.pruned = Removed {
            components: pruned.components,
            triangles: pruned.triangles,
            error: pruned.error,
        };
        self.mesh = Cow::Owned(pruned.mesh);
        Ok(self)
    }

    /// Levels that are built together: all that are bounded by counts, for
    /// one run makes them; every one that is bounded by its measured error,
    /// for it may take several attempts, alone.
    pub fn tasks(&self) -> Vec<Range<usize>> {
        let levels = 0..self.stops.len();
        if self.stops.iter().any(Stop::bounds_error) {
            levels.map(|level| level..level + 1).collect()
        } else {
            vec![levels]
        }
    }

    /// Builds these levels, reporting as part `part`.
    pub fn run(
        &self,
        levels: Range<usize>,
        options: &LodOptions,
        parts: &Parts,
        part: usize,
    ) -> Result<Vec<Measured>> {
        let progress = parts.part(part);
        let measuring = Measuring {
            mesh: &self.mesh,
            surface: &self.surface,
            options: SimplifyOptions {
                weights: self.weights.as_deref(),
                locks: self.locks.as_deref(),
                progress: &progress,
                ..options.simplify
            },
            method: options.method,
            samples: samples(options.samples, &self.mesh),
            seed: options.seed,
        };
        measuring.chain(&self.stops[levels])
    }

    /// Sorts what was built into levels and those that are not worth having.
    pub fn finish(&self, built: Vec<Measured>, options: &LodOptions) -> LodChain {
        let mut chain = LodChain {
            levels: Vec::new(),
            dropped: Vec::new(),
            scale: self.around.scale,
            radius: self.around.scale * radius(self.original),
            area: self.surface.area(),
            instances: self.instances,
            pruned: self.pruned,
        };
        for (&asked, measured) in self.stops.iter().zip(built) {
            self.add(&mut chain, asked, measured, options);
        }
        chain
    }

    fn add(&self, chain: &mut LodChain, asked: Stop, measured: Measured, options: &LodOptions) {
        let Measured {
            simplified,
            distance,
            fallback,
        } = measured;
        let finer = chain.levels.last();
        let before = finer.map_or(self.original.triangles.len(), |l| l.mesh.triangles.len());
        let triangles = simplified.mesh.triangles.len();
        let worthwhile = triangles < before
            && triangles as f64 <= options.levels.worthwhile() * before as f64
            && options.levels.accepts(simplified.stopped);
        let (Some(mut distance), true) = (distance, worthwhile) else {
            chain.dropped.push(DroppedLevel {
                asked,
                triangles,
                stopped: simplified.stopped,
                blocked: simplified.blocked,
            });
            return;
        };
        distance.a_to_b.max = distance.a_to_b.max.max(self.pruned.error);
        let error = (distance.max() * chain.scale).max(finer.map_or(0.0, |l| l.error));
        chain.levels.push(LodLevel {
            mesh: simplified.mesh,
            asked,
            stopped: simplified.stopped,
            fallback,
            blocked: simplified.blocked,
            log: simplified.log.filter(|_| self.pruned.components == 0),
            estimate: simplified.error,
            distance,
            error,
            switch_distance: options.screen.switch_distance(error),
        });
    }
}

fn chosen<T: Copy>(values: &[T], sources: &[u32]) -> Vec<T> {
    // Of too short a list the simplifier tells how long it should be.
    let value = |&v: &u32| values.get(v as usize).copied();
    sources.iter().filter_map(value).collect()
}

/// Fewer samples for small meshes, of which a scene may have thousands.
fn samples(most: u64, mesh: &TriMesh) -> u64 {
    most.min((20 * mesh.triangles.len() as u64).max(1000))
}

/// Radius of the sphere around the middle of the mesh's box.
fn radius(mesh: &TriMesh) -> f64 {
    let center = mesh.bounds().center().as_dvec3();
    let distance = |p: &glam::Vec3| p.as_dvec3().distance(center);
    mesh.positions.iter().map(distance).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lod::Levels;
    use crate::mesh::shapes;
    use crate::simplify::Border;

    #[test]
    fn halving_ends_where_the_mesh_no_longer_lets_it() {
        let options = LodOptions {
            levels: Levels::Halving {
                min_triangles: 1,
                max_levels: 8,
            },
            simplify: SimplifyOptions {
                border: Border::Lock,
                ..SimplifyOptions::default()
            },
            ..LodOptions::default()
        };
        let chain = chain_mesh(&shapes::terrain(16, 16, 1), &options).unwrap();
        assert!(!chain.levels.is_empty());
        assert!(chain.levels.iter().all(|l| l.stopped == Stopped::Target));
        assert_eq!(chain.dropped[0].stopped, Stopped::Locked);
    }
}
