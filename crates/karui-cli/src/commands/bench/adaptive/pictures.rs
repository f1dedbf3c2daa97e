//! Pictures of refined cages.

use crate::output::Staged;
use anyhow::Result;
use karui::geom::{Camera, Light, Quat, Vec3};
use karui::metrics::image::{ImageOptions, compare};
use karui::render::{Outputs, Picture, RenderOptions, Renderer, Wireframe};
use karui::subdiv::adaptive::AdaptiveMesh;

/// Radians around the model from where it is looked at to where that is looked at from.
const ASIDE: f32 = 1.9;

/// A camera and what goes with it.
pub struct Studio {
    camera: Camera,
    options: RenderOptions<'static>,
}

impl Studio {
    pub fn new(camera: Camera, size: (u32, u32)) -> Self {
        Self {
            camera,
            options: RenderOptions {
                width: size.0,
                height: size.1,
                samples: 2,
                outputs: Outputs::COLOR,
                background: [221, 225, 230, 255],
                ..RenderOptions::default()
            },
        }
    }

    pub fn picture(&self, mesh: &AdaptiveMesh) -> Result<Picture> {
        draw(mesh, &self.camera, &self.options)
    }

    /// Mean FLIP.
    pub fn difference(&self, a: &Picture, b: &Picture) -> Result<f64> {
        Ok(compare(a, b, &ImageOptions::default())?.flip)
    }

    /// From the camera, smooth and with edges, and with edges from aside.
    pub fn write(&self, staged: &Staged, name: &str, mesh: &AdaptiveMesh) -> Result<()> {
        let wires = RenderOptions {
            wireframe: Some(Wireframe {
                width: 0.7,
                ..Wireframe::default()
            }),
            ..self.options
        };
        let offset = self.camera.eye - self.camera.target;
        let aside = Camera {
            eye: self.camera.target + Quat::from_axis_angle(Vec3::Y, ASIDE) * offset,
            ..self.camera
        };
        let all = [
            ("front", &self.camera, &self.options),
            ("wires", &self.camera, &wires),
            ("side", &aside, &wires),
        ];
        for (what, camera, options) in all {
            let png = karui_io::encode_png(&draw(mesh, camera, options)?)?;
            staged.bytes(&format!("{name}-{what}.png"), &png)?;
        }
        Ok(())
    }
}

fn draw(mesh: &AdaptiveMesh, camera: &Camera, options: &RenderOptions<'_>) -> Result<Picture> {
    let triangles = mesh.to_tri_mesh();
    let renderer = Renderer::of_mesh(&triangles)?;
    let lights = Light::three_points(camera)?;
    Ok(renderer.frame(camera, &lights, options)?.color)
}
