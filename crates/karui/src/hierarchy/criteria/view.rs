//! What an eye sees of a node: test 1, and what tests 2 to 5 go by.

use super::travel::{Answer, Sight, Vantage};
use crate::error::{Error, Result};
use crate::geom::{Aabb, Camera, DVec3, Projection, sin_cos};
use crate::hierarchy::node::Bounds;

/// A camera as the tests need it.
#[derive(Debug, Clone)]
pub(super) struct View {
    eye: DVec3,
    forward: DVec3,
    perspective: bool,
    /// Pixels by model units, at distance 1 with a perspective.
    scale: f64,
    /// Diagonal of the mesh, not 0: what a turn by a radian counts as that no
    /// distance bears on.
    pub size: f64,
    /// Inward normals and offsets of what bounds the picture.
    planes: Vec<(DVec3, f64)>,
    bounds: Aabb,
}

/// What is seen of a node that is not outside the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Seen {
    /// Nothing if the eye is inside it.
    pub sight: Option<Sight>,
    /// Sine of the angle that it is seen under; the radius, without perspective.
    pub sine: f64,
}

impl View {
    pub fn new(camera: &Camera, size: [u32; 2], frustum: bool, bounds: Aabb) -> Result<Self> {
        if size.contains(&0) {
            return Err(Error::BadOption {
                option: "size",
                found: format!("{} x {}", size[0], size[1]),
                expected: "at least 1 x 1 pixels",
            });
        }
        let axes = camera.axes()?;
        let scale = 0.5 * f64::from(size[1]) * camera.scale()?;
        let eye = camera.eye.as_dvec3();
        if !eye.is_finite() {
            return Err(not_finite("camera.eye", &camera.eye));
        }
        let mut view = Self {
            eye,
            forward: axes.forward,
            perspective: matches!(camera.projection, Projection::Perspective { .. }),
            scale,
            size: bounds.diagonal() + f64::MIN_POSITIVE,
            bounds,
            planes: Vec::new(),
        };
        if frustum {
            view.add_sides(size, [axes.right, axes.up]);
            view.add_depths(camera)?;
        }
        Ok(view)
    }

    fn add_sides(&mut self, size: [u32; 2], axes: [DVec3; 2]) {
        for (axis, pixels) in axes.into_iter().zip(size) {
            let half = 0.5 * f64::from(pixels) / self.scale;
            for axis in [axis, -axis] {
                match self.perspective {
                    true => self.add_plane((self.forward * half + axis).normalize(), 0.0),
                    false => self.add_plane(axis, -half),
                }
            }
        }
    }

    fn add_plane(&mut self, normal: DVec3, from_eye: f64) {
        self.planes.push((normal, normal.dot(self.eye) + from_eye));
    }

    fn add_depths(&mut self, camera: &Camera) -> Result<()> {
        let near = match (camera.near, self.perspective) {
            (None, true) => Some(0.0),
            (near, _) => near.map(f64::from),
        };
        let far = camera.far.map(f64::from);
        for (option, depth) in [("camera.near", near), ("camera.far", far)] {
            if let Some(depth) = depth.filter(|d| !d.is_finite()) {
                return Err(not_finite(option, &depth));
            }
        }
        near.into_iter()
            .for_each(|near| self.add_plane(self.forward, near));
        far.into_iter()
            .for_each(|far| self.add_plane(-self.forward, -far));
        Ok(())
    }

    /// Test 1: whether it is outside the picture.
    #[inline]
    pub fn outside(&self, bounds: &Bounds) -> Answer {
        let mut way = f64::INFINITY;
        for (normal, offset) in &self.planes {
            let inside = normal.dot(bounds.center) - offset + bounds.radius;
            if inside < 0.0 {
                return Answer::of(-inside, 1.0);
            }
            way = way.min(inside);
        }
        Answer::for_way(false, way)
    }

    #[inline]
    pub fn look(&self, bounds: &Bounds) -> Seen {
        if !self.perspective {
            return Seen {
                sight: Some(Sight::from_far(-self.forward, self.size)),
                sine: bounds.radius,
            };
        }
        let sight = Sight::from_point(bounds, self.eye);
        let sine = sight.map_or(f64::INFINITY, |s| s.extent[0]);
        Seen { sight, sine }
    }

    /// The sine, or radius, at which the area on the screen is this.
    pub fn sine_of(&self, area: f64) -> f64 {
        (area / std::f64::consts::PI).sqrt() / self.scale
    }

    /// Area on the screen, square pixels.
    pub fn area(&self, bounds: &Bounds) -> f64 {
        let side = self.look(bounds).sine * self.scale;
        std::f64::consts::PI * side * side
    }

    /// How far the eye would have to go to be outside of what it is inside of.
    pub fn way_out(&self, bounds: &Bounds) -> f64 {
        bounds.radius - self.eye.distance(bounds.center)
    }

    pub fn vantage(&self) -> Vantage {
        let kind = [self.scale, f64::from(u8::from(self.perspective))];
        Vantage {
            eye: self.eye,
            planes: self.planes.clone(),
            places: Vec::new(),
            directions: Vec::new(),
            view: (!self.perspective).then_some(self.forward),
            size: self.size,
            bounds: self.bounds,
            rest: kind.to_vec(),
        }
    }
}

pub(super) fn not_finite(option: &'static str, found: &dyn std::fmt::Display) -> Error {
    Error::BadOption {
        option,
        found: found.to_string(),
        expected: "finite",
    }
}

/// Which way the normals of a node face.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Facing {
    /// All of them towards.
    Toward,
    /// All of them away.
    Away,
    /// One may be at a right angle.
    Across,
}

/// How all normals of a node lie to where it is seen from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Turn {
    pub facing: Facing,
    /// The way for which that holds.
    pub way: f64,
    /// The way before all face away.
    pub way_to_away: f64,
}

/// Tests 2, 3 and 6: how all normals in the cone lie to all directions in which
/// a point is seen from the sphere.
#[inline]
pub(super) fn facing(bounds: &Bounds, sight: &Sight) -> Turn {
    let across = |way: f64| Turn {
        facing: Facing::Across,
        way,
        way_to_away: way,
    };
    let Some(spread) = bounds.spread else {
        return across(sight.way);
    };
    let [sine, cosine] = sum(spread, sight.extent);
    // Together a right angle or more: every direction is among them.
    if cosine <= 0.0 {
        let answer = Answer::of(cosine, sight.growth);
        return across(answer.way.min(sight.way));
    }
    let along = bounds.axis.dot(sight.toward);
    let by_rate = 1.0 / (sight.turn + sight.growth);
    let limit = (cosine * by_rate).min(sight.way);
    let facing = match along {
        _ if along > sine => Facing::Toward,
        _ if along < -sine => Facing::Away,
        _ => Facing::Across,
    };
    Turn {
        facing,
        way: ((along.abs() - sine).abs() * by_rate).min(limit),
        way_to_away: ((along + sine).abs() * by_rate).min(limit),
    }
}

/// Sine and cosine of the sum of two angles.
#[inline]
pub(super) fn sum(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] * b[1] + a[1] * b[0], a[1] * b[1] - a[0] * b[0]]
}

/// Sine and cosine of an angle in degrees.
pub(super) fn of_degrees(angle: f64) -> [f64; 2] {
    let (sine, cosine) = sin_cos(angle.to_radians());
    [sine, cosine]
}
