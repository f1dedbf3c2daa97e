//! A cage refined once and evaluated as often as wanted, for Python.

use super::control_mesh::ControlLike;
use super::options::{RuleNames, scheme};
use crate::arrays::{array, floats, indices, owned, view};
use crate::errors::{Raise, input_error};
use crate::progress::run;
use bytemuck::{Pod, allocation::cast_vec};
use karui::subdiv::{self as lib, Faces, SubdivOptions, Workspace};
use numpy::{PyArray1, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use std::mem::take;
use std::sync::{Arc, Mutex, PoisonError};

type Array<'py> = PyResult<Bound<'py, PyAny>>;

/// The connectivity of a refined cage, made once; values of the cage's vertices, e.g. the positions
/// of every frame of an animation, follow from it as often as wanted.
///
/// The cage and the options are those of `subdivide`, as are the faces, but for two things: holes
/// are still there, and vertices are not split at seams. The cage's vertices come first and keep
/// their numbers. Raises InputError and Cancelled.
#[pyclass(frozen, module = "karui")]
pub struct Refinement {
    fine: Arc<lib::Refinement>,
    /// For the next frame.
    memory: Mutex<Workspace<3>>,
}

#[pymethods]
impl Refinement {
    #[new]
    #[pyo3(signature = (cage, levels=1, scheme="catmull-clark", *, boundary=None,
        crease_method=None, triangle_rule=None, uv_rule=None, max_faces=1 << 28, progress=None),
        text_signature = "(cage, levels=1, scheme='catmull-clark', *, boundary=None, \
        crease_method=None, triangle_rule=None, uv_rule=None, max_faces=268435456, progress=None)")]
    #[expect(
        clippy::too_many_arguments,
        reason = "they are keywords of a Python function"
    )]
    fn new(
        py: Python<'_>,
        cage: ControlLike,
        levels: u32,
        scheme: &str,
        boundary: Option<&str>,
        crease_method: Option<&str>,
        triangle_rule: Option<&str>,
        uv_rule: Option<&str>,
        max_faces: u64,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let names = RuleNames {
            boundary,
            crease_method,
            triangle_rule,
            uv_rule,
        };
        let options = names.over(cage.0.rules)?.apply(SubdivOptions {
            scheme: self::scheme(scheme)?,
            levels,
            max_faces,
            ..SubdivOptions::default()
        });
        let fine = run(py, progress, |progress| {
            lib::Refinement::with_progress(&cage.0.cage, &options, progress)
        })?;
        Ok(Self::of(fine))
    }

    /// The refinement of values that differ from face to face at one vertex, such as texture
    /// coordinates. indices: (c,) integers, which of `count` values each corner of the cage has.
    /// Its faces are those of this refinement, in the same order.
    ///
    /// Raises InputError, also under "sqrt3" and after odd numbers of "sqrt2" steps.
    fn face_varying(
        &self,
        py: Python<'_>,
        indices: &Bound<'_, PyAny>,
        count: usize,
    ) -> PyResult<Self> {
        let indices: Vec<u32> = self::indices("indices", indices, 0)?;
        run(py, None, |_| self.fine.face_varying(&indices, count)).map(Self::of)
    }

    /// Values after the last step, float32, from values of the cage: positions, colours or whatever
    /// else 1 to 4 numbers a vertex are. values: (n,) or (n, k) numbers; the result has as many
    /// columns.
    ///
    /// Raises InputError.
    fn evaluate<'py>(&self, py: Python<'py>, values: &Bound<'py, PyAny>) -> Array<'py> {
        match *array("values", values)?.shape() {
            [_] => {
                let made = self.columns::<1>(py, values, 0, &mut Workspace::default())?;
                Ok(PyArray1::from_vec(py, made.into_flattened()).into_any())
            }
            [_, 1] => owned(
                py,
                self.columns::<1>(py, values, 1, &mut Workspace::default())?,
            ),
            [_, 2] => owned(
                py,
                self.columns::<2>(py, values, 2, &mut Workspace::default())?,
            ),
            [_, 3] => {
                // Another thread may be at it as well, and begins anew.
                let mut memory = take(&mut *self.lock());
                let made = self.columns(py, values, 3, &mut memory);
                *self.lock() = memory;
                owned(py, made?)
            }
            [_, 4] => owned(
                py,
                self.columns::<4>(py, values, 4, &mut Workspace::default())?,
            ),
            ref shape => {
                let found = format!("of shape {shape:?}");
                Err(input_error(
                    "values",
                    &found,
                    "of shape (n,) or (n, 1 to 4)",
                ))
            }
        }
    }

    /// The surface after infinitely many steps, at all vertices after the last one. positions:
    /// (n, 3) numbers, those of the cage.
    ///
    /// Raises InputError, also under "sqrt3".
    fn limits(&self, py: Python<'_>, positions: &Bound<'_, PyAny>) -> PyResult<Limits> {
        let positions: Vec<[f32; 3]> = floats("positions", positions, 3)?;
        let limits = run(py, None, |_| self.fine.limits(&positions))?;
        Limits::of(py, limits)
    }

    /// Number of vertices after the last step.
    #[getter]
    fn vertex_count(&self) -> usize {
        self.fine.vertex_count()
    }

    /// Number of faces after the last step, holes among them.
    #[getter]
    fn face_count(&self) -> usize {
        self.fine.faces().count()
    }

    /// (c,) uint32: vertices of the corners of all faces; a read-only view.
    #[getter]
    fn indices<'py>(&self, py: Python<'py>) -> Array<'py> {
        view::<u32, _, _>(py, &self.fine, 0, |r| r.corners())
    }

    /// (m + 1,) uint32: face f has the corners offsets[f] to offsets[f + 1].
    #[getter]
    fn offsets<'py>(&self, py: Python<'py>) -> Array<'py> {
        match *self.fine.faces() {
            Faces::Uniform { size, count } => {
                let offsets = (0..=count).map(|f| f * size);
                Ok(PyArray1::from_iter(py, offsets).into_any())
            }
            Faces::Mixed { .. } => view::<u32, _, _>(py, &self.fine, 0, |r| match r.faces() {
                Faces::Mixed { offsets, .. } => offsets,
                Faces::Uniform { .. } => &[],
            }),
        }
    }

    /// (m, k) uint32 if all m faces have k corners, else None; a read-only view of `indices`.
    #[getter]
    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let rows = |size| view::<u32, _, _>(py, &self.fine, size as usize, |r| r.corners());
        self.fine.faces().size().map(rows).transpose()
    }

    /// (t, 3) uint32: all faces but holes as fans of triangles from their first corners, the same
    /// for any positions.
    #[getter]
    fn triangles<'py>(&self, py: Python<'py>) -> Array<'py> {
        owned(py, py.detach(|| self.fans()))
    }

    /// (m,) uint32: the face of the cage that every face lies in; one of two if it lies across an
    /// edge.
    #[getter]
    fn parents<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u32>> {
        PyArray1::from_vec(py, py.detach(|| self.fine.parents()))
    }

    /// (m,) bool: faces that are left out of the surface.
    #[getter]
    fn holes<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        PyArray1::from_iter(py, (0..self.face_count()).map(|f| self.fine.is_hole(f)))
    }

    fn __repr__(&self) -> String {
        let (faces, vertices) = (self.face_count(), self.vertex_count());
        format!("<karui.Refinement of {faces} faces and {vertices} vertices>")
    }
}

impl Refinement {
    fn of(fine: lib::Refinement) -> Self {
        Self {
            fine: Arc::new(fine),
            memory: Mutex::default(),
        }
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, Workspace<3>> {
        self.memory.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn columns<const N: usize>(
        &self,
        py: Python<'_>,
        values: &Bound<'_, PyAny>,
        columns: usize,
        memory: &mut Workspace<N>,
    ) -> PyResult<Vec<[f32; N]>>
    where
        [f32; N]: Pod,
    {
        let values: Vec<[f32; N]> = floats("values", values, columns)?;
        let mut made = Vec::new();
        py.detach(|| self.fine.evaluate_into(&values, memory, &mut made))
            .map_err(Raise::raise)?;
        Ok(made)
    }

    fn fans(&self) -> Vec<[u32; 3]> {
        let faces = (0..self.face_count()).filter(|&f| !self.fine.is_hole(f));
        let corners = faces.map(|f| &self.fine.corners()[self.fine.faces().corners(f)]);
        corners
            .flat_map(|face| face[1..].windows(2).map(|w| [face[0], w[0], w[1]]))
            .collect()
    }
}

/// The surface after infinitely many steps, at vertices.
#[pyclass(frozen, get_all, module = "karui")]
pub struct Limits {
    /// (n, 3) float32: points of the surface, model units.
    positions: Py<PyAny>,
    /// (n, 2, 3) float32: two directions along the surface, of any length; zero at vertices of no
    /// face.
    tangents: Py<PyAny>,
    /// (n, 3) float32 of length 1; zero where the tangents are one direction.
    normals: Py<PyAny>,
    /// (n,) bool: whether there are several normals, of which this is one: on creases, at corners.
    one_sided: Py<PyArray1<bool>>,
}

impl Limits {
    fn of(py: Python<'_>, limits: lib::Limits) -> PyResult<Self> {
        let points = limits.positions.len();
        let tangents: Vec<[f32; 6]> = cast_vec(limits.tangents);
        let tangents = PyArray1::from_vec(py, tangents.into_flattened());
        Ok(Self {
            positions: owned::<f32, 3>(py, cast_vec(limits.positions))?.unbind(),
            tangents: tangents.reshape([points, 2, 3])?.into_any().unbind(),
            normals: owned::<f32, 3>(py, cast_vec(limits.normals))?.unbind(),
            one_sided: PyArray1::from_vec(py, limits.one_sided).unbind(),
        })
    }
}
