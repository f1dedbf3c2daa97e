//! How much a placement enlarges what it places.

use crate::geom::Mat4;
use glam::{DMat3, DVec3};

/// Largest factor by which the matrix stretches any direction: the largest
/// singular value of its linear part.
#[must_use]
pub(super) fn largest_stretch(matrix: &Mat4) -> f64 {
    let column = |c: usize| matrix.col(c).truncate().as_dvec3();
    let linear = DMat3::from_cols(column(0), column(1), column(2));
    largest_eigenvalue(linear.transpose() * linear)
        .max(0.0)
        .sqrt()
}

/// Of a symmetric matrix, in closed form (Smith, "Eigenvalues of a symmetric
/// 3 x 3 matrix", CACM 4(4), 1961).
fn largest_eigenvalue(m: DMat3) -> f64 {
    let diagonal = DVec3::new(m.x_axis.x, m.y_axis.y, m.z_axis.z);
    let mean = diagonal.element_sum() / 3.0;
    let off = DVec3::new(m.y_axis.x, m.z_axis.x, m.z_axis.y);
    let spread = (diagonal - mean).length_squared() + 2.0 * off.length_squared();
    let p = (spread / 6.0).sqrt();
    if p <= 1e-12 * mean.abs() {
        return mean;
    }
    let shifted = (m - DMat3::from_diagonal(DVec3::splat(mean))) * (1.0 / p);
    let angle = (0.5 * shifted.determinant()).clamp(-1.0, 1.0).acos() / 3.0;
    mean + 2.0 * p * angle.cos()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Quat, Vec3};

    /// By trying very many directions.
    fn by_search(matrix: &Mat4) -> f64 {
        let n = 60;
        let directions = (0..n).flat_map(|i| (0..2 * n).map(move |j| (i, j)));
        directions.fold(0.0, |best, (i, j)| {
            let (a, b) = (i as f32 / n as f32 * 3.2, j as f32 / n as f32 * 3.2);
            let d = Vec3::new(a.sin() * b.cos(), a.sin() * b.sin(), a.cos());
            f64::max(best, f64::from(matrix.transform_vector3(d).length()))
        })
    }

    #[test]
    fn stretch_of_scales_rotations_and_shears() {
        let turn = |x| Mat4::from_quat(Quat::from_rotation_x(x) * Quat::from_rotation_z(1.7 * x));
        let scale = |x, y, z| Mat4::from_scale(Vec3::new(x, y, z));
        assert_eq!(largest_stretch(&Mat4::IDENTITY), 1.0);
        assert_eq!(largest_stretch(&scale(0.0, 0.0, 0.0)), 0.0);
        let cases = [
            scale(0.5, -3.0, 2.0),
            turn(0.4) * scale(1.0, 2.0, 0.1),
            scale(1.0, 5.0, 1.0) * turn(0.8) * scale(0.3, 1.0, 1.0),
            scale(1.0, 0.0, 0.0) * turn(1.1),
        ];
        for matrix in cases {
            let (exact, found) = (largest_stretch(&matrix), by_search(&matrix));
            assert!(
                exact >= found - 1e-5 && exact < 1.01 * found,
                "{exact} {found}"
            );
        }
    }
}
