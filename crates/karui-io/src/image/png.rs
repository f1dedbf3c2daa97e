//! PNG.

use super::{check_size, picture};
use crate::error::{Error, ErrorKind, Place, Result};
use ::png::{
    BitDepth, ColorType, Compression, Decoder, DecodingError, Encoder, EncodingError, Filter,
    Transformations,
};
use karui::render::Picture;
use std::io::{self, Cursor};

/// Deflate makes at most 1032 bytes of one, and a byte holds at most 8 pixels.
const DENSEST: u64 = 1032 * 8;

pub(super) fn decode(bytes: &[u8]) -> Result<Picture, ErrorKind> {
    let fail = |error| problem(bytes, error);
    let mut decoder = Decoder::new(Cursor::new(bytes));
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    decoder.set_transformations(Transformations::normalize_to_color8());
    let header = decoder.read_header_info().map_err(fail)?;
    check_size(bytes, header.width, header.height, DENSEST)?;
    let mut reader = decoder.read_info().map_err(fail)?;
    let size = reader.output_buffer_size().unwrap_or(usize::MAX);
    let mut data = Vec::new();
    if data.try_reserve_exact(size).is_err() {
        return Err(ErrorKind::unsupported(format!("an image of {size} bytes")));
    }
    data.resize(size, 0);
    let frame = reader.next_frame(&mut data).map_err(fail)?;
    let channels = frame.color_type.samples();
    picture(
        frame.width,
        frame.height,
        channels,
        &data[..frame.buffer_size()],
    )
}

fn problem(bytes: &[u8], error: DecodingError) -> ErrorKind {
    match error {
        DecodingError::IoError(e) if e.kind() == io::ErrorKind::UnexpectedEof => {
            ErrorKind::truncated("the rest of the PNG", format!("{} bytes", bytes.len()))
        }
        other => ErrorKind::syntax("a PNG", other.to_string()),
    }
}

/// A picture as a PNG: without alpha if all of it is opaque. The same picture
/// gives the same bytes.
///
/// # Errors
/// [`ErrorKind::Unsupported`] for a picture without pixels.
pub fn encode_png(picture: &Picture) -> Result<Vec<u8>> {
    let opaque = picture.pixels().iter().all(|p| p[3] == 255);
    let (color, channels) = match opaque {
        true => (ColorType::Rgb, 3),
        false => (ColorType::Rgba, 4),
    };
    let kept = picture.pixels().iter().flat_map(|p| &p[..channels]);
    let data: Vec<u8> = kept.copied().collect();
    encode(picture, color, &data).map_err(|e| {
        Error::new(
            Place::File,
            ErrorKind::unsupported(format!("this picture ({e})")),
        )
    })
}

fn encode(picture: &Picture, color: ColorType, data: &[u8]) -> Result<Vec<u8>, EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, picture.width(), picture.height());
    encoder.set_color(color);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::Balanced);
    encoder.set_filter(Filter::Adaptive);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(data)?;
    writer.finish()?;
    Ok(bytes)
}
