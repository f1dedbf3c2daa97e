//! A triangle mesh, for Python.

use crate::arrays::{custom, floats, triangles, view};
use crate::attributes::{self, add};
use crate::errors::{Raise, input_error};
use crate::progress::run;
use crate::subdiv::Polygons;
use karui::{Scene, TriMesh};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::{path::PathBuf, sync::Arc};

/// A triangle mesh. It never changes, so that its arrays can be its own memory.
#[pyclass(frozen, module = "karui")]
pub struct Mesh(pub Arc<TriMesh>);

impl Mesh {
    /// Takes a mesh over.
    pub fn of(mesh: TriMesh) -> Self {
        Self(Arc::new(mesh))
    }

    /// A mesh of arrays, checked.
    pub fn of_arrays(positions: &Bound<'_, PyAny>, faces: &Bound<'_, PyAny>) -> PyResult<TriMesh> {
        let positions = floats("positions", positions, 3)?;
        Ok(TriMesh::new(positions, triangles(faces)?))
    }
}

#[pymethods]
impl Mesh {
    /// A mesh of arrays, which are copied once.
    ///
    /// positions: (n, 3) numbers, model units. triangles: (m, 3) integers, counter-clockwise
    /// seen from outside. normals: (n, 3), of length 1. uvs: (n, 2), v grows downwards as in
    /// glTF. colors: (n, 4), linear RGBA, 1 is full. attributes and face_attributes: further
    /// arrays by name, (n,) or (n, k) and (m,) or (m, k), of float32, float64 or integers of
    /// up to 32 bits; the names TANGENT, TEXCOORD_1, COLOR_1 and so on mean what they do in glTF.
    ///
    /// Raises InputError for wrong shapes or types, for numbers that are not finite and for
    /// triangles of vertices that do not exist.
    #[staticmethod]
    #[pyo3(signature = (positions, triangles, *, normals=None, uvs=None, colors=None,
        attributes=None, face_attributes=None))]
    fn from_arrays(
        positions: &Bound<'_, PyAny>,
        triangles: &Bound<'_, PyAny>,
        normals: Option<&Bound<'_, PyAny>>,
        uvs: Option<&Bound<'_, PyAny>>,
        colors: Option<&Bound<'_, PyAny>>,
        attributes: Option<&Bound<'_, PyDict>>,
        face_attributes: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let mut mesh = Self::of_arrays(positions, triangles)?;
        let usual = [
            ("NORMAL", normals),
            ("TEXCOORD_0", uvs),
            ("COLOR_0", colors),
        ];
        for (name, given) in usual {
            given.map_or(Ok(()), |given| add(&mut mesh, name, given))?;
        }
        for (name, given) in attributes.into_iter().flatten() {
            add(&mut mesh, &name.extract::<String>()?, &given)?;
        }
        for (name, given) in face_attributes.into_iter().flatten() {
            mesh.face_attributes
                .push(custom(&name.extract::<String>()?, &given)?);
        }
        mesh.validate().map_err(Raise::raise)?;
        Ok(Self::of(mesh))
    }

    /// Reads a file (glTF, GLB, OBJ, PLY, STL or OFF) as one mesh, in world space.
    ///
    /// Raises FileError, or InputError if the content is wrong.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let scene = run(py, None, |_| karui_io::read(&path))?;
        let mesh = run(py, None, |_| scene.into_single_mesh())?;
        Ok(Self::of(mesh))
    }

    /// Writes a file in the format that its extension asks for; all of it or nothing.
    ///
    /// Raises FileError, or InputError for an extension that is not known.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let scene = bare_scene(&self.0);
        run(py, None, |_| karui_io::write(&path, &scene))
    }

    /// (n, 3) float32, model units; a read-only view.
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        view::<f32, _, _>(py, &self.0, 3, |m| &m.positions)
    }

    /// (m, 3) uint32, counter-clockwise seen from outside; a read-only view.
    #[getter]
    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        view::<u32, _, _>(py, &self.0, 3, |m| &m.triangles)
    }

    /// (n, 3) float32 of length 1, or None; a read-only view.
    #[getter]
    fn normals<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        attributes::normals(py, &self.0)
    }

    /// (n, 2) float32, v growing downwards, or None: TEXCOORD_0; a read-only view.
    #[getter]
    fn uvs<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        attributes::uvs(py, &self.0, 0)
    }

    /// (n, 4) float32, linear RGBA, or None: COLOR_0; a read-only view.
    #[getter]
    fn colors<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        attributes::colors(py, &self.0, 0)
    }

    /// All that vertices carry besides positions, as read-only arrays by name: NORMAL,
    /// TANGENT, TEXCOORD_0, COLOR_0, JOINTS_0, WEIGHTS_0 as in glTF, then custom ones.
    #[getter]
    fn attributes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        attributes::dictionary(py, &self.0)
    }

    /// What triangles carry, as read-only arrays by name.
    #[getter]
    fn face_attributes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        attributes::face_dictionary(py, &self.0)
    }

    /// The least and the largest corner of the box around all vertices, model units.
    #[getter]
    fn bounds(&self) -> [[f32; 3]; 2] {
        let bounds = self.0.bounds();
        [bounds.min, bounds.max].map(Into::into)
    }

    fn __repr__(&self) -> String {
        let (triangles, vertices) = (self.0.triangles.len(), self.0.positions.len());
        format!("<karui.Mesh of {triangles} triangles and {vertices} vertices>")
    }
}

/// A mesh without what it was read with: its materials are not there.
pub fn bare_scene(mesh: &TriMesh) -> Scene {
    let mut mesh = mesh.clone();
    for range in &mut mesh.ranges {
        (range.material, range.source) = (None, None);
    }
    Scene::from_mesh(mesh)
}

/// A mesh as functions take it: a Mesh, Polygons, which are cut into triangles, a pair of arrays,
/// or what has `vertices` and `faces` (trimesh) or `points` and `regular_faces` (pyvista), of which
/// only the shape is taken.
pub struct MeshLike(pub Arc<TriMesh>);

impl<'a, 'py> FromPyObject<'a, 'py> for MeshLike {
    type Error = PyErr;

    fn extract(given: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(mesh) = given.cast::<Mesh>() {
            return Ok(Self(Arc::clone(&mesh.get().0)));
        }
        if let Ok(polygons) = given.cast::<Polygons>() {
            return Ok(Self(Arc::new(polygons.get().triangulated())));
        }
        let (positions, faces) = arrays_of("mesh", &given, MESHES)?;
        let mesh = Mesh::of_arrays(&positions, &faces)?;
        mesh.validate().map_err(Raise::raise)?;
        Ok(Self(Arc::new(mesh)))
    }
}

const MESHES: &str = "a karui.Mesh, a pair (positions, triangles) of arrays, karui.Polygons, or a \
    mesh of trimesh or pyvista";

type Pair<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>);

/// Positions and faces of a pair, or of another package's mesh.
pub fn arrays_of<'py>(
    what: &str,
    given: &Bound<'py, PyAny>,
    expected: &str,
) -> PyResult<Pair<'py>> {
    for (positions, faces) in [("vertices", "faces"), ("points", "regular_faces")] {
        if given.hasattr(positions)? && given.hasattr(faces)? {
            return Ok((given.getattr(positions)?, given.getattr(faces)?));
        }
    }
    given
        .extract()
        .map_err(|_| input_error(what, &format!("a {}", given.get_type()), expected))
}
