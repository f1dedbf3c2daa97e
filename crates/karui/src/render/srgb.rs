//! sRGB (IEC 61966-2-1) through tables whose entries are made with roots that
//! IEEE 754 fixes, not with `powf`.

use std::sync::LazyLock;

/// Linear values of the 256 codes.
static LINEAR: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|code| decode(code as f64 / 255.0) as f32));

/// Least linear value of every code but the first, and one never reached.
static LEAST: LazyLock<[f32; 256]> = LazyLock::new(|| {
    let half_up = |code: usize| decode((code as f64 + 0.5) / 255.0) as f32;
    std::array::from_fn(|code| {
        if code < 255 {
            half_up(code)
        } else {
            f32::INFINITY
        }
    })
});

/// Linear values of all codes.
pub(crate) fn linear_of_codes() -> &'static [f32; 256] {
    &LINEAR
}

const STEPS: usize = 4096;

/// Code of the least value that rounds to a 4096th of the linear range; as many
/// entries as an index of 13 bits can name.
static START: LazyLock<[u8; 2 * STEPS]> = LazyLock::new(|| {
    std::array::from_fn(|i| {
        let linear = (i as f32 - 0.5) / STEPS as f32;
        LEAST.partition_point(|&least| least <= linear) as u8
    })
});

/// The tables, looked up once for many pixels.
#[derive(Clone, Copy)]
pub(super) struct Srgb {
    linear: &'static [f32; 256],
    least: &'static [f32; 256],
    start: &'static [u8; 2 * STEPS],
}

impl Srgb {
    pub(super) fn new() -> Self {
        Self {
            linear: &LINEAR,
            least: &LEAST,
            start: &START,
        }
    }

    #[inline]
    pub(super) fn linear(self, code: u8) -> f32 {
        self.linear[usize::from(code)]
    }

    /// Nearest code of a linear value, cut off at 0 and 1; 0 for NaN.
    #[inline]
    pub(super) fn code(self, linear: f32) -> u8 {
        let linear = unit(linear);
        // Adding 2^23 leaves the nearest integer in the lowest bits.
        let nearest = (linear * STEPS as f32 + 8_388_608.0).to_bits() as usize;
        let code = self.start[nearest % (2 * STEPS)];
        // Codes are wider than the steps of the table: at most one begins in each.
        code + u8::from(linear >= self.least[usize::from(code)])
    }
}

fn decode(encoded: f64) -> f64 {
    if encoded <= 0.04045 {
        return encoded / 12.92;
    }
    let x = (encoded + 0.055) / 1.055;
    x * x * fifth_root(x * x)
}

/// Newton's method from above, for 0 < x <= 1.
fn fifth_root(x: f64) -> f64 {
    let mut root = 1.0;
    for _ in 0..40 {
        let fourth = (root * root) * (root * root);
        root -= (root * fourth - x) / (5.0 * fourth);
    }
    root
}

/// Cut off at 0 and 1; 0 for NaN and -0, of which `max` promises less.
#[inline]
pub(super) fn unit(x: f32) -> f32 {
    if x > 0.0 { x.min(1.0) } else { 0.0 }
}

/// Nearest code of a value that is not gamma-encoded; 0 for NaN.
#[inline]
pub(super) fn plain_code(value: f32) -> u8 {
    (unit(value) * 255.0 + 0.5) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_definition() {
        for code in 0..=255u8 {
            let e = f64::from(code) / 255.0;
            let linear = if e <= 0.04045 {
                e / 12.92
            } else {
                ((e + 0.055) / 1.055).powf(2.4)
            };
            assert!((f64::from(Srgb::new().linear(code)) - linear).abs() < 1e-7);
        }
    }

    #[test]
    fn encoding_rounds_to_the_nearest_code() {
        let srgb = Srgb::new();
        for i in 0..=100_000 {
            let x = f64::from(i) / 100_000.0;
            let e = if x <= 0.003_130_8 {
                12.92 * x
            } else {
                1.055 * x.powf(1.0 / 2.4) - 0.055
            };
            let (found, exact) = (f64::from(srgb.code(x as f32)), 255.0 * e);
            assert!((found - exact).abs() < 0.501, "{x}: {found} {exact}");
        }
        assert!((0..=255).all(|c| srgb.code(srgb.linear(c)) == c));
        assert_eq!(
            [f32::NAN, -1.0, 2.0, f32::INFINITY].map(|x| srgb.code(x)),
            [0, 0, 255, 255]
        );
    }
}
