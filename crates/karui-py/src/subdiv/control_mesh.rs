//! Control meshes, for Python.

use super::polygons::Polygons;
use crate::arrays::{faces, floats, indices, owned, repeated, view};
use crate::errors::{Raise, input_error};
use crate::mesh::{Mesh, arrays_of};
use crate::progress::run;
use karui::geom::Vec2;
use karui::subdiv::{self as lib, Cage, Corner, Crease, FaceVarying, INFINITELY_SHARP};
use karui::{PolyMesh, TriMesh};
use numpy::PyArray1;
use pyo3::prelude::*;
use std::{path::PathBuf, sync::Arc};

type Given<'a, 'py> = Option<&'a Bound<'py, PyAny>>;
type Array<'py> = PyResult<Bound<'py, PyAny>>;

/// The coarse mesh of a subdivision surface: faces with any number of corners, what is sharp, and
/// what is left out. It never changes, so that its arrays can be its own memory.
#[pyclass(frozen, module = "karui")]
pub struct ControlMesh {
    mesh: Arc<lib::ControlMesh>,
    warnings: Vec<String>,
}

#[pymethods]
impl ControlMesh {
    /// A control mesh of arrays, which are copied once.
    ///
    /// positions: (n, 3) numbers, model units. faces: rows of an array (m, k) or sequences, one
    /// each, of integers, counter-clockwise seen from outside; with offsets, (m + 1,) integers,
    /// (c,) corners of all faces, of which face f has those from offsets[f] to offsets[f + 1].
    /// creases: (e, 2) integers, the ends of sharp edges. corners: (s,) integers, sharp vertices.
    /// crease_sharpness and corner_sharpness: (e,) and (s,) numbers, or one for all: the number of
    /// steps that they stay sharp, 10 or more is for ever. holes: (h,) integers, faces that shape
    /// the surface but are left out of it. uvs: (n, 2), v grows downwards; with uv_indices, (c,)
    /// integers, any number of them, of which each corner has one. colors: (n, 4), linear RGBA.
    ///
    /// Raises InputError for wrong shapes or types, for numbers that are not finite or negative
    /// sharpness, for faces of fewer than three corners and for what names something that does not
    /// exist.
    #[staticmethod]
    #[pyo3(signature = (positions, faces, offsets=None, *, creases=None,
        crease_sharpness=None, corners=None, corner_sharpness=None, holes=None, uvs=None,
        uv_indices=None, colors=None))]
    #[expect(
        clippy::too_many_arguments,
        reason = "they are keywords of a Python function"
    )]
    fn from_arrays(
        positions: &Bound<'_, PyAny>,
        faces: &Bound<'_, PyAny>,
        offsets: Given<'_, '_>,
        creases: Given<'_, '_>,
        crease_sharpness: Given<'_, '_>,
        corners: Given<'_, '_>,
        corner_sharpness: Given<'_, '_>,
        holes: Given<'_, '_>,
        uvs: Given<'_, '_>,
        uv_indices: Given<'_, '_>,
        colors: Given<'_, '_>,
    ) -> PyResult<Self> {
        let mut mesh = of_arrays(positions, faces, offsets)?;
        mesh.cage.creases = self::creases(creases, crease_sharpness)?;
        mesh.cage.corners = self::corners(corners, corner_sharpness)?;
        let holes = holes.map(|given| indices("holes", given, 0));
        mesh.cage.holes = holes.transpose()?.unwrap_or_default();
        mesh.uvs = texture(&mesh.cage, uvs, uv_indices)?;
        let colors = colors.map(|given| floats("colors", given, 4));
        mesh.colors = colors.transpose()?;
        mesh.validate().map_err(Raise::raise)?;
        Ok(Self {
            mesh: Arc::new(mesh),
            warnings: Vec::new(),
        })
    }

    /// Reads a file (OBJ, PLY, OFF, STL, glTF, GLB; all but glTF also as .gz) with faces as they
    /// are. Of OBJ the tags `t crease`, `t corner`, `t hole` and those of rules are read. In other
    /// formats vertices at one position are joined if they have texture coordinates or normals.
    ///
    /// Raises FileError, or InputError if the content is wrong.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let loaded = run(py, None, |_| karui_io::read_control(&path))?;
        loaded.mesh.validate().map_err(Raise::raise)?;
        Ok(Self {
            mesh: Arc::new(loaded.mesh),
            warnings: loaded.warnings,
        })
    }

    /// (n, 3) float32, model units; a read-only view.
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> Array<'py> {
        view::<f32, _, _>(py, &self.mesh, 3, |m| &m.positions)
    }

    /// (c,) uint32: vertices of the corners of all faces; a read-only view.
    #[getter]
    fn indices<'py>(&self, py: Python<'py>) -> Array<'py> {
        view::<u32, _, _>(py, &self.mesh, 0, |m| &m.cage.indices)
    }

    /// (m + 1,) uint32: face f has the corners offsets[f] to offsets[f + 1]; a read-only view.
    #[getter]
    fn offsets<'py>(&self, py: Python<'py>) -> Array<'py> {
        view::<u32, _, _>(py, &self.mesh, 0, |m| &m.cage.offsets)
    }

    /// (e, 2) uint32: the ends of sharp edges.
    #[getter]
    fn creases<'py>(&self, py: Python<'py>) -> Array<'py> {
        let creases = self.mesh.cage.creases.iter();
        owned(py, creases.map(|crease| crease.vertices).collect())
    }

    /// (e,) float32: steps that the edges of `creases` stay sharp; 10 is for ever.
    #[getter]
    fn crease_sharpness<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        let creases = self.mesh.cage.creases.iter();
        PyArray1::from_iter(py, creases.map(|crease| crease.sharpness))
    }

    /// (s,) uint32: sharp vertices.
    #[getter]
    fn corners<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        let corners = self.mesh.cage.corners.iter();
        PyArray1::from_iter(py, corners.map(|corner| corner.vertex))
    }

    /// (s,) float32: steps that the vertices of `corners` stay sharp; 10 is for ever.
    #[getter]
    fn corner_sharpness<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        let corners = self.mesh.cage.corners.iter();
        PyArray1::from_iter(py, corners.map(|corner| corner.sharpness))
    }

    /// (h,) uint32: faces that shape the surface but are left out of it; a read-only view.
    #[getter]
    fn holes<'py>(&self, py: Python<'py>) -> Array<'py> {
        view::<u32, _, _>(py, &self.mesh, 0, |m| &m.cage.holes)
    }

    /// (u, 2) float32, v growing downwards, or None: texture coordinates; a read-only view.
    #[getter]
    fn uvs<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let Some(_) = self.mesh.uvs else {
            return Ok(None);
        };
        view::<f32, _, _>(py, &self.mesh, 2, |m| {
            m.uvs.as_ref().map_or(&[], |uvs| &uvs.values)
        })
        .map(Some)
    }

    /// (c,) uint32, or None: which of `uvs` each corner has; a read-only view.
    #[getter]
    fn uv_indices<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let Some(_) = self.mesh.uvs else {
            return Ok(None);
        };
        view::<u32, _, _>(py, &self.mesh, 0, |m| {
            m.uvs.as_ref().map_or(&[], |uvs| &uvs.indices)
        })
        .map(Some)
    }

    /// (n, 4) float32, linear RGBA, or None; a read-only view.
    #[getter]
    fn colors<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let Some(_) = self.mesh.colors else {
            return Ok(None);
        };
        view::<f32, _, _>(py, &self.mesh, 4, |m| {
            m.colors.as_deref().unwrap_or_default()
        })
        .map(Some)
    }

    /// What the reader has passed over.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }

    fn __repr__(&self) -> String {
        let cage = &self.mesh.cage;
        let (faces, vertices) = (cage.face_count(), cage.vertices);
        let sharp = cage.creases.len() + cage.corners.len();
        format!("<karui.ControlMesh of {faces} faces, {vertices} vertices and {sharp} sharp tags>")
    }
}

fn of_arrays(
    positions: &Bound<'_, PyAny>,
    corners: &Bound<'_, PyAny>,
    offsets: Given<'_, '_>,
) -> PyResult<lib::ControlMesh> {
    let positions: Vec<_> = floats("positions", positions, 3)?;
    let (indices, offsets) = match offsets {
        Some(offsets) => (
            indices("faces", corners, 0)?,
            indices("offsets", offsets, 0)?,
        ),
        None => faces(corners)?,
    };
    Ok(lib::ControlMesh {
        cage: Cage {
            vertices: positions.len(),
            offsets,
            indices,
            ..Cage::default()
        },
        positions,
        ..lib::ControlMesh::default()
    })
}

fn creases(edges: Given<'_, '_>, sharpness: Given<'_, '_>) -> PyResult<Vec<Crease>> {
    let edges = edges
        .map(|given| indices("creases", given, 2))
        .transpose()?;
    let edges: Vec<[u32; 2]> = edges.unwrap_or_default();
    let sharpness = sharpnesses("crease_sharpness", sharpness, edges.len())?;
    let both = edges.into_iter().zip(sharpness);
    Ok(both
        .map(|(vertices, sharpness)| Crease {
            vertices,
            sharpness,
        })
        .collect())
}

fn corners(vertices: Given<'_, '_>, sharpness: Given<'_, '_>) -> PyResult<Vec<Corner>> {
    let vertices = vertices
        .map(|given| indices("corners", given, 0))
        .transpose()?;
    let vertices: Vec<u32> = vertices.unwrap_or_default();
    let sharpness = sharpnesses("corner_sharpness", sharpness, vertices.len())?;
    let both = vertices.into_iter().zip(sharpness);
    Ok(both
        .map(|(vertex, sharpness)| Corner { vertex, sharpness })
        .collect())
}

fn sharpnesses(what: &str, given: Given<'_, '_>, count: usize) -> PyResult<Vec<f32>> {
    given.map_or(Ok(vec![INFINITELY_SHARP; count]), |given| {
        repeated(what, given, count)
    })
}

fn texture(
    cage: &Cage,
    uvs: Given<'_, '_>,
    uv_indices: Given<'_, '_>,
) -> PyResult<Option<FaceVarying>> {
    let values: Vec<Vec2> = match uvs {
        Some(given) => floats("uvs", given, 2)?,
        None if uv_indices.is_some() => {
            return Err(input_error("uvs", "missing", "there with `uv_indices`"));
        }
        None => return Ok(None),
    };
    let indices = match uv_indices {
        Some(given) => indices("uv_indices", given, 0)?,
        None if values.len() == cage.vertices => cage.indices.clone(),
        None => {
            let found = format!("of {} rows", values.len());
            let expected = format!("one a vertex, {}, without `uv_indices`", cage.vertices);
            return Err(input_error("uvs", &found, &expected));
        }
    };
    Ok(Some(FaceVarying { values, indices }))
}

/// A control mesh as functions take it: a ControlMesh, a Mesh or Polygons, whose vertices at one
/// position are joined at seams, arrays, or another package's mesh, of which only the shape is
/// taken.
pub struct ControlLike(pub Arc<lib::ControlMesh>);

const CONTROL_MESHES: &str = "a karui.ControlMesh, Mesh or Polygons, a pair (positions, faces), a \
    triple (positions, indices, offsets), or a mesh of trimesh or pyvista";

impl<'a, 'py> FromPyObject<'a, 'py> for ControlLike {
    type Error = PyErr;

    fn extract(given: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(control) = given.cast::<ControlMesh>() {
            return Ok(Self(Arc::clone(&control.get().mesh)));
        }
        let mesh = if let Ok(mesh) = given.cast::<Mesh>() {
            let polygons = PolyMesh::from(TriMesh::clone(&mesh.get().0));
            lib::ControlMesh::of_poly_mesh(&polygons)
        } else if let Ok(polygons) = given.cast::<Polygons>() {
            lib::ControlMesh::of_poly_mesh(&polygons.get().0)
        } else if let Ok(three) = given.extract::<[Bound<'py, PyAny>; 3]>() {
            let [positions, indices, offsets] = &three;
            of_arrays(positions, indices, Some(offsets))?
        } else {
            let (positions, faces) = arrays_of("cage", &given, CONTROL_MESHES)?;
            of_arrays(&positions, &faces, None)?
        };
        mesh.validate().map_err(Raise::raise)?;
        Ok(Self(Arc::new(mesh)))
    }
}
