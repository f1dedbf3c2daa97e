//! LDR-FLIP.
//!
//! P. Andersson, J. Nilsson, T. Akenine-Möller, M. Oskarsson, K. Åström,
//! M. D. Fairchild: FLIP: A Difference Evaluator for Alternating Images.
//! Proc. ACM Comput. Graph. Interact. Tech. 3(2) (HPG), 2020. Equations and
//! constants are those of the paper; both sums of Gaussians are taken apart into
//! filters along x and along y.

mod color;
mod filter;
mod magma;
mod row;

use super::flat::Pair;
use crate::error::{Error, Result};
use crate::render::Picture;
use color::Scale;
use filter::Filters;
use rayon::prelude::*;
use row::{Planes, Scratch};

/// Pixels per degree of a display 0.7 m wide with 3840 pixels, seen from 0.7 m.
pub const PIXELS_PER_DEGREE: f64 = 67.020_643_276_582_26;

/// Perceived difference of two pictures that are shown in turn.
#[derive(Debug, Clone, PartialEq)]
pub struct Flip {
    /// Mean of the map.
    pub mean: f64,
    /// Difference of every pixel, 0 (none) to 1, row by row from the top left.
    pub map: Vec<f32>,
    /// Pixels a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Flip {
    /// The map in the colours of magma: black is 0, pale yellow 1.
    ///
    /// # Errors
    /// [`Error::LengthMismatch`] if the fields were changed to contradict each other.
    pub fn picture(&self) -> Result<Picture> {
        let pixels = self.map.iter().map(|&error| magma::magma(error)).collect();
        Picture::new(self.width, self.height, pixels)
    }
}

/// LDR-FLIP (Andersson et al. 2020) of two pictures laid over black, seen at
/// `pixels_per_degree` of visual angle ([`PIXELS_PER_DEGREE`] is the usual one).
/// Beyond the border the outermost pixels go on. Symmetric.
///
/// # Errors
/// [`Error::SizeMismatch`] for pictures of different size, [`Error::Empty`] for
/// pictures without pixels, [`Error::BadOption`] for `pixels_per_degree` outside
/// 1 to 10,000.
pub fn flip(a: &Picture, b: &Picture, pixels_per_degree: f64) -> Result<Flip> {
    of_pair(&Pair::new(a, b, [0; 3])?, pixels_per_degree)
}

pub(in super::super) fn of_pair(pair: &Pair, pixels_per_degree: f64) -> Result<Flip> {
    // Below, a Gaussian is less than a pixel and its slope nothing but rounding.
    if !(1.0..=10_000.0).contains(&pixels_per_degree) {
        return Err(Error::BadOption {
            option: "pixels_per_degree",
            found: pixels_per_degree.to_string(),
            expected: "1 to 10,000",
        });
    }
    Ok(map_of(pair, &Filters::new(pixels_per_degree)))
}

fn map_of(pair: &Pair, filters: &Filters) -> Flip {
    let width = pair.width;
    let planes = [&pair.a, &pair.b].map(|pixels| Planes::new(pixels, width));
    let scale = Scale::new();
    let mut map = vec![0.0; pair.a.len()];
    let scratch = || [Scratch::new(width), Scratch::new(width)];
    let touched = touched(pair, filters.reach());
    // One sum a row, added in order, so that rounding does not depend on threads.
    let mut sums = vec![0.0; pair.height];
    map.par_chunks_mut(width)
        .zip(&mut sums)
        .zip(touched)
        .enumerate()
        .for_each_init(scratch, |scratch, (y, ((errors, sum), touched))| {
            if !touched {
                return;
            }
            for (scratch, planes) in scratch.iter_mut().zip(&planes) {
                scratch.fill(planes, y, filters);
            }
            row::errors(scratch, &scale, errors);
            *sum = errors.iter().map(|&error| f64::from(error)).sum();
        });
    Flip {
        mean: sums.iter().sum::<f64>() / map.len() as f64,
        map,
        width: width as u32,
        height: pair.height as u32,
    }
}

/// Rows that see a difference: in the others, errors are 0. Views of two levels of
/// detail have much background in common.
fn touched(pair: &Pair, reach: usize) -> Vec<bool> {
    let rows = [&pair.a, &pair.b].map(|pixels| pixels.chunks(pair.width));
    let [a, b] = rows;
    let differs: Vec<bool> = a.zip(b).map(|(a, b)| a != b).collect();
    let near = |y: usize| y.saturating_sub(reach)..(y + reach + 1).min(pair.height);
    let any = |y: usize| differs[near(y)].contains(&true);
    (0..pair.height).map(any).collect()
}
