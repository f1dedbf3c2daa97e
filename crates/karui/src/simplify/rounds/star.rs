//! The planes around a point as they are now.

use super::lanes::V;
use super::sym3::Sym3;
use glam::{Mat4, Vec3, Vec4, Vec4Swizzles};
use std::ops::{AddAssign, Sub, SubAssign};

/// Sum of area times `n nT` and of the area normals, over the triangles at a
/// point, through which all their planes pass; laid out so that three vector
/// instructions add one to another and four edges are priced at once: xx xy xz
/// nx, yy yz zz ny, nz and the point's place.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Star([Vec4; 3]);

impl Star {
    /// Of one triangle; `root` is its unit normal times the root of its area,
    /// and that root.
    #[inline(always)]
    pub fn of(root: Vec4) -> Self {
        Self([
            root * root.x,
            root.yzzy() * root.yyzw(),
            Vec4::new(root.z * root.w, 0.0, 0.0, 0.0),
        ])
    }

    /// Of a line, which has no side.
    pub fn of_line(line: Sym3) -> Self {
        let [xx, xy, xz, yy, yz, zz] = line.0;
        Self([
            Vec4::new(xx, xy, xz, 0.0),
            Vec4::new(yy, yz, zz, 0.0),
            Vec4::ZERO,
        ])
    }

    /// The planes.
    #[inline(always)]
    pub fn planes(&self) -> Sym3 {
        let [a, b, _] = &self.0;
        Sym3([a.x, a.y, a.z, b.x, b.y, b.z])
    }

    /// The sum of the area normals.
    #[inline(always)]
    pub fn normal(&self) -> Vec3 {
        let [a, b, c] = &self.0;
        Vec3::new(a.w, b.w, c.x)
    }

    /// The sum of the area normals, and of areas.
    pub fn facing(&self) -> Vec4 {
        self.normal().extend(self.planes().trace())
    }

    /// Remembers where the point is.
    #[inline(always)]
    pub fn set_place(&mut self, place: Vec3) {
        let c = &mut self.0[2];
        *c = Vec4::new(c.x, place.x, place.y, place.z);
    }

    /// Row `i` of four stars as four vectors, one for every number of the row,
    /// with one lane for every star.
    #[inline(always)]
    pub fn lanes(stars: [&Self; 4], i: usize) -> [Vec4; 4] {
        Self::columns(stars.map(|s| s.0[i]))
    }

    /// Places of four stars.
    #[inline(always)]
    pub fn places(stars: [&Self; 4]) -> V {
        let [_, x, y, z] = Self::lanes(stars, 2);
        V(x, y, z)
    }

    /// Four vectors as one for every of their numbers.
    #[inline(always)]
    pub fn columns([a, b, c, d]: [Vec4; 4]) -> [Vec4; 4] {
        let columns = Mat4::from_cols(a, b, c, d).transpose();
        [
            columns.x_axis,
            columns.y_axis,
            columns.z_axis,
            columns.w_axis,
        ]
    }
}

impl AddAssign for Star {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        for (a, b) in self.0.iter_mut().zip(other.0) {
            *a += b;
        }
    }
}

impl Sub for Star {
    type Output = Self;
    #[inline(always)]
    fn sub(mut self, other: Self) -> Self {
        self -= other;
        self
    }
}

impl SubAssign for Star {
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
    fn star_of_a_triangle_is_its_plane() {
        let root = Vec3::new(0.5, -1.0, 2.0);
        let star = Star::of(root.extend(root.length()));
        assert_eq!(star.planes(), Sym3::outer(root));
        assert!(star.normal().abs_diff_eq(root * root.length(), 1e-6));
        let mut sum = star;
        sum += star;
        sum -= star;
        assert_eq!(sum.0, star.0);
    }
}
