//! From saliency to the weight that simplification takes.

use super::quantile::quantile;
use crate::error::{Error, Result};

/// How a saliency between 0 and 1 becomes the factor of a collapse's cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum WeightMap {
    /// From `least` at saliency 0 in a straight line to `most` at 1. A `least` above 0
    /// keeps edges from being free.
    Linear {
        /// Weight of what is not salient; above 0.
        least: f32,
        /// Weight of what is most salient.
        most: f32,
    },
    /// As `Linear`, but along a power of the saliency: what is but half salient weighs
    /// little more than `least`, so that triangles go where it matters.
    Power {
        /// Weight of what is not salient; above 0.
        least: f32,
        /// Weight of what is most salient.
        most: f32,
        /// The exponent, 1 or more.
        power: u32,
    },
    /// `factor` times the saliency from a percentile on, the saliency itself below it
    /// (Lee, Varshney & Jacobs 2005, 5.1: 100 from the 30th percentile on), never under
    /// `least`.
    Amplified {
        /// Share of the vertices that are not amplified, 0 to 1.
        percentile: f32,
        /// Factor above it.
        factor: f32,
        /// Smallest weight; above 0.
        least: f32,
    },
}

impl Default for WeightMap {
    /// From 1 to 300 along the eighth power: of the maps tried (`karui bench saliency`) the one
    /// that brings the most salient fifth closest without pictures getting worse. An error falls
    /// with the third root of a weight only, and ranks in the middle must stay cheap.
    fn default() -> Self {
        Self::Power {
            least: 1.0,
            most: 300.0,
            power: 8,
        }
    }
}

impl WeightMap {
    /// Lee, Varshney & Jacobs 2005.
    pub const LEE2005: Self = Self::Amplified {
        percentile: 0.3,
        factor: 100.0,
        least: 1e-3,
    };

    /// One weight a vertex, for
    /// [`SimplifyOptions::weights`](crate::simplify::SimplifyOptions::weights).
    ///
    /// # Errors
    /// [`Error::NotFinite`] for a saliency that is no number; [`Error::BadOption`] for a
    /// weight that is not above 0 or a percentile out of range.
    pub fn weights(&self, saliency: &[f32]) -> Result<Vec<f32>> {
        self.check()?;
        if let Some(index) = saliency.iter().position(|s| !s.is_finite()) {
            let what = "saliency".into();
            return Err(Error::NotFinite { what, index });
        }
        let each = saliency.iter();
        Ok(match *self {
            Self::Linear { least, most } => each.map(|s| least + (most - least) * s).collect(),
            Self::Power { least, most, power } => {
                let raised = |s: &f32| (0..power).fold(1.0, |all, _| all * s);
                each.map(|s| least + (most - least) * raised(s)).collect()
            }
            Self::Amplified {
                percentile,
                factor,
                least,
            } => {
                let from = quantile(saliency, percentile);
                let amplified = |s: f32| if s > from { s * factor } else { s };
                each.map(|&s| amplified(s).max(least)).collect()
            }
        })
    }

    fn check(&self) -> Result<()> {
        let above_zero = |value: f32| value > 0.0 && value.is_finite();
        let (weights, percentile) = match *self {
            Self::Linear { least, most } | Self::Power { least, most, .. } => ([least, most], 0.0),
            Self::Amplified {
                percentile,
                factor,
                least,
            } => ([factor, least], percentile),
        };
        let bad = |option, value: f32, expected| {
            let found = value.to_string();
            Err(Error::BadOption {
                option,
                found,
                expected,
            })
        };
        let power = match *self {
            Self::Power { power, .. } => power,
            _ => 1,
        };
        match weights.into_iter().find(|w| !above_zero(*w)) {
            Some(weight) => bad("weight", weight, "above 0"),
            None if !(1..=64).contains(&power) => bad("power", power as f32, "1 to 64"),
            None if !(0.0..=1.0).contains(&percentile) => bad("percentile", percentile, "0 to 1"),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_keeps_the_middle_low() {
        let map = |power| WeightMap::Power {
            least: 1.0,
            most: 17.0,
            power,
        };
        assert_eq!(map(4).weights(&[0.0, 0.5, 1.0]), Ok(vec![1.0, 2.0, 17.0]));
        assert!(map(0).weights(&[0.5]).is_err() && map(65).weights(&[0.5]).is_err());
    }

    #[test]
    fn a_line_from_least_to_most() {
        let map = WeightMap::Linear {
            least: 1.0,
            most: 5.0,
        };
        assert_eq!(map.weights(&[0.0, 0.5, 1.0]), Ok(vec![1.0, 3.0, 5.0]));
    }

    #[test]
    fn lee_amplifies_above_the_percentile_and_nothing_is_free() {
        let saliency: Vec<f32> = (0..10).map(|i| i as f32 / 10.0).collect();
        let weights = WeightMap::LEE2005.weights(&saliency).unwrap();
        assert_eq!(weights[0], 1e-3);
        assert_eq!(weights[2], 0.2);
        assert!((weights[3] - 30.0).abs() < 1e-4);
    }

    #[test]
    fn bad_maps_and_values_are_told() {
        let free = WeightMap::Linear {
            least: 0.0,
            most: 1.0,
        };
        assert!(free.weights(&[0.5]).is_err());
        assert!(WeightMap::default().weights(&[f32::NAN]).is_err());
    }
}
