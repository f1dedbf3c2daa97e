//! The planes of the input that a point stands for: how far it has moved off.

use super::sym3::Sym3;
use glam::{DVec3, Vec3, Vec4};

/// Squared distance to planes, as seen from a point (Garland & Heckbert 1997).
/// In `f64`: in `f32` a way of 1 along a plane counts as one of 0.0003 off it.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Planes {
    matrix: [f64; 6],
    linear: DVec3,
    constant: f64,
    area: f64,
}

impl Planes {
    /// `share` of the plane of a triangle through the point itself; `root` is
    /// the triangle's unit normal times the root of its area, and that root.
    #[inline(always)]
    pub fn of(root: Vec4, share: f64) -> Self {
        let DVec3 { x, y, z } = root.truncate().as_dvec3();
        let matrix = [x * x, x * y, x * z, y * y, y * z, z * z].map(|v| v * share);
        Self {
            area: matrix[0] + matrix[3] + matrix[5],
            matrix,
            ..Self::default()
        }
    }

    /// `share` of a line through the point itself.
    pub(super) fn of_line(line: Sym3, share: f64) -> Self {
        Self {
            matrix: line.0.map(|v| f64::from(v) * share),
            // A line, though made of two planes, weighs once.
            area: 0.5 * f64::from(line.trace()) * share,
            ..Self::default()
        }
    }

    /// The same planes as seen from a point `by` away.
    pub fn moved(&self, by: Vec3) -> Self {
        let by = by.as_dvec3();
        let [xx, xy, xz, yy, yz, zz] = self.matrix;
        let along = DVec3::new(
            xx * by.x + xy * by.y + xz * by.z,
            xy * by.x + yy * by.y + yz * by.z,
            xz * by.x + yz * by.y + zz * by.z,
        );
        Self {
            linear: self.linear + along,
            constant: self.constant + 2.0 * self.linear.dot(by) + along.dot(by),
            ..*self
        }
    }

    /// Both together.
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            matrix: std::array::from_fn(|i| self.matrix[i] + other.matrix[i]),
            linear: self.linear + other.linear,
            constant: self.constant + other.constant,
            area: self.area + other.area,
        }
    }

    /// Their area.
    pub fn area(&self) -> f64 {
        self.area
    }

    /// Half of them.
    pub fn halved(&self) -> Self {
        Self {
            matrix: self.matrix.map(|v| 0.5 * v),
            linear: 0.5 * self.linear,
            constant: 0.5 * self.constant,
            area: 0.5 * self.area,
        }
    }

    /// Root mean square distance of the point from the planes.
    pub fn distance(&self) -> f32 {
        if self.area > 0.0 {
            (self.constant / self.area).max(0.0).sqrt() as f32
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_grows_with_the_way_off_the_planes() {
        let floor = Planes::of(Vec4::new(0.0, 0.0, 2.0, 2.0), 1.0);
        assert_eq!(floor.moved(Vec3::X).distance(), 0.0);
        let there = floor.moved(Vec3::new(5.0, 1.0, 0.5));
        assert_eq!(there.distance(), 0.5);
        let back = there.moved(Vec3::new(0.0, 0.0, -0.5));
        assert!(back.distance() < 1e-6);
    }

    #[test]
    fn a_way_along_a_slanting_plane_is_none_off_it() {
        let normal = Vec3::new(0.3, -0.5, 0.7).normalize();
        let planes = Planes::of(normal.extend(1.0), 1.0);
        let along = normal.any_orthonormal_vector() * 100.0;
        assert!(planes.moved(along).distance() < 1e-4);
    }

    #[test]
    fn a_line_is_left_sideways_only() {
        let line = Planes::of_line(Sym3::across(Vec3::X, 2.0), 0.5);
        assert_eq!(line.moved(Vec3::X).distance(), 0.0);
        assert_eq!(line.moved(Vec3::Y * 0.25).distance(), 0.25);
    }
}
