//! What heat maps show.

use karui::saliency::Kind;
use std::str::FromStr;

/// A number at every vertex.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measured {
    /// How much it matters, 0 to 1.
    Saliency(Kind),
    /// Distance to the original, model units.
    Error,
}

impl FromStr for Measured {
    type Err = karui::Error;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        match name {
            "error" => Ok(Self::Error),
            _ => Ok(Self::Saliency(name.parse()?)),
        }
    }
}
