//! What came of a plan, written piece by piece.

use karui::mesh::Attributes;
use karui::outofcore::{Error, Result, Sink, Vertices};
use karui_io::slices::PlyWriter;
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

/// A PLY file that takes a result.
pub struct PlySink(pub PlyWriter);

fn sunk<T>(written: karui_io::Result<T>) -> Result<T> {
    written.map_err(|error| Error::Sink(Box::new(error)))
}

impl Sink for PlySink {
    fn begin(&mut self, _: u64, _: u64, _: &Attributes) -> Result<()> {
        Ok(())
    }

    fn vertices(&mut self, vertices: &Vertices) -> Result<()> {
        sunk(self.0.write_vertices(vertices.clone()))
    }

    fn triangles(&mut self, triangles: &[[u64; 3]]) -> Result<()> {
        sunk(self.0.write_triangles(triangles))
    }
}
