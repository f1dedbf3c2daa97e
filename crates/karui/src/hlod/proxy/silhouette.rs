//! The members from outside, along parallel rays and without light.

use super::group::Group;
use super::outfit::Outfit;
use crate::error::Result;
use crate::geom::{Camera, Projection, Vec2, Vec3};
use crate::render::{Frame, Hit, Outputs, Picture, RenderOptions, Renderer, Shading};

/// A rectangle to look at, from in front of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Window {
    /// Its middle.
    pub center: Vec3,
    /// Towards the viewer, of length 1.
    pub towards: Vec3,
    /// Up in the picture, of length 1.
    pub up: Vec3,
    /// Width and height, model units.
    pub size: Vec2,
}

impl Window {
    /// To the right in the picture, of length 1.
    pub fn right(&self) -> Vec3 {
        self.up.cross(self.towards)
    }
}

/// Prepared to be looked at.
pub(super) struct Sitter<'a> {
    renderer: Renderer<'a>,
    radius: f32,
}

impl<'a> Sitter<'a> {
    pub fn new(group: &'a Group<'_>, outfit: &'a Outfit) -> Result<Self> {
        let renderer = Renderer::of_model(&outfit.model(&group.mesh))?;
        let radius = renderer.bounds().diagonal() as f32;
        Ok(Self { renderer, radius })
    }

    /// Surface colours in the window, `texels` wide and high; alpha tells how much
    /// of a texel is covered, at 16 samples each.
    pub fn picture(&self, window: &Window, texels: [u32; 2]) -> Result<Picture> {
        let options = RenderOptions {
            samples: 4,
            outputs: Outputs::COLOR,
            shading: Shading::Unlit,
            ..sized(texels)
        };
        Ok(self.frame(window, &options)?.color)
    }

    /// What is seen in the middle of every texel.
    pub fn hits(&self, window: &Window, texels: [u32; 2]) -> Result<Vec<Hit>> {
        let options = RenderOptions {
            outputs: Outputs::GEOMETRY,
            ..sized(texels)
        };
        Ok(self.frame(window, &options)?.hits)
    }

    fn frame(&self, window: &Window, options: &RenderOptions<'_>) -> Result<Frame> {
        let camera = Camera {
            eye: window.center + window.towards * self.radius,
            target: window.center,
            up: window.up,
            projection: Projection::Orthographic {
                height: window.size.y,
            },
            near: None,
            far: None,
        };
        self.renderer.frame(&camera, &[], options)
    }
}

fn sized([width, height]: [u32; 2]) -> RenderOptions<'static> {
    RenderOptions {
        width,
        height,
        ..RenderOptions::default()
    }
}
