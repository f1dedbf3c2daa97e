//! A band of rows: which triangle is closest at every sample.

use super::bins::{BAND, Entry, Kind};
use super::clip::clip;
use super::edges::{Extent, Window, cover_large, cover_small, oriented, two_areas};
use super::pass::Pass;
use super::project::Corner;
use super::shade::Shader;

/// What is closest, in one number that is larger for what is closer and, at the
/// same distance, for the triangle with the lower number. 0 is nothing.
pub(super) fn key(closeness: f32, triangle: u32) -> u64 {
    u64::from(closeness.to_bits()) << 32 | u64::from(!triangle)
}

/// The triangle in a key.
#[inline]
pub(super) fn triangle_of(key: u64) -> Option<u32> {
    (key != 0).then_some(!(key as u32))
}

/// The samples of a band.
#[derive(Debug, Default)]
pub(super) struct Band {
    /// Closest that is not blended, row by row.
    pub keys: Vec<u64>,
    pub width: usize,
    pub first_row: i32,
}

impl Band {
    /// Draws what is opaque or masked.
    pub(super) fn draw(&mut self, pass: &Pass<'_>, shader: &Shader<'_>, index: usize) {
        let within = within(pass, index);
        self.first_row = within.rows.start;
        self.width = within.columns.len();
        self.keys.clear();
        self.keys.resize(within.rows.len() * self.width, 0);
        for entry in pass.binned(index, Kind::Opaque).flatten() {
            self.draw_one(pass, entry, &within, |_, _| true);
        }
        for entry in pass.binned(index, Kind::Back).flatten() {
            if !self.is_hidden(pass, entry, &within) {
                self.draw_one(pass, entry, &within, |_, _| true);
            }
        }
        for entry in pass.binned(index, Kind::Masked).flatten() {
            let solid = |x, y| shader.is_solid(entry.triangle, x, y);
            self.draw_one(pass, entry, &within, solid);
        }
    }

    /// Where a sample is in [`Band::keys`].
    #[inline]
    pub(super) fn slot(&self, column: i32, row: i32) -> usize {
        (row - self.first_row) as usize * self.width + column as usize
    }

    /// Column and row of a sample.
    #[inline]
    pub(super) fn place_of(&self, slot: usize) -> (i32, i32) {
        let row = (slot / self.width) as i32 + self.first_row;
        ((slot % self.width) as i32, row)
    }

    /// Whether something else is closer at all samples around a small triangle than any
    /// of its corners.
    fn is_hidden(&self, pass: &Pass<'_>, entry: &Entry, within: &Window) -> bool {
        let Some(window) = entry.window(&within.rows) else {
            return false;
        };
        let [a, b, c] = pass.corners_of(entry.triangle).map(|c| c.closeness);
        let closest = key(a.max(b).max(c), entry.triangle);
        window.rows.clone().all(|row| {
            let row = self.slot(window.columns.start, row);
            let keys = &self.keys[row..row + window.columns.len()];
            keys.iter().all(|&key| key > closest)
        })
    }

    fn draw_one(
        &mut self,
        pass: &Pass<'_>,
        entry: &Entry,
        within: &Window,
        solid: impl Fn(i32, i32) -> bool,
    ) {
        let (first_row, width) = (self.first_row, self.width);
        let keys = &mut self.keys;
        samples(pass, entry, within, &mut |x, y, closeness| {
            let key = key(closeness, entry.triangle);
            let slot = &mut keys[(y - first_row) as usize * width + x as usize];
            if key > *slot && solid(x, y) {
                *slot = key;
            }
        });
    }
}

/// The samples of a band.
pub(super) fn within(pass: &Pass<'_>, index: usize) -> Window {
    let first = index as i32 * BAND;
    Window {
        columns: pass.picture.columns.clone(),
        rows: first..(first + BAND).min(pass.picture.rows.end),
    }
}

/// Calls `covered(column, row, closeness)` for every sample within the window
/// that a triangle covers.
#[inline]
pub(super) fn samples(
    pass: &Pass<'_>,
    entry: &Entry,
    within: &Window,
    covered: &mut impl FnMut(i32, i32, f32),
) {
    let corners = pass.corners_of(entry.triangle);
    if let Some(window) = entry.window(&within.rows) {
        let (corners, plane) = turned(&corners);
        return cover_small(&corners, &window, &mut |x, y, e| covered(x, y, plane.at(e)));
    }
    if corners.iter().all(|c| c.outside == 0) {
        return samples_of_large(&corners, within, covered);
    }
    let corners = pass.geometry.homogeneous(&pass.view, entry.triangle);
    for part in clip(&pass.view, corners) {
        samples_of_large(&part, within, covered);
    }
}

fn samples_of_large(
    corners: &[Corner; 3],
    within: &Window,
    covered: &mut impl FnMut(i32, i32, f32),
) {
    let window = Extent::new(corners).window(within);
    if two_areas(corners) != 0 && !window.is_empty() {
        let (corners, plane) = turned(corners);
        cover_large(&corners, &window, &mut |x, y, e| covered(x, y, plane.at(e)));
    }
}

/// How closeness follows from the edge functions.
struct Plane {
    start: f32,
    slopes: [f32; 2],
    most: f32,
}

/// Corners in the order of a positive area, and closeness over them.
#[inline]
fn turned(corners: &[Corner; 3]) -> ([Corner; 3], Plane) {
    let area = two_areas(corners);
    let [a, b, c] = oriented(*corners, area);
    let by_area = 1.0 / area.abs() as f32;
    let slopes = [b, c].map(|corner| (corner.closeness - a.closeness) * by_area);
    let plane = Plane {
        start: a.closeness,
        slopes,
        most: a.closeness.max(b.closeness).max(c.closeness),
    };
    ([a, b, c], plane)
}

impl Plane {
    #[inline]
    fn at(&self, [e1, e2]: [f32; 2]) -> f32 {
        let closeness = self.start + (e1 * self.slopes[0] + e2 * self.slopes[1]);
        // No closer than a corner, whatever rounding does. Bits compare as numbers do
        // from +0 on only, and `max` may give -0.
        let closeness = closeness.min(self.most);
        if closeness > 0.0 { closeness } else { 0.0 }
    }
}
