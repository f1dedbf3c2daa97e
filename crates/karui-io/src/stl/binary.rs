//! Binary STL: 80 bytes of anything, a count, 50 bytes a facet.

use super::Soup;
use crate::{
    Warnings,
    error::{Error, ErrorKind, Place, Result},
};
use karui::geom::Vec3;

/// Bytes before the first facet.
pub(crate) const HEADER: usize = 84;
/// Bytes a facet: normal, three corners, two attribute bytes.
pub(crate) const FACET: usize = 50;

/// Reads the facets. The count must agree with the size of the file: fewer
/// facets than it says mean a truncated file, more mean a damaged header. Less
/// than one facet of trailing bytes is passed over with a warning.
pub(super) fn read(bytes: &[u8], warnings: &mut Warnings) -> Result<Soup> {
    let facets = facets(bytes, warnings)?;
    let mut soup = Soup::default();
    soup.corners.reserve_exact(3 * facets.len());
    soup.attributes.reserve_exact(facets.len());
    for (f, facet) in facets.iter().enumerate() {
        let (numbers, _) = facet.as_chunks::<4>();
        for k in 1..4 {
            let number = |i| f32::from_le_bytes(numbers[3 * k + i]);
            let corner = Vec3::new(number(0), number(1), number(2));
            if !corner.is_finite() {
                return Err(not_finite(f, k));
            }
            soup.corners.push(corner);
        }
        soup.attributes
            .push(u16::from_le_bytes([facet[48], facet[49]]));
    }
    Ok(soup)
}

fn facets<'a>(bytes: &'a [u8], warnings: &mut Warnings) -> Result<&'a [[u8; FACET]]> {
    let Some((header, body)) = bytes.split_at_checked(HEADER) else {
        let found = format!("{} bytes", bytes.len());
        let kind = ErrorKind::truncated("an STL header of 84 bytes", found);
        return Err(Error::new(Place::Byte(0), kind));
    };
    let count = u32::from_le_bytes([header[80], header[81], header[82], header[83]]);
    let (facets, trailing) = body.as_chunks::<FACET>();
    let expected = format!("{count} facets");
    let found = format!("{}", facets.len());
    let fail = |kind| Err(Error::new(Place::Byte(80), kind));
    if facets.len() < count as usize {
        return fail(ErrorKind::truncated(expected, found));
    }
    if facets.len() > count as usize {
        return fail(ErrorKind::syntax(expected, found));
    }
    if !trailing.is_empty() {
        let n = trailing.len();
        warnings.push(format!("{n} bytes after the last facet were passed over"));
    }
    Ok(facets)
}

fn not_finite(facet: usize, vector: usize) -> Error {
    let what = "vertex coordinate";
    let byte = HEADER + FACET * facet + 12 * vector;
    Error::new(Place::Byte(byte as u64), ErrorKind::NotFinite { what })
}
