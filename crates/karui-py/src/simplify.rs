//! Fewer triangles, for Python.

use crate::arrays::{flags, scalars};
use crate::choice::choice;
use crate::mesh::{Mesh, MeshLike};
use crate::progress::run;
use karui::simplify::{self as lib, AttributeWeights, Border, Placement, Quality, Stopped};
use karui::simplify::{SimplifyOptions, Stop, Topology};
use pyo3::prelude::*;

pub const QUALITIES: [(&str, Quality); 3] = [
    ("fast", Quality::Fast),
    ("balanced", Quality::Balanced),
    ("exact", Quality::Exact),
];
pub const BORDERS: [(&str, Border); 3] = [
    ("preserve", Border::Preserve),
    ("lock", Border::Lock),
    ("free", Border::Free),
];
const PLACEMENTS: [(&str, Placement); 2] = [
    ("optimal", Placement::Optimal),
    ("half_edge", Placement::HalfEdge),
];

/// Why a simplification went no further, in a word.
pub fn reason(stopped: Stopped) -> &'static str {
    match stopped {
        Stopped::Target => "target",
        Stopped::ErrorBound => "error",
        Stopped::Exhausted => "exhausted",
        Stopped::Locked => "locked",
        Stopped::Topology => "topology",
        Stopped::Seams => "seams",
        Stopped::Flips => "flips",
    }
}

/// How much attributes count, all alike.
pub fn attributes(weight: f64) -> AttributeWeights {
    AttributeWeights {
        normal: weight,
        uv: weight,
        color: weight,
        skin: weight,
    }
}

/// A simplified mesh and how it came about.
#[pyclass(frozen, get_all, module = "karui")]
pub struct Simplified {
    /// The coarser mesh.
    mesh: Py<Mesh>,
    /// Estimate of the distance to the input, model units; `measure` measures it.
    error: f64,
    /// Why it went no further: "target", "error", "exhausted", "locked", "topology", "seams" or
    /// "flips".
    stopped: &'static str,
    /// Number of edges collapsed.
    collapses: usize,
}

#[pymethods]
impl Simplified {
    fn __repr__(&self) -> String {
        let triangles = self.mesh.get().0.triangles.len();
        let (error, stopped) = (self.error, self.stopped);
        format!(
            "<karui.Simplified: {triangles} triangles, error {error:.3e}, stopped by {stopped}>"
        )
    }
}

/// Collapses edges, cheapest first, until one of the bounds given is met: `ratio` (0 to 1) of the
/// triangles, `triangles`, `error` (model units) or `relative_error` (of the box's diagonal).
/// Without any, as far as it goes.
///
/// quality: "fast", "balanced" or "exact". weights: (n,) numbers of 0 or more, 1 is neutral,
/// larger ones keep detail. locks: (n,) bool, vertices that neither move nor vanish. border:
/// "preserve", "lock" or "free". placement: "optimal", or "half_edge" for vertices that are a
/// subset of the input's. regularity: preference for even triangles; 0.1 is mild, 0.5 strong.
/// attribute_weight: how much normals, UVs, colours and skins count; 0 is not at all.
/// keep_topology: whether small parts, holes and handles stay. progress: called with a stage and
/// a fraction; returning False cancels.
///
/// The result is the same for any number of threads. Raises InputError and Cancelled.
#[pyfunction]
#[pyo3(signature = (mesh, *, ratio=None, triangles=None, error=None, relative_error=None,
    quality="balanced", weights=None, locks=None, border="preserve", placement="optimal",
    regularity=0.0, attribute_weight=1.0, keep_topology=false, progress=None))]
#[expect(
    clippy::too_many_arguments,
    reason = "they are keywords of a Python function"
)]
pub fn simplify(
    py: Python<'_>,
    mesh: MeshLike,
    ratio: Option<f64>,
    triangles: Option<usize>,
    error: Option<f64>,
    relative_error: Option<f64>,
    quality: &str,
    weights: Option<&Bound<'_, PyAny>>,
    locks: Option<&Bound<'_, PyAny>>,
    border: &str,
    placement: &str,
    regularity: f64,
    attribute_weight: f64,
    keep_topology: bool,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Simplified> {
    let (weights, locks) = (scalars("weights", weights)?, flags("locks", locks)?);
    let topology = match keep_topology {
        true => Topology::Preserve,
        false => Topology::Simplify,
    };
    let stop = Stop {
        triangles,
        ratio,
        error,
        relative_error,
    };
    let (quality, border) = (
        choice("quality", quality, &QUALITIES)?,
        choice("border", border, &BORDERS)?,
    );
    let placement = choice("placement", placement, &PLACEMENTS)?;
    let attributes = attributes(attribute_weight);
    let done = run(py, progress, |progress| {
        let options = SimplifyOptions {
            stop,
            quality,
            border,
            placement,
            regularity,
            attributes,
            topology,
            weights: weights.as_deref(),
            locks: locks.as_deref(),
            progress,
            ..SimplifyOptions::default()
        };
        lib::simplify(&mesh.0, &options)
    })?;
    Ok(Simplified {
        mesh: Py::new(py, Mesh::of(done.mesh))?,
        error: done.error,
        stopped: reason(done.stopped),
        collapses: done.collapses,
    })
}
