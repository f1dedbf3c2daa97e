//! Differences of several views, together.

use super::{ImageDifference, rmse};

/// Sums over views, e.g. over the cameras around a model.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ViewDifferences {
    views: u64,
    squared: f64,
    rmse: f64,
    ssim: f64,
    flip: f64,
}

impl ViewDifferences {
    /// Adds a view.
    pub fn add(&mut self, view: &ImageDifference) {
        self.views += 1;
        self.squared += view.rmse * view.rmse;
        self.rmse += view.rmse;
        self.ssim += view.ssim;
        self.flip += view.flip;
    }

    /// Adds the views of `later`. Merge in a fixed order for the same bits.
    pub fn merge(&mut self, later: &Self) {
        self.views += later.views;
        self.squared += later.squared;
        self.rmse += later.rmse;
        self.ssim += later.ssim;
        self.flip += later.flip;
    }

    /// Number of views added.
    #[must_use]
    pub fn views(&self) -> u64 {
        self.views
    }

    /// Mean of each figure; PSNR is that of the mean squared difference, so that
    /// an equal view does not make it infinite. `None` without views.
    #[must_use]
    pub fn mean(&self) -> Option<ImageDifference> {
        let views = self.views as f64;
        (self.views > 0).then(|| ImageDifference {
            rmse: self.rmse / views,
            psnr: rmse::decibels(self.squared / views),
            ssim: self.ssim / views,
            flip: self.flip / views,
        })
    }
}
