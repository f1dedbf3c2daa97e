//! The number that says where a triangle belongs: regions are ranges of keys.

use super::PlanOptions;
use crate::spatial::morton::spread;
use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

/// How regions are cut out of a model.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Scheme {
    /// Cubes halved along one axis after the other (a Morton curve): short borders.
    #[default]
    Cells,
    /// Slabs across the longest axis that are as much work each, as in the paper.
    Sweep,
    /// Slabs of as many triangles each, for comparison.
    Slabs,
}

/// From triangles to keys.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Keys {
    scheme: Scheme,
    /// Least corner of the model.
    min: [f64; 3],
    /// Longest side of the model's box, model units; above 0.
    side: f64,
    /// Longest axis.
    axis: usize,
    /// Where the box begins in a cube of side 1 in which it takes half.
    shift: f64,
}

/// Bits of a key.
pub(super) const BITS: u32 = 63;
/// Bits of an axis.
const AXIS_BITS: u32 = BITS / 3;

fn shift(level: u32) -> f64 {
    if level % 2 == 1 { 1.0 / 3.0 } else { 0.0 }
}

impl Keys {
    /// Keys of a level. Cuts at powers of two of odd levels lie a third of a cell from
    /// those of even ones, at any size: what lies on a border once is inside the next time.
    pub fn of(options: &PlanOptions, bounds: [[f32; 3]; 2], level: u32) -> Self {
        let [min, max] = bounds.map(|p| Vec3::from(p).as_dvec3());
        let size = max - min;
        let axis = (0..3).fold(0, |best, i| if size[i] > size[best] { i } else { best });
        Self {
            scheme: options.scheme,
            min: min.to_array(),
            side: if size[axis] > 0.0 { size[axis] } else { 1.0 },
            axis,
            shift: shift(level),
        }
    }

    /// The same with a box a little larger, so that nothing lies on its far sides.
    pub fn padded(self) -> Self {
        Self {
            side: self.side * (1.0 + 1e-6),
            ..self
        }
    }

    /// Least corner and side of the cube around the model.
    pub fn root(&self) -> (DVec3, f64) {
        (self.min.into(), self.side)
    }

    /// The faces between cells of a depth, for each axis, as far as 32 bits tell them apart.
    pub fn planes(&self, depth: u32) -> [Vec<f32>; 3] {
        std::array::from_fn(|axis| {
            let planes = (1..1u32 << depth).map(|i| self.plane(axis, i, depth));
            planes.collect()
        })
    }

    fn plane(&self, axis: usize, number: u32, depth: u32) -> f32 {
        let share = f64::from(number) / f64::from(1u32 << depth);
        (self.min[axis] + self.side * share) as f32
    }

    /// Corners of a cell.
    pub fn cube(&self, place: [u32; 3], depth: u32) -> [Vec3; 2] {
        let corner = |more: u32| {
            let at = |axis: usize| self.plane(axis, place[axis] + more, depth);
            Vec3::from(std::array::from_fn(at))
        };
        [corner(0), corner(1)]
    }

    /// The same for another level.
    pub fn at_level(&self, level: u32) -> Self {
        let shift = shift(level);
        Self { shift, ..*self }
    }

    /// Key of a triangle: that of its centre.
    pub fn key(&self, [a, b, c]: [Vec3; 3]) -> u64 {
        let center = (a.as_dvec3() + b.as_dvec3() + c.as_dvec3()) / 3.0;
        let place = (center - DVec3::from(self.min)) / (2.0 * self.side) + self.shift;
        let cells = (1u64 << AXIS_BITS) as f64;
        match self.scheme {
            Scheme::Cells => {
                // `as` takes what lies outside to the ends.
                let cell = (place * cells)
                    .to_array()
                    .map(|x| (x as u64).min((1 << AXIS_BITS) - 1));
                let [x, y, z] = cell.map(spread);
                x << 2 | y << 1 | z
            }
            Scheme::Sweep | Scheme::Slabs => {
                let steps = (1u64 << BITS) as f64;
                ((place[self.axis] * steps) as u64).min((1 << BITS) - 1)
            }
        }
    }
}
