//! One row of the map of errors. A row needs the rows about it only, so there are
//! no filtered pictures in memory, and the inner loops run along rows.

use super::color::{self, Scale};
use super::filter::{Filters, Kernel};
use std::f32::consts::FRAC_1_SQRT_2;

/// A picture as luminance, red-green and blue-yellow.
pub(super) struct Planes {
    width: usize,
    planes: [Vec<f32>; 3],
}

impl Planes {
    pub(super) fn new(pixels: &[[u8; 3]], width: usize) -> Self {
        let mut planes = [(); 3].map(|()| Vec::with_capacity(pixels.len()));
        for &pixel in pixels {
            for (plane, value) in planes.iter_mut().zip(color::opponents(pixel)) {
                plane.push(value);
            }
        }
        Self { width, planes }
    }
}

/// What is known of a row of one picture.
pub(super) struct Scratch {
    /// A row filtered down, with the border carried on at both ends.
    padded: Vec<f32>,
    colors: [Vec<f32>; 3],
    /// Slopes along x and y, then curvatures.
    features: [Vec<f32>; 4],
}

impl Scratch {
    pub(super) fn new(width: usize) -> Self {
        Self {
            padded: Vec::new(),
            colors: [(); 3].map(|()| vec![0.0; width]),
            features: [(); 4].map(|()| vec![0.0; width]),
        }
    }

    pub(super) fn fill(&mut self, picture: &Planes, y: usize, filters: &Filters) {
        for row in self.colors.iter_mut().chain(&mut self.features) {
            row.fill(0.0);
        }
        let [luminance, red_green, blue_yellow] = &picture.planes;
        let width = picture.width;
        let padded = &mut self.padded;
        let colors = &mut self.colors;
        let mut filter = |plane: &[f32], down: &Kernel, along: &Kernel, share, out: &mut [f32]| {
            filter_down(plane, width, y, down, along.len() / 2, padded);
            filter_along(padded, along, share, out);
        };
        let (l, rg) = (&filters.luminance, &filters.red_green);
        filter(luminance, l, l, 1.0, &mut colors[0]);
        filter(red_green, rg, rg, 1.0, &mut colors[1]);
        for (share, by) in &filters.blue_yellow {
            filter(blue_yellow, by, by, *share, &mut colors[2]);
        }
        let (across, edge, point) = (&filters.across, &filters.edge, &filters.point);
        let passes = [
            (across, edge),
            (edge, across),
            (across, point),
            (point, across),
        ];
        for ((down, along), out) in passes.into_iter().zip(&mut self.features) {
            filter(luminance, down, along, 1.0, out);
        }
    }

    fn color(&self, x: usize) -> [f32; 3] {
        [self.colors[0][x], self.colors[1][x], self.colors[2][x]]
    }

    /// Strength of edges and of points.
    fn features(&self, x: usize) -> [f32; 2] {
        let length = |a: f32, b: f32| (a * a + b * b).sqrt();
        let [edge_x, edge_y, point_x, point_y] = self.features.each_ref().map(|row| row[x]);
        [length(edge_x, edge_y), length(point_x, point_y)]
    }
}

/// Filters the columns at row `y`, and carries on the ends by `pad`.
fn filter_down(
    plane: &[f32],
    width: usize,
    y: usize,
    kernel: &Kernel,
    pad: usize,
    padded: &mut Vec<f32>,
) {
    padded.clear();
    padded.resize(width + 2 * pad, 0.0);
    let last = plane.len() / width - 1;
    let radius = kernel.len() / 2;
    let inner = &mut padded[pad..pad + width];
    for (i, &weight) in kernel.iter().enumerate() {
        let row = (y + i).saturating_sub(radius).min(last) * width;
        add(inner, &plane[row..row + width], weight);
    }
    let (first, end) = (inner[0], inner[width - 1]);
    padded[..pad].fill(first);
    padded[pad + width..].fill(end);
}

fn filter_along(padded: &[f32], kernel: &Kernel, share: f32, out: &mut [f32]) {
    for (i, &weight) in kernel.iter().enumerate() {
        add(out, &padded[i..], weight * share);
    }
}

fn add(sums: &mut [f32], values: &[f32], weight: f32) {
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum += weight * value;
    }
}

/// Errors of a row that both scratches are filled with.
pub(super) fn errors(rows: &[Scratch; 2], scale: &Scale, errors: &mut [f32]) {
    let [a, b] = rows;
    for (x, error) in errors.iter_mut().enumerate() {
        let ([edge_a, point_a], [edge_b, point_b]) = (a.features(x), b.features(x));
        let colors = [a.color(x), b.color(x)];
        if colors[0] == colors[1] && edge_a == edge_b && point_a == point_b {
            *error = 0.0;
            continue;
        }
        let [lab_a, lab_b] = colors.map(|color| color::lab(color, &scale.inverse));
        let color = scale.difference(lab_a, lab_b);
        let feature = (edge_a - edge_b).abs().max((point_a - point_b).abs());
        let feature = (FRAC_1_SQRT_2 * feature).clamp(0.0, 1.0).sqrt();
        *error = color.powf(1.0 - feature).clamp(0.0, 1.0);
    }
}
