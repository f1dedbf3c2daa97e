//! How different two pictures look: RMSE, PSNR, SSIM and FLIP.
//!
//! Pictures are laid over an opaque background first (black, unless
//! [`ImageOptions`] says otherwise): sRGB codes are mixed by alpha and rounded to
//! 8 bits. What a fully transparent pixel has as colour does not matter. All
//! figures have the same bits for any number of threads.

mod flat;
mod flip;
mod rmse;
mod ssim;
mod views;

pub use flip::{Flip, PIXELS_PER_DEGREE, flip};
pub use rmse::{psnr, rmse};
pub use ssim::ssim;
pub use views::ViewDifferences;

use crate::error::Result;
use crate::render::Picture;
use flat::Pair;

/// What [`compare`] assumes about who looks at the pictures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImageOptions {
    /// sRGB codes of what both pictures are laid over. Default: black.
    pub background: [u8; 3],
    /// Pixels per degree of visual angle, for FLIP; 1 to 10,000. Default:
    /// [`PIXELS_PER_DEGREE`].
    pub pixels_per_degree: f64,
}

impl Default for ImageOptions {
    fn default() -> Self {
        Self {
            background: [0; 3],
            pixels_per_degree: PIXELS_PER_DEGREE,
        }
    }
}

/// How different two pictures are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImageDifference {
    /// See [`rmse()`]: 0 (equal) to 1.
    pub rmse: f64,
    /// See [`psnr`]: dB, infinite for equal pictures.
    pub psnr: f64,
    /// See [`ssim()`]: 1 (equal) down to -1.
    pub ssim: f64,
    /// Mean of [`flip()`]: 0 (no difference seen) to 1.
    pub flip: f64,
}

/// All figures at once. All are symmetric in `a` and `b`.
///
/// ```
/// use karui::metrics::image::{ImageOptions, compare};
/// use karui::render::Picture;
///
/// let dark = Picture::filled(16, 16, [0, 0, 0, 255]);
/// let light = Picture::filled(16, 16, [51, 51, 51, 255]);
/// let difference = compare(&dark, &light, &ImageOptions::default())?;
/// assert!((difference.rmse - 0.2).abs() < 1e-12);
/// assert!(difference.flip > 0.1);
/// # Ok::<(), karui::Error>(())
/// ```
///
/// # Errors
/// As [`flip()`].
pub fn compare(a: &Picture, b: &Picture, options: &ImageOptions) -> Result<ImageDifference> {
    let pair = Pair::new(a, b, options.background)?;
    let squared = rmse::squared(&pair);
    Ok(ImageDifference {
        rmse: squared.sqrt(),
        psnr: rmse::decibels(squared),
        ssim: ssim::similarity(&pair),
        flip: flip::of_pair(&pair, options.pixels_per_degree)?.mean,
    })
}
