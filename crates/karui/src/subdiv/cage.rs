//! The control mesh: faces of any size, and what is sharp.

use crate::error::{Error, Result};
use crate::mesh::PolyMesh;

/// Sharpness from which on an edge or vertex stays sharp for ever.
pub const INFINITELY_SHARP: f32 = 10.0;

/// An edge that is sharp for some levels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crease {
    /// The ends, in any order.
    pub vertices: [u32; 2],
    /// Number of levels, fractions blended; [`INFINITELY_SHARP`] or more is for ever.
    pub sharpness: f32,
}

/// A vertex that stays where it is for some levels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corner {
    /// The vertex.
    pub vertex: u32,
    /// As of a [`Crease`].
    pub sharpness: f32,
}

/// Connectivity and tags of a control mesh. Positions are not part of it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Cage {
    /// Number of vertices, used by faces or not.
    pub vertices: usize,
    /// Face `f` has the corners `indices[offsets[f]..offsets[f + 1]]`.
    pub offsets: Vec<u32>,
    /// Vertices of all faces, counter-clockwise seen from outside.
    pub indices: Vec<u32>,
    /// Sharp edges.
    pub creases: Vec<Crease>,
    /// Sharp vertices.
    pub corners: Vec<Corner>,
    /// Faces that shape the surface but are left out of it.
    pub holes: Vec<u32>,
}

impl Cage {
    /// The faces of a polygon mesh, without tags. Vertices at one position stay apart: see
    /// [`ControlMesh`](super::ControlMesh) for meshes with seams.
    #[must_use]
    pub fn of_poly_mesh(mesh: &PolyMesh) -> Self {
        Self {
            vertices: mesh.positions.len(),
            offsets: mesh.offsets.clone(),
            indices: mesh.indices.clone(),
            ..Self::default()
        }
    }

    /// Number of faces.
    #[must_use]
    pub fn face_count(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// Checks everything but positions. Faces may meet in any way; one may even name a
    /// vertex twice, as poles of some models do.
    ///
    /// # Errors
    /// [`Error::Empty`] without faces, [`Error::LengthMismatch`] if offsets do not fit,
    /// [`Error::DegenerateFace`] for fewer than three corners,
    /// [`Error::IndexOutOfRange`], [`Error::NotFinite`] or, if negative,
    /// [`Error::BadOption`] for a sharpness, [`Error::TooLarge`].
    pub fn validate(&self) -> Result<()> {
        if self.face_count() == 0 {
            return Err(Error::Empty { what: "cage" });
        }
        check_size("vertices", self.vertices)?;
        check_size("corners of faces", self.indices.len())?;
        let end = self.offsets[self.face_count()] as usize;
        if self.offsets[0] != 0 || end != self.indices.len() || !self.offsets.is_sorted() {
            return Err(Error::LengthMismatch {
                what: "faces by `offsets`".into(),
                expected: self.indices.len(),
                found: end,
            });
        }
        for face in 0..self.face_count() {
            self.check_face(face)?;
        }
        self.check_tags()
    }

    fn check_face(&self, face: usize) -> Result<()> {
        let corners = &self.indices[self.offsets[face] as usize..self.offsets[face + 1] as usize];
        if let Some(&index) = corners.iter().find(|&&v| v as usize >= self.vertices) {
            return Err(self.out_of_range(face, index));
        }
        if corners.len() < 3 {
            return Err(Error::DegenerateFace { face });
        }
        Ok(())
    }

    fn check_tags(&self) -> Result<()> {
        let creases = self.creases.iter().map(|c| c.sharpness);
        check_sharpness("sharpness of crease", creases)?;
        let corners = self.corners.iter().map(|c| c.sharpness);
        check_sharpness("sharpness of corner", corners)?;
        let ends = self.creases.iter().flat_map(|c| c.vertices);
        let mut named = ends.chain(self.corners.iter().map(|c| c.vertex));
        if let Some(index) = named.find(|&v| v as usize >= self.vertices) {
            return Err(self.out_of_range(0, index));
        }
        match self
            .holes
            .iter()
            .find(|&&f| f as usize >= self.face_count())
        {
            Some(&to) => Err(Error::BadReference {
                what: "hole",
                index: 0,
                target: "face",
                to: to as usize,
                problem: "does not exist",
            }),
            None => Ok(()),
        }
    }

    fn out_of_range(&self, face: usize, index: u32) -> Error {
        Error::IndexOutOfRange {
            face,
            index,
            vertices: self.vertices,
        }
    }
}

fn check_sharpness(what: &'static str, all: impl Iterator<Item = f32>) -> Result<()> {
    for (index, sharpness) in all.enumerate() {
        if !sharpness.is_finite() {
            return Err(not_finite(what, index));
        }
        if sharpness < 0.0 {
            return Err(Error::BadOption {
                option: what,
                found: format!("{sharpness} at {index}"),
                expected: "0 or more",
            });
        }
    }
    Ok(())
}

pub(super) fn not_finite(what: &str, index: usize) -> Error {
    Error::NotFinite {
        what: what.into(),
        index,
    }
}

pub(super) fn check_size(what: &'static str, found: usize) -> Result<()> {
    let limit = u32::MAX as usize - 1;
    if found > limit {
        return Err(Error::TooLarge { what, found, limit });
    }
    Ok(())
}
