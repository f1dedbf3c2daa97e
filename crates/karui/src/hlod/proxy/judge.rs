//! How different a stand-in looks from the members.

use super::group::Group;
use super::outfit::Outfit;
use super::proxy::Proxy;
use crate::error::Result;
use crate::geom::{Camera, Light, Vec3, fibonacci_directions};
use crate::metrics::image::{PIXELS_PER_DEGREE, flip};
use crate::render::{Model, Outputs, Picture, RenderOptions, Renderer};

/// Sides of the pictures are no shorter, pixels.
const LEAST_SIDE: u32 = 16;

/// The members, looked at once from all around.
pub(super) struct Judge {
    views: Vec<(Camera, Picture)>,
    side: u32,
}

impl Judge {
    /// Along `views` directions, without perspective, so that the diagonal of the
    /// group is `pixels` long.
    pub fn new(group: &Group<'_>, pixels: u32, views: u32) -> Result<Self> {
        let outfit = Outfit::of(&group.slots);
        let members = Renderer::of_model(&outfit.model(&group.mesh))?;
        let side = pixels.clamp(LEAST_SIDE, super::budget::LONGEST);
        let share = f64::from(side) / f64::from(pixels.min(side));
        let height = (group.bounds().diagonal() * share) as f32;
        let view = |direction: Vec3| {
            let camera = Camera::looking_at(group.bounds(), direction, 0.5);
            let camera = Camera {
                projection: crate::geom::Projection::Orthographic { height },
                ..camera
            };
            Ok((camera, picture(&members, &camera, side)?))
        };
        let views = fibonacci_directions(views).into_iter().map(view);
        Ok(Self {
            views: views.collect::<Result<_>>()?,
            side,
        })
    }

    /// Mean FLIP over the pixels that members or stand-in cover, then over the views;
    /// one in which neither is seen counts as 0.
    pub fn flip(&self, proxy: &Proxy) -> Result<f64> {
        let pictures = proxy.pictures();
        let renderer = Renderer::of_model(&Model::of_scene(&proxy.scene, &pictures))?;
        let mut sum = 0.0;
        for (camera, members) in &self.views {
            sum += difference(members, &picture(&renderer, camera, self.side)?)?;
        }
        Ok(sum / self.views.len() as f64)
    }
}

fn picture(renderer: &Renderer<'_>, camera: &Camera, side: u32) -> Result<Picture> {
    let options = RenderOptions {
        width: side,
        height: side,
        samples: 2,
        outputs: Outputs::COLOR,
        ..RenderOptions::default()
    };
    let lights = Light::three_points(camera)?;
    Ok(renderer.frame(camera, &lights, &options)?.color)
}

fn difference(members: &Picture, proxy: &Picture) -> Result<f64> {
    let map = flip(members, proxy, PIXELS_PER_DEGREE)?.map;
    let (mut sum, mut count) = (0.0, 0u32);
    let pixels = members.pixels().iter().zip(proxy.pixels());
    for (error, _) in map
        .iter()
        .zip(pixels)
        .filter(|(_, (a, b))| a[3].max(b[3]) > 0)
    {
        sum += f64::from(*error);
        count += 1;
    }
    Ok(sum / f64::from(count.max(1)))
}
