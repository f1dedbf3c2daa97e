//! The codecs of `EXT_meshopt_compression` and `KHR_meshopt_compression`.
//!
//! Written from the bitstream description in those extensions. Decoders
//! check every read and grow their output with the data that is there.

mod filter;
mod index;
mod vertex;

pub(super) use index::{encode_sequence, encode_triangles};
pub(super) use vertex::encode as encode_vertices;

use super::{
    budget::Budget,
    json::{self, At},
};
use crate::error::{ErrorKind, Result};
use serde_json::Value;

/// Decodes the buffer view that the extension object `compressed` describes.
pub(super) fn decode_view(
    compressed: &Value,
    bytes: &[u8],
    budget: &Budget,
    at: &At<'_>,
) -> Result<Vec<u8>> {
    let stride = json::required(compressed, "byteStride", at)?;
    let count = json::required(compressed, "count", at)?;
    let mode = json::text(compressed, "mode").unwrap_or("none");
    let filter = json::text(compressed, "filter").unwrap_or("NONE");
    check_shape(mode, stride, count, at)?;
    budget.take(count, stride, at)?;
    let decoded = match mode {
        "ATTRIBUTES" => vertex::decode(bytes, count, stride),
        "TRIANGLES" => index::decode_triangles(bytes, count).map(|i| narrow(&i, stride)),
        _ => index::decode_sequence(bytes, count).map(|i| narrow(&i, stride)),
    };
    let mut decoded = decoded.map_err(|kind| at.fail(kind))?;
    if mode == "ATTRIBUTES" && !filter::apply(filter, stride, &mut decoded) {
        let expected = format!("a filter for a byteStride of {stride}");
        return Err(at.syntax(expected, filter));
    }
    Ok(decoded)
}

fn check_shape(mode: &str, stride: usize, count: usize, at: &At<'_>) -> Result<()> {
    let (fits, expected) = match mode {
        "ATTRIBUTES" => (
            stride.is_multiple_of(4) && (4..=256).contains(&stride),
            "a byteStride that is a multiple of 4 up to 256",
        ),
        "TRIANGLES" => (
            matches!(stride, 2 | 4) && count.is_multiple_of(3),
            "a byteStride of 2 or 4 and whole triangles",
        ),
        "INDICES" => (matches!(stride, 2 | 4), "a byteStride of 2 or 4"),
        other => {
            let mode = format!("meshopt mode {other}");
            return Err(at.fail(ErrorKind::unsupported(mode)));
        }
    };
    if fits {
        return Ok(());
    }
    Err(at.syntax(expected, format!("{stride} and {count} elements")))
}

/// Indices in `size` bytes each.
fn narrow(indices: &[u32], size: usize) -> Vec<u8> {
    let bytes = indices.iter().map(|i| i.to_le_bytes());
    bytes.flat_map(|b| b.into_iter().take(size)).collect()
}

/// Reads bytes and never beyond the end.
struct Bytes<'a> {
    rest: &'a [u8],
}

impl<'a> Bytes<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], ErrorKind> {
        let Some((head, tail)) = self.rest.split_at_checked(count) else {
            return Err(ErrorKind::truncated(
                format!("{count} bytes of compressed data"),
                self.rest.len().to_string(),
            ));
        };
        self.rest = tail;
        Ok(head)
    }

    fn byte(&mut self) -> Result<u8, ErrorKind> {
        Ok(self.take(1)?[0])
    }

    /// A number in groups of seven bits, lowest first.
    fn varint(&mut self) -> Result<u32, ErrorKind> {
        let mut number = 0;
        for shift in (0..35).step_by(7) {
            let group = self.byte()?;
            number |= u32::from(group & 127) << shift;
            if group < 128 {
                break;
            }
        }
        Ok(number)
    }
}

fn push_varint(bytes: &mut Vec<u8>, mut number: u32) {
    while number > 127 {
        bytes.push(number as u8 | 128);
        number >>= 7;
    }
    bytes.push(number as u8);
}

/// The header byte: a mark in the high four bits, the version in the low ones.
fn version(bytes: &mut Bytes<'_>, mark: u8, newest: u8) -> Result<u8, ErrorKind> {
    let header = bytes.byte()?;
    if header & 0xf0 != mark {
        return Err(ErrorKind::syntax(
            format!("a header of {mark:#04x}"),
            format!("{header:#04x}"),
        ));
    }
    match header & 0x0f {
        version if version <= newest => Ok(version),
        other => Err(ErrorKind::unsupported(format!(
            "meshopt codec version {other}"
        ))),
    }
}
