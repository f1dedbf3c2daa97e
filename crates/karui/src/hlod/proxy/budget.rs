//! How fine a texture may be.

use super::group::Group;
use super::merged::MergedOptions;
use crate::error::{Error, Result};

/// Longest side of a texture, texels.
pub(super) const LONGEST: u32 = 4096;

/// How fine a texture is to be, and how large it may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Budget {
    /// Side of a texel, model units.
    pub texel: f64,
    /// Longest side of the texture, texels.
    pub side: u32,
    /// Pixels that images may have to be kept as they are.
    pub kept: usize,
    /// Whether that is coarser than was asked for.
    pub coarser: bool,
}

impl Budget {
    pub fn new(group: &Group<'_>, options: &MergedOptions<'_>) -> Result<Self> {
        check(options.pixels, options.side)?;
        let pixels = options.pixels.min(LONGEST);
        Ok(Self {
            texel: group.bounds().diagonal() / f64::from(pixels),
            side: options.side,
            kept: (pixels as usize).pow(2),
            coarser: pixels < options.pixels,
        })
    }
}

/// Whether a texture may be asked for in this way.
pub(super) fn check(pixels: u32, side: u32) -> Result<()> {
    let wrong = |option, found: u32, expected| Error::BadOption {
        option,
        found: found.to_string(),
        expected,
    };
    if pixels == 0 {
        return Err(wrong("pixels", pixels, "1 or more"));
    }
    if !(32..=LONGEST).contains(&side) {
        return Err(wrong("side", side, "32 to 4096 texels"));
    }
    Ok(())
}
