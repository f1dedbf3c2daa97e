//! Quadric error: weighted sums of squared distances to planes.
//!
//! M. Garland, P. Heckbert: Surface Simplification Using Quadric Error
//! Metrics, SIGGRAPH 1997.

use glam::{DMat3, DVec3};
use std::iter::Sum;
use std::ops::{Add, AddAssign, Mul};

/// `x^T A x - 2 b.x + c`: a weighted sum of squared distances, with the sum of
/// its weights.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Quadric {
    xx: f64,
    xy: f64,
    xz: f64,
    yy: f64,
    yz: f64,
    zz: f64,
    b: DVec3,
    c: f64,
    /// Sum of the weights; [`Quadric::mean`] divides by it.
    pub weight: f64,
}

impl Quadric {
    /// The sum of no distances.
    pub const ZERO: Self = Self {
        xx: 0.0,
        xy: 0.0,
        xz: 0.0,
        yy: 0.0,
        yz: 0.0,
        zz: 0.0,
        b: DVec3::ZERO,
        c: 0.0,
        weight: 0.0,
    };

    /// `weight` times the squared distance to the plane `normal . x = offset`;
    /// `normal` has unit length.
    #[must_use]
    pub fn plane(normal: DVec3, offset: f64, weight: f64) -> Self {
        let n = normal * weight;
        Self {
            xx: n.x * normal.x,
            xy: n.x * normal.y,
            xz: n.x * normal.z,
            yy: n.y * normal.y,
            yz: n.y * normal.z,
            zz: n.z * normal.z,
            b: n * offset,
            c: weight * offset * offset,
            weight,
        }
    }

    /// The weighted sum of squared distances at `x`, never below 0.
    #[must_use]
    pub fn sum(&self, x: DVec3) -> f64 {
        let ax = self.matrix() * x;
        (x.dot(ax) - 2.0 * self.b.dot(x) + self.c).max(0.0)
    }

    /// The weighted mean of squared distances at `x`; 0 without weight.
    #[must_use]
    pub fn mean(&self, x: DVec3) -> f64 {
        if self.weight > 0.0 {
            self.sum(x) / self.weight
        } else {
            0.0
        }
    }

    /// The matrix A.
    #[must_use]
    pub fn matrix(&self) -> DMat3 {
        DMat3::from_cols(
            DVec3::new(self.xx, self.xy, self.xz),
            DVec3::new(self.xy, self.yy, self.yz),
            DVec3::new(self.xz, self.yz, self.zz),
        )
    }

    /// The vector b.
    #[must_use]
    pub fn linear(&self) -> DVec3 {
        self.b
    }

    /// Trace of A.
    #[must_use]
    pub fn trace(&self) -> f64 {
        self.xx + self.yy + self.zz
    }

    /// The same function of `x + origin`: moves the origin of coordinates.
    #[must_use]
    pub fn relative_to(&self, origin: DVec3) -> Self {
        let ao = self.matrix() * origin;
        Self {
            b: self.b - ao,
            c: origin.dot(ao) - 2.0 * self.b.dot(origin) + self.c,
            ..*self
        }
    }
}

impl Sum for Quadric {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::ZERO, |sum, one| sum + one)
    }
}

impl AddAssign for Quadric {
    fn add_assign(&mut self, o: Self) {
        self.xx += o.xx;
        self.xy += o.xy;
        self.xz += o.xz;
        self.yy += o.yy;
        self.yz += o.yz;
        self.zz += o.zz;
        self.b += o.b;
        self.c += o.c;
        self.weight += o.weight;
    }
}

impl Add for Quadric {
    type Output = Self;

    fn add(mut self, o: Self) -> Self {
        self += o;
        self
    }
}

impl Mul<f64> for Quadric {
    type Output = Self;

    /// The same distances, of so many times the weight.
    fn mul(self, factor: f64) -> Self {
        Self {
            xx: self.xx * factor,
            xy: self.xy * factor,
            xz: self.xz * factor,
            yy: self.yy * factor,
            yz: self.yz * factor,
            zz: self.zz * factor,
            b: self.b * factor,
            c: self.c * factor,
            weight: self.weight * factor,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_squared_plane_distances() {
        let mut q = Quadric::plane(DVec3::Z, 1.0, 2.0);
        q += Quadric::plane(DVec3::X, -1.0, 3.0);
        let x = DVec3::new(1.0, 5.0, 4.0);
        assert!((q.sum(x) - (2.0 * 9.0 + 3.0 * 4.0)).abs() < 1e-12);
        assert!((q.mean(x) - 30.0 / 5.0).abs() < 1e-12);
        assert_eq!(q.trace(), 5.0);
        let half = (q + q) * 0.25;
        assert_eq!((half.sum(x), half.mean(x)), (0.5 * q.sum(x), q.mean(x)));
    }

    #[test]
    fn moved_origin_is_the_same_function() {
        let n = DVec3::new(1.0, 2.0, -2.0) / 3.0;
        let q = Quadric::plane(n, 0.7, 1.5);
        let (x, origin) = (DVec3::new(0.3, -2.0, 1.0), DVec3::new(5.0, 6.0, 7.0));
        let moved = q.relative_to(origin);
        assert!((q.sum(x) - moved.sum(x - origin)).abs() < 1e-10);
    }
}
