//! What a file holds, for Python.

use crate::errors::{Raise, input_error};
use crate::mesh::{Mesh, MeshLike, bare_scene};
use crate::progress::run;
use karui::{Scene as Whole, TriMesh};
use pyo3::prelude::*;
use std::{path::PathBuf, sync::Arc};

/// What a file holds: meshes, and the nodes, materials and pictures around them.
#[pyclass(frozen, module = "karui")]
pub struct Scene {
    /// All but the triangles.
    frame: Whole,
    meshes: Vec<Arc<TriMesh>>,
    warnings: Vec<String>,
}

impl Scene {
    fn of(mut frame: Whole, warnings: Vec<String>) -> Self {
        let take = |m: &mut karui::mesh::NamedMesh| Arc::new(std::mem::take(&mut m.mesh));
        let meshes = frame.meshes.iter_mut().map(take).collect();
        Self {
            frame,
            meshes,
            warnings,
        }
    }

    /// With the meshes in their places, copied.
    pub fn whole(&self) -> Whole {
        let mut whole = self.frame.clone();
        for (named, mesh) in whole.meshes.iter_mut().zip(&self.meshes) {
            named.mesh = TriMesh::clone(mesh);
        }
        whole
    }
}

#[pymethods]
impl Scene {
    /// The meshes, each in its own space and once, however often it is placed.
    #[getter]
    fn meshes(&self) -> Vec<Mesh> {
        self.meshes.iter().map(|m| Mesh(Arc::clone(m))).collect()
    }

    /// The meshes' names; None for those without.
    #[getter]
    fn names(&self) -> Vec<Option<String>> {
        self.frame.meshes.iter().map(|m| m.name.clone()).collect()
    }

    /// What the reader has passed over, such as missing textures.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }

    /// The same scene with other meshes: as many, in the same order.
    fn with_meshes(&self, meshes: Vec<MeshLike>) -> PyResult<Self> {
        let (expected, found) = (self.meshes.len(), meshes.len());
        if expected != found {
            let expected = format!("as many as in the scene, {expected}");
            return Err(input_error("meshes", &found.to_string(), &expected));
        }
        Ok(Self {
            frame: self.frame.clone(),
            meshes: meshes.into_iter().map(|m| m.0).collect(),
            warnings: Vec::new(),
        })
    }

    /// All placed meshes as one, in world space.
    fn merged(&self, py: Python<'_>) -> PyResult<Mesh> {
        let whole = self.whole();
        Ok(Mesh::of(run(py, None, |_| whole.into_single_mesh())?))
    }

    fn __repr__(&self) -> String {
        let triangles: usize = self.meshes.iter().map(|m| m.triangles.len()).sum();
        let meshes = self.meshes.len();
        format!("<karui.Scene of {meshes} meshes with {triangles} triangles>")
    }
}

/// Reads a file (glTF, GLB, OBJ, PLY, STL or OFF; all but glTF also as .gz).
///
/// Raises FileError, or InputError if the content is wrong.
#[pyfunction]
pub fn read(py: Python<'_>, path: PathBuf) -> PyResult<Scene> {
    let options = karui_io::ReadOptions::default();
    let loaded = run(py, None, |_| karui_io::read_with(&path, &options))?;
    Ok(Scene::of(loaded.scene, loaded.warnings))
}

/// Writes a scene or a mesh in the format that the extension asks for; all of it or nothing.
/// Returns what the format could not hold.
///
/// Raises FileError, or InputError for an extension that is not known.
#[pyfunction]
pub fn write(py: Python<'_>, path: PathBuf, content: &Bound<'_, PyAny>) -> PyResult<Vec<String>> {
    let scene = match content.cast::<Scene>() {
        Ok(scene) => scene.get().whole(),
        Err(_) => bare_scene(&content.extract::<MeshLike>()?.0),
    };
    scene.validate().map_err(Raise::raise)?;
    let options = karui_io::WriteOptions::default();
    let written = run(py, None, |_| karui_io::write_with(&path, &scene, &options))?;
    Ok(written.lost)
}
