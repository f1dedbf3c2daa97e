//! One level: simplified, then measured against the original.

use crate::error::Result;
use crate::mesh::TriMesh;
use crate::metrics::surface_distance_between;
use crate::metrics::{Samples, Surface, SurfaceDistance, SurfaceDistanceOptions};
use crate::progress::Progress;
use crate::simplify::{Simplified, SimplifyOptions, Stop, simplify, simplify_chain};

/// A simplified mesh and its true distance to the original.
#[derive(Debug, Clone)]
pub struct Measured {
    /// The mesh and how it came about.
    pub simplified: Simplified,
    /// From the original to the simplified surface and back; `None` if no
    /// triangle is left.
    pub distance: Option<SurfaceDistance>,
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
/// As [`simplify`] and [`surface_distance_between`].
pub fn simplify_measured(
    mesh: &TriMesh,
    surface: &Surface,
    options: &SimplifyOptions<'_>,
    samples: u64,
    seed: u64,
) -> Result<Measured> {
    let options = SimplifyOptions {
        stop: absolute(options.stop, mesh),
        ..*options
    };
    let run = |stop| {
        let options = SimplifyOptions { stop, ..options };
        attempt(surface, mesh, &options, samples, seed)
    };
    let mut found = run(options.stop)?;
    let Some(allowed) = options.stop.error else {
        return Ok(found);
    };
    // What rounding to 32 bits may move a vertex by is nobody's error.
    let rounding = f64::from(f32::EPSILON) * surface.bounds().diagonal();
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
        found = run(options.stop.or_error(bound))?;
    }
    Ok(found)
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
    if stops.iter().any(Stop::bounds_error) {
        let level = |&stop| {
            let options = SimplifyOptions { stop, ..*options };
            simplify_measured(mesh, surface, &options, samples, seed)
        };
        return stops.iter().map(level).collect();
    }
    let measured = |simplified: Simplified| {
        let distance = measure(surface, &simplified.mesh, samples, seed, options.progress)?;
        Ok(Measured {
            simplified,
            distance,
        })
    };
    let chain = simplify_chain(mesh, stops, options)?;
    chain.into_iter().map(measured).collect()
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

fn attempt(
    surface: &Surface,
    mesh: &TriMesh,
    options: &SimplifyOptions<'_>,
    samples: u64,
    seed: u64,
) -> Result<Measured> {
    let simplified = simplify(mesh, options)?;
    let distance = measure(surface, &simplified.mesh, samples, seed, options.progress)?;
    Ok(Measured {
        simplified,
        distance,
    })
}

fn measure(
    surface: &Surface,
    coarse: &TriMesh,
    samples: u64,
    seed: u64,
    progress: &dyn Progress,
) -> Result<Option<SurfaceDistance>> {
    if coarse.triangles.is_empty() {
        return Ok(None);
    }
    let options = SurfaceDistanceOptions {
        samples: Samples::Count(samples),
        seed,
        progress,
        ..SurfaceDistanceOptions::default()
    };
    surface_distance_between(surface, &Surface::new(coarse)?, &options).map(Some)
}
