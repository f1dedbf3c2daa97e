//! Where a picture is taken from.

use super::{Aabb, sin_cos, tan};
use crate::error::{Error, Result};
use glam::{DMat4, DVec3, DVec4, Vec3};

/// A camera. Its space has x to the right, y up and looks along -z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Where it stands, world units.
    pub eye: Vec3,
    /// A point in the middle of the picture.
    pub target: Vec3,
    /// What is up in the picture; need not be perpendicular to the view. Where
    /// it is parallel to it, an axis takes its place.
    pub up: Vec3,
    /// Perspective or not, and how much is seen.
    pub projection: Projection,
    /// Distance before which nothing is seen, along the view, world units.
    /// `None` lets the bounds of what is looked at decide.
    pub near: Option<f32>,
    /// Distance beyond which nothing is seen; `None` as for `near`.
    pub far: Option<f32>,
}

/// How much a camera sees, and whether what is far is small.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    /// As an eye does.
    Perspective {
        /// Vertical field of view, radians, between 0 and pi.
        fov_y: f32,
    },
    /// Along parallel rays.
    Orthographic {
        /// Height of the picture, world units.
        height: f32,
    },
}

/// The three axes a camera looks along.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Axes {
    pub right: DVec3,
    pub up: DVec3,
    pub forward: DVec3,
}

impl Camera {
    /// A camera that has all of `bounds` in view, seen from `direction` (from
    /// the box's centre towards the eye), y up: the sphere around the box
    /// touches the edges of the picture above and below, or left and right if
    /// the picture is narrower than high and `fov_y` the narrower angle.
    /// An empty box counts as the point at the origin, a zero `direction` as +z.
    #[must_use]
    pub fn looking_at(bounds: Aabb, direction: Vec3, fov_y: f32) -> Self {
        let target = bounds.center();
        // A point is looked at from where `f32` tells the eye from it.
        let least = (1e-3 * target.as_dvec3().length()).max(1e-18);
        let radius = (0.5 * bounds.diagonal()).max(least);
        let (sine, _) = sin_cos(0.5 * f64::from(fov_y));
        let towards = direction.as_dvec3().try_normalize().unwrap_or(DVec3::Z);
        let eye = target.as_dvec3() + towards * (radius / sine);
        Self {
            eye: eye.as_vec3(),
            target,
            up: Vec3::Y,
            projection: Projection::Perspective { fov_y },
            near: None,
            far: None,
        }
    }

    /// The same place and direction, without perspective: the picture is as
    /// high as what a perspective camera sees at its target.
    #[must_use]
    pub fn without_perspective(self) -> Self {
        let height = match self.projection {
            Projection::Perspective { fov_y } => {
                let distance = self.target.as_dvec3().distance(self.eye.as_dvec3());
                (2.0 * distance * tan(0.5 * f64::from(fov_y))) as f32
            }
            Projection::Orthographic { height } => height,
        };
        Self {
            projection: Projection::Orthographic { height },
            ..self
        }
    }

    /// Takes the world's space to the camera's.
    ///
    /// # Errors
    /// [`Error::BadOption`] if the eye is at the target or a number is not finite.
    pub fn view_from_world(&self) -> Result<DMat4> {
        let Axes { right, up, forward } = self.axes()?;
        let eye = self.eye.as_dvec3();
        let row = |axis: DVec3| axis.extend(-axis.dot(eye));
        Ok(DMat4::from_cols(row(right), row(up), row(-forward), DVec4::W).transpose())
    }

    /// Takes the camera's space to clip space: after the division by w, x and y
    /// in -1..=1 are in the picture, and z runs from 0 at the near plane to 1 at
    /// the far one. `aspect` is width by height; `bounds` are those of what is
    /// looked at.
    ///
    /// # Errors
    /// [`Error::BadOption`] as for [`Camera::depth_range`], or if field of view
    /// or height are out of range.
    pub fn clip_from_view(&self, aspect: f64, bounds: Aabb) -> Result<DMat4> {
        let (near, far) = self.depth_range(bounds)?;
        let scale = self.scale()?;
        let depth = far - near;
        let cols = match self.projection {
            Projection::Perspective { .. } => [
                DVec4::new(0.0, 0.0, -far / depth, -1.0),
                DVec4::new(0.0, 0.0, -far * near / depth, 0.0),
            ],
            Projection::Orthographic { .. } => [
                DVec4::new(0.0, 0.0, -1.0 / depth, 0.0),
                DVec4::new(0.0, 0.0, -near / depth, 1.0),
            ],
        };
        let (x, y) = (DVec4::X * (scale / aspect), DVec4::Y * scale);
        Ok(DMat4::from_cols(x, y, cols[0], cols[1]))
    }

    /// Takes the world's space to clip space; see [`Camera::clip_from_view`].
    ///
    /// # Errors
    /// [`Error::BadOption`] if the camera sees nothing.
    pub fn clip_from_world(&self, aspect: f64, bounds: Aabb) -> Result<DMat4> {
        Ok(self.clip_from_view(aspect, bounds)? * self.view_from_world()?)
    }

    /// Distances of the near and the far plane: those given, else as close
    /// around the sphere around `bounds` as may be; never closer to a
    /// perspective eye than 1/10000 of the farther one.
    ///
    /// # Errors
    /// [`Error::BadOption`] if `near` is not before `far`, or not positive with
    /// a perspective.
    pub fn depth_range(&self, bounds: Aabb) -> Result<(f64, f64)> {
        let axes = self.axes()?;
        let center = bounds.center().as_dvec3() - self.eye.as_dvec3();
        let middle = axes.forward.dot(center);
        // A hair more, for what rounding does to a vertex on the sphere.
        let least = center.length() * 1e-6 + f64::from(f32::MIN_POSITIVE);
        let radius = 0.5 * bounds.diagonal() * (1.0 + 1e-6) + least;
        let perspective = matches!(self.projection, Projection::Perspective { .. });
        let far = match self.far {
            Some(far) => f64::from(far),
            None if perspective => (middle + radius).max(radius * 1e-3),
            None => middle + radius,
        };
        let near = match self.near {
            Some(near) => f64::from(near),
            None if perspective => (middle - radius).max(far * 1e-4),
            None => middle - radius,
        };
        // All that is there may lie before a near plane that was asked for.
        let far = if self.far.is_none() {
            far.max(near + least)
        } else {
            far
        };
        check("camera.near", near, !perspective || near > 0.0, "positive")?;
        check("camera.far", far, far > near, "beyond the near plane")?;
        Ok((near, far))
    }

    pub(crate) fn axes(&self) -> Result<Axes> {
        let view = self.target.as_dvec3() - self.eye.as_dvec3();
        let forward = view.try_normalize().ok_or_else(|| Error::BadOption {
            option: "camera.target",
            found: self.target.to_string(),
            expected: "finite, and not where the eye is",
        })?;
        let up = self.up.as_dvec3().try_normalize();
        // Squared sine of the angle to the view; an axis at hand below 1e-12.
        let aside = |up: &DVec3| forward.cross(*up).length_squared() > 1e-12;
        let up = up.filter(aside).unwrap_or_else(|| least_axis(forward));
        let right = forward.cross(up).normalize();
        let up = right.cross(forward);
        Ok(Axes { right, up, forward })
    }

    /// Clip coordinates by view coordinates, vertically.
    pub(crate) fn scale(&self) -> Result<f64> {
        match self.projection {
            Projection::Perspective { fov_y } => {
                let (angle, pi) = (f64::from(fov_y), std::f64::consts::PI);
                check(
                    "camera.fov_y",
                    angle,
                    angle > 0.0 && angle < pi,
                    "between 0 and pi",
                )?;
                Ok(1.0 / tan(0.5 * angle))
            }
            Projection::Orthographic { height } => {
                let height = f64::from(height);
                check("camera.height", height, height > 0.0, "positive")?;
                Ok(2.0 / height)
            }
        }
    }
}

fn check(option: &'static str, value: f64, good: bool, expected: &'static str) -> Result<()> {
    if good && value.is_finite() {
        return Ok(());
    }
    Err(Error::BadOption {
        option,
        found: value.to_string(),
        expected,
    })
}

/// The axis that `v` points along least.
fn least_axis(v: DVec3) -> DVec3 {
    let size = v.abs();
    if size.z <= size.x && size.z <= size.y {
        DVec3::Z
    } else if size.y <= size.x {
        DVec3::Y
    } else {
        DVec3::X
    }
}

/// `count` unit vectors around the y axis, starting at +z and turning towards
/// +x, all `elevation` radians above the horizon.
#[must_use]
pub fn turntable_directions(count: u32, elevation: f32) -> Vec<Vec3> {
    let (height, around) = sin_cos(f64::from(elevation));
    let direction = |i| {
        let (s, c) = sin_cos(std::f64::consts::TAU * f64::from(i) / f64::from(count));
        DVec3::new(around * s, height, around * c).as_vec3()
    };
    (0..count).map(direction).collect()
}

/// `count` unit vectors spread evenly over the sphere: a spiral that advances by
/// the golden angle (Swinbank and Purser, "Fibonacci grids: a novel approach to
/// global modelling", 2006), the y axis in its middle.
#[must_use]
pub fn fibonacci_directions(count: u32) -> Vec<Vec3> {
    let golden = 0.5 * (1.0 + 5f64.sqrt());
    let direction = |i| {
        let y = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
        let turns = (f64::from(i) / golden).fract();
        let (s, c) = sin_cos(std::f64::consts::TAU * turns);
        let around = (1.0 - y * y).sqrt();
        DVec3::new(around * s, y, around * c).as_vec3()
    };
    (0..count).map(direction).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit_box() -> Aabb {
        Aabb::of([Vec3::splat(-1.0), Vec3::ONE])
    }

    #[test]
    fn a_framed_box_is_inside_the_picture() {
        for direction in fibonacci_directions(50) {
            let camera = Camera::looking_at(unit_box(), direction, 0.7);
            let clip_from_world = camera.clip_from_world(1.0, unit_box()).unwrap();
            let mut widest = 0f64;
            for corner in 0..8 {
                let sign = |k: u32| if corner >> k & 1 == 1 { 1.0 } else { -1.0 };
                let p = clip_from_world.project_point3(DVec3::new(sign(0), sign(1), sign(2)));
                assert!((0.0..=1.0).contains(&p.z), "{p}");
                widest = widest.max(p.x.abs()).max(p.y.abs());
            }
            assert!(widest < 1.0 && widest > 0.6, "{widest}");
        }
    }

    #[test]
    fn the_camera_looks_along_minus_z() {
        let mut camera = Camera::looking_at(unit_box(), Vec3::X, 0.7);
        let view = camera.view_from_world().unwrap();
        let distance = f64::from(camera.eye.x);
        let target = view.transform_point3(DVec3::ZERO);
        assert!(target.distance(DVec3::new(0.0, 0.0, -distance)) < 1e-12);
        assert!(view.transform_vector3(DVec3::Y).distance(DVec3::Y) < 1e-12);
        camera.up = Vec3::X;
        assert!(camera.view_from_world().unwrap().is_finite());
        camera.target = camera.eye;
        assert!(camera.view_from_world().is_err());
    }

    #[test]
    fn planes_lie_where_they_should() {
        let camera = Camera {
            near: Some(1.0),
            far: Some(5.0),
            ..Camera::looking_at(unit_box(), Vec3::Z, 1.0)
        };
        for camera in [camera, camera.without_perspective()] {
            let clip = camera.clip_from_view(2.0, Aabb::EMPTY).unwrap();
            let at = |distance: f64| clip.project_point3(DVec3::new(0.0, 0.0, -distance)).z;
            assert!(at(1.0).abs() < 1e-12 && (at(5.0) - 1.0).abs() < 1e-12);
        }
        let wrong = Camera {
            near: Some(6.0),
            ..camera
        };
        assert!(wrong.depth_range(unit_box()).is_err());
        let wrong = Camera {
            near: Some(0.0),
            ..camera
        };
        assert!(wrong.depth_range(unit_box()).is_err());
        let wrong = Camera::looking_at(unit_box(), Vec3::Z, 4.0);
        assert!(wrong.clip_from_world(1.0, unit_box()).is_err());
    }

    #[test]
    fn directions_are_even() {
        for (directions, name) in [
            (fibonacci_directions(200), "fibonacci"),
            (turntable_directions(200, 0.0), "turntable"),
        ] {
            let sum: Vec3 = directions.iter().sum();
            assert!(sum.length() < 0.1, "{name} {sum}");
            assert!(directions.iter().all(|d| (d.length() - 1.0).abs() < 1e-6));
        }
        assert_eq!(turntable_directions(4, 0.0)[1], Vec3::X);
        assert_eq!(turntable_directions(0, 0.0), []);
    }
}
