//! Pictures, for Python.

use crate::camera::Camera;
use crate::errors::Raise;
use crate::mesh::{MeshLike, bare_scene};
use crate::progress::run;
use crate::scene::Scene;
use karui::geom::{Camera as Lib, Light};
use karui::render::{Outputs, Picture, RenderOptions, Renderer};
use karui::{Result, Scene as Whole};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;

/// A picture of a scene or a mesh: (height, width, 4) uint8, sRGB with straight alpha, transparent
/// where there is nothing; the same pixels for any number of threads.
///
/// camera: by default one that sees all of it from a little above. size: width and height, pixels.
/// samples: along each side of a pixel: 1, 2 or 4. Lit by three lights that go with the camera.
///
/// Raises InputError.
#[pyfunction]
#[pyo3(signature = (content, camera=None, *, size=(512, 512), samples=2),
    text_signature = "(content, camera=None, *, size=(512, 512), samples=2)")]
pub fn render<'py>(
    py: Python<'py>,
    content: &Bound<'_, PyAny>,
    camera: Option<&Camera>,
    size: (u32, u32),
    samples: u32,
) -> PyResult<Bound<'py, PyAny>> {
    let scene = match content.cast::<Scene>() {
        Ok(scene) => scene.get().whole(),
        Err(_) => bare_scene(&content.extract::<MeshLike>()?.0),
    };
    scene.validate().map_err(Raise::raise)?;
    let camera = camera.map(|c| c.0);
    let picture = run(py, None, |_| drawn(&scene, camera, size, samples))?;
    let shape = [picture.height() as usize, picture.width() as usize, 4];
    let bytes = picture.pixels().as_flattened().to_vec();
    Ok(PyArray1::from_vec(py, bytes).reshape(shape)?.into_any())
}

fn drawn(scene: &Whole, camera: Option<Lib>, size: (u32, u32), samples: u32) -> Result<Picture> {
    // A picture that cannot be read is drawn without, as the reader's warnings say.
    let decoded = |image| karui_io::picture_of(image).ok().flatten();
    let images: Vec<_> = scene.images.iter().map(decoded).collect();
    let renderer = Renderer::new(scene, &images)?;
    let usual = || Lib::looking_at(renderer.bounds(), [0.4, 0.3, 1.0].into(), 0.7);
    let camera = camera.unwrap_or_else(usual);
    let options = RenderOptions {
        width: size.0,
        height: size.1,
        samples,
        outputs: Outputs::COLOR,
        ..RenderOptions::default()
    };
    Ok(renderer
        .frame(&camera, &Light::three_points(&camera)?, &options)?
        .color)
}
