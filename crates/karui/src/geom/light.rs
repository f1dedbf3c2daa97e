//! What shines on a scene.

use super::Camera;
use crate::error::Result;
use glam::{DVec3, Vec3};

/// A light. Its colour is linear RGB; a surface that is white and matte and
/// faces a light whose colour and intensity are 1 is shown white.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Light {
    /// From infinitely far away.
    Directional {
        /// Where the light goes to; need not be of length 1.
        direction: Vec3,
        /// Linear RGB.
        color: Vec3,
        /// Factor to `color`.
        intensity: f32,
    },
    /// From a point into all directions, falling off with the squared distance.
    Point {
        /// Where it is, world units.
        position: Vec3,
        /// Linear RGB.
        color: Vec3,
        /// Factor to `color` at a distance of one world unit.
        intensity: f32,
    },
}

impl Light {
    /// White light of intensity 1 along the view: what is seen is lit.
    ///
    /// # Errors
    /// [`Error::BadOption`](crate::Error::BadOption) if the camera looks nowhere.
    pub fn headlight(camera: &Camera) -> Result<Self> {
        Ok(white(camera.axes()?.forward, 1.0))
    }

    /// A strong light from the upper left behind the camera, a weak one from
    /// the right and one from behind the object: forms are told apart better
    /// than by a headlight.
    ///
    /// # Errors
    /// [`Error::BadOption`](crate::Error::BadOption) if the camera looks nowhere.
    pub fn three_points(camera: &Camera) -> Result<Vec<Self>> {
        let axes = camera.axes()?;
        let from = |right: f64, up: f64, back: f64| {
            -(axes.right * right + axes.up * up - axes.forward * back)
        };
        Ok(vec![
            white(from(-0.6, 0.8, 1.0), 0.8),
            white(from(1.0, 0.1, 0.7), 0.2),
            white(from(0.3, 0.8, -1.0), 0.3),
        ])
    }
}

fn white(direction: DVec3, intensity: f32) -> Light {
    Light::Directional {
        direction: direction.as_vec3(),
        color: Vec3::ONE,
        intensity,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Aabb;

    #[test]
    fn a_headlight_shines_where_the_camera_looks() {
        let bounds = Aabb::of([Vec3::ZERO, Vec3::ONE]);
        let camera = Camera::looking_at(bounds, Vec3::X, 1.0);
        let Ok(Light::Directional { direction, .. }) = Light::headlight(&camera) else {
            panic!("not directional");
        };
        assert!(direction.distance(-Vec3::X) < 1e-6);
        assert_eq!(Light::three_points(&camera).unwrap().len(), 3);
    }
}
