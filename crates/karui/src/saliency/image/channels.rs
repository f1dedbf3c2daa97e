//! Intensity and the two colour oppositions of a picture.

use super::plane::Plane;
use crate::render::Picture;

/// Intensity, R - G and B - Y at full resolution. Pyramids are linear, so the
/// oppositions of their levels are the levels of the oppositions. Channels are
/// the picture's codes by 255, over black where it is transparent.
pub(super) fn channels(picture: &Picture, out: &mut [Plane; 3]) {
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    for plane in out.iter_mut() {
        (plane.width, plane.height) = (width, height);
        plane.values.resize(width * height, 0.0);
    }
    let pixels = picture.pixels();
    let [i, rg, by] = out;
    let runs = || pixels.chunk_by(|a, b| a == b);
    let brightness = runs().map(|run| sum(over_black(run[0])));
    let least = 0.1 * brightness.fold(0.0, f32::max);
    let mut start = 0;
    // Most of a picture of a model is background.
    for run in runs() {
        let end = start + run.len();
        let color = over_black(run[0]);
        let [red_green, blue_yellow] = oppositions(color, least);
        i.values[start..end].fill(sum(color) / 3.0);
        rg.values[start..end].fill(red_green);
        by.values[start..end].fill(blue_yellow);
        start = end;
    }
}

#[inline]
fn over_black([r, g, b, a]: [u8; 4]) -> [f32; 3] {
    let factor = f32::from(a) / (255.0 * 255.0);
    [r, g, b].map(|c| f32::from(c) * factor)
}

#[inline]
fn sum([r, g, b]: [f32; 3]) -> f32 {
    r + g + b
}

/// R - G and B - Y of a colour; 0 where the sum of its channels is not above
/// `least`.
#[inline]
fn oppositions(color: [f32; 3], least: f32) -> [f32; 2] {
    let total = sum(color);
    let factor = if total > least { 3.0 / total } else { 0.0 };
    let [r, g, b] = color.map(|c| c * factor);
    let red = (r - 0.5 * (g + b)).max(0.0);
    let green = (g - 0.5 * (r + b)).max(0.0);
    let blue = (b - 0.5 * (r + g)).max(0.0);
    let yellow = (0.5 * (r + g) - 0.5 * (r - g).abs() - b).max(0.0);
    [red - green, blue - yellow]
}
