//! The rising threshold by which a tree gets its levels.

use super::object::Object;
use crate::error::{Error, Result};

/// Values of `Omega_t` while a tree is built: what merges at one of them forms
/// one group.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Thresholds {
    /// From `first` by `step` to `last`, as in the paper. What is not below `last`
    /// stays apart: the tree may have many roots.
    Arithmetic {
        /// Least threshold, above 0.
        first: f64,
        /// Greatest threshold.
        last: f64,
        /// Difference between two, above 0.
        step: f64,
    },
    /// Each `ratio` times the one before, until everything is one group.
    Geometric {
        /// Least threshold, above 0; `None` is a 16th of the objects' median
        /// diagonal, seen from the reference distance.
        first: Option<f64>,
        /// At least 1.01.
        ratio: f64,
    },
}

impl Default for Thresholds {
    /// Doubled until everything is one group.
    fn default() -> Self {
        Self::Geometric {
            first: None,
            ratio: 2.0,
        }
    }
}

impl Thresholds {
    /// The thresholds of the paper: from 0.001 to 0.1 by 0.001.
    #[must_use]
    pub fn kato1998() -> Self {
        Self::Arithmetic {
            first: 0.001,
            last: 0.1,
            step: 0.001,
        }
    }

    /// # Errors
    /// [`Error::BadOption`] for what does not rise.
    pub(super) fn resolved(&self, objects: &[Object], distance: f64) -> Result<Steps> {
        let bad = |option, found: f64, expected| {
            let found = found.to_string();
            Err(Error::BadOption {
                option,
                found,
                expected,
            })
        };
        let positive = |x: f64| x > 0.0 && x.is_finite();
        match *self {
            Self::Arithmetic { first, .. } if !positive(first) => {
                bad("thresholds.first", first, "above 0")
            }
            Self::Arithmetic { step, .. } if !positive(step) => {
                bad("thresholds.step", step, "above 0")
            }
            Self::Arithmetic { first, last, step } => {
                let count = ((last - first) / step + 1e-9).floor();
                if !(0.0..=1e9).contains(&count) {
                    let expected = "no less than the first, within 1e9 steps";
                    return bad("thresholds.last", last, expected);
                }
                let last = Some(count as u32);
                Ok(Steps {
                    first,
                    by: By::Difference(step),
                    last,
                })
            }
            Self::Geometric { ratio, .. } if !(1.01..=1e6).contains(&ratio) => {
                bad("thresholds.ratio", ratio, "between 1.01 and 1e6")
            }
            Self::Geometric { first, ratio } => {
                let first = first.unwrap_or_else(|| default_first(objects, distance));
                if !positive(first) || first < 1e-60 {
                    return bad("thresholds.first", first, "at least 1e-60");
                }
                let by = By::Ratio(ratio);
                Ok(Steps {
                    first,
                    by,
                    last: None,
                })
            }
        }
    }
}

fn default_first(objects: &[Object], distance: f64) -> f64 {
    let mut diagonals: Vec<f64> = objects.iter().map(|o| o.bounds.diagonal()).collect();
    let middle = diagonals.len() / 2;
    if diagonals.is_empty() {
        return 1.0;
    }
    let (_, median, _) = diagonals.select_nth_unstable_by(middle, f64::total_cmp);
    let first = *median / 16.0 / distance;
    // Points have no size.
    if first > 1e-60 { first } else { 1e-6 }
}

/// Thresholds as numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Steps {
    first: f64,
    by: By,
    /// Number of the last one; there is none for a series without end.
    last: Option<u32>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum By {
    Difference(f64),
    Ratio(f64),
}

/// The threshold where the tree is being built.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rising {
    steps: Steps,
    number: u32,
    value: f64,
}

impl Steps {
    pub fn rising(self) -> Rising {
        Rising {
            steps: self,
            number: 0,
            value: self.first,
        }
    }

    /// What everything merged is below; `None` if all merges.
    pub fn limit(&self) -> Option<f64> {
        match (self.last, self.by) {
            (Some(last), By::Difference(step)) => Some(self.first + f64::from(last) * step),
            _ => None,
        }
    }
}

impl Rising {
    /// Rises until `omega` is below and tells the number of the threshold; `None`
    /// if it is below none.
    pub fn until_above(&mut self, omega: f64) -> Option<u32> {
        while omega >= self.value {
            if self.steps.last.is_some_and(|last| self.number >= last) {
                return None;
            }
            self.number += 1;
            self.value = match self.steps.by {
                By::Difference(step) => self.steps.first + f64::from(self.number) * step,
                By::Ratio(ratio) => self.value * ratio,
            };
        }
        Some(self.number)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_papers_are_a_hundred() {
        let steps = Thresholds::kato1998().resolved(&[], 5000.0).unwrap();
        let mut rising = steps.rising();
        assert_eq!(rising.until_above(0.0), Some(0));
        assert_eq!(rising.until_above(0.0015), Some(1));
        assert_eq!(rising.until_above(0.0005), Some(1), "it never falls");
        assert_eq!(rising.until_above(0.0999), Some(99));
        assert_eq!(rising.until_above(0.1001), None);
        assert!((steps.limit().unwrap() - 0.1).abs() < 1e-12);
    }

    #[test]
    fn a_geometric_series_has_no_end() {
        let steps = Thresholds::Geometric {
            first: Some(1.0),
            ratio: 2.0,
        };
        let mut rising = steps.resolved(&[], 1.0).unwrap().rising();
        assert_eq!(rising.until_above(1.0), Some(1));
        assert_eq!(rising.until_above(1023.0), Some(10));
        assert!(rising.until_above(1e90).is_some());
    }

    #[test]
    fn what_does_not_rise_is_refused() {
        for bad in [
            Thresholds::Geometric {
                first: Some(1.0),
                ratio: 1.0,
            },
            Thresholds::Geometric {
                first: Some(f64::NAN),
                ratio: 2.0,
            },
            Thresholds::Arithmetic {
                first: 1.0,
                last: 0.5,
                step: 0.1,
            },
            Thresholds::Arithmetic {
                first: 0.1,
                last: 0.5,
                step: 0.0,
            },
        ] {
            assert!(bad.resolved(&[], 1.0).is_err(), "{bad:?}");
        }
    }
}
