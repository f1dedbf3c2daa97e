//! Differences of pixels, each for itself.

use super::flat::Pair;
use crate::error::Result;
use crate::render::Picture;

/// Root mean squared difference of the sRGB-coded red, green and blue, 0 to 1,
/// of the pictures laid over black.
///
/// # Errors
/// [`Error::SizeMismatch`](crate::Error::SizeMismatch) for pictures of different
/// size, [`Error::Empty`](crate::Error::Empty) for pictures without pixels.
pub fn rmse(a: &Picture, b: &Picture) -> Result<f64> {
    Ok(squared(&Pair::new(a, b, [0; 3])?).sqrt())
}

/// Peak signal-to-noise ratio, in dB: `-20 log10` of [`rmse`], infinite for equal
/// pictures.
///
/// # Errors
/// As [`rmse`].
pub fn psnr(a: &Picture, b: &Picture) -> Result<f64> {
    Ok(decibels(squared(&Pair::new(a, b, [0; 3])?)))
}

/// Mean squared difference, 0 to 1. Integers are added: the order does not matter.
pub(super) fn squared(pair: &Pair) -> f64 {
    let channels = pair.a.as_flattened().iter().zip(pair.b.as_flattened());
    let sum: u64 = channels
        .map(|(&a, &b)| u64::from(a.abs_diff(b)).pow(2))
        .sum();
    sum as f64 / (3 * pair.a.len()) as f64 / (255.0 * 255.0)
}

/// PSNR of a mean squared difference.
pub(super) fn decibels(squared: f64) -> f64 {
    if squared > 0.0 {
        -10.0 * squared.log10()
    } else {
        f64::INFINITY
    }
}
