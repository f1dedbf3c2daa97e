//! What members are made of.

use crate::mesh::{Material, Scene, Texture};
use crate::render::{BaseColors, Picture};

/// Materials, textures and decoded images that the ranges of meshes name; made
/// once and shared by many members. The default has none: everything is grey.
#[derive(Debug, Clone, Default)]
pub struct Look<'a> {
    pub(super) materials: &'a [Material],
    pub(super) textures: &'a [Texture],
    pub(super) images: &'a [Option<Picture>],
    pub(super) colors: BaseColors<'a>,
}

impl<'a> Look<'a> {
    /// Takes materials and what they need; makes smaller copies of the images of
    /// base colours. An image that is `None` or not there is done without.
    #[must_use]
    pub fn new(
        materials: &'a [Material],
        textures: &'a [Texture],
        images: &'a [Option<Picture>],
    ) -> Self {
        Self {
            materials,
            textures,
            images,
            colors: BaseColors::new(materials, textures, images),
        }
    }

    /// Those of a scene, whose images are given decoded.
    #[must_use]
    pub fn of_scene(scene: &'a Scene, images: &'a [Option<Picture>]) -> Self {
        Self::new(&scene.materials, &scene.textures, images)
    }
}
