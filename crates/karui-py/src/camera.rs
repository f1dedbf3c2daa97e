//! Where a mesh is looked at from, for Python.

use crate::mesh::MeshLike;
use karui::geom::{Camera as Lib, Light, Projection};
use pyo3::prelude::*;

/// A camera: where it stands, what it looks at, and how much it sees.
#[pyclass(frozen, module = "karui")]
pub struct Camera(pub Lib);

#[pymethods]
impl Camera {
    /// eye and target: points, world units. up: what is up in the picture. fov_y: vertical field
    /// of view, radians. height: of the picture, world units; given, there is no perspective.
    /// near and far: distances along the view; by default what holds all that is looked at.
    #[new]
    #[pyo3(signature = (eye, target, *, up=[0.0, 1.0, 0.0], fov_y=1.0, height=None, near=None, far=None),
        text_signature = "(eye, target, *, up=(0.0, 1.0, 0.0), fov_y=1.0, height=None, near=None, far=None)")]
    fn new(
        eye: [f32; 3],
        target: [f32; 3],
        up: [f32; 3],
        fov_y: f32,
        height: Option<f32>,
        near: Option<f32>,
        far: Option<f32>,
    ) -> Self {
        let perspective = Projection::Perspective { fov_y };
        let projection = height.map_or(perspective, |height| Projection::Orthographic { height });
        let [eye, target, up] = [eye, target, up].map(Into::into);
        Self(Lib {
            eye,
            target,
            up,
            projection,
            near,
            far,
        })
    }

    /// A camera that has all of a mesh in view, seen from `direction` (from its middle to the eye).
    #[staticmethod]
    #[pyo3(signature = (mesh, direction=[0.4, 0.3, 1.0], *, fov_y=0.7),
        text_signature = "(mesh, direction=(0.4, 0.3, 1.0), *, fov_y=0.7)")]
    fn looking_at(mesh: MeshLike, direction: [f32; 3], fov_y: f32) -> Self {
        Self(Lib::looking_at(mesh.0.bounds(), direction.into(), fov_y))
    }

    /// Where it stands, world units.
    #[getter]
    fn eye(&self) -> [f32; 3] {
        self.0.eye.into()
    }

    /// What is in the middle of the picture, world units.
    #[getter]
    fn target(&self) -> [f32; 3] {
        self.0.target.into()
    }

    fn __repr__(&self) -> String {
        format!(
            "<karui.Camera at {:?} looking at {:?}>",
            self.eye(),
            self.target()
        )
    }
}

/// White lights from infinitely far away, by where their light goes to.
pub fn lights(directions: &[[f32; 3]]) -> Vec<Light> {
    let of = |&direction: &[f32; 3]| Light::Directional {
        direction: direction.into(),
        color: [1.0; 3].into(),
        intensity: 1.0,
    };
    directions.iter().map(of).collect()
}
