//! Stanford PLY: text, little and big endian.
//!
//! Turk, The PLY Polygon File Format, 1994. Custom names are understood:
//! `nx ny nz`, `red green blue alpha` (also `r g b a` and `diffuse_red` ...),
//! `s t` (also `u v`, `texture_u texture_v`), `tx ty tz tw`. Every other
//! property is kept by name and type as a custom attribute; `name_0 name_1 ...`
//! become one attribute of several components, and so do lists of one length.
//! The second set of texture coordinates and colours has the suffix 1.

pub(crate) mod columns;
pub(crate) mod faces;
pub(crate) mod header;
mod read;
pub(crate) mod vertices;
pub(crate) mod write;

#[cfg(test)]
mod tests;

pub use write::PlyEncoding;

pub(crate) use read::read;
pub(crate) use vertices::SETS;
pub(crate) use write::write;
