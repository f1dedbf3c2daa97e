//! Boxes in `f64`, and the bounding volumes made of them.

use super::{
    ecef::{A, Geodetic},
    model::{Region, Shape},
};
use glam::{DMat4, DVec3};
use std::f64::consts::{PI, TAU};

/// Share by which a sphere is larger than it has to be, for rounding.
const SLACK: f64 = 1e-9;

/// A box along the axes, z up; empty if `min > max`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Extent {
    pub min: DVec3,
    pub max: DVec3,
}

impl Extent {
    pub const EMPTY: Self = Self {
        min: DVec3::INFINITY,
        max: DVec3::NEG_INFINITY,
    };

    pub fn is_empty(self) -> bool {
        self.min.cmpgt(self.max).any()
    }

    pub fn with(self, p: DVec3) -> Self {
        Self {
            min: self.min.min(p),
            max: self.max.max(p),
        }
    }

    pub fn union(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    pub fn grown(self, by: f64) -> Self {
        Self {
            min: self.min - by,
            max: self.max + by,
        }
    }

    pub fn moved(self, by: DVec3) -> Self {
        Self {
            min: self.min + by,
            max: self.max + by,
        }
    }

    pub fn center(self) -> DVec3 {
        self.min + (self.max - self.min) * 0.5
    }

    /// As a box of a tile whose origin is `origin`.
    pub fn shape(self, origin: DVec3) -> Shape {
        let half = (self.max - self.min) * 0.5;
        Shape::Box {
            center: self.center() - origin,
            half_axes: [DVec3::X * half.x, DVec3::Y * half.y, DVec3::Z * half.z],
        }
    }

    fn corners(self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            let pick = |bit: usize, a: f64, b: f64| if i >> bit & 1 == 1 { b } else { a };
            DVec3::new(
                pick(0, self.min.x, self.max.x),
                pick(1, self.min.y, self.max.y),
                pick(2, self.min.z, self.max.z),
            )
        })
    }
}

/// A sphere around a box and the spheres of children.
pub(super) fn sphere(extent: Extent, children: &[(DVec3, f64)]) -> (DVec3, f64) {
    let center = extent.center();
    let own = (extent.max - center).length();
    let reach = |(c, r): &(DVec3, f64)| (*c - center).length() + r;
    let radius = children.iter().map(reach).fold(own, f64::max);
    (center, radius * (1.0 + SLACK))
}

/// A region around a box on the earth. Longitudes are told relative to that of
/// `place` (within half a turn of it) so that unions need no care;
/// [`wrapped`] makes them proper.
pub(super) fn region(extent: Extent, ecef_from_scene: &DMat4, place: Geodetic) -> Region {
    let mut region = Region {
        west: f64::INFINITY,
        south: f64::INFINITY,
        east: f64::NEG_INFINITY,
        north: f64::NEG_INFINITY,
        min_height: f64::INFINITY,
        max_height: f64::NEG_INFINITY,
    };
    for corner in extent.corners() {
        let p = Geodetic::from_ecef(ecef_from_scene.transform_point3(corner));
        let lon = place.lon + (p.lon - place.lon + PI).rem_euclid(TAU) - PI;
        region.west = region.west.min(lon);
        region.east = region.east.max(lon);
        region.south = region.south.min(p.lat);
        region.north = region.north.max(p.lat);
        region.min_height = region.min_height.min(p.height);
        region.max_height = region.max_height.max(p.height);
    }
    // Between corners a flat box bends against the ground: by the square of
    // its size over the earth's radius, more in longitude near the poles.
    let size = (extent.max - extent.min).length();
    let bend = size * size / A;
    let angle = bend / A + 1e-12;
    let lat = region.south.abs().max(region.north.abs());
    region.west -= angle * (1.0 + lat.tan().abs()) / lat.cos();
    region.east += angle * (1.0 + lat.tan().abs()) / lat.cos();
    region.south -= angle * (1.0 + lat.tan().abs());
    region.north += angle * (1.0 + lat.tan().abs());
    region.min_height -= bend + 1e-6;
    region.max_height += 1e-6;
    region
}

/// The smallest region around both; longitudes as [`region`] tells them.
pub(super) fn union(a: Region, b: Region) -> Region {
    Region {
        west: a.west.min(b.west),
        south: a.south.min(b.south),
        east: a.east.max(b.east),
        north: a.north.max(b.north),
        min_height: a.min_height.min(b.min_height),
        max_height: a.max_height.max(b.max_height),
    }
}

/// With longitudes from -pi to pi.
pub(super) fn wrapped(region: Region) -> Region {
    let wrap = |lon: f64| (lon + PI).rem_euclid(TAU) - PI;
    Region {
        west: wrap(region.west),
        east: wrap(region.east),
        ..region
    }
}
