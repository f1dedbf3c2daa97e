//! Two pictures of one size, without alpha.

use crate::error::{Error, Result};
use crate::render::Picture;

/// Two pictures to be compared, sRGB codes.
pub(super) struct Pair {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) a: Vec<[u8; 3]>,
    pub(super) b: Vec<[u8; 3]>,
}

impl Pair {
    /// Both laid over `background`.
    pub(super) fn new(a: &Picture, b: &Picture, background: [u8; 3]) -> Result<Self> {
        let (first, second) = (size(a), size(b));
        if first != second {
            return Err(Error::SizeMismatch { first, second });
        }
        if a.pixels().is_empty() {
            return Err(Error::Empty { what: "picture" });
        }
        Ok(Self {
            width: a.width() as usize,
            height: a.height() as usize,
            a: flat(a, background),
            b: flat(b, background),
        })
    }
}

fn size(picture: &Picture) -> [u32; 2] {
    [picture.width(), picture.height()]
}

fn flat(picture: &Picture, background: [u8; 3]) -> Vec<[u8; 3]> {
    let over = |&[r, g, b, alpha]: &[u8; 4]| {
        let color = [r, g, b];
        std::array::from_fn(|c| mix(color[c], background[c], alpha))
    };
    picture.pixels().iter().map(over).collect()
}

/// Codes are mixed as browsers and image viewers do, and rounded.
fn mix(front: u8, back: u8, alpha: u8) -> u8 {
    let [front, back, alpha] = [front, back, alpha].map(u32::from);
    ((front * alpha + back * (255 - alpha) + 127) / 255) as u8
}
