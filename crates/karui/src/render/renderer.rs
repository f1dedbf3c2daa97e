//! Everything that many pictures of one scene share.

use super::frame::Frame;
use super::geometry::{Geometry, Part};
use super::material::{Materials, Prepared};
use super::model::{Instance, Model};
use super::options::{Paint, RenderOptions};
use super::pass::Pass;
use super::resolve::resolve;
use super::shade::Shader;
use super::{Picture, View};
use crate::error::{Error, Result};
use crate::geom::{Aabb, Camera, Light};
use crate::mesh::{Scene, TriMesh};

/// A scene prepared for pictures: instances placed, normals where there were
/// none, smaller copies of the images.
#[derive(Debug, Clone)]
pub struct Renderer<'a> {
    pub(super) geometry: Geometry<'a>,
    pub(super) materials: Materials<'a>,
    instances: Vec<Instance>,
    vertices: Vec<usize>,
}

impl<'a> Renderer<'a> {
    /// Prepares a scene. `images` are its images, decoded; those that are
    /// `None` or not there are done without.
    ///
    /// # Errors
    /// Those of [`Renderer::of_model`].
    pub fn new(scene: &'a Scene, images: &'a [Option<Picture>]) -> Result<Self> {
        Self::of_model(&Model::of_scene(scene, images))
    }

    /// Prepares one mesh, which is shown in grey.
    ///
    /// # Errors
    /// Those of [`Renderer::of_model`].
    pub fn of_mesh(mesh: &'a TriMesh) -> Result<Self> {
        Self::of_model(&Model::of_mesh(mesh))
    }

    /// Prepares meshes that stand somewhere.
    ///
    /// Normals that are not finite or zero are done without; UVs and colours may
    /// be anything.
    ///
    /// # Errors
    /// [`Error::IndexOutOfRange`], [`Error::LengthMismatch`] and
    /// [`Error::BadRange`] for damaged meshes, [`Error::NotFinite`] for positions
    /// and matrices, [`Error::BadReference`] for materials and textures that do
    /// not exist, [`Error::TooLarge`] if 32 bits cannot count the vertices or
    /// triangles of all instances, [`Error::Unfolds`] if these are more than 2^28
    /// and more than those of the meshes.
    pub fn of_model(model: &Model<'a>) -> Result<Self> {
        model.check()?;
        Ok(Self {
            geometry: Geometry::new(model)?,
            materials: Materials::new(model),
            instances: model.instances.clone(),
            vertices: model.meshes.iter().map(|m| m.positions.len()).collect(),
        })
    }

    /// Box around all triangles, world units; empty if there are none.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.geometry.bounds
    }

    /// What stands where, as numbered by [`Hit::instance`](super::Hit::instance).
    #[must_use]
    pub fn instances(&self) -> &[Instance] {
        &self.instances
    }

    /// The view that a frame of this size has; see [`View::project`].
    ///
    /// # Errors
    /// [`Error::BadOption`] if the camera sees nothing.
    pub fn view(&self, camera: &Camera, width: u32, height: u32) -> Result<View> {
        View::new(camera, self.bounds(), width, height)
    }

    /// A picture. Without `lights` there is only the ambient light.
    ///
    /// Pixels are the same to the bit for any number of threads. An empty scene
    /// gives the background.
    ///
    /// # Errors
    /// [`Error::BadOption`] for a camera that sees nothing or options out of
    /// range; [`Error::LengthMismatch`] if scalars are not one a vertex.
    pub fn frame(
        &self,
        camera: &Camera,
        lights: &[Light],
        options: &RenderOptions<'_>,
    ) -> Result<Frame> {
        options.check()?;
        self.check_scalars(&options.paint)?;
        let pass = Pass::new(self, camera, options)?;
        let shader = Shader::new(self, &pass, lights, options);
        Ok(resolve(&pass, &shader))
    }

    fn check_scalars(&self, paint: &Paint<'_>) -> Result<()> {
        let Paint::Scalar(scalar) = paint else {
            return Ok(());
        };
        let mismatch = |what: String, expected, found| Error::LengthMismatch {
            what,
            expected,
            found,
        };
        if scalar.values.len() != self.vertices.len() {
            let (expected, found) = (self.vertices.len(), scalar.values.len());
            return Err(mismatch("paint.values".into(), expected, found));
        }
        for (m, (values, &expected)) in scalar.values.iter().zip(&self.vertices).enumerate() {
            if values.len() != expected {
                let what = format!("paint.values of mesh {m}");
                return Err(mismatch(what, expected, values.len()));
            }
        }
        Ok(())
    }

    #[inline]
    pub(super) fn part_of(&self, triangle: u32) -> &Part<'a> {
        self.geometry.part_of(triangle)
    }

    #[inline]
    pub(super) fn material(&self, part: &Part<'_>) -> &Prepared {
        let known = part
            .material
            .and_then(|m| self.materials.prepared.get(m as usize));
        known.unwrap_or(&Prepared::CLAY)
    }
}

/// One picture of a scene. [`Renderer`] saves work where there are several.
///
/// # Errors
/// Those of [`Renderer::new`] and [`Renderer::frame`].
pub fn render(
    scene: &Scene,
    images: &[Option<Picture>],
    camera: &Camera,
    lights: &[Light],
    options: &RenderOptions<'_>,
) -> Result<Frame> {
    Renderer::new(scene, images)?.frame(camera, lights, options)
}
