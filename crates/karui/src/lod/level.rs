//! One level: simplified, then measured against the original.

use super::method::{Made, Method};
use crate::error::Result;
use crate::mesh::TriMesh;
use crate::metrics::surface_distance_between;
use crate::metrics::{Samples, Surface, SurfaceDistance, SurfaceDistanceOptions};
use crate::simplify::{Simplified, SimplifyOptions, Stop, Stopped};

/// A simplified mesh and its true distance to the original.
#[derive(Debug, Clone)]
pub struct Measured {
    /// The mesh and how it came about.
    pub simplified: Simplified,
    /// From the original to the simplified surface and back; `None` if no
    /// triangle is left.
    pub distance: Option<SurfaceDistance>,
    /// Why edge collapse had stopped, if clustering has taken over
    /// ([`Method::CollapseElseCluster`]).
    pub fallback: Option<Stopped>,
}

impl Measured {
    /// Largest measured distance, the model's unit; infinite if nothing is
    /// left.
    #[must_use]
    pub fn max(&self) -> f64 {
        self.distance.map_or(f64::INFINITY, |d| d.max())
    }
}

/// Times a level is simplified anew because it is farther off than allowed.
const ATTEMPTS: usize = 6;
/// Share of the allowed error that a new attempt aims at.
const AIM: f64 = 0.9;

/// Simplifies a mesh and measures the result. Bounds on the error that
/// `options.stop` has hold for the measured maximum, not just for the
/// estimate: a result that is farther off is simplified anew with a tighter
/// bound, six times at most. Compare [`Measured::max`] with the bound, since
/// there are meshes for which that is not enough.
///
/// `surface` is made of `mesh`; `samples` is the number of face and of edge
/// samples each direction takes.
///
/// # Errors
/// As [`simplify`](crate::simplify::simplify()) and [`surface_distance_between`].
pub fn simplify_measured(
    mesh: &TriMesh,
    surface: &Surface,
    options: &SimplifyOptions<'_>,
    samples: u64,
    seed: u64,
) -> Result<Measured> {
    Measuring::new(mesh, surface, options, samples, seed).level(options.stop)
}

/// As [`simplify_measured`], to one stop after another. Stops without a bound
/// on the error share one run of the simplifier.
///
/// # Errors
/// As [`simplify_measured`].
pub fn chain_measured(
    mesh: &TriMesh,
    surface: &Surface,
    stops: &[Stop],
    options: &SimplifyOptions<'_>,
    samples: u64,
    seed: u64,
) -> Result<Vec<Measured>> {
    Measuring::new(mesh, surface, options, samples, seed).chain(stops)
}

/// A mesh whose levels are to be made and measured.
pub(super) struct Measuring<'a> {
    pub mesh: &'a TriMesh,
    pub surface: &'a Surface,
    pub options: SimplifyOptions<'a>,
    pub method: Method,
    pub samples: u64,
    pub seed: u64,
}

impl<'a> Measuring<'a> {
    fn new(
        mesh: &'a TriMesh,
        surface: &'a Surface,
        options: &SimplifyOptions<'a>,
        samples: u64,
        seed: u64,
    ) -> Self {
        Self {
            mesh,
            surface,
            options: *options,
            method: Method::default(),
            samples,
            seed,
        }
    }

    /// One level, made again until a bound on its error holds when measured.
    pub fn level(&self, stop: Stop) -> Result<Measured> {
        let stop = absolute(stop, self.mesh);
        let mut found = self.attempt(stop)?;
        let Some(allowed) = stop.error else {
            return Ok(found);
        };
        // What rounding to 32 bits may move a vertex by is nobody's error.
        let rounding = f64::from(f32::EPSILON) * self.surface.bounds().diagonal();
        let mut bound = allowed;
        for _ in 1..ATTEMPTS {
            let max = found.max();
            if max <= allowed + rounding {
                break;
            }
            bound *= if max.is_finite() {
                AIM * allowed / max
            } else {
                0.1
            };
            found = self.attempt(stop.or_error(bound))?;
        }
        Ok(found)
    }

    /// One level after another.
    pub fn chain(&self, stops: &[Stop]) -> Result<Vec<Measured>> {
        if stops.iter().any(Stop::bounds_error) {
            return stops.iter().map(|&stop| self.level(stop)).collect();
        }
        let made = self.method.make_chain(self.mesh, stops, &self.options)?;
        made.into_iter().map(|made| self.measured(made)).collect()
    }

    fn attempt(&self, stop: Stop) -> Result<Measured> {
        let options = SimplifyOptions {
            stop,
            ..self.options
        };
        self.measured(self.method.make(self.mesh, &options)?)
    }

    fn measured(&self, made: Made) -> Result<Measured> {
        Ok(Measured {
            distance: self.distance(&made.simplified.mesh)?,
            simplified: made.simplified,
            fallback: made.fallback,
        })
    }

    fn distance(&self, coarse: &TriMesh) -> Result<Option<SurfaceDistance>> {
        if coarse.triangles.is_empty() {
            return Ok(None);
        }
        let options = SurfaceDistanceOptions {
            samples: Samples::Count(self.samples),
            seed: self.seed,
            progress: self.options.progress,
            ..SurfaceDistanceOptions::default()
        };
        surface_distance_between(self.surface, &Surface::new(coarse)?, &options).map(Some)
    }
}

/// The stop with its relative bound turned into an absolute one.
fn absolute(stop: Stop, mesh: &TriMesh) -> Stop {
    let Some(relative) = stop.relative_error else {
        return stop;
    };
    let of_relative = relative * mesh.bounds().diagonal();
    Stop {
        error: Some(stop.error.map_or(of_relative, |e| e.min(of_relative))),
        relative_error: None,
        ..stop
    }
}
