//! Values for texels that have none, so that neither filtering nor smaller copies
//! mix in what is not there.

use crate::geom::{Vec3, Vec4};
use crate::render::{encoded, linear_of_codes};

/// What texels are, and how their means are taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Texels {
    /// sRGB colours with straight alpha; alpha is spread like the colours.
    Colors,
    /// sRGB colours; nothing is seen of those that are filled in.
    Covered,
    /// Plain numbers, opaque.
    Numbers,
}

/// Gives every texel that is not `known` the mean of its neighbours that are, from
/// the known ones outwards.
pub(super) fn dilate(pixels: &mut [[u8; 4]], width: usize, known: &mut [bool], kind: Texels) {
    let mut front: Vec<usize> = (0..pixels.len()).filter(|&i| known[i]).collect();
    while !front.is_empty() {
        let mut next: Vec<usize> = Vec::new();
        for &i in &front {
            next.extend(neighbours(i, width, pixels.len()).filter(|&n| !known[n]));
        }
        next.sort_unstable();
        next.dedup();
        let filled = next.iter().map(|&i| mean(i, width, pixels, known, kind));
        let filled: Vec<[u8; 4]> = filled.collect();
        for (&i, value) in next.iter().zip(filled) {
            (pixels[i], known[i]) = (value, true);
        }
        front = next;
    }
}

fn neighbours(i: usize, width: usize, count: usize) -> impl Iterator<Item = usize> {
    let (x, y, rows) = (i % width, i / width, count / width);
    (0..9).filter_map(move |k| {
        let (dx, dy) = (k % 3, k / 3);
        let inside = (1..=width).contains(&(x + dx)) && (1..=rows).contains(&(y + dy));
        (k != 4 && inside).then(|| (y + dy - 1) * width + x + dx - 1)
    })
}

fn mean(i: usize, width: usize, pixels: &[[u8; 4]], known: &[bool], kind: Texels) -> [u8; 4] {
    let linear = linear_of_codes();
    let plain = |code: u8| f32::from(code) / 255.0;
    let (mut sum, mut count) = (Vec4::ZERO, 0.0);
    for n in neighbours(i, width, pixels.len()).filter(|&n| known[n]) {
        let [r, g, b, a] = pixels[n];
        let value = [r, g, b].map(|code| match kind {
            Texels::Numbers => plain(code),
            Texels::Colors | Texels::Covered => linear[usize::from(code)],
        });
        sum += Vec3::from_array(value).extend(plain(a));
        count += 1.0;
    }
    let mean = sum / f32::max(count, 1.0);
    let [r, g, b, a] = encoded(mean);
    match kind {
        Texels::Colors => [r, g, b, a],
        Texels::Covered => [r, g, b, 0],
        Texels::Numbers => mean.to_array().map(|x| (x * 255.0 + 0.5) as u8),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_known_is_as_what_is_near() {
        let (red, blue) = ([255, 0, 0, 255], [0, 0, 255, 255]);
        let filled = |kind| {
            let mut pixels = vec![[9; 4]; 12];
            let mut known = vec![false; 12];
            (pixels[0], known[0]) = (red, true);
            (pixels[11], known[11]) = (blue, true);
            dilate(&mut pixels, 4, &mut known, kind);
            assert!(known.iter().all(|k| *k));
            pixels
        };
        let colors = filled(Texels::Colors);
        assert_eq!(
            [colors[0], colors[4], colors[11], colors[7]],
            [red, red, blue, blue]
        );
        assert_eq!(filled(Texels::Covered)[4], [255, 0, 0, 0]);
        assert_eq!(filled(Texels::Numbers)[7], blue);
    }
}
