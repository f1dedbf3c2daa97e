//! Symmetric 3x3 matrices in `f32`.

use glam::Vec3;
use std::ops::{Add, AddAssign, Sub, SubAssign};

/// A symmetric matrix: xx, xy, xz, yy, yz, zz.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Sym3(pub [f32; 6]);

impl Sym3 {
    /// `v vT`.
    #[inline(always)]
    pub fn outer(v: Vec3) -> Self {
        let Vec3 { x, y, z } = v;
        Self([x * x, x * y, x * z, y * y, y * z, z * z])
    }

    /// `weight (|e|^2 I - e eT)`: what squared distances to a line along `e`
    /// sum up to.
    pub fn across(e: Vec3, weight: f32) -> Self {
        let l = e.length_squared();
        let [xx, xy, xz, yy, yz, zz] = Self::outer(e).0;
        Self([l - xx, -xy, -xz, l - yy, -yz, l - zz].map(|v| v * weight))
    }

    /// Sum of the diagonal.
    #[inline(always)]
    pub fn trace(&self) -> f32 {
        self.0[0] + self.0[3] + self.0[5]
    }

    /// The matrix times `v`.
    #[inline(always)]
    pub fn mul(&self, v: Vec3) -> Vec3 {
        let [xx, xy, xz, yy, yz, zz] = self.0;
        Vec3::new(
            xx * v.x + xy * v.y + xz * v.z,
            xy * v.x + yy * v.y + yz * v.z,
            xz * v.x + yz * v.y + zz * v.z,
        )
    }

    /// `vT M v`.
    #[inline(always)]
    pub fn square(&self, v: Vec3) -> f32 {
        self.mul(v).dot(v)
    }

    /// Solves `(M + ridge I) x = r` by LDLT, which stays accurate for the
    /// nearly singular matrices of flat surfaces where Cramer's rule in `f32`
    /// does not. Not finite for a zero matrix without a ridge.
    #[inline(always)]
    pub fn solve(&self, ridge: f32, r: Vec3) -> Vec3 {
        let [xx, xy, xz, yy, yz, zz] = self.0;
        let i0 = 1.0 / (xx + ridge);
        let (l10, l20) = (xy * i0, xz * i0);
        let i1 = 1.0 / (yy + ridge - l10 * xy);
        let e = yz - l20 * xy;
        let l21 = e * i1;
        let i2 = 1.0 / (zz + ridge - l20 * xz - l21 * e);
        let y1 = r.y - l10 * r.x;
        let z = (r.z - l20 * r.x - l21 * y1) * i2;
        let y = y1 * i1 - l21 * z;
        Vec3::new(r.x * i0 - l10 * y - l20 * z, y, z)
    }
}

impl Add for Sym3 {
    type Output = Self;
    #[inline(always)]
    fn add(mut self, other: Self) -> Self {
        self += other;
        self
    }
}

impl Sub for Sym3 {
    type Output = Self;
    #[inline(always)]
    fn sub(mut self, other: Self) -> Self {
        self -= other;
        self
    }
}

impl AddAssign for Sym3 {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        for (a, b) in self.0.iter_mut().zip(other.0) {
            *a += b;
        }
    }
}

impl SubAssign for Sym3 {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        for (a, b) in self.0.iter_mut().zip(other.0) {
            *a -= b;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solution_solves() {
        let (a, b, c) = (Vec3::new(1.0, 2.0, 0.5), Vec3::Y, Vec3::new(0.0, 1.0, 3.0));
        let m = Sym3::outer(a) + Sym3::outer(b) + Sym3::outer(c);
        let x = m.solve(0.0, m.mul(Vec3::new(0.3, -0.2, 0.1)));
        assert!((x - Vec3::new(0.3, -0.2, 0.1)).length() < 1e-4, "{x}");
    }

    #[test]
    fn plane_with_a_ridge_is_solved_to_the_ridge() {
        let n = Vec3::new(0.6, 0.0, 0.8);
        let x = Sym3::outer(n).solve(1e-4, n * 0.5);
        assert!((x - n * 0.5).length() < 1e-3, "{x}");
    }

    #[test]
    fn distance_across_a_line() {
        let m = Sym3::across(Vec3::X * 2.0, 0.5);
        assert_eq!(m.square(Vec3::new(7.0, 3.0, 0.0)), 0.5 * 4.0 * 9.0);
    }
}
