//! What matters on a surface, for Python.

use crate::arrays::floats;
use crate::choice::choice;
use crate::errors::Raise;
use crate::mesh::MeshLike;
use crate::progress::run;
use karui::render::Model;
use karui::saliency::{self as lib, HybridOptions, MeshSaliencyOptions, MultiView};
use karui::saliency::{MultiViewOptions, Preset, SMOOTHING, Views, WeightMap};
use karui::{Progress, Result, TriMesh};
use numpy::PyArray1;
use pyo3::prelude::*;

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Curvature,
    Mesh,
    Image,
    Hybrid,
    As(Preset),
}

const KINDS: [(&str, Kind); 7] = [
    ("curvature", Kind::Curvature),
    ("mesh", Kind::Mesh),
    ("image", Kind::Image),
    ("hybrid", Kind::Hybrid),
    (Preset::Thesis2014.name(), Kind::As(Preset::Thesis2014)),
    (Preset::Lee2005.name(), Kind::As(Preset::Lee2005)),
    (Preset::Itti1998.name(), Kind::As(Preset::Itti1998)),
];

/// Directions that pictures are made from; as many as for the command line.
const VIEWS: u32 = 96;

/// How much every vertex matters: (n,) float32, 0 to 1.
///
/// kind: "curvature" (how strongly the surface bends), "mesh" (where it bends otherwise than around
/// it; Lee, Varshney & Jacobs 2005), "image" (what stands out in pictures from all around; Itti,
/// Koch & Niebur 1998) or "hybrid" (all three; An 2014); or a published way with the options of
/// its paper: "thesis2014", "lee2005" or "itti1998". smoothing: how wide values are smoothed, as a
/// share of the diagonal; by default 0.02 for "hybrid", 0 for the others. progress: called with a
/// stage and a fraction; returning False cancels.
///
/// Raises InputError and Cancelled.
#[pyfunction]
#[pyo3(signature = (mesh, kind="mesh", *, smoothing=None, progress=None))]
pub fn saliency<'py>(
    py: Python<'py>,
    mesh: MeshLike,
    kind: &str,
    smoothing: Option<f64>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Bound<'py, PyArray1<f32>>> {
    let kind = choice("kind", kind, &KINDS)?;
    let usual = if kind == Kind::Hybrid { SMOOTHING } else { 0.0 };
    let found = run(py, progress, |progress| {
        let values = kind.of(&mesh.0, progress)?;
        lib::smooth(&mesh.0, &values, smoothing.unwrap_or(usual))
    })?;
    Ok(PyArray1::from_vec(py, found))
}

/// Weights for `simplify` and `lod` from a saliency of 0 to 1: (n,) float32, from 1 where nothing
/// matters to `most` where it matters most, along a power: what is but half salient weighs little.
///
/// Raises InputError for numbers that are not finite or a `most` that is not above 0.
#[pyfunction]
#[pyo3(signature = (saliency, *, most=300.0, power=8))]
pub fn saliency_weights<'py>(
    py: Python<'py>,
    saliency: &Bound<'_, PyAny>,
    most: f32,
    power: u32,
) -> PyResult<Bound<'py, PyArray1<f32>>> {
    let values: Vec<f32> = floats("saliency", saliency, 0)?;
    let map = WeightMap::Power {
        least: 1.0,
        most,
        power,
    };
    let weights = map.weights(&values).map_err(Raise::raise)?;
    Ok(PyArray1::from_vec(py, weights))
}

impl Kind {
    fn of(self, mesh: &TriMesh, progress: &dyn Progress) -> Result<Vec<f32>> {
        match self {
            Self::Curvature => sizes(mesh),
            Self::Mesh => lib::mesh_saliency(mesh, &MeshSaliencyOptions::default()),
            Self::Image => Ok(look(mesh, progress)?.mean),
            Self::Hybrid => {
                let shape = lib::mesh_saliency(mesh, &MeshSaliencyOptions::default())?;
                let views = look(mesh, progress)?;
                let options = HybridOptions::default();
                Ok(lib::hybrid(&sizes(mesh)?, &shape, &views, &options)?.values)
            }
            Self::As(preset) => {
                let all = preset.saliency(&Model::of_mesh(mesh), progress)?;
                all.into_iter()
                    .next()
                    .ok_or(karui::Error::Empty { what: "mesh" })
            }
        }
    }
}

/// Sizes of the mean curvature, 0 to 1.
fn sizes(mesh: &TriMesh) -> Result<Vec<f32>> {
    Ok(lib::curvature_sizes(&lib::curvature(mesh)?))
}

/// What pictures from all around say.
fn look(mesh: &TriMesh, progress: &dyn Progress) -> Result<MultiView> {
    let options = MultiViewOptions {
        views: Views::Fibonacci(VIEWS),
        ..MultiViewOptions::default()
    };
    let all = lib::multi_view(&Model::of_mesh(mesh), &options, progress)?;
    all.into_iter()
        .next()
        .ok_or(karui::Error::Empty { what: "mesh" })
}
