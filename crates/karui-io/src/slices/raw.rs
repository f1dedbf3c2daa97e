//! Positions and indices as they lie in memory.
//!
//! All numbers are little endian:
//!
//! | byte | |
//! |-|-|
//! | 0 | `KARUITM1` |
//! | 8 | vertices, u64 |
//! | 16 | triangles, u64 |
//! | 24 | bytes of an index, u32: 4 or 8 |
//! | 28 | 0, u32 |
//! | 32 | x, y, z of each vertex, f32 |
//! | 32 + 12 x vertices, rounded up to a multiple of 8 | three indices of each triangle, u32 or u64 |
//!
//! Nothing follows the last index.

use super::{failed, file::FileAt};
use crate::{
    Place,
    error::{Error, ErrorKind, Result},
};
use karui::{
    geom::Vec3,
    mesh::Attributes,
    outofcore::{self, Source, Vertices},
};
use std::ops::Range;

pub(super) const MAGIC: &[u8; 8] = b"KARUITM1";
/// Bytes before the first vertex.
const HEADER: u64 = 32;
/// Bytes of a vertex.
const VERTEX: u64 = 12;
/// Triangles of a portion.
const TRIANGLES: u64 = 65_536;

/// A raw file.
#[derive(Debug)]
pub(super) struct Raw {
    file: FileAt,
    vertices: u64,
    triangles: u64,
    /// Bytes of an index.
    width: u64,
    /// Where the indices start.
    indices: u64,
}

/// Checks the counts against the length of the file.
pub(super) fn open(file: FileAt) -> Result<Raw> {
    let header = file.read(0, HEADER)?;
    let words = header.as_chunks::<8>().0;
    let [vertices, triangles, last] = [1, 2, 3].map(|i| u64::from_le_bytes(words[i]));
    let width = last & u64::from(u32::MAX);
    if last != width || !matches!(width, 4 | 8) {
        let kind = ErrorKind::syntax("4 or 8 bytes an index, then 0", last.to_string());
        return Err(Error::new(Place::Byte(24), kind));
    }
    let indices = vertices
        .checked_mul(VERTEX)
        .and_then(|bytes| bytes.checked_add(HEADER)?.checked_next_multiple_of(8));
    let end = indices.and_then(|at| triangles.checked_mul(3 * width)?.checked_add(at));
    let (Some(indices), true) = (indices, end == Some(file.len)) else {
        let expected = end.map_or("more bytes than can be counted".into(), |e| {
            format!("{e} bytes")
        });
        let counts = format!("{expected} for {vertices} vertices and {triangles} triangles");
        let found = file.len.to_string();
        let kind = if end.is_none_or(|end| end > file.len) {
            ErrorKind::truncated(counts, found)
        } else {
            ErrorKind::syntax(counts, found)
        };
        return Err(Error::new(Place::Byte(8), kind));
    };
    Ok(Raw {
        file,
        vertices,
        triangles,
        width,
        indices,
    })
}

impl Raw {
    fn positions(&self, ids: Range<u64>) -> Result<Vec<Vec3>> {
        let end = ids.end.min(self.vertices);
        let start = ids.start.min(end);
        let at = HEADER + VERTEX * start;
        let bytes = self.file.read(at, VERTEX * (end - start))?;
        let numbers = bytes.as_chunks::<4>().0;
        let numbers: Vec<f32> = numbers.iter().map(|&n| f32::from_le_bytes(n)).collect();
        if let Some(i) = numbers.iter().position(|n| !n.is_finite()) {
            let what = "vertex coordinate";
            let place = Place::Byte(at + 4 * i as u64);
            return Err(Error::new(place, ErrorKind::NotFinite { what }));
        }
        let triples = numbers.as_chunks::<3>().0;
        Ok(triples.iter().copied().map(Vec3::from).collect())
    }

    fn triangles(&self, portion: u64) -> Result<Vec<[u64; 3]>> {
        let first = portion.saturating_mul(TRIANGLES).min(self.triangles);
        let count = TRIANGLES.min(self.triangles - first);
        let at = self.indices + 3 * self.width * first;
        let bytes = self.file.read(at, 3 * self.width * count)?;
        let indices: Vec<u64> = if self.width == 4 {
            let words = bytes.as_chunks::<4>().0;
            words
                .iter()
                .map(|&w| u32::from_le_bytes(w).into())
                .collect()
        } else {
            let words = bytes.as_chunks::<8>().0;
            words.iter().map(|&w| u64::from_le_bytes(w)).collect()
        };
        if let Some(i) = indices.iter().position(|&v| v >= self.vertices) {
            let kind = ErrorKind::IndexOutOfRange {
                what: "vertex",
                index: i64::try_from(indices[i]).unwrap_or(i64::MAX),
                count: self.vertices as usize,
            };
            return Err(Error::new(Place::Byte(at + self.width * i as u64), kind));
        }
        Ok(indices.as_chunks::<3>().0.to_vec())
    }
}

impl Source for Raw {
    fn vertices(&self) -> u64 {
        self.vertices
    }

    fn chunks(&self) -> u64 {
        self.triangles.div_ceil(TRIANGLES)
    }

    fn read_vertices(&self, ids: Range<u64>) -> outofcore::Result<Vertices> {
        let positions = self.positions(ids).map_err(|e| failed(e, &self.file))?;
        let attributes = Attributes::default();
        Ok(Vertices {
            positions,
            attributes,
        })
    }

    fn read_triangles(&self, chunk: u64) -> outofcore::Result<Vec<[u64; 3]>> {
        self.triangles(chunk).map_err(|e| failed(e, &self.file))
    }
}
