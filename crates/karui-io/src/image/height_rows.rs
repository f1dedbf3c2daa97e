//! Heights from a grey PNG, row after row.

use crate::error::{Error, ErrorKind, Place, Result};
use ::png::{BitDepth, ColorType, Decoder, DecodingError, Reader};
use std::{
    fs::File,
    io::{self, BufReader},
    path::{Path, PathBuf},
};

/// A grey PNG of 8 or 16 bits that is read one row at a time: a picture of any height
/// takes the memory of a row.
pub struct HeightRows {
    reader: Reader<BufReader<File>>,
    path: PathBuf,
    depth: BitDepth,
}

impl HeightRows {
    /// Opens it and reads its size.
    ///
    /// # Errors
    /// [`ErrorKind::Io`], [`ErrorKind::Syntax`] for what is no PNG, and
    /// [`ErrorKind::Unsupported`] for colours, other depths or an interlaced one.
    pub fn open(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let file = File::open(path).map_err(|e| Error::file(path, ErrorKind::Io(e)))?;
        let mut decoder = Decoder::new(BufReader::new(file));
        decoder.set_ignore_text_chunk(true);
        let reader = decoder.read_info().map_err(|e| problem(path, e))?;
        let info = reader.info();
        let depth = info.bit_depth;
        let is_grey = info.color_type == ColorType::Grayscale;
        if !is_grey || !matches!(depth, BitDepth::Eight | BitDepth::Sixteen) || info.interlaced {
            let feature = "a height map that is not a plain grey PNG of 8 or 16 bits";
            return Err(Error::file(path, ErrorKind::unsupported(feature)));
        }
        Ok(Self {
            depth,
            path: path.to_path_buf(),
            reader,
        })
    }

    /// Columns and rows.
    #[must_use]
    pub fn size(&self) -> [u32; 2] {
        let info = self.reader.info();
        [info.width, info.height]
    }

    /// The next row from the top, `None` after the last.
    ///
    /// # Errors
    /// [`ErrorKind::Truncated`] or [`ErrorKind::Syntax`] if the file is damaged.
    pub fn next_row(&mut self) -> Result<Option<Vec<u16>>> {
        let row = self.reader.next_row().map_err(|e| problem(&self.path, e))?;
        Ok(row.map(|row| match self.depth {
            BitDepth::Sixteen => {
                let pairs = row.data().as_chunks::<2>().0;
                pairs.iter().map(|&pair| u16::from_be_bytes(pair)).collect()
            }
            _ => row.data().iter().copied().map(u16::from).collect(),
        }))
    }
}

fn problem(path: &Path, error: DecodingError) -> Error {
    let kind = match error {
        DecodingError::IoError(e) if e.kind() == io::ErrorKind::UnexpectedEof => {
            ErrorKind::truncated("the rest of the PNG", "the end of the file")
        }
        DecodingError::IoError(e) => ErrorKind::Io(e),
        other => ErrorKind::syntax("a PNG", other.to_string()),
    };
    Error::new(Place::File, kind).in_file(path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn png(color: ColorType, depth: BitDepth, data: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = ::png::Encoder::new(&mut bytes, 2, 2);
        encoder.set_color(color);
        encoder.set_depth(depth);
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(data).unwrap();
        writer.finish().unwrap();
        bytes
    }

    fn rows(bytes: &[u8]) -> Result<Vec<Vec<u16>>> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        fs::write(&path, bytes).unwrap();
        let mut reader = HeightRows::open(&path)?;
        assert_eq!(reader.size(), [2, 2]);
        let mut rows = Vec::new();
        while let Some(row) = reader.next_row()? {
            rows.push(row);
        }
        Ok(rows)
    }

    #[test]
    fn rows_of_both_depths() {
        let wide = png(
            ColorType::Grayscale,
            BitDepth::Sixteen,
            &[0, 1, 1, 0, 255, 255, 0, 0],
        );
        assert_eq!(rows(&wide).unwrap(), [[1, 256], [65535, 0]]);
        let narrow = png(ColorType::Grayscale, BitDepth::Eight, &[1, 2, 3, 255]);
        assert_eq!(rows(&narrow).unwrap(), [[1, 2], [3, 255]]);
        for end in 0..wide.len() - 20 {
            assert!(rows(&wide[..end]).is_err(), "{end}");
        }
    }

    #[test]
    fn colours_are_refused() {
        let error = rows(&png(ColorType::Rgb, BitDepth::Eight, &[0; 12])).unwrap_err();
        assert!(error.to_string().contains("not a plain grey PNG"));
        assert!(rows(b"P5 2 2 255").is_err());
    }
}
