//! Which groups are good enough for a view, and what of them is seen.

use super::angle::Angle;
use super::bounds::{Bounds, Cone, Sphere};
use crate::error::{Error, Result};
use crate::geom::{Camera, Light, Projection};
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
    /// Where light asks for more detail. Default: nowhere.
    pub light: Option<LightDetail<'a>>,
}

/// More detail where light changes fast: in highlights and where the surface
/// turns away from a light.
#[derive(Debug, Clone, Copy)]
pub struct LightDetail<'a> {
    /// The lights.
    pub lights: &'a [Light],
    /// Factor to the threshold there, above 0 and at most 1.
    pub factor: f32,
    /// Cosine of the largest angle between a normal and the direction halfway
    /// between eye and light in a highlight; `None` for no highlights.
    pub highlight: Option<f32>,
    /// Whether the shadow line on the surface counts.
    pub silhouettes: bool,
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
            light: None,
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
        self.light.map_or(Ok(()), |light| light.check())
    }
}

impl LightDetail<'_> {
    fn check(&self) -> Result<()> {
        let good = self.factor > 0.0 && self.factor <= 1.0;
        in_range("light.factor", self.factor, good, "above 0, at most 1")?;
        let cos = self.highlight.unwrap_or(1.0);
        let good = (-1.0..=1.0).contains(&cos);
        in_range("light.highlight", cos, good, "between -1 and 1")?;
        let place = |light: &Light| match *light {
            Light::Directional { direction, .. } => direction,
            Light::Point { position, .. } => position,
        };
        match self.lights.iter().map(place).find(|p| !p.is_finite()) {
            Some(place) => in_range("light.lights", place, false, "finite"),
            None => Ok(()),
        }
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
pub(super) struct Judge<'a> {
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
    light: Option<LightDetail<'a>>,
}

impl<'a> Judge<'a> {
    /// # Errors
    /// [`Error::BadOption`] for a view that sees nothing.
    pub fn new(view: &View<'a>) -> Result<Self> {
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
            light: view.light,
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
            && self.light.is_none_or(|light| {
                let factor = f64::from(light.factor);
                error <= limit * factor || !self.is_lit(&light, bounds)
            })
    }

    fn is_lit(&self, light: &LightDetail<'_>, bounds: &Bounds) -> bool {
        let to_eye = match self.perspective {
            true => Fan::towards(self.eye, &bounds.sphere),
            false => Fan::parallel(-self.forward),
        };
        let normals = Fan {
            axis: bounds.cone.unit(),
            half: bounds.cone.angle(),
        };
        light.lights.iter().any(|one| {
            let Some(to_light) = Fan::of(one, &bounds.sphere) else {
                return false;
            };
            (light.silhouettes && normals.may_be_across(&to_light))
                || light.highlight.is_some_and(|cos| {
                    normals.may_be_between(&to_light, &to_eye, Angle::of_cos(f64::from(cos)))
                })
        })
    }
}

/// Directions within an angle of an axis. What is asked of several is asked of
/// every combination of directions in them, so smaller ones inside hold no more.
struct Fan {
    axis: DVec3,
    half: Angle,
}

impl Fan {
    fn parallel(axis: DVec3) -> Self {
        Self {
            axis,
            half: Angle::ZERO,
        }
    }

    /// From every point of the sphere towards a light; none for one that shines
    /// nowhere.
    fn of(light: &Light, sphere: &Sphere) -> Option<Self> {
        match *light {
            Light::Directional { direction, .. } => {
                let direction = direction.as_dvec3().try_normalize()?;
                Some(Self::parallel(-direction))
            }
            Light::Point { position, .. } => Some(Self::towards(position.as_dvec3(), sphere)),
        }
    }

    /// From every point of the sphere towards `place`.
    fn towards(place: DVec3, sphere: &Sphere) -> Self {
        let way = place - sphere.center.as_dvec3();
        let (distance, radius) = (way.length(), f64::from(sphere.radius));
        if distance <= radius {
            return Self {
                axis: DVec3::Z,
                half: Angle::STRAIGHT,
            };
        }
        Self {
            axis: way / distance,
            half: Angle::of_sin(radius / distance),
        }
    }

    /// Smallest angle between directions of both.
    fn least(&self, other: &Self) -> Angle {
        let between = Angle::between(self.axis, other.axis);
        between.minus(self.half).minus(other.half)
    }

    /// Largest angle between directions of both.
    fn most(&self, other: &Self) -> Angle {
        let between = Angle::between(self.axis, other.axis);
        between.plus(self.half).plus(other.half)
    }

    /// Whether directions of both may be at a right angle.
    fn may_be_across(&self, other: &Self) -> bool {
        self.least(other).cos >= 0.0 && self.most(other).cos <= 0.0
    }

    /// Whether one of these directions may be within `reach` of the middle
    /// between one of `a` and one of `b`. Such a one is at most half the angle
    /// between them, and `reach`, from either, which is what is asked.
    fn may_be_between(&self, a: &Self, b: &Self, reach: Angle) -> bool {
        let limit = a.most(b).half().plus(reach);
        self.least(a).at_most(limit) && self.least(b).at_most(limit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Aabb;
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
    fn light_is_where_normals_say() {
        let lights = [Light::Directional {
            direction: -Vec3::Z,
            color: Vec3::ONE,
            intensity: 1.0,
        }];
        let mut view = view();
        let detail = LightDetail {
            lights: &lights,
            factor: 0.1,
            highlight: Some(0.99),
            silhouettes: true,
        };
        view.light = Some(detail);
        let judge = Judge::new(&view).unwrap();
        let lit = |axis: Vec3| {
            let sphere = ball(0.0, 0.0, 0.0);
            let cone = Cone {
                axis: axis.normalize(),
                cos: 0.999,
            };
            judge.is_lit(
                &detail,
                &Bounds {
                    error: 1.0,
                    sphere,
                    cone,
                },
            )
        };
        assert!(lit(Vec3::Z) && lit(Vec3::X) && lit(Vec3::Y));
        assert!(!lit(Vec3::new(1.0, 0.0, 1.0)) && !lit(-Vec3::Z));
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
