//! What a view makes of lengths, places and directions.

use super::options::{View, bad};
use super::store::Shape;
use crate::error::Result;
use crate::geom::{Camera, Light, Projection};
use glam::DVec3;

/// So many lights, and the eye, have their bits in 32.
const MAX_LIGHTS: usize = 15;

/// Who looks at the surface: the eye, or a light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Looker {
    At(DVec3),
    /// From infinitely far away, towards where it is.
    Towards(DVec3),
}

impl Looker {
    /// Whether all of a shape faces the looker, or all of it faces away.
    pub fn sees(self, shape: &Shape) -> Option<bool> {
        let towards = self.from(shape.center.as_dvec3());
        let near = match self {
            Self::At(_) => f64::from(shape.radius),
            Self::Towards(_) => 0.0,
        };
        // A hair more, for the rounding of the axis.
        let least = (f64::from(shape.spread) + 1e-5) * towards.length() + near;
        let along = towards.dot(shape.axis.as_dvec3());
        (along.abs() > least).then_some(along > 0.0)
    }

    /// From a place towards the looker; of any length.
    pub fn from(self, place: DVec3) -> DVec3 {
        match self {
            Self::At(at) => at - place,
            Self::Towards(direction) => direction,
        }
    }
}

#[derive(Debug, Clone)]
pub(super) struct Eye {
    /// The eye first, then the lights.
    pub lookers: Vec<Looker>,
    /// Pixels by model units, at distance 1 with a perspective.
    scale: f64,
    /// Inward normals of what bounds the picture, and offsets along them.
    planes: Vec<(DVec3, f64)>,
}

impl Eye {
    pub fn new(view: &View) -> Result<Self> {
        let View {
            camera,
            size,
            lights,
        } = view;
        if size.contains(&0) {
            let found = format!("{} x {}", size[0], size[1]);
            return Err(bad("size", &found, "at least 1 x 1 pixels"));
        }
        if !camera.eye.is_finite() {
            return Err(bad("camera.eye", &camera.eye, "finite"));
        }
        if lights.len() > MAX_LIGHTS {
            return Err(bad("lights", &lights.len(), "at most 15"));
        }
        let eye = match camera.projection {
            Projection::Perspective { .. } => Looker::At(camera.eye.as_dvec3()),
            Projection::Orthographic { .. } => Looker::Towards(-camera.axes()?.forward),
        };
        let lights = lights.iter().map(light).collect::<Result<Vec<_>>>()?;
        let scale = 0.5 * f64::from(size[1]) * camera.scale()?;
        Ok(Self {
            lookers: [eye].into_iter().chain(lights).collect(),
            scale,
            planes: planes(camera, size.map(|pixels| 0.5 * f64::from(pixels) / scale))?,
        })
    }

    /// Whether a sphere is outside the picture.
    pub fn outside(&self, center: DVec3, radius: f64) -> bool {
        let beyond = |(normal, offset): &(DVec3, f64)| normal.dot(center) - offset < -radius;
        self.planes.iter().any(beyond)
    }

    /// Pixels by model units at the nearest place of a sphere; infinite around the eye.
    pub fn pixels(&self, center: DVec3, radius: f64) -> f64 {
        match self.lookers[0] {
            Looker::At(eye) => self.scale / (eye.distance(center) - radius).max(0.0),
            Looker::Towards(_) => self.scale,
        }
    }
}

fn light(light: &Light) -> Result<Looker> {
    let (what, place) = match *light {
        Light::Directional { direction, .. } => ("light.direction", direction),
        Light::Point { position, .. } => ("light.position", position),
    };
    if !place.is_finite() {
        return Err(bad(what, &place, "finite"));
    }
    Ok(match light {
        Light::Directional { .. } => Looker::Towards(-place.as_dvec3()),
        Light::Point { .. } => Looker::At(place.as_dvec3()),
    })
}

/// Sides of the picture that is twice `half` wide and high at distance 1, and its depths.
fn planes(camera: &Camera, half: [f64; 2]) -> Result<Vec<(DVec3, f64)>> {
    let axes = camera.axes()?;
    let eye = camera.eye.as_dvec3();
    let perspective = matches!(camera.projection, Projection::Perspective { .. });
    let mut planes = Vec::with_capacity(6);
    let mut add = |normal: DVec3, from_eye: f64| {
        planes.push((normal, normal.dot(eye) + from_eye));
    };
    for (axis, half) in [axes.right, axes.up].into_iter().zip(half) {
        for axis in [axis, -axis] {
            match perspective {
                true => add((axes.forward * half + axis).normalize(), 0.0),
                false => add(axis, -half),
            }
        }
    }
    let near = camera.near.map(f64::from).or(perspective.then_some(0.0));
    let far = camera.far.map(f64::from);
    if let Some(bad_depth) = near.into_iter().chain(far).find(|d| !d.is_finite()) {
        return Err(bad("camera.near or camera.far", &bad_depth, "finite"));
    }
    near.into_iter().for_each(|near| add(axes.forward, near));
    far.into_iter().for_each(|far| add(-axes.forward, -far));
    Ok(planes)
}

/// Normals of a polygon at its corners; of any length.
pub(super) fn corner_normals(polygon: &[DVec3]) -> impl Iterator<Item = DVec3> + '_ {
    let n = polygon.len();
    (0..n).map(move |i| {
        let [before, at, after] = [i + n - 1, i, i + 1].map(|i| polygon[i % n]);
        (at - before).cross(after - at)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{Aabb, Vec3};

    #[test]
    fn a_framed_box_is_in_the_picture_and_a_pixel_is_a_pixel() {
        let bounds = Aabb::of([Vec3::splat(-1.0), Vec3::ONE]);
        let camera = Camera::looking_at(bounds, Vec3::Z, 0.7);
        for camera in [camera, camera.without_perspective()] {
            let size = [200, 100];
            let eye = Eye::new(&View {
                camera,
                size,
                lights: Vec::new(),
            })
            .unwrap();
            assert!(!eye.outside(DVec3::ZERO, 0.0));
            assert!(eye.outside(DVec3::X * 9.0, 0.1) && !eye.outside(DVec3::X * 9.0, 9.0));
            // The sphere around the box fills the height nearly.
            let pixels = eye.pixels(DVec3::ZERO, 0.0) * 2.0 * 3f64.sqrt();
            assert!((90.0..=110.0).contains(&pixels), "{pixels}");
        }
    }
}
