//! A band of rows: which triangle is closest at every sample.

use super::bins::{BAND, Kind};
use super::clip::clip;
use super::edges::{Extent, Window, cover, oriented, two_areas};
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
        for t in pass.binned(index, Kind::Opaque) {
            self.draw_one(pass, t, &within, |_, _| true);
        }
        for t in pass.binned(index, Kind::Masked) {
            self.draw_one(pass, t, &within, |x, y| shader.is_solid(t, x, y));
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

    fn draw_one(
        &mut self,
        pass: &Pass<'_>,
        t: u32,
        within: &Window,
        solid: impl Fn(i32, i32) -> bool,
    ) {
        let (first_row, width) = (self.first_row, self.width);
        let keys = &mut self.keys;
        samples(pass, t, within, &mut |x, y, closeness| {
            let key = key(closeness, t);
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
    t: u32,
    within: &Window,
    covered: &mut impl FnMut(i32, i32, f32),
) {
    let corners = pass.corners_of(t);
    if corners.iter().all(|c| c.outside == 0) {
        return samples_of(&corners, within, covered);
    }
    for part in clip(
        &pass.view,
        pass.geometry.homogeneous(&pass.view, t as usize),
    ) {
        samples_of(&part, within, covered);
    }
}

#[inline]
fn samples_of(corners: &[Corner; 3], within: &Window, covered: &mut impl FnMut(i32, i32, f32)) {
    let area = two_areas(corners);
    let extent = Extent::new(corners);
    let window = extent.window(within);
    if area == 0 || window.is_empty() {
        return;
    }
    let [a, b, c] = oriented(*corners, area);
    let by_area = 1.0 / area.abs() as f32;
    let slope_b = (b.closeness - a.closeness) * by_area;
    let slope_c = (c.closeness - a.closeness) * by_area;
    cover(&[a, b, c], &extent, &window, &mut |x, y, [e1, e2]| {
        let closeness = a.closeness + (e1 * slope_b + e2 * slope_c);
        // Bits compare as numbers do from +0 on only, and `max` may give -0.
        covered(x, y, if closeness > 0.0 { closeness } else { 0.0 });
    });
}
