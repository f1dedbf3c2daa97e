//! Pictures of models from all around, and how different they look.

use crate::failure::Failure;
use anyhow::Result;
use karui::geom::{Aabb, Camera, Light, fibonacci_directions};
use karui::metrics::image::{ImageDifference, ImageOptions, compare};
use karui::render::{Model, Outputs, Picture, RenderOptions, Renderer};
use rayon::prelude::*;
use std::path::Path;

/// Field of view, radians.
const FOV: f32 = 0.75;

/// Cameras around a model.
pub struct Eye {
    pub cameras: Vec<Camera>,
    options: RenderOptions<'static>,
}

impl Eye {
    /// Looks at what is within `bounds` from `views` directions, none of which
    /// saliency looks from, in pictures of `size` pixels a side.
    pub fn new(bounds: Aabb, views: u32, size: u32) -> Self {
        let directions = fibonacci_directions(views).into_iter();
        let camera = |d: glam::Vec3| Camera::looking_at(bounds, glam::vec3(d.y, d.z, d.x), FOV);
        Self {
            cameras: directions.map(camera).collect(),
            options: RenderOptions {
                width: size,
                height: size,
                outputs: Outputs::COLOR,
                ..RenderOptions::default()
            },
        }
    }

    /// One picture a camera.
    pub fn pictures(&self, model: &Model<'_>) -> Result<Vec<Picture>> {
        let renderer = Renderer::of_model(model)?;
        let picture = |camera: &Camera| self.picture(&renderer, camera, &self.options);
        self.cameras.par_iter().map(picture).collect()
    }

    /// One picture, drawn otherwise.
    pub fn picture(
        &self,
        renderer: &Renderer<'_>,
        camera: &Camera,
        options: &RenderOptions<'_>,
    ) -> Result<Picture> {
        let lights = Light::three_points(camera)?;
        Ok(renderer.frame(camera, &lights, options)?.color)
    }

    /// Size and outputs of the pictures.
    pub fn options(&self) -> &RenderOptions<'static> {
        &self.options
    }
}

/// Whether there is anything to see.
pub fn require_placed(renderer: &Renderer<'_>, path: &Path) -> Result<()> {
    if renderer.bounds().is_empty() {
        let message = format!("{}: no mesh with triangles is placed", path.display());
        let hint = "`karui info` shows instances; the default scene has to show a mesh";
        return Err(Failure::input(message).hint(hint).into());
    }
    Ok(())
}

/// How different pictures look, one after the other.
pub fn differences(a: &[Picture], b: &[Picture]) -> Result<Vec<ImageDifference>> {
    let pairs = a.par_iter().zip(b);
    let options = ImageOptions::default();
    let all = pairs.map(|(a, b)| compare(a, b, &options));
    Ok(all.collect::<karui::Result<_>>()?)
}
