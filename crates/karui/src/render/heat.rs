//! Numbers as colours: a map that the colour-blind can read, and that grey print keeps.

use super::srgb::linear_of_codes;
use glam::{Vec3, Vec4};

/// Viridis at 0, 1/4, ... 1 (S. van der Walt, N. Smith, matplotlib; CC0), sRGB.
const VIRIDIS: [Vec3; 5] = [
    Vec3::new(0.267, 0.005, 0.329),
    Vec3::new(0.229, 0.322, 0.546),
    Vec3::new(0.128, 0.567, 0.551),
    Vec3::new(0.369, 0.789, 0.383),
    Vec3::new(0.993, 0.906, 0.144),
];

/// Linear RGBA of the code that stands for a share of 0 (dark) to 1 (bright).
#[must_use]
pub fn heat_color(share: f32) -> Vec4 {
    let linear = linear_of_codes();
    let [r, g, b] = code(share).map(|c| linear[usize::from(c)]);
    Vec4::new(r, g, b, 1.0)
}

/// sRGB codes for shares from 0 to 1 in equal steps.
#[must_use]
pub fn heat_table() -> [[u8; 3]; 256] {
    std::array::from_fn(|i| code(i as f32 / 255.0))
}

fn code(share: f32) -> [u8; 3] {
    let at = share.clamp(0.0, 1.0) * 4.0;
    let below = (at as usize).min(3);
    let srgb = VIRIDIS[below].lerp(VIRIDIS[below + 1], at - below as f32);
    (srgb * 255.0).to_array().map(|c| c.round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brighter_means_more() {
        let luminance = |i: i32| {
            let c = heat_color(i as f32 / 50.0);
            0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z
        };
        assert!((0..50).all(|i| luminance(i) < luminance(i + 1)));
        assert_eq!(heat_color(f32::INFINITY), heat_color(1.0));
        assert_eq!(heat_color(-1.0), heat_color(0.0));
    }
}
