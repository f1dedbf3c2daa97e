//! Pictures as files: PNG and JPEG are read, PNG is written.
//!
//! A header is believed only as far as the bytes behind it can bear it out:
//! neither format packs a pixel into less than a certain part of a byte.

mod height_rows;
mod jpeg;
mod pixels;
mod png;
#[cfg(test)]
mod tests;

pub use height_rows::HeightRows;
pub(crate) use pixels::encoded;
pub use pixels::{picture_of, pictures_of};
pub use png::encode_png;

use crate::error::{Error, ErrorKind, IMAGE_SIDE, Place, Result};
use karui::render::{MAX_SIDE, Picture};

/// Decodes a PNG or JPEG, told apart by their first bytes. Palettes, grey and 16
/// bits a channel become 8 bits of sRGB with straight alpha; colour profiles and
/// gamma are left out of account, as glTF wants it.
///
/// # Errors
/// [`ErrorKind::UnknownFormat`] for other formats, [`ErrorKind::TooLarge`] for more
/// than 16,384 pixels a side, [`ErrorKind::Truncated`], [`ErrorKind::Syntax`] and
/// [`ErrorKind::Unsupported`].
pub fn decode_image(bytes: &[u8]) -> Result<Picture> {
    let decoded = match bytes {
        [0x89, b'P', b'N', b'G', ..] => png::decode(bytes),
        [0xff, 0xd8, 0xff, ..] => jpeg::decode(bytes),
        _ => Err(ErrorKind::UnknownFormat {
            extension: None,
            known: "PNG and JPEG",
        }),
    };
    decoded.map_err(|kind| Error::new(Place::File, kind))
}

/// Refuses what is too large, and what cannot be all there: a byte holds at most
/// `densest` pixels.
fn check_size(bytes: &[u8], width: u32, height: u32, densest: u64) -> Result<(), ErrorKind> {
    let side = width.max(height);
    if side > MAX_SIDE {
        return Err(ErrorKind::TooLarge {
            what: IMAGE_SIDE,
            found: side.into(),
            limit: MAX_SIDE.into(),
        });
    }
    let least = u64::from(width) * u64::from(height) / densest;
    if bytes.len() as u64 >= least {
        return Ok(());
    }
    Err(ErrorKind::truncated(
        format!("{least} bytes or more for {width} x {height} pixels"),
        format!("{} bytes", bytes.len()),
    ))
}

/// A picture of decoded pixels with `channels` bytes each: grey, grey and alpha,
/// RGB or RGBA.
fn picture(width: u32, height: u32, channels: usize, data: &[u8]) -> Result<Picture, ErrorKind> {
    let rgba = |pixel: &[u8]| match *pixel {
        [grey] => [grey, grey, grey, 255],
        [grey, alpha] => [grey, grey, grey, alpha],
        [r, g, b] => [r, g, b, 255],
        [r, g, b, a] => [r, g, b, a],
        _ => [0; 4],
    };
    let pixels = data.chunks_exact(channels).map(rgba).collect();
    Ok(Picture::new(width, height, pixels)?)
}
