//! A cage refined: connectivity once, values as often as wanted.

use super::cage::Cage;
use super::face_varying::Charts;
use super::level::Level;
use super::masks;
use super::options::{FaceVaryingRule, Scheme, SubdivOptions};
use super::split::Kind;
use crate::error::Result;

/// Connectivity of all levels of a cage.
#[derive(Debug, Clone)]
pub struct Refinement {
    kind: Kind,
    /// The cage first.
    levels: Vec<Level>,
    charts: Option<Charts>,
}

impl Refinement {
    /// Refines the connectivity of `cage`.
    ///
    /// # Errors
    /// As [`Cage::validate`]; [`Error::TooFine`] if there would be more faces than
    /// `options.max_faces`.
    pub fn new(cage: &Cage, options: &SubdivOptions) -> Result<Self> {
        let kind=Kind{triangles: options.scheme==Scheme::Loop, linear: options.scheme==Scheme::Bilinear};
        Ok(Self::of_level(Level::of_cage(cage, options)?, kind, options.levels))
    }

    fn of_level(base: Level, kind: Kind, levels_: u32) -> Self {
        let mut levels = vec![base];
        for _ in 0..levels_ {
            let last = &levels[levels.len() - 1];
            levels.push(last.refined(kind, true));
        }
        Self { kind, levels, charts: None }
    }

    /// Refinement of values by corner
    pub fn face_varying(&self, indices: &[u32], count: usize, options: &SubdivOptions) -> Result<Self> {
        let charts = Charts::new(&self.levels[0], indices, count, options)?;
        let mut kind = self.kind;
        kind.linear |= options.face_varying == FaceVaryingRule::All;
        let mut fine = Self::of_level(charts.level.clone(), kind, self.levels.len() as u32 - 1);
        fine.charts = Some(charts);
        Ok(fine)
    }

    /// levels
    pub fn levels(&self) -> &[Level] {
        &self.levels
    }

    /// values
    pub fn evaluate<const N: usize>(&self, values: &[[f32; N]]) -> Result<Vec<[f32; N]>> {
        let mut from = match &self.charts { Some(c) => c.value.iter().map(|&v| values[v as usize]).collect(), None=> values.to_vec()};
        for pair in self.levels.windows(2) {
            let mut to = vec![[0.0; N]; pair[1].vertices];
            masks::step(&pair[0], self.kind, &from, &mut to);
            from = to;
        }
        Ok(from)
    }
}
