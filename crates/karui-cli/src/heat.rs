//! Numbers as colours.

use glam::{Vec3, Vec4};

/// Viridis at 0, 1/4, ... 1 (S. van der Walt, N. Smith, matplotlib; CC0), sRGB.
const VIRIDIS: [Vec3; 5] = [
    Vec3::new(0.267, 0.005, 0.329),
    Vec3::new(0.229, 0.322, 0.546),
    Vec3::new(0.128, 0.567, 0.551),
    Vec3::new(0.369, 0.789, 0.383),
    Vec3::new(0.993, 0.906, 0.144),
];

/// Linear RGBA for a share of 0 (dark) to 1 (bright), for the colour-blind and
/// for grey print too.
pub fn color(share: f32) -> Vec4 {
    srgb(share).map(linear).extend(1.0)
}

/// sRGB codes for shares from 0 to 1 in equal steps.
pub fn table() -> [[u8; 3]; 256] {
    let code = |i: usize| srgb(i as f32 / 255.0) * 255.0;
    std::array::from_fn(|i| code(i).to_array().map(|c| c.round() as u8))
}

fn srgb(share: f32) -> Vec3 {
    let at = share.clamp(0.0, 1.0) * 4.0;
    let below = (at as usize).min(3);
    VIRIDIS[below].lerp(VIRIDIS[below + 1], at - below as f32)
}

/// IEC 61966-2-1.
fn linear(srgb: f32) -> f32 {
    if srgb <= 0.040_45 {
        return srgb / 12.92;
    }
    ((srgb + 0.055) / 1.055).powf(2.4)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brighter_means_more() {
        let luminance = |i: i32| {
            let c = color(i as f32 / 50.0);
            0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z
        };
        assert!((0..50).all(|i| luminance(i) < luminance(i + 1)));
        assert_eq!(color(f32::INFINITY), color(1.0));
        assert_eq!(color(-1.0), color(0.0));
    }
}
