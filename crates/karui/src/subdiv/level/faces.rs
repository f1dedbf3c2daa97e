//! Where the corners of faces are.

use std::ops::Range;

/// Faces as ranges of corners: one number if all have the same size.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Faces {
    /// So many faces of so many corners.
    Uniform {
        /// Corners of a face.
        size: u32,
        /// Number of faces.
        count: u32,
    },
    /// Faces of any size.
    Mixed {
        /// Face `f` has the corners `offsets[f]..offsets[f + 1]`.
        offsets: Vec<u32>,
        /// The face of every corner.
        of_corner: Vec<u32>,
    },
}

impl Faces {
    /// Faces that start at these corners.
    pub(in crate::subdiv) fn of_offsets(offsets: &[u32]) -> Self {
        let size = offsets.get(1).copied().unwrap_or(0);
        if offsets.windows(2).all(|w| w[1] - w[0] == size) {
            let count = offsets.len() as u32 - 1;
            return Self::Uniform { size, count };
        }
        let faces = offsets.windows(2).enumerate();
        let of_corner = faces.flat_map(|(f, w)| (w[0]..w[1]).map(move |_| f as u32));
        Self::Mixed {
            of_corner: of_corner.collect(),
            offsets: offsets.to_vec(),
        }
    }

    /// Number of faces.
    #[must_use]
    pub fn count(&self) -> usize {
        match self {
            Self::Uniform { count, .. } => *count as usize,
            Self::Mixed { offsets, .. } => offsets.len() - 1,
        }
    }

    /// Corners per face, if all have the same.
    #[must_use]
    pub fn size(&self) -> Option<u32> {
        match self {
            Self::Uniform { size, .. } => Some(*size),
            Self::Mixed { .. } => None,
        }
    }

    /// Corners of face `f`.
    #[must_use]
    pub fn corners(&self, f: usize) -> Range<usize> {
        match self {
            Self::Uniform { size, .. } => f * *size as usize..(f + 1) * *size as usize,
            Self::Mixed { offsets, .. } => offsets[f] as usize..offsets[f + 1] as usize,
        }
    }

    /// The face of corner `c`.
    #[must_use]
    pub fn of_corner(&self, c: u32) -> u32 {
        match self {
            Self::Uniform { size: 4, .. } => c / 4,
            Self::Uniform { size, .. } => c / size,
            Self::Mixed { of_corner, .. } => of_corner[c as usize],
        }
    }

    /// The corner after `c` in its face.
    #[must_use]
    pub fn next(&self, c: u32) -> u32 {
        let range = self.corners(self.of_corner(c) as usize);
        if c as usize + 1 == range.end {
            range.start as u32
        } else {
            c + 1
        }
    }

    /// The corner before `c` in its face.
    #[must_use]
    pub fn previous(&self, c: u32) -> u32 {
        let range = self.corners(self.of_corner(c) as usize);
        if c as usize == range.start {
            range.end as u32 - 1
        } else {
            c - 1
        }
    }
}
