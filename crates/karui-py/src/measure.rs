//! How far surfaces are apart, for Python.

use crate::arrays::scalars;
use crate::mesh::MeshLike;
use crate::progress::run;
use karui::metrics::{self, Samples, SurfaceDistance, SurfaceDistanceOptions};
use numpy::PyArray1;
use pyo3::prelude::*;

/// Distance of samples of one surface to the other, model units.
#[pyclass(frozen, get_all, module = "karui")]
pub struct OneWay {
    /// Largest distance of any sample.
    max: f64,
    /// Mean distance.
    mean: f64,
    /// Root mean square distance.
    rms: f64,
    /// Number of samples.
    samples: u64,
    /// The sample at distance `max`, and the nearest point of the other surface.
    farthest: [[f32; 3]; 2],
}

impl From<metrics::Distance> for OneWay {
    fn from(found: metrics::Distance) -> Self {
        let metrics::Distance {
            max,
            mean,
            rms,
            samples,
            farthest,
        } = found;
        Self {
            max,
            mean,
            rms,
            samples,
            farthest: farthest.map(Into::into),
        }
    }
}

/// Distance between two surfaces, model units; each figure that of the worse direction.
#[pyclass(frozen, get_all, module = "karui")]
pub struct Distance {
    /// Largest distance found: a lower bound of the Hausdorff distance.
    max: f64,
    /// Mean distance.
    mean: f64,
    /// Root mean square distance.
    rms: f64,
    /// Diagonal of the box around the first surface: rms / diagonal is the usual relative error.
    diagonal: f64,
    /// From samples of the first surface to the second.
    a_to_b: Py<OneWay>,
    /// From samples of the second surface to the first.
    b_to_a: Py<OneWay>,
}

impl Distance {
    fn of(py: Python<'_>, found: SurfaceDistance) -> PyResult<Self> {
        Ok(Self {
            max: found.max(),
            mean: found.mean(),
            rms: found.rms(),
            diagonal: found.diagonal,
            a_to_b: Py::new(py, OneWay::from(found.a_to_b))?,
            b_to_a: Py::new(py, OneWay::from(found.b_to_a))?,
        })
    }
}

#[pymethods]
impl Distance {
    fn __repr__(&self) -> String {
        let Self { max, mean, rms, .. } = self;
        format!("<karui.Distance: max {max:.3e}, mean {mean:.3e}, rms {rms:.3e}>")
    }
}

/// Two-sided distance between surfaces, sampled as Metro does: at `samples` points of the faces,
/// as many of the edges, and every vertex, each way.
///
/// seed: places the samples. weights: (n,) numbers of 0 or more, how much each vertex of `a`
/// counts. progress: called with a stage and a fraction; returning False cancels.
///
/// Raises InputError, also for a mesh without triangles, and Cancelled.
#[pyfunction]
#[pyo3(signature = (a, b, *, samples=500_000, seed=0, weights=None, progress=None))]
pub fn measure(
    py: Python<'_>,
    a: MeshLike,
    b: MeshLike,
    samples: u64,
    seed: u64,
    weights: Option<&Bound<'_, PyAny>>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Distance> {
    let weights = scalars("weights", weights)?;
    let found = run(py, progress, |progress| {
        let options = SurfaceDistanceOptions {
            samples: Samples::Count(samples),
            seed,
            weights: weights.as_deref(),
            progress,
            ..SurfaceDistanceOptions::default()
        };
        metrics::surface_distance(&a.0, &b.0, &options)
    })?;
    Distance::of(py, found)
}

/// Distance of every vertex of a mesh to the surface of another, model units: (n,) float32.
///
/// Raises InputError, also for a surface without triangles.
#[pyfunction]
pub fn vertex_distances<'py>(
    py: Python<'py>,
    mesh: MeshLike,
    surface: MeshLike,
) -> PyResult<Bound<'py, PyArray1<f32>>> {
    let found = run(py, None, |_| metrics::vertex_distances(&mesh.0, &surface.0))?;
    Ok(PyArray1::from_vec(py, found))
}
