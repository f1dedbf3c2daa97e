//! Places as integers.

use crate::{geom::Aabb, spatial::morton};
use glam::Vec3;

/// Steps along an axis that is swept.
const STEPS: u32 = 1 << 16;
/// Bits of a Morton code that number the cells: 10 an axis.
const CELL_BITS: u32 = 30;
/// Bits of a Morton code.
const MORTON_BITS: u32 = 63;

/// How a box is divided.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Division {
    /// Into 65,536 slabs across this axis (0 is x).
    Axis(u8),
    /// Into cubes whose side is a 1024th of the longest, in Morton order.
    Cells,
}

/// A box divided so finely that regions can be told by numbers of slabs or cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// The model's box.
    pub bounds: Aabb,
    /// How it is divided.
    pub division: Division,
}

impl Grid {
    /// Slabs across the longest axis (step 4 of the paper), the first of equal ones.
    #[must_use]
    pub fn along_longest(bounds: Aabb) -> Self {
        let size = bounds.size();
        let longer = |a: u8, b: u8| {
            if size[b.into()] > size[a.into()] {
                b
            } else {
                a
            }
        };
        let division = Division::Axis(longer(longer(0, 1), 2));
        Self { bounds, division }
    }

    /// Cubes, for models that are not like terrain.
    #[must_use]
    pub fn cells(bounds: Aabb) -> Self {
        Self {
            bounds,
            division: Division::Cells,
        }
    }

    /// Number of the slab or cell at `position`, the nearest one if it is outside; 0 for
    /// what is not a number.
    #[must_use]
    pub fn code(&self, position: Vec3) -> u32 {
        match self.division {
            Division::Axis(axis) => self.slab(position, usize::from(axis.min(2))),
            Division::Cells => {
                (morton::code(position, self.bounds) >> (MORTON_BITS - CELL_BITS)) as u32
            }
        }
    }

    fn slab(&self, position: Vec3, axis: usize) -> u32 {
        let [low, high, at] =
            [self.bounds.min, self.bounds.max, position].map(|p| f64::from(p[axis]));
        // One of several divisions by zero is NaN, which becomes 0.
        let step = (at - low) / (high - low) * f64::from(STEPS);
        (step as u32).min(STEPS - 1)
    }
}
