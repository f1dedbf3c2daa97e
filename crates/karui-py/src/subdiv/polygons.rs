//! Meshes of polygons, for Python.

use crate::arrays::view;
use crate::attributes;
use crate::mesh::Mesh;
use karui::{PolyMesh, TriMesh};
use pyo3::prelude::*;
use std::sync::Arc;

/// A mesh of faces with any number of corners. It never changes, so that its arrays can be its own
/// memory. Functions that take a mesh take it cut into triangles.
#[pyclass(frozen, module = "karui")]
pub struct Polygons(pub Arc<PolyMesh>);

impl Polygons {
    /// Takes a mesh over.
    pub fn of(mesh: PolyMesh) -> Self {
        Self(Arc::new(mesh))
    }

    /// In triangles, whose materials are not there.
    pub fn triangulated(&self) -> TriMesh {
        let mut polygons = PolyMesh::clone(&self.0);
        polygons.face_materials.clear();
        polygons.triangulate()
    }

    /// Corners of a face, if all have the same number.
    fn face_size(&self) -> Option<usize> {
        let offsets = &self.0.offsets;
        let size = *offsets.get(1)?;
        let even = offsets.windows(2).all(|w| w[1] - w[0] == size);
        even.then_some(size as usize)
    }
}

#[pymethods]
impl Polygons {
    /// (n, 3) float32, model units; a read-only view.
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        view::<f32, _, _>(py, &self.0, 3, |m| &m.positions)
    }

    /// (c,) uint32: vertices of the corners of all faces, counter-clockwise seen from outside; a
    /// read-only view.
    #[getter]
    fn indices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        view::<u32, _, _>(py, &self.0, 0, |m| &m.indices)
    }

    /// (m + 1,) uint32: face f has the corners offsets[f] to offsets[f + 1]; a read-only view.
    #[getter]
    fn offsets<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        view::<u32, _, _>(py, &self.0, 0, |m| &m.offsets)
    }

    /// (m, k) uint32 if all m faces have k corners, else None; a read-only view of `indices`.
    #[getter]
    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let rows = |size| view::<u32, _, _>(py, &self.0, size, |m| &m.indices);
        self.face_size().map(rows).transpose()
    }

    /// (n, 3) float32 of length 1, or None; a read-only view.
    #[getter]
    fn normals<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        attributes::normals(py, &self.0)
    }

    /// (n, 2) float32, v growing downwards, or None; a read-only view.
    #[getter]
    fn uvs<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        attributes::uvs(py, &self.0, 0)
    }

    /// (n, 4) float32, linear RGBA, or None; a read-only view.
    #[getter]
    fn colors<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        attributes::colors(py, &self.0, 0)
    }

    /// The same in triangles, n - 2 of a face of n corners, with the same vertices.
    fn to_mesh(&self, py: Python<'_>) -> Mesh {
        py.detach(|| Mesh::of(self.triangulated()))
    }

    fn __repr__(&self) -> String {
        let (faces, vertices) = (self.0.face_count(), self.0.positions.len());
        format!("<karui.Polygons of {faces} faces and {vertices} vertices>")
    }
}
