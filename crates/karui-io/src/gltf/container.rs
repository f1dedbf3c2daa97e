//! The binary container GLB (glTF 2.0, section 4).

use crate::{
    Warnings,
    error::{Error, ErrorKind, Place, Result},
};

pub(super) const MAGIC: &[u8; 4] = b"glTF";
pub(super) const JSON: u32 = 0x4e4f_534a;
pub(super) const BIN: u32 = 0x004e_4942;
pub(super) const HEADER: usize = 12;
pub(super) const CHUNK_HEADER: usize = 8;

/// The parts of a file.
pub(super) struct Container<'a> {
    /// The document.
    pub json: &'a [u8],
    /// The binary chunk of a GLB, if it has one.
    pub bin: Option<&'a [u8]>,
}

/// Takes a file apart; whatever is not GLB is taken for JSON.
pub(super) fn split<'a>(bytes: &'a [u8], warnings: &mut Warnings) -> Result<Container<'a>> {
    if !bytes.starts_with(MAGIC) {
        return Ok(Container {
            json: bytes,
            bin: None,
        });
    }
    let end = check_header(bytes, warnings)?;
    let mut rest = Chunks {
        bytes: &bytes[..end],
        offset: HEADER,
    };
    let Some((JSON, json)) = rest.next()? else {
        let kind = ErrorKind::syntax("a first chunk with JSON", "none");
        return Err(at_byte(HEADER, kind));
    };
    let bin = match rest.next()? {
        Some((BIN, bin)) => Some(bin),
        _ => None,
    };
    Ok(Container { json, bin })
}

fn at_byte(offset: usize, kind: ErrorKind) -> Error {
    Error::new(Place::Byte(offset as u64), kind)
}

fn word(bytes: &[u8], offset: usize) -> Result<u32> {
    let word = bytes
        .get(offset..offset + 4)
        .and_then(|w| w.try_into().ok());
    word.map(u32::from_le_bytes).ok_or_else(|| {
        let left = bytes.len().saturating_sub(offset);
        at_byte(offset, ErrorKind::truncated("4 bytes", left.to_string()))
    })
}

/// Checks version and length; returns where the content ends.
fn check_header(bytes: &[u8], warnings: &mut Warnings) -> Result<usize> {
    let version = word(bytes, 4)?;
    if version != 2 {
        let kind = ErrorKind::unsupported(format!("GLB version {version}"));
        return Err(at_byte(4, kind));
    }
    let length = word(bytes, 8)? as usize;
    if length > bytes.len() {
        let (expected, found) = (format!("{length} bytes"), bytes.len().to_string());
        return Err(at_byte(8, ErrorKind::truncated(expected, found)));
    }
    if length < HEADER + CHUNK_HEADER {
        let kind = ErrorKind::syntax("a length of at least 20 bytes", length.to_string());
        return Err(at_byte(8, kind));
    }
    if length < bytes.len() {
        warnings.push(format!(
            "{} bytes after the end of the GLB are ignored",
            bytes.len() - length
        ));
    }
    Ok(length)
}

struct Chunks<'a> {
    bytes: &'a [u8],
    offset: usize,
}

impl<'a> Chunks<'a> {
    /// Type and content of the next chunk; `None` at the end.
    fn next(&mut self) -> Result<Option<(u32, &'a [u8])>> {
        if self.offset >= self.bytes.len() {
            return Ok(None);
        }
        let length = word(self.bytes, self.offset)? as usize;
        let kind = word(self.bytes, self.offset + 4)?;
        let start = self.offset + CHUNK_HEADER;
        let left = self.bytes.len() - start;
        if length > left {
            let kind = ErrorKind::truncated(format!("a chunk of {length} bytes"), left.to_string());
            return Err(at_byte(self.offset, kind));
        }
        // Chunks start at multiples of 4 even if a careless writer left the
        // padding out of the length.
        self.offset = start + length.next_multiple_of(4);
        Ok(Some((kind, &self.bytes[start..start + length])))
    }
}

/// Puts a GLB together; `bin` may be empty.
///
/// # Errors
/// [`ErrorKind::TooLarge`] beyond 4 GiB, the most the format can hold.
pub(super) fn join(mut json: Vec<u8>, bin: &[u8]) -> Result<Vec<u8>> {
    json.resize(json.len().next_multiple_of(4), b' ');
    let bin_chunk = if bin.is_empty() {
        0
    } else {
        CHUNK_HEADER + bin.len().next_multiple_of(4)
    };
    let length = HEADER + CHUNK_HEADER + json.len() + bin_chunk;
    let Ok(total) = u32::try_from(length) else {
        return Err(Error::new(
            Place::File,
            ErrorKind::TooLarge {
                what: "size of the GLB in bytes",
                found: length as u64,
                limit: u64::from(u32::MAX),
            },
        ));
    };
    let mut glb = Vec::with_capacity(length);
    glb.extend(MAGIC);
    glb.extend([2, total].map(u32::to_le_bytes).as_flattened());
    push_chunk(&mut glb, JSON, &json);
    if !bin.is_empty() {
        push_chunk(&mut glb, BIN, bin);
    }
    Ok(glb)
}

fn push_chunk(glb: &mut Vec<u8>, kind: u32, content: &[u8]) {
    let padded = content.len().next_multiple_of(4);
    glb.extend([padded as u32, kind].map(u32::to_le_bytes).as_flattened());
    glb.extend(content);
    glb.resize(glb.len() + padded - content.len(), 0);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joined_is_split_again() {
        let glb = join(b"{}".to_vec(), &[1, 2, 3]).unwrap();
        assert_eq!(glb.len() % 4, 0);
        let mut warnings = Warnings::default();
        let parts = split(&glb, &mut warnings).unwrap();
        assert_eq!(parts.json, b"{}  ");
        assert_eq!(parts.bin, Some(&[1, 2, 3, 0][..]));
        let glb = join(b"{}".to_vec(), &[]).unwrap();
        assert_eq!(split(&glb, &mut warnings).unwrap().bin, None);
        assert!(warnings.into_messages().is_empty());
    }

    #[test]
    fn every_truncation_is_an_error() {
        let glb = join(b"{}".to_vec(), &[1, 2, 3]).unwrap();
        for end in 4..glb.len() {
            assert!(
                split(&glb[..end], &mut Warnings::default()).is_err(),
                "{end}"
            );
        }
    }
}
