//! A mesh that is read in slices, never as a whole.

use super::{Error, Result};
use crate::mesh::{Attributes, TriMesh};
use glam::Vec3;
use std::ops::Range;

/// A mesh that is read in slices, from several threads at once.
///
/// What a call answers is defined by the input alone: the same slice twice is the same.
pub trait Source: Sync {
    /// Vertices of the whole model.
    fn vertices(&self) -> u64;

    /// Portions the faces come in; defined by the input, of some 65,536 triangles each.
    fn chunks(&self) -> u64;

    /// Vertices of a range of ids, which ends within [`Source::vertices`].
    ///
    /// # Errors
    /// [`Error::Source`] if the input is damaged there.
    fn read_vertices(&self, ids: Range<u64>) -> Result<Vertices>;

    /// Triangles of one portion; larger faces come as triangles. Indices are checked.
    ///
    /// # Errors
    /// [`Error::Source`] if the input is damaged there, [`Error::IndexOutOfRange`].
    fn read_triangles(&self, chunk: u64) -> Result<Vec<[u64; 3]>>;
}

/// Some of a model's vertices.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Vertices {
    /// One position a vertex, in the model's unit.
    pub positions: Vec<Vec3>,
    /// What else is known of each vertex; the same kinds for every slice of a source.
    pub attributes: Attributes,
}

/// A mesh in memory as a source.
#[derive(Debug, Clone, Copy)]
pub struct Memory<'a>(pub &'a TriMesh);

/// Triangles of one portion of a mesh in memory.
const PORTION: usize = 65_536;

impl Source for Memory<'_> {
    fn vertices(&self) -> u64 {
        self.0.positions.len() as u64
    }

    fn chunks(&self) -> u64 {
        self.0.triangles.len().div_ceil(PORTION) as u64
    }

    fn read_vertices(&self, ids: Range<u64>) -> Result<Vertices> {
        let sources: Vec<u32> = (ids.start as u32..ids.end as u32).collect();
        let mut attributes = self.0.attributes.clone();
        attributes.gather(&sources);
        let positions = self.0.positions[ids.start as usize..ids.end as usize].to_vec();
        Ok(Vertices {
            positions,
            attributes,
        })
    }

    fn read_triangles(&self, chunk: u64) -> Result<Vec<[u64; 3]>> {
        let vertices = self.vertices();
        let start = (chunk as usize)
            .saturating_mul(PORTION)
            .min(self.0.triangles.len());
        let end = (start + PORTION).min(self.0.triangles.len());
        let indexed = (start as u64..).zip(&self.0.triangles[start..end]);
        indexed
            .map(|(number, triangle)| checked(number, triangle.map(u64::from), vertices))
            .collect()
    }
}

/// A triangle whose vertices exist.
///
/// # Errors
/// [`Error::IndexOutOfRange`]
fn checked(triangle: u64, corners: [u64; 3], vertices: u64) -> Result<[u64; 3]> {
    match corners.into_iter().find(|&c| c >= vertices) {
        Some(index) => Err(Error::IndexOutOfRange {
            triangle,
            index,
            vertices,
        }),
        None => Ok(corners),
    }
}
