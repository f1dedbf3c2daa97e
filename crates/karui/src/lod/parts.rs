//! One progress made of many that run at the same time.

use crate::progress::Progress;
use std::sync::{Mutex, PoisonError};

/// Sums up the progress of parts of known weight.
pub(super) struct Parts<'a> {
    whole: &'a dyn Progress,
    stage: &'static str,
    weights: Vec<f32>,
    done: Mutex<Vec<f32>>,
}

/// One of the parts, as its work sees it.
pub(super) struct Part<'a> {
    parts: &'a Parts<'a>,
    index: usize,
}

impl<'a> Parts<'a> {
    pub fn new(whole: &'a dyn Progress, stage: &'static str, weights: Vec<f32>) -> Self {
        let done = Mutex::new(vec![0.0; weights.len()]);
        Self {
            whole,
            stage,
            weights,
            done,
        }
    }

    pub fn part(&'a self, index: usize) -> Part<'a> {
        Part { parts: self, index }
    }

    fn set(&self, index: usize, fraction: f32) {
        // Held while reporting, so that what is reported grows.
        let mut done = self.done.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(part) = done.get_mut(index) {
            *part = part.max(fraction.clamp(0.0, 1.0));
        }
        let sum: f32 = done.iter().zip(&self.weights).map(|(d, w)| d * w).sum();
        let total: f32 = self.weights.iter().sum();
        self.whole.report(self.stage, (sum / total).clamp(0.0, 1.0));
    }
}

impl Progress for Part<'_> {
    fn report(&self, _: &'static str, fraction: f32) {
        self.parts.set(self.index, fraction);
    }

    fn cancelled(&self) -> bool {
        self.parts.whole.cancelled()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Default)]
    struct Log(Mutex<Vec<f32>>);

    impl Progress for Log {
        fn report(&self, stage: &'static str, fraction: f32) {
            assert_eq!(stage, "levels");
            self.0.lock().unwrap().push(fraction);
        }
    }

    #[test]
    fn the_sum_only_grows() {
        let log = Log::default();
        let parts = Parts::new(&log, "levels", vec![1.0, 3.0]);
        parts.part(0).report("simplify", 0.5);
        parts.part(1).report("simplify", 0.5);
        parts.part(0).report("measuring", 0.0);
        parts.part(0).report("measuring", 1.0);
        assert_eq!(*log.0.lock().unwrap(), [0.125, 0.5, 0.5, 0.625]);
    }
}
