//! How far a point or another volume sticks out of a bounding volume.

use super::{
    ecef::{A, Geodetic},
    model::{Region, Shape},
};
use glam::{DMat3, DMat4, DVec3};
use std::f64::consts::TAU;

/// A shape prepared for many questions.
#[derive(Debug, Clone, Copy)]
pub(super) struct Solid {
    shape: Shape,
    /// Of a box: takes a point to distances along its axes.
    axes_from_frame: DMat3,
    half: DVec3,
}

impl Solid {
    /// The shape of a tile moved into the frame of the root.
    pub fn new(shape: Shape, root_from_tile: &DMat4) -> Self {
        let shape = transformed(shape, root_from_tile);
        let (axes_from_frame, half) = match shape {
            Shape::Box { half_axes, .. } => frame(half_axes),
            _ => (DMat3::IDENTITY, DVec3::ZERO),
        };
        Self {
            shape,
            axes_from_frame,
            half,
        }
    }

    /// Whether it is a part of the earth's shell, which is not convex.
    pub fn is_region(&self) -> bool {
        matches!(self.shape, Shape::Region(_))
    }

    /// About the largest extent, metres.
    pub fn size(&self) -> f64 {
        match self.shape {
            Shape::Box { .. } => 2.0 * self.half.length(),
            Shape::Sphere { radius, .. } => 2.0 * radius,
            Shape::Region(r) => {
                let (wide, high) = (width(r), r.north - r.south);
                A * wide.hypot(high).min(2.0) + (r.max_height - r.min_height)
            }
        }
    }

    /// Largest coordinate, metres: what rounding is relative to.
    pub fn reach(&self) -> f64 {
        match self.shape {
            Shape::Box { center, .. } => center.abs().max_element() + self.half.max_element(),
            Shape::Sphere { center, radius } => center.abs().max_element() + radius,
            Shape::Region(_) => A,
        }
    }

    /// Metres by which a point lies outside, at most 0 inside. Outside of a
    /// corner or an edge it is the largest distance from a side.
    pub fn outside(&self, p: DVec3) -> f64 {
        match self.shape {
            Shape::Box { center, .. } => {
                let local = self.axes_from_frame * (p - center);
                (local.abs() - self.half).max_element()
            }
            Shape::Sphere { center, radius } => (p - center).length() - radius,
            Shape::Region(region) => outside_region(region, Geodetic::from_ecef(p)),
        }
    }

    /// Metres by which another volume certainly sticks out, at most 0 if it
    /// does not. Points of the other volume decide; a box in a region is
    /// judged by its centre, as boxes around curved ground stick out of it.
    pub fn beyond(&self, other: &Self) -> f64 {
        let furthest = |points: &[DVec3]| {
            let each = points.iter().map(|&p| self.outside(p));
            each.fold(f64::NEG_INFINITY, f64::max)
        };
        match (self.shape, other.shape) {
            (Shape::Region(outer), Shape::Region(inner)) => beyond_region(outer, inner),
            (Shape::Region(_), Shape::Box { center, .. } | Shape::Sphere { center, .. }) => {
                self.outside(center)
            }
            (_, Shape::Box { center, half_axes }) => furthest(&corners(center, half_axes)),
            (
                Shape::Sphere {
                    center: c,
                    radius: r,
                },
                Shape::Sphere { center, radius },
            ) => (center - c).length() + radius - r,
            (_, Shape::Sphere { center, radius }) => {
                let rows = self.axes_from_frame.transpose();
                let normals = [rows.x_axis, rows.y_axis, rows.z_axis];
                let ends = normals.map(|n| n.normalize_or_zero() * radius);
                furthest(&ends.map(|e| [center + e, center - e]).concat())
            }
            (_, Shape::Region(region)) => furthest(&samples(region)),
        }
    }
}

/// A shape in another frame. Regions stay (specification, "Transforms"), and
/// spheres grow by the largest scale.
pub(super) fn transformed(shape: Shape, matrix: &DMat4) -> Shape {
    match shape {
        Shape::Box { center, half_axes } => Shape::Box {
            center: matrix.transform_point3(center),
            half_axes: half_axes.map(|a| matrix.transform_vector3(a)),
        },
        Shape::Sphere { center, radius } => {
            let axes = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
            let scale = axes.map(|a| a.truncate().length());
            Shape::Sphere {
                center: matrix.transform_point3(center),
                radius: radius * scale.into_iter().fold(0.0, f64::max),
            }
        }
        region @ Shape::Region(_) => region,
    }
}

/// Takes vectors to distances along the half axes, whose lengths are the
/// second value. Half axes of length 0 point at right angles to the others.
fn frame(half_axes: [DVec3; 3]) -> (DMat3, DVec3) {
    let half = DVec3::from(half_axes.map(DVec3::length));
    let [mut x, mut y, mut z] = half_axes.map(DVec3::normalize_or_zero);
    for _ in 0..2 {
        complete(&mut x, y, z);
        complete(&mut y, z, x);
        complete(&mut z, x, y);
    }
    let matrix = DMat3::from_cols(x, y, z);
    let inverse = if matrix.determinant().abs() > 1e-6 {
        matrix.inverse()
    } else {
        // So skewed that it is flat: the distances along its axes.
        matrix.transpose()
    };
    (inverse, half)
}

fn complete(axis: &mut DVec3, a: DVec3, b: DVec3) {
    if *axis != DVec3::ZERO {
        return;
    }
    *axis = match (a == DVec3::ZERO, b == DVec3::ZERO) {
        (false, false) => a.cross(b).normalize_or_zero(),
        (false, true) => a.any_orthonormal_vector(),
        (true, false) => b.any_orthonormal_vector(),
        (true, true) => DVec3::ZERO,
    };
}

fn corners(center: DVec3, [x, y, z]: [DVec3; 3]) -> [DVec3; 8] {
    std::array::from_fn(|i| {
        let sign = |bit: usize| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
        center + x * sign(0) + y * sign(1) + z * sign(2)
    })
}

/// Radians from west to east.
pub(super) fn width(region: Region) -> f64 {
    let width = region.east - region.west;
    if width < 0.0 { width + TAU } else { width }
}

/// Radians of a longitude east of another, 0 to a full turn.
fn eastwards(from: f64, to: f64) -> f64 {
    (to - from).rem_euclid(TAU)
}

fn outside_region(region: Region, p: Geodetic) -> f64 {
    let width = width(region);
    let east = eastwards(region.west, p.lon);
    let lon = (east - width).min(TAU - east).max(0.0);
    let lat = (region.south - p.lat).max(p.lat - region.north);
    // Near a pole any longitude is near.
    let angle = (lon * p.lat.cos()).max(lat);
    let height = (region.min_height - p.height).max(p.height - region.max_height);
    (angle * A).max(height)
}

fn beyond_region(outer: Region, inner: Region) -> f64 {
    let west = eastwards(outer.west, inner.west);
    // A little to the west of the edge is not almost a turn to the east.
    let west = if TAU - west < 1e-6 { west - TAU } else { west };
    let east = (west + width(inner) - width(outer)).max(-west);
    let lat = (outer.south - inner.south).max(inner.north - outer.north);
    let low = outer.min_height - inner.min_height;
    (east.max(lat) * A)
        .max(low)
        .max(inner.max_height - outer.max_height)
}

/// Points on a region.
fn samples(region: Region) -> [DVec3; 18] {
    std::array::from_fn(|i| {
        let part = |i: usize| i as f64 / 2.0;
        let height = if i < 9 {
            region.min_height
        } else {
            region.max_height
        };
        let place = Geodetic {
            lon: region.west + width(region) * part(i % 3),
            lat: region.south + (region.north - region.south) * part(i / 3 % 3),
            height,
        };
        place.to_ecef()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn solid(shape: Shape) -> Solid {
        Solid::new(shape, &DMat4::IDENTITY)
    }

    fn cube(center: DVec3, half: f64) -> Shape {
        let half_axes = [DVec3::X * half, -DVec3::Y * half, DVec3::Z * half];
        Shape::Box { center, half_axes }
    }

    fn near(a: f64, b: f64) {
        assert!((a - b).abs() < 1e-6, "{a} {b}");
    }

    #[test]
    fn points_and_boxes() {
        let unit = solid(cube(DVec3::ZERO, 1.0));
        near(unit.outside(DVec3::new(3.0, 0.0, 0.0)), 2.0);
        near(unit.outside(DVec3::splat(0.5)), -0.5);
        let turned = DMat4::from_rotation_z(0.25 * std::f64::consts::PI);
        let turned = Solid::new(cube(DVec3::ZERO, 1.0), &turned);
        near(
            turned.outside(DVec3::X * 2.0),
            2.0 * 0.5f64.sqrt() - 1.0 + 0.0,
        );
        near(unit.beyond(&turned), 2f64.sqrt() - 1.0);
        let flat = [DVec3::X, DVec3::Y * 2.0, DVec3::ZERO];
        let flat = solid(Shape::Box {
            center: DVec3::ZERO,
            half_axes: flat,
        });
        near(flat.outside(DVec3::new(0.0, 0.0, 0.25)), 0.25);
        let line = [DVec3::ZERO, DVec3::Y * 2.0, DVec3::ZERO];
        let line = solid(Shape::Box {
            center: DVec3::ZERO,
            half_axes: line,
        });
        assert!(line.outside(DVec3::new(0.5, 0.0, 0.0)) > 0.3);
    }

    #[test]
    fn spheres() {
        let ball = |x, radius| {
            solid(Shape::Sphere {
                center: DVec3::X * x,
                radius,
            })
        };
        near(ball(0.0, 2.0).outside(DVec3::Y * 3.0), 1.0);
        near(ball(0.0, 2.0).beyond(&ball(1.5, 1.0)), 0.5);
        near(solid(cube(DVec3::ZERO, 1.0)).beyond(&ball(0.5, 1.0)), 0.5);
        near(
            ball(0.0, 1.0).beyond(&solid(cube(DVec3::ZERO, 1.0))),
            3f64.sqrt() - 1.0,
        );
        let scaled = Solid::new(
            Shape::Sphere {
                center: DVec3::ZERO,
                radius: 1.0,
            },
            &DMat4::from_scale(DVec3::new(1.0, 3.0, 2.0)),
        );
        near(scaled.outside(DVec3::Z * 3.0), 0.0);
    }

    fn region(west: f64, east: f64) -> Region {
        Region {
            west,
            east,
            south: -0.1,
            north: 0.1,
            min_height: 0.0,
            max_height: 100.0,
        }
    }

    #[test]
    fn regions_across_the_antimeridian() {
        let date_line = solid(Shape::Region(region(3.1, -3.1)));
        let at = |lon, height| {
            Geodetic {
                lon,
                lat: 0.0,
                height,
            }
            .to_ecef()
        };
        assert!(date_line.outside(at(3.13, 50.0)) <= 1e-6);
        assert!(date_line.outside(at(-3.13, 50.0)) <= 1e-6);
        near(date_line.outside(at(3.12, 150.0)), 50.0);
        near(date_line.outside(at(3.0, 50.0)), 0.1 * A);
        let inner = |west, east| date_line.beyond(&solid(Shape::Region(region(west, east))));
        assert!(inner(3.12, -3.12) <= 1e-6);
        assert!(inner(3.1, 3.13) <= 1e-6);
        near(inner(3.1, -3.0), 0.1 * A);
        near(inner(3.0, -3.1), inner(3.0, -3.1).abs());
        assert!(inner(3.0, -3.1) > 0.05 * A);
    }
}
