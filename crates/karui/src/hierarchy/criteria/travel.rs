//! How far eye and lights may go before an answer can change.
//!
//! Everything that the tests compare is the sine or cosine of an angle, and
//! changes by no more than the angle does. An angle changes by no more than the
//! way gone times a rate that depends on the distance. So the gap between what
//! was compared tells how far the way is for which the answer holds; the least of
//! all gaps that led to an answer tells it for the answer.

use crate::geom::{Aabb, DVec3};
use crate::hierarchy::node::Bounds;
use std::f64::consts::FRAC_PI_2;

/// From where a frame looks, and what else its answers depend on.
///
/// An answer is a matter of planes, or of the eye and one light.
#[derive(Debug, Clone, PartialEq)]
pub struct Vantage {
    /// Where the eye is, model units.
    pub eye: DVec3,
    /// Unit normals and offsets of planes.
    pub planes: Vec<(DVec3, f64)>,
    /// Places of lights.
    pub places: Vec<DVec3>,
    /// Unit vectors to lights that are infinitely far away.
    pub directions: Vec<DVec3>,
    /// The unit vector along the view, without perspective.
    pub view: Option<DVec3>,
    /// What a turn of a direction by one radian counts as, model units.
    pub size: f64,
    /// Box around all that is asked about.
    pub bounds: Aabb,
    /// All the rest; if any of it differs, nothing is known.
    pub rest: Vec<f64>,
}

/// How far eye and lights have gone, model units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Way {
    /// The eye and its planes.
    pub eye: f64,
    /// The light that has gone farthest.
    pub lights: f64,
}

impl Vantage {
    /// The way from another one; infinite if the two have nothing to do with each
    /// other.
    #[must_use]
    pub fn way_from(&self, before: &Self) -> Way {
        let same_kind = self.rest == before.rest
            && self.size == before.size
            && self.planes.len() == before.planes.len()
            && self.places.len() == before.places.len()
            && self.directions.len() == before.directions.len()
            && self.view.is_some() == before.view.is_some();
        if !same_kind {
            return Way {
                eye: f64::INFINITY,
                lights: f64::INFINITY,
            };
        }
        let moved = self.places.iter().zip(&before.places);
        let moved = moved.map(|(a, b)| a.distance(*b));
        // The arc is longer than the chord, by no more than half of pi.
        let turned = |a: &[DVec3], b: &[DVec3]| {
            let pairs = a.iter().zip(b);
            let turns = pairs.map(|(a, b)| FRAC_PI_2 * a.distance(*b) * self.size);
            turns.fold(0.0, f64::max)
        };
        let of_lights = moved.fold(turned(&self.directions, &before.directions), f64::max);
        let of_planes = self.planes.iter().zip(&before.planes);
        let of_planes = of_planes
            .map(|(a, b)| self.most_between(a, b))
            .fold(0.0, f64::max);
        Way {
            eye: of_planes.max(
                self.eye.distance(before.eye)
                    + turned(self.view.as_slice(), before.view.as_slice()),
            ),
            lights: of_lights,
        }
    }

    /// How much the distances to two planes differ at most: at a corner.
    fn most_between(&self, a: &(DVec3, f64), b: &(DVec3, f64)) -> f64 {
        let (normal, offset) = (a.0 - b.0, a.1 - b.1);
        let center = self.bounds.center().as_dvec3();
        // A hair more, as spheres may have their centres at the very surface.
        let half = 0.5 * self.bounds.size().as_dvec3() * (1.0 + 1e-5);
        (normal.dot(center) - offset).abs() + normal.abs().dot(half)
    }
}

/// A yes or no, and the way for which it holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Answer {
    pub yes: bool,
    /// While the lights stand still: the way of the eye.
    pub way: f64,
    /// The sum of both ways, as far as lights have to do with it.
    pub with_lights: f64,
}

impl Answer {
    /// That holds wherever one goes.
    pub const fn always(yes: bool) -> Self {
        Self {
            yes,
            way: f64::INFINITY,
            with_lights: f64::INFINITY,
        }
    }

    /// That holds for a way of the eye.
    pub const fn for_way(yes: bool, way: f64) -> Self {
        Self {
            way,
            ..Self::always(yes)
        }
    }

    /// Whether `gap`, which changes by at most `rate` for every unit of the eye's
    /// way, is above 0.
    #[inline]
    pub fn of(gap: f64, rate: f64) -> Self {
        Self::for_way(gap > 0.0, gap.abs() / rate)
    }

    /// Holds for no longer than this way of the eye.
    #[inline]
    pub fn within(self, way: f64) -> Self {
        Self {
            way: self.way.min(way),
            ..self
        }
    }

    /// Holds for no longer than another.
    #[inline]
    pub fn while_holds(self, other: Self) -> Self {
        Self {
            yes: self.yes,
            way: self.way.min(other.way),
            with_lights: self.with_lights.min(other.with_lights),
        }
    }

    #[inline]
    pub fn and(self, yes: bool) -> Self {
        Self { yes, ..self }
    }
}

/// Answers hold for no more than this share of the way to a sphere: the rates are
/// those at its end.
const STEP: f64 = 0.1;

/// A sphere seen from a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sight {
    /// Unit vector from the sphere's centre to the point.
    pub toward: DVec3,
    /// Sine and cosine of the angle that the sphere is seen under, axis to side.
    pub extent: [f64; 2],
    /// Radians by which the direction, and the extent, changes at most for every
    /// unit of the way, for ways up to `way`.
    pub turn: f64,
    pub growth: f64,
    pub way: f64,
}

impl Sight {
    /// Nothing if the point is inside the sphere.
    #[inline]
    pub fn from_point(bounds: &Bounds, point: DVec3) -> Option<Self> {
        let offset = point - bounds.center;
        let distance = offset.length();
        let radius = bounds.radius;
        if distance <= radius {
            return None;
        }
        let by_distance = 1.0 / distance;
        let sine = radius * by_distance;
        Some(Self {
            toward: offset * by_distance,
            extent: [sine, (1.0 - sine * sine).sqrt()],
            turn: by_distance * (1.0 / (1.0 - STEP)),
            growth: growth(radius, sine, by_distance, distance),
            way: STEP * (distance - radius),
        })
    }

    /// From infinitely far away; a turn by a radian counts as `reach`.
    #[inline]
    pub fn from_far(toward: DVec3, reach: f64) -> Self {
        Self {
            toward,
            extent: [0.0, 1.0],
            turn: 1.0 / reach,
            growth: 0.0,
            way: f64::INFINITY,
        }
    }
}

/// How fast the angle changes at most that a sphere is seen under, up to `STEP` of
/// the way to it: the derivative of `asin(radius / distance)`, there.
#[inline]
fn growth(radius: f64, sine: f64, by_distance: f64, distance: f64) -> f64 {
    // Where a sphere is small its cosine is close to 1 and need not be found: that
    // of 0.5 at 0.9 of the distance is 0.83.
    const SMALL: f64 = 0.5;
    const BY_SQUARE: f64 = 1.5;
    if sine < SMALL {
        return BY_SQUARE * sine * by_distance;
    }
    let least = distance - STEP * (distance - radius);
    radius / (least * (least * least - radius * radius).sqrt())
}
