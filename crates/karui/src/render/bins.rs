//! Which triangles may be seen, by band of rows.

use super::clip::clip;
use super::edges::{Extent, Window, covers, oriented, two_areas};
use super::geometry::{Geometry, Part};
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
    /// Opaque, and showing its back.
    Back,
    /// Not at all.
    Hidden,
}

/// What to do with a part.
#[derive(Debug, Clone, Copy)]
pub(super) struct Treatment {
    pub kind: Kind,
    /// Sign of the areas of backs.
    pub back: i64,
    /// Whether backs are shown.
    pub two_sided: bool,
}

/// A triangle that may be seen.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    pub triangle: u32,
    /// First and last column and row of the samples around it, if edge functions over
    /// them fit into 32 bits; else the last column is before the first.
    columns: [u16; 2],
    rows: [u16; 2],
}

impl Entry {
    /// Of a triangle that takes more care.
    fn large(triangle: u32) -> Self {
        Self {
            triangle,
            columns: [1, 0],
            rows: [0, 0],
        }
    }

    fn small(triangle: u32, window: &Window) -> Self {
        // A picture has at most 4 * 16384 samples a side.
        let ends = |range: &Range<i32>| [range.start as u16, (range.end - 1) as u16];
        Self {
            triangle,
            columns: ends(&window.columns),
            rows: ends(&window.rows),
        }
    }

    /// Samples within these rows that it may cover, if it is small.
    #[inline]
    pub(super) fn window(&self, rows: &Range<i32>) -> Option<Window> {
        let [first, last] = self.columns.map(i32::from);
        let [top, bottom] = self.rows.map(i32::from);
        (first <= last).then(|| Window {
            columns: first..last + 1,
            rows: top.max(rows.start)..(bottom + 1).min(rows.end),
        })
    }
}

/// Entries by kind; the last are backs of what is opaque, which fronts often hide.
type Lists = [Vec<Entry>; 4];

/// For every chunk of triangles, in ascending order, what each band has of it.
pub(super) type Bins = Vec<Vec<Lists>>;

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
        let count = self.geometry.triangles;
        let chunk = |c: usize| self.chunk(c * CHUNK..count.min((c + 1) * CHUNK));
        (0..count.div_ceil(CHUNK))
            .into_par_iter()
            .map(chunk)
            .collect()
    }

    fn chunk(&self, range: Range<usize>) -> Vec<Lists> {
        let bands = (self.picture.rows.end + BAND - 1) >> BAND_BITS;
        let mut bins = vec![Lists::default(); bands as usize];
        let first_part = self.geometry.part_before(range.start);
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
                self.sort_into(&mut bins, part, run, *treatment);
            }
        }
        bins
    }

    fn sort_into(&self, bins: &mut [Lists], part: &Part<'_>, run: Range<usize>, how: Treatment) {
        let first = self.geometry.first_vertex(part);
        for t in run {
            let vertices = part.triangle(t as u32);
            let corners = vertices.map(|v| self.corners[(v + first) as usize]);
            let [a, b, c] = corners.map(|corner| corner.outside);
            let mut kind = how.kind;
            let (entry, rows) = if a | b | c == 0 {
                let extent = Extent::new(&corners);
                let Some((window, is_back)) = self.window(&corners, &extent, how) else {
                    continue;
                };
                if is_back && kind == Kind::Opaque {
                    kind = Kind::Back;
                }
                let entry = match extent.is_small() {
                    true => Entry::small(t as u32, &window),
                    false => Entry::large(t as u32),
                };
                (entry, window.rows)
            } else if a & b & c == 0 {
                (Entry::large(t as u32), self.clipped_rows(t, how))
            } else {
                continue;
            };
            if rows.start < rows.end {
                for band in rows.start >> BAND_BITS..=(rows.end - 1) >> BAND_BITS {
                    bins[band as usize][kind as usize].push(entry);
                }
            }
        }
    }

    /// Samples that a triangle may cover, and whether it shows its back; `None` if there
    /// are none or it is not shown.
    #[inline(always)]
    fn window(
        &self,
        corners: &[Corner; 3],
        extent: &Extent,
        how: Treatment,
    ) -> Option<(Window, bool)> {
        let window = extent.window(&self.picture);
        if window.is_empty() {
            return None;
        }
        let area = two_areas(corners);
        let is_back = area.signum() == how.back;
        if area == 0 || (is_back && !how.two_sided) {
            return None;
        }
        // Most triangles of a fine mesh come close to one sample, and miss it.
        let missed = |(x, y)| !covers(&oriented(*corners, area), x, y);
        if window.only().is_some_and(missed) {
            return None;
        }
        Some((window, is_back))
    }

    fn clipped_rows(&self, t: usize, how: Treatment) -> Range<i32> {
        let corners = self.geometry.homogeneous(self.view, t as u32);
        let mut all = 0..0;
        for part in clip(self.view, corners) {
            if let Some((Window { rows, .. }, _)) = self.window(&part, &Extent::new(&part), how) {
                all = match all.is_empty() {
                    true => rows,
                    false => all.start.min(rows.start)..all.end.max(rows.end),
                };
            }
        }
        all
    }
}
