//! Smaller copies of an image, each pixel the mean of those it stands for
//! (Williams, "Pyramidal parametrics", 1983).

use super::Picture;
use super::srgb::Srgb;
use rayon::prelude::*;
use std::ops::Range;

/// What the bytes of an image mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    /// Colours; means are taken of light, weighted by alpha.
    Srgb,
    /// Plain numbers.
    Plain,
}

/// Half, a quarter and so on of an image, down to one pixel.
pub(super) fn mips(image: &Picture, encoding: Encoding) -> Vec<Picture> {
    let mut levels: Vec<Picture> = Vec::new();
    loop {
        let last = levels.last().unwrap_or(image);
        if last.width().max(last.height()) <= 1 {
            return levels;
        }
        let half = half(last, encoding);
        levels.push(half);
    }
}

fn half(image: &Picture, encoding: Encoding) -> Picture {
    let (width, height) = ((image.width() / 2).max(1), (image.height() / 2).max(1));
    let mut half = Picture::filled(width, height, [0; 4]);
    let srgb = Srgb::new();
    let rows = half.pixels_mut().par_chunks_mut(width as usize);
    rows.enumerate().for_each(|(y, row)| {
        let ys = sources(y, image.height(), height);
        for (x, pixel) in row.iter_mut().enumerate() {
            let xs = sources(x, image.width(), width);
            let block = ys.clone().flat_map(|y| {
                let row = y * image.width() as usize;
                image.pixels()[row + xs.start..row + xs.end].iter()
            });
            *pixel = match encoding {
                Encoding::Srgb => mean_color(srgb, block),
                Encoding::Plain => mean(block),
            };
        }
    });
    half
}

/// Two pixels, or the last three of an odd number.
fn sources(i: usize, from: u32, to: u32) -> Range<usize> {
    let last = i + 1 == to as usize;
    2 * i..if last { from as usize } else { 2 * i + 2 }
}

fn mean_color<'a>(srgb: Srgb, block: impl Iterator<Item = &'a [u8; 4]> + Clone) -> [u8; 4] {
    let alpha: f32 = block.clone().map(|p| f32::from(p[3])).sum();
    let count = block.clone().count() as f32;
    let channel = |k: usize| {
        let light = block.clone().map(|p| {
            let share = if alpha > 0.0 { f32::from(p[3]) } else { 1.0 };
            srgb.linear(p[k]) * share
        });
        let whole = if alpha > 0.0 { alpha } else { count };
        srgb.code(light.sum::<f32>() / whole)
    };
    [
        channel(0),
        channel(1),
        channel(2),
        (alpha / count + 0.5) as u8,
    ]
}

fn mean<'a>(block: impl Iterator<Item = &'a [u8; 4]>) -> [u8; 4] {
    let (mut sum, mut count) = ([0u32; 4], 0);
    for pixel in block {
        sum = std::array::from_fn(|k| sum[k] + u32::from(pixel[k]));
        count += 1;
    }
    sum.map(|s| ((s + count / 2) / count) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_level_is_half_of_the_one_before() {
        let image = Picture::filled(13, 4, [10, 20, 30, 200]);
        for encoding in [Encoding::Srgb, Encoding::Plain] {
            let levels = mips(&image, encoding);
            let sizes: Vec<_> = levels.iter().map(|l| (l.width(), l.height())).collect();
            assert_eq!(sizes, [(6, 2), (3, 1), (1, 1)]);
            let same = |l: &Picture| l.pixels().iter().all(|p| *p == [10, 20, 30, 200]);
            assert!(levels.iter().all(same));
        }
        assert!(mips(&Picture::filled(1, 1, [0; 4]), Encoding::Plain).is_empty());
    }

    #[test]
    fn the_mean_of_black_and_white_is_half_the_light() {
        let image = Picture::new(2, 1, vec![[0, 0, 0, 255], [255; 4]]).unwrap();
        assert_eq!(
            mips(&image, Encoding::Plain)[0].pixels(),
            [[128, 128, 128, 255]]
        );
        assert_eq!(
            mips(&image, Encoding::Srgb)[0].pixels(),
            [[188, 188, 188, 255]]
        );
    }

    #[test]
    fn what_is_transparent_has_no_colour() {
        let image = Picture::new(2, 1, vec![[255, 0, 0, 255], [0, 255, 0, 0]]).unwrap();
        assert_eq!(mips(&image, Encoding::Srgb)[0].pixels(), [[255, 0, 0, 128]]);
    }
}
