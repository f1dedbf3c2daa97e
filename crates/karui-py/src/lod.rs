//! Levels of detail, for Python.

use crate::arrays::scalars;
use crate::choice::choice;
use crate::errors::input_error;
use crate::mesh::{Mesh, MeshLike};
use crate::progress::run;
use crate::simplify::{BORDERS, QUALITIES, attributes, reason};
use karui::lod::{Levels, LodLevel, LodOptions, Screen, chain_mesh};
use karui::simplify::SimplifyOptions;
use pyo3::prelude::*;

/// One level of detail; distances are measured against the original, model units.
#[pyclass(frozen, get_all, module = "karui")]
pub struct Level {
    /// The mesh.
    mesh: Py<Mesh>,
    /// Largest error it is taken to have: the largest measured one of this and all finer levels.
    error: f64,
    /// Largest distance measured.
    max: f64,
    /// Mean distance measured.
    mean: f64,
    /// Root mean square distance measured.
    rms: f64,
    /// Distance from the eye beyond which it may be shown.
    switch_distance: f64,
    /// Why it went no further, as in Simplified.
    stopped: &'static str,
}

impl Level {
    fn of(py: Python<'_>, level: LodLevel) -> PyResult<Self> {
        let distance = &level.distance;
        Ok(Self {
            error: level.error,
            max: distance.max(),
            mean: distance.mean(),
            rms: distance.rms(),
            switch_distance: level.switch_distance,
            stopped: reason(level.stopped),
            mesh: Py::new(py, Mesh::of(level.mesh))?,
        })
    }
}

#[pymethods]
impl Level {
    fn __repr__(&self) -> String {
        let triangles = self.mesh.get().0.triangles.len();
        let (error, distance) = (self.error, self.switch_distance);
        format!(
            "<karui.Level: {triangles} triangles, error {error:.3e}, shown beyond {distance:.4}>"
        )
    }
}

/// Levels of detail, finest first, the original not among them, each with its measured error.
///
/// Which: `ratios` of the original's triangles (0 to 1 each), counts of `triangles`, or largest
/// measured `errors` (model units); of these at most one. Without any, `levels` by halving, down
/// to `min_triangles`. Levels that would be no coarser than those before are left out.
///
/// quality, weights, border, attribute_weight: as in `simplify`. screen_height (pixels), fov_y
/// (radians, vertical) and tolerance (pixels): of the screen that switch distances are for.
/// progress: called with a stage and a fraction; returning False cancels.
///
/// Raises InputError and Cancelled.
#[pyfunction]
#[pyo3(signature = (mesh, *, ratios=None, triangles=None, errors=None, levels=5, min_triangles=32,
    quality="balanced", weights=None, border="preserve", attribute_weight=1.0,
    screen_height=1080.0, fov_y=std::f64::consts::FRAC_PI_3, tolerance=1.0, progress=None),
    text_signature = "(mesh, *, ratios=None, triangles=None, errors=None, levels=5, \
    min_triangles=32, quality='balanced', weights=None, border='preserve', attribute_weight=1.0, \
    screen_height=1080.0, fov_y=1.0471975511965976, tolerance=1.0, progress=None)")]
#[expect(
    clippy::too_many_arguments,
    reason = "they are keywords of a Python function"
)]
pub fn lod(
    py: Python<'_>,
    mesh: MeshLike,
    ratios: Option<Vec<f64>>,
    triangles: Option<Vec<usize>>,
    errors: Option<Vec<f64>>,
    levels: usize,
    min_triangles: usize,
    quality: &str,
    weights: Option<&Bound<'_, PyAny>>,
    border: &str,
    attribute_weight: f64,
    screen_height: f64,
    fov_y: f64,
    tolerance: f64,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Vec<Level>> {
    let levels = match (ratios, triangles, errors) {
        (None, None, None) => Levels::Halving {
            min_triangles,
            max_levels: levels,
        },
        (Some(ratios), None, None) => Levels::Ratios(ratios),
        (None, Some(triangles), None) => Levels::Triangles(triangles),
        (None, None, Some(errors)) => Levels::Errors(errors),
        _ => {
            return Err(input_error(
                "ratios, triangles, errors",
                "more than one",
                "at most one",
            ));
        }
    };
    let quality = choice("quality", quality, &QUALITIES)?;
    let border = choice("border", border, &BORDERS)?;
    let attributes = attributes(attribute_weight);
    let screen = Screen {
        height_px: screen_height,
        fov_y,
        tolerance_px: tolerance,
    };
    let weights = [scalars("weights", weights)?];
    let chain = run(py, progress, |progress| {
        let simplify = SimplifyOptions {
            quality,
            border,
            attributes,
            ..SimplifyOptions::default()
        };
        let options = LodOptions {
            levels,
            screen,
            simplify,
            weights: &weights,
            progress,
            ..LodOptions::default()
        };
        chain_mesh(&mesh.0, &options)
    })?;
    chain
        .levels
        .into_iter()
        .map(|level| Level::of(py, level))
        .collect()
}
