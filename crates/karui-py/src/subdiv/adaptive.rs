//! A cage refined where it is looked at, for Python.

use super::control_mesh::ControlLike;
use super::options::RuleNames;
use super::polygons::Polygons;
use crate::arrays::floats;
use crate::camera::{Camera, lights};
use crate::errors::Raise;
use crate::progress::run;
use karui::geom::Vec3;
use karui::subdiv::adaptive::{self as lib, AdaptiveOptions, View};
use karui::subdiv::{ControlMesh, SubdivOptions};
use numpy::PyArray1;
use pyo3::prelude::*;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A cage that is refined anew for every view, without cracks, and what is kept in between.
///
/// The cage and the rules are those of `subdivide`; refinement is by √2 steps, two to a step of
/// Catmull-Clark, and vertices are where that puts them. Raises InputError, also where faces do not
/// meet in pairs.
#[pyclass(frozen, module = "karui")]
pub struct Adaptive(Mutex<lib::Adaptive>);

impl Adaptive {
    fn lock(&self) -> MutexGuard<'_, lib::Adaptive> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl Adaptive {
    #[new]
    #[pyo3(signature = (cage, *, boundary=None, crease_method=None, triangle_rule=None))]
    fn new(
        py: Python<'_>,
        cage: ControlLike,
        boundary: Option<&str>,
        crease_method: Option<&str>,
        triangle_rule: Option<&str>,
    ) -> PyResult<Self> {
        let names = RuleNames {
            boundary,
            crease_method,
            triangle_rule,
            uv_rule: None,
        };
        let rules = names.over(cage.0.rules)?;
        let cage = ControlMesh {
            rules,
            ..(*cage.0).clone()
        };
        let made = run(py, None, |_| {
            lib::Adaptive::of_control(&cage, &SubdivOptions::default())
        })?;
        Ok(Self(Mutex::new(made)))
    }

    /// Puts the vertices of the cage elsewhere. positions: (n, 3) numbers, model units.
    ///
    /// Raises InputError; the cage is then where it was.
    fn move_cage(&self, py: Python<'_>, positions: &Bound<'_, PyAny>) -> PyResult<()> {
        let positions: Vec<Vec3> = floats("positions", positions, 3)?;
        py.detach(|| self.lock().move_cage(&positions))
            .map_err(Raise::raise)
    }

    /// The mesh for a picture of `size` (width, height; pixels) that a camera takes.
    ///
    /// pixels: how close front faces must come to the limit surface; silhouette_pixels: the same
    /// at silhouettes, by default half of it; without pixels depths decide alone. terminator_pixels:
    /// the same where light and dark part; lights: (k, 3), where the light of each goes to.
    /// side_pixels: longest side of a front face, pixels. depth_front, depth_silhouette and
    /// depth_hidden: most √2 steps, at most 30, of faces by what they are; by default 4, 8 and 0,
    /// with pixels 20, 20 and 0. two_sided: whether faces are seen from behind as well. limit:
    /// whether vertices are on the limit surface. max_faces: nothing is split once there are so
    /// many. max_kept: faces kept from other views, about 480 bytes each, before all are forgotten.
    ///
    /// Raises InputError.
    #[pyo3(signature = (camera, *, size=(1920, 1080), pixels=None, silhouette_pixels=None,
        terminator_pixels=None, side_pixels=None, lights=Vec::new(), depth_front=None,
        depth_silhouette=None, depth_hidden=0, two_sided=false, limit=true, max_faces=4_000_000,
        max_kept=4_000_000), text_signature = "($self, camera, *, size=(1920, 1080), pixels=None, \
        silhouette_pixels=None, terminator_pixels=None, side_pixels=None, lights=(), \
        depth_front=None, depth_silhouette=None, depth_hidden=0, two_sided=False, limit=True, \
        max_faces=4000000, max_kept=4000000)")]
    #[expect(
        clippy::too_many_arguments,
        reason = "they are keywords of a Python function"
    )]
    fn refine(
        &self,
        py: Python<'_>,
        camera: &Camera,
        size: (u32, u32),
        pixels: Option<f64>,
        silhouette_pixels: Option<f64>,
        terminator_pixels: Option<f64>,
        side_pixels: Option<f64>,
        lights: Vec<[f32; 3]>,
        depth_front: Option<u32>,
        depth_silhouette: Option<u32>,
        depth_hidden: u32,
        two_sided: bool,
        limit: bool,
        max_faces: usize,
        max_kept: usize,
    ) -> PyResult<AdaptiveMesh> {
        let usual = pixels.map_or_else(AdaptiveOptions::default, AdaptiveOptions::within);
        let options = AdaptiveOptions {
            depth_front: depth_front.unwrap_or(usual.depth_front),
            depth_silhouette: depth_silhouette.unwrap_or(usual.depth_silhouette),
            depth_hidden,
            silhouette_pixels: silhouette_pixels.or(usual.silhouette_pixels),
            terminator_pixels,
            side_pixels,
            two_sided,
            limit,
            max_faces,
            max_kept,
            ..usual
        };
        let view = View {
            camera: camera.0,
            size: [size.0, size.1],
            lights: self::lights(&lights),
        };
        let refined = py.detach(|| self.lock().refine(&view, &options));
        AdaptiveMesh::of(py, refined.map_err(Raise::raise)?)
    }

    /// Number of faces kept, of all depths; each is about 480 bytes.
    #[getter]
    fn kept(&self, py: Python<'_>) -> usize {
        py.detach(|| self.lock().kept())
    }
}

/// A cage refined where it is looked at.
#[pyclass(frozen, get_all, module = "karui")]
pub struct AdaptiveMesh {
    /// The faces, with normals of the limit surface. Where an edge stays sharp, a vertex is there
    /// once a side.
    mesh: Py<Polygons>,
    /// (m,) uint32: the face of the cage that every face is part of; of one across an edge, the
    /// first of two.
    parents: Py<PyArray1<u32>>,
    /// (m,) uint8: number of √2 steps that have made every face.
    depths: Py<PyArray1<u8>>,
    /// (n,) uint32: vertices that are one, but for normals and texture coordinates, have one number,
    /// that of the cage's vertex, or if it is none a larger one.
    points: Py<PyArray1<u32>>,
    /// Whether more would have been split, but for max_faces.
    truncated: bool,
}

impl AdaptiveMesh {
    fn of(py: Python<'_>, refined: lib::AdaptiveMesh) -> PyResult<Self> {
        Ok(Self {
            mesh: Py::new(py, Polygons::of(refined.mesh))?,
            parents: PyArray1::from_vec(py, refined.parents).unbind(),
            depths: PyArray1::from_vec(py, refined.depths).unbind(),
            points: PyArray1::from_vec(py, refined.points).unbind(),
            truncated: refined.truncated,
        })
    }
}
