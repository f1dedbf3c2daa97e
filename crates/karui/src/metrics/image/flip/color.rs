//! The colour spaces of FLIP, relative to its white (sRGB's): X, Y and Z of white
//! are 1 here, so the white point drops out of all equations.

use crate::render::linear_of_codes;

/// Rows: X, Y, Z of red, green, blue, divided by those of white.
const XYZ: [[f32; 3]; 3] = [
    [0.433_895_4, 0.376_242_37, 0.189_862_24],
    [0.212_636_82, 0.715_183, 0.072_180_2],
    [0.017_752_42, 0.109_465_63, 0.872_781_95],
];

/// Exponent of the colour difference.
const QC: f32 = 0.7;
/// Part of the range of colour differences that is told apart best.
const PC: f32 = 0.4;
/// Where that part ends in the result.
const PT: f32 = 0.95;

/// Of sRGB codes: luminance 0 to 1, red-green and blue-yellow opponents, as Y, Cx
/// and Cz of YCxCz without offset and scale, which linear filters do not see.
pub(super) fn opponents(pixel: [u8; 3]) -> [f32; 3] {
    let table = linear_of_codes();
    let [x, y, z] = xyz(pixel.map(|code| table[usize::from(code)]));
    [y, x - y, y - z]
}

fn xyz(rgb: [f32; 3]) -> [f32; 3] {
    XYZ.map(|row| row[0] * rgb[0] + row[1] * rgb[1] + row[2] * rgb[2])
}

/// L*a*b* of filtered opponents, cut off at what sRGB can show, with a and b
/// scaled by lightness (Hunt effect).
pub(super) fn lab(opponents: [f32; 3], inverse: &[[f32; 3]; 3]) -> [f32; 3] {
    let [y, cx, cz] = opponents;
    let from = [cx + y, y, y - cz];
    let rgb = inverse.map(|row| row[0] * from[0] + row[1] * from[1] + row[2] * from[2]);
    lab_of(xyz(rgb.map(|c| c.clamp(0.0, 1.0))))
}

fn lab_of(xyz: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = xyz.map(|t| {
        if t > 216.0 / 24389.0 {
            t.cbrt()
        } else {
            t * (841.0 / 108.0) + 4.0 / 29.0
        }
    });
    let lightness = 116.0 * y - 16.0;
    let hunt = 0.01 * lightness;
    [lightness, hunt * 500.0 * (x - y), hunt * 200.0 * (y - z)]
}

/// Turns colours into differences of 0 to 1.
pub(super) struct Scale {
    largest: f32,
    /// Matrix from relative XYZ to linear RGB.
    pub(super) inverse: [[f32; 3]; 3],
}

impl Scale {
    pub(super) fn new() -> Self {
        let [green, blue] = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|rgb| lab_of(xyz(rgb)));
        let columns = glam::DMat3::from_cols_array_2d(&XYZ.map(|row| row.map(f64::from)));
        // What are rows above are columns of `columns`: its inverse is transposed, too.
        let inverse = columns.inverse().to_cols_array_2d();
        Self {
            largest: hyab(green, blue).powf(QC),
            inverse: inverse.map(|row| row.map(|v| v as f32)),
        }
    }

    /// Difference of two colours from [`lab`].
    pub(super) fn difference(&self, a: [f32; 3], b: [f32; 3]) -> f32 {
        let power = hyab(a, b).powf(QC);
        let knee = PC * self.largest;
        if power < knee {
            return power * PT / knee;
        }
        PT + (power - knee) / (self.largest - knee) * (1.0 - PT)
    }
}

/// City-block in lightness, Euclidean in a and b.
fn hyab(a: [f32; 3], b: [f32; 3]) -> f32 {
    let [l, u, v] = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    l.abs() + (u * u + v * v).sqrt()
}
