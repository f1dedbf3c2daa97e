//! Which triangles may be seen, by band of rows.

use super::clip::clip;
use super::edges::{Extent, Window, covers, oriented, two_areas};
use super::geometry::Geometry;
use super::project::Corner;
use super::view::View;
use rayon::prelude::*;
use std::ops::Range;

/// Rows of samples a band has, and their logarithm.
pub(super) const BAND: i32 = 1 << BAND_BITS;
const BAND_BITS: u32 = 5;

/// How a part's triangles are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Opaque,
    /// Here and there, by alpha.
    Masked,
    /// Over what is behind.
    Blended,
    /// Not at all.
    Hidden,
}

/// What to do with a part.
#[derive(Debug, Clone, Copy)]
pub(super) struct Treatment {
    pub kind: Kind,
    /// Sign of the areas that are not shown; 0 shows both sides.
    pub culled: i64,
}

/// Triangles of a band in ascending order, list after list, by kind.
pub(super) type Bins = Vec<Vec<[Vec<u32>; 3]>>;

/// What all triangles have in common.
pub(super) struct Picked<'a> {
    pub view: &'a View,
    pub geometry: &'a Geometry<'a>,
    pub corners: &'a [Corner],
    pub treatments: &'a [Treatment],
    pub picture: Window,
}

/// Triangles a task.
const CHUNK: usize = 1 << 14;

impl Picked<'_> {
    /// One entry a chunk of triangles, in it one a band.
    pub(super) fn bins(&self) -> Bins {
        let count = self.geometry.triangles.len();
        let chunk = |c: usize| self.chunk(c * CHUNK..count.min((c + 1) * CHUNK));
        (0..count.div_ceil(CHUNK))
            .into_par_iter()
            .map(chunk)
            .collect()
    }

    fn chunk(&self, range: Range<usize>) -> Vec<[Vec<u32>; 3]> {
        let bands = (self.picture.rows.end + BAND - 1) >> BAND_BITS;
        let mut bins = vec![<[Vec<u32>; 3]>::default(); bands as usize];
        let first_part = self.geometry.part_of[range.start] as usize;
        for (part, treatment) in self
            .geometry
            .parts
            .iter()
            .zip(self.treatments)
            .skip(first_part)
        {
            let first = part.first_triangle as usize;
            let run = first.max(range.start)..(first + part.count as usize).min(range.end);
            if first >= range.end {
                break;
            }
            if treatment.kind != Kind::Hidden {
                self.sort_into(&mut bins, run, *treatment);
            }
        }
        bins
    }

    fn sort_into(&self, bins: &mut [[Vec<u32>; 3]], run: Range<usize>, how: Treatment) {
        let kind = how.kind as usize;
        for t in run {
            let corners = self.corners_of(t);
            let [a, b, c] = corners.map(|corner| corner.outside);
            let rows = if a | b | c != 0 {
                if a & b & c != 0 {
                    continue;
                }
                self.clipped_rows(t, how)
            } else {
                self.rows(&corners, how)
            };
            if rows.start < rows.end {
                let bands = rows.start >> BAND_BITS..=(rows.end - 1) >> BAND_BITS;
                for band in bands {
                    bins[band as usize][kind].push(t as u32);
                }
            }
        }
    }

    #[inline]
    fn corners_of(&self, t: usize) -> [Corner; 3] {
        self.geometry.triangles[t].map(|v| self.corners[v as usize])
    }

    /// Rows whose samples a triangle may cover; none if it is not shown.
    #[inline(always)]
    fn rows(&self, corners: &[Corner; 3], how: Treatment) -> Range<i32> {
        let window = Extent::new(corners).window(&self.picture);
        if window.is_empty() {
            return 0..0;
        }
        let area = two_areas(corners);
        if area == 0 || area.signum() == how.culled {
            return 0..0;
        }
        // Most triangles of a fine mesh come close to one sample, and miss it.
        let missed = window
            .only()
            .is_some_and(|(x, y)| !covers(&oriented(*corners, area), x, y));
        if missed { 0..0 } else { window.rows }
    }

    fn clipped_rows(&self, t: usize, how: Treatment) -> Range<i32> {
        let corners = self.geometry.homogeneous(self.view, t);
        let mut all = 0..0;
        for part in clip(self.view, corners) {
            let rows = self.rows(&part, how);
            all = match (all.is_empty(), rows.is_empty()) {
                (true, _) => rows,
                (_, true) => all,
                _ => all.start.min(rows.start)..all.end.max(rows.end),
            };
        }
        all
    }
}
