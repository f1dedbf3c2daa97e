//! Implicit tiling: coordinates of cells, their volumes and the names of their
//! files (3D Tiles 1.1, "Implicit Tiling").

use super::{
    model::{Region, Scheme, Shape},
    solid::width,
};
use std::fmt;

/// A cell of an implicit tree.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Cell {
    /// Level; the root has 0 and every level halves the cells.
    pub level: u32,
    /// Number of the cell along x or east, below 2 to the power of the level.
    pub x: u32,
    /// Along y or north.
    pub y: u32,
    /// Along z or upwards; 0 in a quadtree.
    pub z: u32,
}

/// Levels that 32-bit coordinates can number.
pub(super) const MAX_LEVEL: u32 = 31;

impl Cell {
    /// The root of the tree.
    pub const ROOT: Self = Self {
        level: 0,
        x: 0,
        y: 0,
        z: 0,
    };

    /// The cell that holds this one, so many levels above it.
    #[must_use]
    pub fn ancestor(self, levels: u32) -> Self {
        let levels = levels.min(self.level);
        let up = |c: u32| c.checked_shr(levels).unwrap_or(0);
        Self {
            level: self.level - levels,
            x: up(self.x),
            y: up(self.y),
            z: up(self.z),
        }
    }

    /// The cell at `morton` in the level that lies `levels` below this one.
    pub(super) fn descendant(self, scheme: Scheme, levels: u32, morton: u64) -> Self {
        let mut low = [0u32; 3];
        for bit in 0..levels {
            for (d, coordinate) in low
                .iter_mut()
                .take(scheme.dimensions() as usize)
                .enumerate()
            {
                let from = bit * scheme.dimensions() + d as u32;
                *coordinate |= ((morton >> from & 1) as u32) << bit;
            }
        }
        let down = |c: u32, low: u32| c.checked_shl(levels).unwrap_or(0) | low;
        Self {
            level: self.level + levels,
            x: down(self.x, low[0]),
            y: down(self.y, low[1]),
            z: if scheme == Scheme::Octree {
                down(self.z, low[2])
            } else {
                0
            },
        }
    }

    /// Number of this cell in Morton order among those of its level below the
    /// ancestor so many levels above.
    pub(super) fn morton(self, scheme: Scheme, levels: u32) -> u64 {
        let coordinates = [self.x, self.y, self.z];
        let dimensions = scheme.dimensions();
        let mut number = 0;
        for bit in 0..levels.min(MAX_LEVEL) {
            for (d, c) in coordinates.iter().take(dimensions as usize).enumerate() {
                number |= u64::from(c >> bit & 1) << (bit * dimensions + d as u32);
            }
        }
        number
    }

    /// A template with the coordinates put in.
    #[must_use]
    pub fn fill(self, template: &str) -> String {
        let values = [
            ("{level}", self.level),
            ("{x}", self.x),
            ("{y}", self.y),
            ("{z}", self.z),
        ];
        values
            .iter()
            .fold(template.to_owned(), |text, (name, value)| {
                text.replace(name, &value.to_string())
            })
    }

    /// The part of the root's volume that is this cell's; `None` for spheres,
    /// which cannot be divided.
    #[must_use]
    pub fn volume(self, root: Shape, scheme: Scheme) -> Option<Shape> {
        let cells = (self.level as f64).exp2();
        let part = |c: u32| (f64::from(c) / cells, f64::from(c + 1) / cells);
        let third = match scheme {
            Scheme::Quadtree => (0.0, 1.0),
            Scheme::Octree => part(self.z),
        };
        let parts = [part(self.x), part(self.y), third];
        match root {
            Shape::Box { center, half_axes } => {
                let mut cell = (center, half_axes);
                for (axis, (from, to)) in parts.into_iter().enumerate() {
                    cell.0 += half_axes[axis] * (from + to - 1.0);
                    cell.1[axis] = half_axes[axis] * (to - from);
                }
                Some(Shape::Box {
                    center: cell.0,
                    half_axes: cell.1,
                })
            }
            Shape::Region(region) => Some(Shape::Region(sub_region(region, parts))),
            Shape::Sphere { .. } => None,
        }
    }
}

fn sub_region(root: Region, [x, y, z]: [(f64, f64); 3]) -> Region {
    let between =
        |from: f64, length: f64, (a, b): (f64, f64)| (from + length * a, from + length * b);
    let turn = |angle: f64| {
        if angle > std::f64::consts::PI {
            angle - std::f64::consts::TAU
        } else {
            angle
        }
    };
    let (west, east) = between(root.west, width(root), x);
    let (south, north) = between(root.south, root.north - root.south, y);
    let (min_height, max_height) = between(root.min_height, root.max_height - root.min_height, z);
    Region {
        west: turn(west),
        south,
        east: turn(east),
        north,
        min_height,
        max_height,
    }
}

impl fmt::Display for Cell {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "tile {}/{}/{}/{}", self.level, self.x, self.y, self.z)
    }
}

/// Cells of all levels above `level`: the place of the first cell of `level`
/// in a bitstream.
pub(super) fn offset(scheme: Scheme, level: u32) -> Option<u64> {
    let branches = 1u64 << scheme.dimensions();
    let mut cells = 0u64;
    let mut of_level = 1u64;
    for _ in 0..level {
        cells = cells.checked_add(of_level)?;
        of_level = of_level.checked_mul(branches)?;
    }
    Some(cells)
}

/// Cells of one level.
pub(super) fn cells(scheme: Scheme, level: u32) -> Option<u64> {
    1u64.checked_shl(scheme.dimensions().checked_mul(level)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn morton_numbers_of_the_specification() {
        // "For example, the Morton index of x = 3, y = 5": bits interleaved,
        // x in the lowest place.
        let cell = Cell {
            level: 3,
            x: 0b011,
            y: 0b101,
            z: 0,
        };
        assert_eq!(cell.morton(Scheme::Quadtree, 3), 0b100111);
        assert_eq!(Cell::ROOT.descendant(Scheme::Quadtree, 3, 0b100111), cell);
        let cell = Cell {
            level: 2,
            x: 1,
            y: 2,
            z: 3,
        };
        assert_eq!(cell.morton(Scheme::Octree, 2), 0b110_101);
        assert_eq!(Cell::ROOT.descendant(Scheme::Octree, 2, 0b110_101), cell);
        assert_eq!(offset(Scheme::Quadtree, 3), Some(1 + 4 + 16));
        assert_eq!(offset(Scheme::Octree, 2), Some(9));
        assert_eq!(offset(Scheme::Octree, 40), None);
    }

    #[test]
    fn cells_tile_their_parent() {
        let root = Shape::Box {
            center: DVec3::new(1.0, 2.0, 3.0),
            half_axes: [DVec3::X * 4.0, DVec3::Y * 2.0, DVec3::Z],
        };
        let cell = Cell {
            level: 1,
            x: 1,
            y: 0,
            z: 0,
        };
        let expected = Shape::Box {
            center: DVec3::new(3.0, 1.0, 3.0),
            half_axes: [DVec3::X * 2.0, DVec3::Y, DVec3::Z],
        };
        assert_eq!(cell.volume(root, Scheme::Quadtree), Some(expected));
        let cell = Cell {
            level: 2,
            x: 3,
            y: 0,
            z: 0,
        };
        assert_eq!(
            cell.ancestor(1),
            Cell {
                level: 1,
                x: 1,
                y: 0,
                z: 0
            }
        );
        assert_eq!(cell.fill("{level}/{x}_{y}.{z}"), "2/3_0.0");
    }

    #[test]
    fn regions_across_the_antimeridian_are_divided() {
        let root = Region {
            west: 3.0,
            east: -3.0,
            south: 0.0,
            north: 0.2,
            min_height: 0.0,
            max_height: 8.0,
        };
        let cell = Cell {
            level: 1,
            x: 1,
            y: 1,
            z: 1,
        };
        let Some(Shape::Region(found)) = cell.volume(Shape::Region(root), Scheme::Octree) else {
            panic!("a region");
        };
        assert!((found.east - -3.0).abs() < 1e-12 && (found.north - 0.2).abs() < 1e-12);
        assert!(
            (found.west.abs() - std::f64::consts::PI).abs() < 1e-9,
            "{found:?}"
        );
        assert_eq!((found.min_height, found.max_height), (4.0, 8.0));
    }
}
