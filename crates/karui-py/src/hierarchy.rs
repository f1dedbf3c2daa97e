//! Refinement by view and by light, for Python.

use crate::arrays::{flags, scalars};
use crate::camera::{Camera, lights};
use crate::errors::{FileError, Raise};
use crate::mesh::{Mesh, MeshLike};
use crate::progress::run;
use crate::whole_file::write_whole;
use karui::hierarchy::{self as lib, Budget, HierarchyOptions, Silhouette, ViewAndLight};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use self_cell::self_cell;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::{fs, path::PathBuf};

type LibCut<'a> = lib::Cut<'a>;

self_cell!(
    /// A cut beside the hierarchy that it is of.
    struct Held {
        owner: Arc<lib::Hierarchy>,
        #[covariant]
        dependent: LibCut,
    }
);

/// A mesh prepared once, so that every frame gets the triangles that its view and its lights need,
/// over the mesh's own vertices. It never changes; any number of cuts share it.
#[pyclass(frozen, module = "karui")]
pub struct Hierarchy(Arc<lib::Hierarchy>);

#[pymethods]
impl Hierarchy {
    /// Prepares a mesh, down to one in `alpha` of its vertices. weights: (n,) numbers of 0 or more,
    /// larger ones keep detail. locks: (n,) bool, vertices that do not vanish. progress: called
    /// with a stage and a fraction; returning False cancels.
    ///
    /// Raises InputError and Cancelled.
    #[staticmethod]
    #[pyo3(signature = (mesh, *, alpha=10.0, weights=None, locks=None, progress=None))]
    fn build(
        py: Python<'_>,
        mesh: MeshLike,
        alpha: f64,
        weights: Option<&Bound<'_, PyAny>>,
        locks: Option<&Bound<'_, PyAny>>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let (weights, locks) = (scalars("weights", weights)?, flags("locks", locks)?);
        let built = run(py, progress, |progress| {
            let options = HierarchyOptions {
                alpha,
                weights: weights.as_deref(),
                locks: locks.as_deref(),
                progress,
            };
            lib::Hierarchy::build(&mesh.0, &options)
        })?;
        Ok(Self(Arc::new(built)))
    }

    /// Reads what `save` or `karui hierarchy build` has written.
    ///
    /// Raises FileError, or InputError if the content is wrong.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let refused = |e| FileError::new_err(format!("{}: {e}", path.display()));
        let bytes = py.detach(|| fs::read(&path)).map_err(refused)?;
        let read = run(py, None, |_| lib::Hierarchy::from_bytes(&bytes))?;
        Ok(Self(Arc::new(read)))
    }

    /// Writes it to a file; the mesh is not in it.
    ///
    /// Raises FileError.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| write_whole(&path, &self.0.to_bytes()))
    }

    /// Whether it was built from this mesh: the same triangles and positions.
    fn is_of(&self, mesh: MeshLike) -> bool {
        self.0.is_of(&mesh.0)
    }

    /// A cut with as few triangles as there can be.
    fn coarsest(&self, py: Python<'_>) -> Cut {
        py.detach(|| Cut(Mutex::new(Held::new(Arc::clone(&self.0), |h| h.coarsest()))))
    }

    /// A cut that is the mesh itself.
    fn finest(&self, py: Python<'_>) -> Cut {
        py.detach(|| Cut(Mutex::new(Held::new(Arc::clone(&self.0), |h| h.finest()))))
    }

    /// Number of triangles of the finest cut.
    #[getter]
    fn triangle_count(&self) -> usize {
        self.0.triangle_count()
    }

    /// Number of triangles of the coarsest cut.
    #[getter]
    fn coarsest_triangle_count(&self) -> usize {
        self.0.counts().coarsest
    }

    fn __repr__(&self) -> String {
        let (finest, coarsest) = (self.triangle_count(), self.coarsest_triangle_count());
        format!("<karui.Hierarchy of {coarsest} to {finest} triangles>")
    }
}

/// All state of one view of a hierarchy.
#[pyclass(frozen, module = "karui")]
pub struct Cut(Mutex<Held>);

impl Cut {
    fn lock(&self) -> MutexGuard<'_, Held> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl Cut {
    /// Makes this the cut that a camera asks for, at a picture of `size` (width, height; pixels).
    ///
    /// lights: (k, 3), where the light of each goes to. triangles: at most this many, those that
    /// are largest in the picture. area: least area in the picture, square pixels, of what a
    /// vertex touches. flatness: least angle between normals, degrees. silhouette and
    /// light_silhouette: area, square pixels, down to which outlines and the borders of shade are
    /// kept; None keeps them no more than the rest. highlight: degrees around a mirrored light
    /// that are kept down to `highlight_area` square pixels; 0 is none. hysteresis: 1, or by how
    /// much larger what is there may look before it goes; the mesh then depends on the path.
    ///
    /// Raises InputError; the cut is then what it was.
    #[pyo3(signature = (camera, *, size=(1920, 1080), lights=Vec::new(), triangles=None, area=25.0,
        flatness=3.0, silhouette=Some(4.0), light_silhouette=Some(4.0), highlight=30.0,
        highlight_area=4.0, hysteresis=1.0),
        text_signature = "($self, camera, *, size=(1920, 1080), lights=(), triangles=None, \
        area=25.0, flatness=3.0, silhouette=4.0, light_silhouette=4.0, highlight=30.0, \
        highlight_area=4.0, hysteresis=1.0)")]
    #[expect(
        clippy::too_many_arguments,
        reason = "they are keywords of a Python function"
    )]
    fn refine(
        &self,
        py: Python<'_>,
        camera: &Camera,
        size: (u32, u32),
        lights: Vec<[f32; 3]>,
        triangles: Option<usize>,
        area: f64,
        flatness: f64,
        silhouette: Option<f64>,
        light_silhouette: Option<f64>,
        highlight: f64,
        highlight_area: f64,
        hysteresis: f64,
    ) -> PyResult<Change> {
        let kept =
            |area: Option<f64>| area.map_or(Silhouette::Ignored, |area| Silhouette::Kept { area });
        let criteria = ViewAndLight {
            camera: camera.0,
            size: [size.0, size.1],
            lights: self::lights(&lights),
            silhouette: kept(silhouette),
            light_silhouette: kept(light_silhouette),
            area,
            flatness,
            highlight,
            highlight_area,
            hysteresis,
            ..ViewAndLight::default()
        };
        let budget = Budget {
            triangles,
            time: None,
        };
        let refine = || {
            self.lock()
                .with_dependent_mut(|_, cut| cut.refine(&criteria, budget))
        };
        py.detach(refine).map(Change::from).map_err(Raise::raise)
    }

    /// (k, 3) uint32: the triangles to draw, over the vertices of the mesh. A copy; `Change.ranges`
    /// tells what of it is new.
    #[getter]
    fn indices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let all = py.detach(|| self.lock().borrow_dependent().indices().to_vec());
        let rows = all.len();
        let flat = PyArray1::from_vec(py, all.into_flattened());
        Ok(flat.reshape([rows, 3])?.into_any())
    }

    /// The mesh to draw, with the attributes of the one that the hierarchy was built from, without
    /// vertices that are not used.
    ///
    /// Raises InputError if `mesh` is not that one.
    fn to_mesh(&self, py: Python<'_>, mesh: MeshLike) -> PyResult<Mesh> {
        let drawn = py.detach(|| self.lock().borrow_dependent().to_mesh(&mesh.0));
        Ok(Mesh::of(drawn.map_err(Raise::raise)?))
    }
}

/// What a call of `Cut.refine` has changed.
#[pyclass(frozen, get_all, module = "karui")]
pub struct Change {
    /// Rows of `Cut.indices` that are new, as pairs of first and one past the last.
    ranges: Vec<(u32, u32)>,
    /// Triangles to draw.
    triangles: usize,
    /// Collapses undone.
    splits: usize,
    /// Collapses applied.
    collapses: usize,
    /// Square pixels below which the budget has left out what would have been kept; 0 if nothing.
    floor: f64,
}

impl From<lib::Change> for Change {
    fn from(change: lib::Change) -> Self {
        Self {
            ranges: change.ranges.iter().map(|r| (r.start, r.end)).collect(),
            triangles: change.triangles,
            splits: change.splits,
            collapses: change.collapses,
            floor: change.floor,
        }
    }
}
