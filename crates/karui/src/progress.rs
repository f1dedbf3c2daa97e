//! How long work tells what it is doing, and is told to stop.

use crate::error::{Error, Result};

/// Observer of long work. Called from the thread that drives the work, at
/// least every few hundred milliseconds.
pub trait Progress: Sync {
    /// `stage` is a short lower-case name, `fraction` lies in `0..=1` and
    /// grows within one stage.
    fn report(&self, stage: &'static str, fraction: f32);

    /// Polled regularly; `true` ends the work with [`Error::Cancelled`].
    fn cancelled(&self) -> bool {
        false
    }
}

/// The observer that neither shows nor stops anything.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Progress for Silent {
    fn report(&self, _: &'static str, _: f32) {}
}

/// A part of longer work: what it tells is told of one stage of the whole, between two
/// fractions.
#[derive(Clone, Copy)]
pub struct Share<'a> {
    /// Observer of the whole.
    pub whole: &'a dyn Progress,
    /// Stage of the whole.
    pub stage: &'static str,
    /// Fraction of the stage at which the part begins.
    pub from: f32,
    /// Fraction at which it ends.
    pub to: f32,
}

impl Progress for Share<'_> {
    fn report(&self, _: &'static str, fraction: f32) {
        let along = fraction.clamp(0.0, 1.0);
        let told = self.from + along * (self.to - self.from);
        self.whole.report(self.stage, told);
    }

    fn cancelled(&self) -> bool {
        self.whole.cancelled()
    }
}

/// Reports and turns a wish to stop into an error, for use with `?`.
///
/// # Errors
/// [`Error::Cancelled`] if the observer asked to stop.
pub fn step(progress: &dyn Progress, stage: &'static str, fraction: f32) -> Result<()> {
    progress.report(stage, fraction);
    if progress.cancelled() {
        return Err(Error::Cancelled);
    }
    Ok(())
}
