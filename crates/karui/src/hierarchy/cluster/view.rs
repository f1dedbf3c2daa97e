//! Which groups are good enough for a view, and what of them is seen.

use super::bounds::{Bounds, Cone, Sphere};
use crate::error::{Error, Result};
use crate::geom::{Aabb, Camera, Projection};
use crate::hierarchy::{Criteria, Keep, Prepared, ViewAndLight};
use glam::DVec3;

/// What a view asks of a [`ClusterDag`](super::ClusterDag).
#[derive(Debug, Clone, Copy)]
pub struct View<'a> {
    /// Where the picture is taken from. Its near plane, if it has one, is the
    /// least distance an error is seen from.
    pub camera: Camera,
    /// Height of the picture, pixels. Default: 1080.
    pub height: f32,
    /// Width of the picture by its height, for [`View::frustum`]. Default: 16 / 9.
    pub aspect: f32,
    /// Largest error on the screen, pixels, 0 or more. Default: 1.
    pub threshold: f32,
    /// Whether to leave out what lies outside the picture. Default: no.
    pub frustum: bool,
    /// Whether to leave out clusters that show the eye their back alone.
    /// Default: no.
    pub backfaces: bool,
    /// Where more detail is asked for. Default: nowhere.
    pub detail: Option<Detail<'a>>,
}

/// More detail where the criteria of a [`Hierarchy`](crate::hierarchy::Hierarchy)
/// keep: silhouettes, highlights, where the surface turns away from a light.
#[derive(Debug, Clone, Copy)]
pub struct Detail<'a> {
    /// What is asked of the sphere around a group and of the cone of its normals.
    pub criteria: &'a ViewAndLight,
    /// Factor to the threshold where they keep, above 0 and at most 1.
    pub factor: f32,
}

impl View<'_> {
    /// The defaults, seen from `camera`.
    #[must_use]
    pub fn new(camera: Camera) -> Self {
        Self {
            camera,
            height: 1080.0,
            aspect: 16.0 / 9.0,
            threshold: 1.0,
            frustum: false,
            backfaces: false,
            detail: None,
        }
    }

    fn check(&self) -> Result<()> {
        let camera = &self.camera;
        in_range("camera.eye", camera.eye, camera.eye.is_finite(), "finite")?;
        let target = camera.target;
        in_range("camera.target", target, target.is_finite(), "finite")?;
        let positive = |x: f32| x > 0.0 && x.is_finite();
        in_range(
            "view.height",
            self.height,
            positive(self.height),
            "positive",
        )?;
        in_range(
            "view.aspect",
            self.aspect,
            positive(self.aspect),
            "positive",
        )?;
        let least = self.threshold >= 0.0;
        in_range("view.threshold", self.threshold, least, "0 or more")?;
        let near = camera.near.unwrap_or(1.0);
        in_range("camera.near", near, near.is_finite(), "finite")?;
        let far = camera.far.unwrap_or(1.0);
        in_range("camera.far", far, !far.is_nan(), "a number")?;
        let factor = self.detail.map_or(1.0, |d| d.factor);
        let good = factor > 0.0 && factor <= 1.0;
        in_range("detail.factor", factor, good, "above 0, at most 1")
    }
}

fn in_range(
    option: &'static str,
    value: impl std::fmt::Display,
    good: bool,
    expected: &'static str,
) -> Result<()> {
    if good {
        return Ok(());
    }
    Err(Error::BadOption {
        option,
        found: value.to_string(),
        expected,
    })
}

/// A view, ready to be asked.
pub(super) struct Judge {
    eye: DVec3,
    perspective: bool,
    /// Pixels of a model unit, at a distance of 1 if there is a perspective.
    pixels: f64,
    /// Least distance an error is seen from.
    near: f64,
    threshold: f64,
    /// Planes that face away from what is seen: outwards, and how far out.
    planes: Vec<(DVec3, f64)>,
    backfaces: bool,
    forward: DVec3,
    /// Criteria and the factor where they keep.
    detail: Option<(Prepared, f64)>,
}

impl Judge {
    /// # Errors
    /// [`Error::BadOption`] for a view that sees nothing.
    pub fn new(view: &View<'_>) -> Result<Self> {
        view.check()?;
        let camera = &view.camera;
        let axes = camera.axes()?;
        let scale = camera.scale()?;
        let eye = camera.eye.as_dvec3();
        let perspective = matches!(camera.projection, Projection::Perspective { .. });
        // Below this, rounding of a distance in f64 could be seen.
        let least = 1e-6 * eye.length().max(f64::from(f32::MIN_POSITIVE));
        let mut judge = Self {
            eye,
            perspective,
            pixels: 0.5 * f64::from(view.height) * scale,
            near: f64::from(camera.near.unwrap_or(0.0)).max(least),
            threshold: f64::from(view.threshold),
            planes: Vec::new(),
            backfaces: view.backfaces,
            forward: axes.forward,
            detail: view.detail.as_ref().map(prepared).transpose()?,
        };
        if view.frustum {
            let sides = [1.0 / scale, f64::from(view.aspect) / scale];
            for (axis, half) in [(axes.up, sides[0]), (axes.right, sides[1])] {
                judge.add_side(axis, half);
                judge.add_side(-axis, half);
            }
            judge.add_depths(camera);
        }
        Ok(judge)
    }

    /// The picture's side towards `axis`, whose half height or width (at a
    /// distance of 1 if there is a perspective) is `half`.
    fn add_side(&mut self, axis: DVec3, half: f64) {
        let plane = if self.perspective {
            let out = (axis - self.forward * half).normalize();
            (out, out.dot(self.eye))
        } else {
            (axis, axis.dot(self.eye) + half)
        };
        self.planes.push(plane);
    }

    fn add_depths(&mut self, camera: &Camera) {
        let depth = self.forward.dot(self.eye);
        let near = camera.near.or(self.perspective.then_some(0.0));
        let near = near.map(|near| (-self.forward, -depth - f64::from(near)));
        let far = camera.far.map(|far| (self.forward, depth + f64::from(far)));
        self.planes.extend(near.into_iter().chain(far));
    }

    /// Whether nothing in the sphere is in the picture.
    pub fn is_outside(&self, sphere: &Sphere) -> bool {
        let (center, radius) = (sphere.center.as_dvec3(), f64::from(sphere.radius));
        self.planes
            .iter()
            .any(|&(out, limit)| out.dot(center) - limit > radius)
    }

    /// Whether what is in the sphere, with normals in the cone, shows its back
    /// alone.
    pub fn is_turned_away(&self, sphere: &Sphere, cone: &Cone) -> bool {
        // A hair more, for the rounding of the axis.
        let sin = f64::from(cone.sin()) + 1e-5;
        if !self.backfaces || cone.cos <= 0.0 || sin >= 1.0 {
            return false;
        }
        if !self.perspective {
            return self.forward.dot(cone.unit()) > sin;
        }
        let view = sphere.center.as_dvec3() - self.eye;
        let radius = f64::from(sphere.radius);
        view.dot(cone.unit()) > sin * view.length() + radius * (1.0 + sin)
    }

    /// Whether the error of a group is small enough. If it is for a group it
    /// is for all groups below: errors are smaller, spheres and cones lie
    /// inside.
    pub fn is_enough(&self, bounds: &Bounds) -> bool {
        let error = f64::from(bounds.error) * self.pixels;
        let center = bounds.sphere.center.as_dvec3();
        let distance = if self.perspective {
            let clear = center.distance(self.eye) - f64::from(bounds.sphere.radius);
            clear.max(self.near)
        } else {
            1.0
        };
        let limit = self.threshold * distance;
        error <= limit
            && self.detail.as_ref().is_none_or(|(criteria, factor)| {
                error <= limit * factor || !criteria.keep(&bounds.as_of_a_node())
            })
    }
}

fn prepared(detail: &Detail<'_>) -> Result<(Prepared, f64)> {
    // The box bears only on how long an answer holds, which is not asked.
    let prepared = detail.criteria.frame(Aabb::EMPTY)?;
    Ok((prepared, f64::from(detail.factor)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Light;
    use crate::hierarchy::Silhouette;
    use glam::Vec3;

    fn view() -> View<'static> {
        let bounds = Aabb::of([Vec3::splat(-1.0), Vec3::ONE]);
        View {
            frustum: true,
            backfaces: true,
            ..View::new(Camera::looking_at(bounds, Vec3::Z, 0.7))
        }
    }

    fn ball(x: f32, y: f32, z: f32) -> Sphere {
        Sphere {
            center: Vec3::new(x, y, z),
            radius: 0.1,
        }
    }

    #[test]
    fn what_is_outside_the_picture_is_known() {
        let view = view();
        for camera in [view.camera, view.camera.without_perspective()] {
            let judge = Judge::new(&View { camera, ..view }).unwrap();
            assert!(!judge.is_outside(&ball(0.0, 0.0, 0.0)));
            assert!(!judge.is_outside(&ball(1.0, 1.0, 1.0)));
            for (x, y) in [(9.0, 0.0), (-9.0, 0.0), (0.0, 5.0), (0.0, -5.0)] {
                assert!(judge.is_outside(&ball(x, y, 0.0)), "{x} {y}");
            }
        }
        let judge = Judge::new(&view).unwrap();
        assert!(judge.is_outside(&ball(0.0, 0.0, 50.0)));
    }

    #[test]
    fn backs_are_known() {
        let judge = Judge::new(&view()).unwrap();
        let cone = |axis, cos| Cone { axis, cos };
        let at = ball(0.0, 0.0, 0.0);
        assert!(judge.is_turned_away(&at, &cone(-Vec3::Z, 0.9)));
        assert!(!judge.is_turned_away(&at, &cone(Vec3::Z, 0.9)));
        assert!(!judge.is_turned_away(&at, &cone(-Vec3::Z, 0.0)));
    }

    #[test]
    fn detail_is_where_criteria_keep() {
        let lit = Light::Directional {
            direction: -Vec3::Z,
            color: Vec3::ONE,
            intensity: 1.0,
        };
        let mut view = view();
        let criteria = ViewAndLight {
            camera: view.camera,
            lights: vec![lit],
            area: f64::INFINITY,
            silhouette: Silhouette::Ignored,
            highlight: 5.0,
            ..ViewAndLight::default()
        };
        view.threshold = 10.0;
        view.detail = Some(Detail {
            criteria: &criteria,
            factor: 0.01,
        });
        let judge = Judge::new(&view).unwrap();
        let is_enough = |axis: Vec3| {
            let cone = Cone {
                axis: axis.normalize(),
                cos: 0.999,
            };
            let sphere = ball(0.0, 0.0, 0.0);
            judge.is_enough(&Bounds {
                error: 5.0 / judge.pixels as f32,
                sphere,
                cone,
            })
        };
        assert!(!is_enough(Vec3::Z) && !is_enough(Vec3::X) && !is_enough(Vec3::Y));
        assert!(is_enough(Vec3::new(1.0, 0.0, 1.0)) && is_enough(-Vec3::Z));
    }

    #[test]
    fn what_is_no_number_is_refused() {
        let bad = |change: fn(&mut View<'_>)| {
            let mut view = view();
            change(&mut view);
            assert!(matches!(Judge::new(&view), Err(Error::BadOption { .. })));
        };
        bad(|v| v.camera.eye.x = f32::NAN);
        bad(|v| v.camera.target = Vec3::splat(f32::INFINITY));
        bad(|v| v.camera.target = v.camera.eye);
        bad(|v| v.camera.near = Some(f32::NAN));
        bad(|v| v.threshold = f32::NAN);
        bad(|v| v.threshold = -1.0);
        bad(|v| v.height = 0.0);
        bad(|v| v.aspect = f32::NAN);
        bad(|v| v.camera.projection = Projection::Perspective { fov_y: f32::NAN });
    }
}
