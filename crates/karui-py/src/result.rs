//! What came of a plan, written piece by piece.

use pyo3::prelude::*;

/// What `Plan.write` has written.
#[pyclass(frozen, get_all, module = "karui")]
pub struct Summary {
    /// Triangles of the model.
    input: u64,
    /// Vertices of the result.
    vertices: u64,
    /// Triangles of the result.
    triangles: u64,
    /// Estimate of the distance to the model, model units.
    error: f64,
}

impl From<karui::outofcore::Summary> for Summary {
    fn from(summary: karui::outofcore::Summary) -> Self {
        let karui::outofcore::Summary {
            input,
            vertices,
            triangles,
            error,
            ..
        } = summary;
        Self {
            input,
            vertices,
            triangles,
            error,
        }
    }
}

#[pymethods]
impl Summary {
    fn __repr__(&self) -> String {
        let Self {
            input,
            triangles,
            error,
            ..
        } = self;
        format!("<karui.Summary: {triangles} of {input} triangles, error {error:.3e}>")
    }
}
