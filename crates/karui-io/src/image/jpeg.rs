//! JPEG.

use super::{check_size, picture};
use crate::error::ErrorKind;
use karui::render::Picture;
use zune_jpeg::JpegDecoder;
use zune_jpeg::errors::DecodeErrors;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

/// A block of 8 x 8 pixels takes a bit or more.
const DENSEST: u64 = 64 * 8;

/// The marker at the end.
const END: [u8; 2] = [0xff, 0xd9];

pub(super) fn decode(bytes: &[u8]) -> Result<Picture, ErrorKind> {
    let fail = |error| problem(bytes, error);
    // Sides are checked below, where the numbers are told. Strict, since what is
    // cut off would be grey otherwise.
    let options = DecoderOptions::default()
        .set_max_width(usize::from(u16::MAX))
        .set_max_height(usize::from(u16::MAX))
        .set_strict_mode(true)
        .jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(fail)?;
    let (width, height) = decoder.info().map_or((0, 0), |i| (i.width, i.height));
    check_size(bytes, width.into(), height.into(), DENSEST)?;
    if memchr::memmem::rfind(bytes, &END).is_none() {
        return Err(cut_off(bytes));
    }
    let data = decoder.decode().map_err(fail)?;
    picture(width.into(), height.into(), 3, &data)
}

fn problem(bytes: &[u8], error: DecodeErrors) -> ErrorKind {
    match error {
        DecodeErrors::ExhaustedData | DecodeErrors::IoErrors(_) => cut_off(bytes),
        other => ErrorKind::syntax("a JPEG", other.to_string()),
    }
}

fn cut_off(bytes: &[u8]) -> ErrorKind {
    ErrorKind::truncated("the rest of the JPEG", format!("{} bytes", bytes.len()))
}
