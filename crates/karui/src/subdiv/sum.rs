//! Weighted sums of values of any number of components, in double precision: at a vertex
//! of ten thousand faces single precision would drift.

/// A sum of weighted values.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sum<const N: usize>([f64; N]);

impl<const N: usize> Sum<N> {
    pub const ZERO: Self = Self([0.0; N]);

    pub fn add(&mut self, weight: f64, value: &[f32; N]) {
        for (sum, &v) in self.0.iter_mut().zip(value) {
            *sum += weight * f64::from(v);
        }
    }

    pub fn add_sum(&mut self, weight: f64, other: Self) {
        for (sum, v) in self.0.iter_mut().zip(other.0) {
            *sum += weight * v;
        }
    }

    /// `self * share + other * (1 - share)`.
    pub fn mixed(self, other: Self, share: f32) -> Self {
        let share = f64::from(share);
        let mut sum = Self::ZERO;
        sum.add_sum(share, self);
        sum.add_sum(1.0 - share, other);
        sum
    }

    pub fn precise(self) -> [f64; N] {
        self.0
    }

    pub fn value(self) -> [f32; N] {
        self.0.map(|v| v as f32)
    }
}
