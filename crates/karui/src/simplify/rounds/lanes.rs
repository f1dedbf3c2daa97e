//! Prices of four edges, and turns of four triangles, at once.

use super::price::{CLOSED, OFF_SURFACE, PULL, SHORT, STEEP, WAY};
use super::star::Star;
use glam::{Vec3, Vec4};
use std::ops::{Add, Mul, Sub};

/// Four vectors.
#[derive(Debug, Clone, Copy)]
pub(super) struct V(pub Vec4, pub Vec4, pub Vec4);

impl V {
    /// One vector four times.
    #[inline(always)]
    pub fn splat(v: Vec3) -> Self {
        Self(Vec4::splat(v.x), Vec4::splat(v.y), Vec4::splat(v.z))
    }

    #[inline(always)]
    fn cross(self, o: Self) -> Self {
        Self(
            self.1 * o.2 - o.1 * self.2,
            self.2 * o.0 - o.2 * self.0,
            self.0 * o.1 - o.0 * self.1,
        )
    }

    /// The dot products.
    #[inline(always)]
    pub fn dot(self, o: Self) -> Vec4 {
        self.0 * o.0 + self.1 * o.1 + self.2 * o.2
    }
}

impl Add for V {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self(self.0 + o.0, self.1 + o.1, self.2 + o.2)
    }
}

impl Sub for V {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self(self.0 - o.0, self.1 - o.1, self.2 - o.2)
    }
}

impl Mul<Vec4> for V {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: Vec4) -> Self {
        Self(self.0 * s, self.1 * s, self.2 * s)
    }
}

/// Symmetric matrices of four edges: xx xy xz yy yz zz.
#[derive(Clone, Copy)]
struct M([Vec4; 6]);

impl M {
    #[inline(always)]
    fn mul(&self, v: V) -> V {
        let [xx, xy, xz, yy, yz, zz] = self.0;
        V(
            xx * v.0 + xy * v.1 + xz * v.2,
            xy * v.0 + yy * v.1 + yz * v.2,
            xz * v.0 + yz * v.1 + zz * v.2,
        )
    }

    /// As [`Sym3::solve`](super::sym3::Sym3::solve).
    #[inline(always)]
    fn solve(&self, ridge: Vec4, r: V) -> V {
        let [xx, xy, xz, yy, yz, zz] = self.0;
        let i0 = Vec4::ONE / (xx + ridge);
        let (l10, l20) = (xy * i0, xz * i0);
        let i1 = Vec4::ONE / (yy + ridge - l10 * xy);
        let e = yz - l20 * xy;
        let l21 = e * i1;
        let i2 = Vec4::ONE / (zz + ridge - l20 * xz - l21 * e);
        let y1 = r.1 - l10 * r.0;
        let z = (r.2 - l20 * r.0 - l21 * y1) * i2;
        let y = y1 * i1 - l21 * z;
        V(r.0 * i0 - l10 * y - l20 * z, y, z)
    }
}

/// Planes, normals and places of four stars.
#[inline(always)]
fn unpack(stars: [&Star; 4]) -> (M, V, V) {
    let [xx, xy, xz, nx] = Star::lanes(stars, 0);
    let [yy, yz, zz, ny] = Star::lanes(stars, 1);
    let [nz, x, y, z] = Star::lanes(stars, 2);
    (M([xx, xy, xz, yy, yz, zz]), V(nx, ny, nz), V(x, y, z))
}

/// What [`Block::offer`](super::block::Block) asks for edges whose ends are
/// both free, from `a` to `b`, but for its comparison with the ends, which
/// matters to the place more than to the price. Not a number where there is no
/// area.
#[inline(always)]
pub(super) fn prices(a: [&Star; 4], b: [&Star; 4], facing: [Vec4; 4], even: f32) -> Vec4 {
    let (qa, na, pa) = unpack(a);
    let (qb, nb, pb) = unpack(b);
    let half = (pb - pa) * Vec4::splat(0.5);
    let sum = M(std::array::from_fn(|i| qa.0[i] + qb.0[i]));
    let area = sum.0[0] + sum.0[3] + sum.0[5];
    let (ha, hb) = (qa.mul(half), qb.mul(half));
    let y = sum.solve(Vec4::splat(PULL + even) * area, hb - ha);
    let along = half.dot(half);
    // Of a place too far away the middle takes its place.
    let near = y.dot(y).cmple(along * 16.0);
    let y = V(
        Vec4::select(near, y.0, Vec4::ZERO),
        Vec4::select(near, y.1, Vec4::ZERO),
        Vec4::select(near, y.2, Vec4::ZERO),
    );
    let (u, v) = (y + half, y - half);
    let least = qa.mul(u).dot(u) + qb.mul(v).dot(v);
    let tiny = Vec4::splat(f32::MIN_POSITIVE);
    let share = (y.dot(half) / along.max(tiny)).clamp(Vec4::NEG_ONE, Vec4::ONE);
    let normal = na + nb;
    let height = (y - half * share).dot(normal);
    let height = height * height / normal.dot(normal).max(tiny);
    let [fx, fy, fz, input] = Star::columns(facing);
    let (facing, input) = (V(fx, fy, fz), input * input);
    let turned = (input * CLOSED - facing.dot(facing)) * STEEP;
    let openness = (turned / input.max(tiny)).clamp(Vec4::ZERO, Vec4::ONE);
    let retreat = openness * WAY * (y.dot(y) + along);
    least.max(Vec4::ZERO) + area * (height * OFF_SURFACE + retreat + along * (4.0 * (SHORT + even)))
}

/// Four triangles before and after one of their corners moves.
#[derive(Debug)]
pub(super) struct Turn {
    /// Their area normals then, doubled.
    pub normal: V,
    /// The length of these.
    pub length: Vec4,
    /// Their longest side then, squared.
    pub longest: Vec4,
    /// Their unit normals before, times the root of the area, and that root.
    pub old_normal: V,
    pub old_root: Vec4,
}

/// Triangles from `place` to the two points of every `ring`; `old` are their
/// roots before.
#[inline(always)]
pub(super) fn turn(place: V, [q, r]: [V; 2], [x, y, z, w]: [Vec4; 4]) -> Turn {
    let (e, f, g) = (q - place, r - place, q - r);
    let normal = e.cross(f);
    Turn {
        normal,
        length: normal.dot(normal).sqrt(),
        longest: e.dot(e).max(f.dot(f)).max(g.dot(g)),
        old_normal: V(x, y, z),
        old_root: w,
    }
}

impl Turn {
    /// The roots of the triangles as they are then, as
    /// [`root_of`](super::block::root_of) has them.
    #[inline(always)]
    pub fn roots(&self) -> [Vec4; 4] {
        let tiny = Vec4::splat(f32::MIN_POSITIVE);
        let by = (Vec4::splat(0.5) / self.length.max(tiny)).sqrt();
        let normal = self.normal * by;
        Star::columns([normal.0, normal.1, normal.2, self.length * by])
    }
}
