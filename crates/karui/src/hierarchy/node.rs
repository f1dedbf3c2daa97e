//! One collapse of the hierarchy and what it takes to decide about it.

use super::facing::{decode, encode};
use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3};

/// One half-edge collapse. 44 bytes.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Node {
    /// The half-edge collapsed, [`REVERSED`](super::surface::REVERSED) or not.
    pub half_edge: u32,
    pub parent: u32,
    /// The collapses that made the removed and the kept vertex what they were.
    pub children: [u32; 2],
    pub cover: Cover,
    /// Where the nodes that wait for this one begin in the list of all.
    pub first_dependent: u32,
}

/// What a node covers, as it is stored.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Cover {
    pub center: Vec3,
    pub radius: f32,
    /// Axis of the cone of normals, octahedral.
    pub axis: u32,
    /// Sine of half its angle; more than 1 if it is no cone.
    pub sine: f32,
}

/// What a node covers: a sphere around all triangles that it and the nodes below
/// it touch, and a cone around all vertex normals there. Those of a node hold
/// those of its children.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Centre of the sphere, model units.
    pub center: DVec3,
    /// Its radius, model units.
    pub radius: f64,
    /// Unit vector along the cone's axis.
    pub axis: DVec3,
    /// Sine and cosine of the angle between axis and side, at most a right one;
    /// `None` if the normals fit into no such cone.
    pub spread: Option<[f64; 2]>,
}

/// A [`Cover`] that is quicker to use.
#[derive(Debug, Clone, Copy)]
pub(super) struct Unpacked {
    center: Vec3,
    radius: f32,
    axis: Vec3,
    sine: f32,
}

impl Unpacked {
    /// The very same as [`Cover::bounds`].
    #[inline]
    pub fn bounds(&self) -> Bounds {
        Bounds {
            center: self.center.as_dvec3(),
            radius: f64::from(self.radius),
            axis: self.axis.as_dvec3(),
            spread: spread(self.sine),
        }
    }
}

#[inline]
fn spread(sine: f32) -> Option<[f64; 2]> {
    let sine = f64::from(sine);
    (sine <= 1.0).then(|| [sine, (1.0 - sine * sine).sqrt()])
}

/// Stands for "no cone" among sines.
const ANY: f32 = 2.0;

impl Cover {
    /// What it covers, in the precision that decides.
    #[inline]
    pub fn bounds(&self) -> Bounds {
        self.unpacked().bounds()
    }

    #[inline]
    pub fn unpacked(&self) -> Unpacked {
        Unpacked {
            center: self.center,
            radius: self.radius,
            axis: decode(self.axis).as_vec3(),
            sine: self.sine,
        }
    }
}

/// The least sphere of some that holds spheres and points.
///
/// Tried are the centres of the given spheres and of the box around all; f64
/// throughout, and the result is rounded up.
pub(super) fn sphere(balls: &[(DVec3, f64)], points: &[DVec3]) -> (Vec3, f32) {
    let corner = |sign: f64| {
        let of_balls = balls.iter().map(move |&(c, r)| c + sign * r);
        of_balls.chain(points.iter().copied())
    };
    let least = corner(-1.0).reduce(DVec3::min).unwrap_or_default();
    let most = corner(1.0).reduce(DVec3::max).unwrap_or_default();
    let around = |center: Vec3| {
        let center = center.as_dvec3();
        let of_balls = balls.iter().map(|&(c, r)| c.distance(center) + r);
        let of_points = points.iter().map(|p| p.distance(center));
        of_balls.chain(of_points).fold(0.0, f64::max)
    };
    let middle = (0.5 * (least + most)).as_vec3();
    let mut best = (middle, around(middle));
    for &(center, _) in balls {
        let center = center.as_vec3();
        let radius = around(center);
        if radius < best.1 {
            best = (center, radius);
        }
    }
    (best.0, rounded_up(best.1))
}

/// A hair more than `x`, in single precision.
fn rounded_up(x: f64) -> f32 {
    (x * (1.0 + 1e-6)) as f32
}

/// A cone around cones and unit vectors, as stored: the axis is that of the first
/// guess or of a cone that holds the others, whichever is narrower.
pub(super) fn cone(cones: &[(DVec3, Option<[f64; 2]>)], normals: &[DVec3]) -> (u32, f32) {
    if cones.iter().any(|c| c.1.is_none()) {
        return (encode(DVec3::Z), ANY);
    }
    let sum: DVec3 = normals.iter().chain(cones.iter().map(|c| &c.0)).sum();
    let mut best = (encode(DVec3::Z), ANY);
    let axes = std::iter::once(sum).chain(cones.iter().map(|c| c.0));
    for axis in axes {
        let code = encode(axis.try_normalize().unwrap_or(DVec3::Z));
        let sine = widest(decode(code), cones, normals);
        if sine < best.1 {
            best = (code, sine);
        }
    }
    best
}

/// Sine of the widest angle to `axis`; [`ANY`] beyond a right one.
fn widest(axis: DVec3, cones: &[(DVec3, Option<[f64; 2]>)], normals: &[DVec3]) -> f32 {
    let mut least = 1f64;
    for n in normals {
        least = least.min(axis.dot(*n));
    }
    for (other, spread) in cones {
        let [sine, cosine] = spread.unwrap_or([1.0, 0.0]);
        let between = axis.dot(*other).min(1.0);
        // Cosine of the sum of both angles; both are at most a right one here.
        let across = (1.0 - between * between).max(0.0).sqrt();
        least = least.min(between * cosine - across * sine);
    }
    if least <= 0.0 {
        return ANY;
    }
    let sine = (1.0 - least * least).max(0.0).sqrt();
    // A hair wider, so that rounding takes nothing out of it.
    ((sine * (1.0 + 1e-6) + 1e-7).min(1.0)) as f32
}
