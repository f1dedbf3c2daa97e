//! Principal curvatures of every vertex.

use super::stars::Stars;
use crate::error::Result;
use crate::mesh::TriMesh;
use glam::{DMat3, DVec2, DVec3, Vec3};
use rayon::prelude::*;

/// How a surface bends at a point; positive where it bends away from its
/// normal, as a sphere seen from outside does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Curvature {
    /// Larger principal curvature, 1 / model unit.
    pub k1: f64,
    /// Smaller principal curvature, 1 / model unit.
    pub k2: f64,
    /// Unit directions of `k1` and `k2`, at right angles in the tangent plane;
    /// any such pair where the curvatures are equal.
    pub directions: [Vec3; 2],
}

impl Curvature {
    /// Mean curvature `(k1 + k2) / 2`, 1 / model unit.
    #[must_use]
    pub fn mean(&self) -> f64 {
        (self.k1 + self.k2) / 2.0
    }
}

/// How the tensor of curvature is made from the edges around a point.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Estimator {
    /// Taubin's with the true spread of the directions divided out, and with the normal
    /// of Max (1999), which is the true one wherever a star lies on a sphere; see
    /// [`curvature`].
    #[default]
    Corrected,
    /// As published: the area-weighted normal, and `3 m1 - m2` whatever the directions.
    Taubin1995,
}

/// How [`curvature_with`] looks at a surface.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct CurvatureOptions {
    /// Default [`Estimator::Corrected`].
    pub estimator: Estimator,
}

/// Curvature of every vertex of `mesh` (Taubin 1995), from the triangles
/// around its position: vertices at one place share theirs, so a seam is no
/// border. The normal is that of these triangles, each weighing as its area by the
/// squares of its two edges at the vertex (N. Max, 1999), so that a star on a sphere
/// has the sphere's however lopsided it is; the attribute is not read.
///
/// Along the edge from `v` to `v_j` the surface bends by
/// `k_j = 2 n.(v - v_j) / |v - v_j|^2`: Taubin's with the sign turned, so that
/// a sphere of radius r with outward normals has 1 / r. An edge weighs as much
/// as the area on it, `w_j`. Taubin reads the curvatures from the eigenvalues
/// of `sum w_j k_j t_j t_j^T`, as `3 m1 - m2` and `3 m2 - m1`, which holds if
/// the directions `t_j` are spread evenly. Here their true spread is divided
/// out instead (weighted least squares of `k_j` over the directions): equal
/// for even directions, and right on a sphere of quads split by diagonals,
/// where Taubin's is off by two thirds. Where the directions are too few for
/// that, Taubin's stands.
///
/// On a border the edges that are there decide. Without a triangle that has an
/// area, and where all normals cancel out, the curvature is 0. All results are
/// finite.
///
/// # Errors
/// [`Error::IndexOutOfRange`](crate::Error::IndexOutOfRange),
/// [`Error::NotFinite`](crate::Error::NotFinite) for a position that is not,
/// and [`Error::TooLarge`](crate::Error::TooLarge).
pub fn curvature(mesh: &TriMesh) -> Result<Vec<Curvature>> {
    curvature_with(mesh, &CurvatureOptions::default())
}

/// As [`curvature`], with a choice of the estimator.
///
/// # Errors
/// Those of [`curvature`].
pub fn curvature_with(mesh: &TriMesh, options: &CurvatureOptions) -> Result<Vec<Curvature>> {
    let stars = Stars::of(mesh)?;
    Ok(stars.spread(&of_points(&stars, options.estimator)))
}

/// Share of the vertices that [`curvature_sizes`] holds for spikes: a few would make
/// everything else nothing.
const SPIKES: f64 = 0.01;

/// Size of the mean curvature, 0 to 1, as a share of what 99 % of the vertices stay
/// under; those above have 1. All are 0 if that is 0, as on a plane.
#[must_use]
pub fn curvature_sizes(found: &[Curvature]) -> Vec<f32> {
    let sizes: Vec<f64> = found.iter().map(|c| c.mean().abs()).collect();
    let mut sorted = sizes.clone();
    sorted.sort_unstable_by(f64::total_cmp);
    let place = ((1.0 - SPIKES) * sorted.len().saturating_sub(1) as f64) as usize;
    match sorted.get(place) {
        Some(&most) if most > 0.0 => {
            let share = |size: f64| (size / most).min(1.0) as f32;
            sizes.into_iter().map(share).collect()
        }
        _ => vec![0.0; found.len()],
    }
}

/// Curvature of every point.
pub(super) fn of_points(stars: &Stars, estimator: Estimator) -> Vec<Curvature> {
    let points = (0..stars.points.len()).into_par_iter();
    points.map(|p| at(stars, p, estimator)).collect()
}

impl Estimator {
    /// What a triangle with the edges `a` and `b` at a point adds to its normal.
    fn normal(self, [a, b]: [DVec3; 2]) -> DVec3 {
        let area = a.cross(b);
        match self {
            Self::Corrected => area / (a.length_squared() * b.length_squared()),
            Self::Taubin1995 => area,
        }
    }
}

fn at(stars: &Stars, p: usize, estimator: Estimator) -> Curvature {
    let from = stars.points[p];
    let edges = |&[a, b]: &[u32; 2]| [a, b].map(|x| stars.points[x as usize] - from);
    let sum = |n: DVec3, edges| n + estimator.normal(edges);
    let around = stars.around(p).iter().map(edges);
    let Some(normal) = around.clone().fold(DVec3::ZERO, sum).try_normalize() else {
        return bent(DVec3::Z, DVec3::ZERO);
    };
    let mut fit = Fit::new(normal);
    for [a, b] in around {
        let area = a.cross(b).length();
        fit.add(a, area);
        fit.add(b, area);
    }
    bent(normal, fit.solve(estimator))
}

/// `mean + x cos 2a + y sin 2a` fitted to the curvature in the directions `a`.
struct Fit {
    normal: DVec3,
    axes: [DVec3; 2],
    /// Sums of products of (1, cos 2a, sin 2a), weighted.
    spread: DMat3,
    /// Sums of curvatures by the same three, weighted.
    found: DVec3,
    weight: f64,
}

impl Fit {
    /// Determinant of the spread, 1/4 if even, below which directions are too
    /// few: quads up to about 7 times as long as wide stay above.
    const LEAST: f64 = 0.01;

    fn new(normal: DVec3) -> Self {
        Self {
            normal,
            axes: normal.any_orthonormal_pair().into(),
            spread: DMat3::ZERO,
            found: DVec3::ZERO,
            weight: 0.0,
        }
    }

    fn add(&mut self, edge: DVec3, weight: f64) {
        let flat = DVec2::from(self.axes.map(|axis| axis.dot(edge)));
        let Some(DVec2 { x, y }) = flat.try_normalize() else {
            return;
        };
        let bend = -2.0 * self.normal.dot(edge) / edge.length_squared();
        let row = DVec3::new(1.0, x * x - y * y, 2.0 * x * y);
        let weighted = row * weight;
        self.spread += DMat3::from_cols(weighted, weighted * row.y, weighted * row.z);
        self.found += weighted * bend;
        self.weight += weight;
    }

    /// Mean, x and y.
    fn solve(&self, estimator: Estimator) -> DVec3 {
        if self.weight <= 0.0 {
            return DVec3::ZERO;
        }
        let spread = self.spread * self.weight.recip();
        let found = self.found / self.weight;
        if estimator == Estimator::Corrected && spread.determinant() > Self::LEAST {
            spread.inverse() * found
        } else {
            found * DVec3::new(1.0, 2.0, 2.0)
        }
    }
}

fn bent(normal: DVec3, DVec3 { x: mean, y, z }: DVec3) -> Curvature {
    let half = DVec2::new(y, z).length();
    let (u, v) = normal.any_orthonormal_pair();
    let angle = z.atan2(y) / 2.0;
    let (sin, cos) = angle.sin_cos();
    Curvature {
        k1: mean + half,
        k2: mean - half,
        directions: [u * cos + v * sin, v * cos - u * sin].map(|d| d.as_vec3()),
    }
}
