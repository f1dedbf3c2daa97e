//! Structural similarity.
//!
//! Z. Wang, A. C. Bovik, H. R. Sheikh, E. P. Simoncelli: Image Quality Assessment:
//! From Error Visibility to Structural Similarity. IEEE TIP 13(4), 2004.

use super::flat::Pair;
use crate::error::Result;
use crate::render::Picture;
use rayon::prelude::*;
use std::ops::Range;

const RADIUS: usize = 5;
const SIGMA: f64 = 1.5;
const C1: f64 = (0.01 * 255.0) * (0.01 * 255.0);
const C2: f64 = (0.03 * 255.0) * (0.03 * 255.0);

/// Weights of a window along one axis; those that lie in the picture are scaled to 1.
type Window = [f64; 2 * RADIUS + 1];

/// Mean structural similarity of the lumas (BT.601, of sRGB codes) of the
/// pictures laid over black, by Wang et al. 2004: Gaussian windows of 11 x 11
/// pixels with sigma 1.5, K1 = 0.01, K2 = 0.03. 1 for equal pictures, down to -1.
///
/// The mean is over all windows that lie in the picture. Along a side of fewer
/// than 11 pixels none does: there it is over windows about every pixel, cut off
/// at the border, with the remaining weights scaled to a sum of 1.
///
/// # Errors
/// As [`rmse`](super::rmse()).
pub fn ssim(a: &Picture, b: &Picture) -> Result<f64> {
    Ok(similarity(&Pair::new(a, b, [0; 3])?))
}

pub(super) fn similarity(pair: &Pair) -> f64 {
    let lumas = [luma(&pair.a), luma(&pair.b)];
    let (columns, rows) = (centres(pair.width), centres(pair.height));
    let windows = (columns.len() * rows.len()) as f64;
    let sums: Vec<f64> = rows
        .into_par_iter()
        .map(|y| row_sum(&lumas, pair.width, pair.height, y, columns.clone()))
        .collect();
    sums.iter().sum::<f64>() / windows
}

fn luma(pixels: &[[u8; 3]]) -> Vec<f64> {
    let one = |&p: &[u8; 3]| {
        let [r, g, b] = p.map(f64::from);
        0.299 * r + 0.587 * g + 0.114 * b
    };
    pixels.iter().map(one).collect()
}

fn centres(side: usize) -> Range<usize> {
    if side > 2 * RADIUS {
        RADIUS..side - RADIUS
    } else {
        0..side
    }
}

/// Similarity of the windows about the pixels of row `y`, added.
fn row_sum(
    lumas: &[Vec<f64>; 2],
    width: usize,
    height: usize,
    y: usize,
    columns: Range<usize>,
) -> f64 {
    let moments = down(lumas, width, height, y);
    columns
        .map(|x| {
            let (weights, inside) = window(x, width);
            let mut sums = [0.0; 5];
            for (weight, column) in weights.iter().zip(&moments[inside]) {
                for (sum, moment) in sums.iter_mut().zip(column) {
                    *sum += weight * moment;
                }
            }
            index(sums)
        })
        .sum()
}

/// Weighted sums down every column about row `y`: of a, b, a², b², ab.
fn down(lumas: &[Vec<f64>; 2], width: usize, height: usize, y: usize) -> Vec<[f64; 5]> {
    let (weights, inside) = window(y, height);
    let mut moments = vec![[0.0; 5]; width];
    for (weight, row) in weights.iter().zip(inside) {
        let row = row * width..(row + 1) * width;
        let pixels = lumas[0][row.clone()].iter().zip(&lumas[1][row]);
        for (sums, (&a, &b)) in moments.iter_mut().zip(pixels) {
            for (sum, moment) in sums.iter_mut().zip([a, b, a * a, b * b, a * b]) {
                *sum += weight * moment;
            }
        }
    }
    moments
}

/// The pixels about `centre` along a side, and the weights of these.
fn window(centre: usize, side: usize) -> (Window, Range<usize>) {
    let inside = centre.saturating_sub(RADIUS)..(centre + RADIUS + 1).min(side);
    let mut weights = Window::default();
    let mut sum = 0.0;
    for (weight, pixel) in weights.iter_mut().zip(inside.clone()) {
        let offset = pixel.abs_diff(centre) as f64 / SIGMA;
        *weight = (-0.5 * offset * offset).exp();
        sum += *weight;
    }
    (weights.map(|weight| weight / sum), inside)
}

fn index([a, b, aa, bb, ab]: [f64; 5]) -> f64 {
    let (vara, varb, cov) = (aa - a * a, bb - b * b, ab - a * b);
    let light = (2.0 * (a * b) + C1) / (a * a + b * b + C1);
    light * ((2.0 * cov + C2) / (vara + varb + C2))
}
