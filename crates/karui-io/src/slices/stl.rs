//! Binary STL in slices: every corner of a facet is a vertex of its own.

use super::{failed, file::FileAt};
use crate::{
    Place,
    error::{Error, ErrorKind, Result},
    stl::{
        binary::{FACET, HEADER},
        looks_like_text,
    },
    warnings::Warnings,
};
use karui::{
    geom::Vec3,
    mesh::Attributes,
    outofcore::{self, Source, Vertices},
};
use std::ops::Range;

/// Facets of a portion.
const FACETS: u64 = 65_536;

/// A binary STL file. Corner c of facet f is vertex 3 f + c.
#[derive(Debug)]
pub(super) struct Stl {
    file: FileAt,
    facets: u64,
}

/// Whether the length is exactly what the count of a binary file asks for.
pub(super) fn is_binary(head: &[u8], len: u64) -> bool {
    count(head).is_some_and(|count| len == HEADER as u64 + FACET as u64 * count)
}

fn count(head: &[u8]) -> Option<u64> {
    let count = head.get(HEADER - 4..HEADER)?.first_chunk()?;
    Some(u32::from_le_bytes(*count).into())
}

/// Checks the count as [`crate::read`] does.
pub(super) fn open(file: FileAt, head: &[u8], warnings: &mut Warnings) -> Result<Stl> {
    if !is_binary(head, file.len) && looks_like_text(head) {
        let feature = "text STL in slices (`karui convert` writes it as binary PLY)";
        return Err(Error::new(Place::File, ErrorKind::unsupported(feature)));
    }
    let Some(count) = count(head) else {
        let found = format!("{} bytes", file.len);
        let kind = ErrorKind::truncated("an STL header of 84 bytes", found);
        return Err(Error::new(Place::Byte(0), kind));
    };
    let body = file.len - HEADER as u64;
    let facets = body / FACET as u64;
    let [expected, found] = [format!("{count} facets"), facets.to_string()];
    let fail = |kind| Err(Error::new(Place::Byte(HEADER as u64 - 4), kind));
    if facets < count {
        return fail(ErrorKind::truncated(expected, found));
    }
    if facets > count {
        return fail(ErrorKind::syntax(expected, found));
    }
    let trailing = body % FACET as u64;
    if trailing > 0 {
        warnings.push(format!(
            "{trailing} bytes after the last facet were passed over"
        ));
    }
    if facets == 0 {
        warnings.push("the file holds no triangles");
    }
    Ok(Stl { file, facets })
}

impl Stl {
    fn corners(&self, ids: Range<u64>) -> Result<Vec<Vec3>> {
        let end = ids.end.min(self.vertices());
        let start = ids.start.min(end);
        let facets = start / 3..end.div_ceil(3);
        let at = HEADER as u64 + FACET as u64 * facets.start;
        let bytes = self
            .file
            .read(at, FACET as u64 * (facets.end - facets.start))?;
        let mut corners = Vec::with_capacity(3 * (facets.end - facets.start) as usize);
        for (f, facet) in bytes.as_chunks::<FACET>().0.iter().enumerate() {
            let numbers = facet.as_chunks::<4>().0;
            for k in 1..4 {
                let number = |i: usize| f32::from_le_bytes(numbers[3 * k + i]);
                // Adding zero makes -0 to 0, which are one place.
                let corner = Vec3::new(number(0), number(1), number(2)) + Vec3::ZERO;
                if !corner.is_finite() {
                    let what = "vertex coordinate";
                    let byte = at + (FACET * f + 12 * k) as u64;
                    return Err(Error::new(Place::Byte(byte), ErrorKind::NotFinite { what }));
                }
                corners.push(corner);
            }
        }
        corners.truncate((end - 3 * facets.start) as usize);
        Ok(corners.split_off((start - 3 * facets.start) as usize))
    }
}

impl Source for Stl {
    fn vertices(&self) -> u64 {
        3 * self.facets
    }

    fn chunks(&self) -> u64 {
        self.facets.div_ceil(FACETS)
    }

    fn read_vertices(&self, ids: Range<u64>) -> outofcore::Result<Vertices> {
        let positions = self.corners(ids).map_err(|e| failed(e, &self.file))?;
        let attributes = Attributes::default();
        Ok(Vertices {
            positions,
            attributes,
        })
    }

    fn read_triangles(&self, chunk: u64) -> outofcore::Result<Vec<[u64; 3]>> {
        let first = chunk.saturating_mul(FACETS).min(self.facets);
        let facets = first..(first + FACETS).min(self.facets);
        Ok(facets.map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect())
    }
}
