//! A colour space in which distance is what an eye sees.

use crate::geom::Vec3;

/// Oklab of a linear RGB colour (B. Ottosson: A perceptual color space for image
/// processing, 2020). L lies in 0..=1.
pub(super) fn oklab(color: Vec3) -> Vec3 {
    let [r, g, b] = color.as_dvec3().to_array();
    let l = cube_root(0.412_221_470_8 * r + 0.536_332_536_3 * g + 0.051_445_992_9 * b);
    let m = cube_root(0.211_903_498_2 * r + 0.680_699_545_1 * g + 0.107_396_956_6 * b);
    let s = cube_root(0.088_302_461_9 * r + 0.281_718_837_6 * g + 0.629_978_700_5 * b);
    Vec3::new(
        (0.210_454_255_3 * l + 0.793_617_785_0 * m - 0.004_072_046_8 * s) as f32,
        (1.977_998_495_1 * l - 2.428_592_205_0 * m + 0.450_593_709_9 * s) as f32,
        (0.025_904_037_1 * l + 0.782_771_766_2 * m - 0.808_675_766_0 * s) as f32,
    )
}

/// Newton's method, without libm: the same bits on every machine.
pub(super) fn cube_root(x: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    // A third of the exponent is a start within a factor of two.
    let mut root = f64::from_bits(x.to_bits() / 3 + 0x2a9f_7893_0000_0000);
    for _ in 0..6 {
        root -= (root * root * root - x) / (3.0 * root * root);
    }
    root
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_agree_with_libm() {
        for i in 1..2000 {
            let x = f64::from(i) * f64::from(i) * 1e-6;
            assert!((cube_root(x) / x.cbrt() - 1.0).abs() < 1e-14, "{x}");
        }
        assert!((cube_root(1e-30) / 1e-10 - 1.0).abs() < 1e-14);
        assert_eq!(cube_root(0.0), 0.0);
    }

    /// Values of the author's page.
    #[test]
    fn white_grey_and_red_are_where_they_should_be() {
        let close = |a: Vec3, b: [f32; 3]| a.distance(Vec3::from(b)) < 1e-3;
        assert!(close(oklab(Vec3::ONE), [1.0, 0.0, 0.0]));
        assert!(close(oklab(Vec3::splat(0.125)), [0.5, 0.0, 0.0]));
        assert!(close(oklab(Vec3::X), [0.628, 0.225, 0.126]));
        assert!(close(oklab(Vec3::Y), [0.866, -0.234, 0.179]));
        assert!(close(oklab(Vec3::Z), [0.452, -0.032, -0.312]));
    }
}
