//! Cells of the tree: cubes, and the ranges of keys that they are.

use super::super::manifest::Row;

/// Cells are halved so many times at most.
pub(super) const DEEPEST: u32 = 20;
/// Bits of the keys in the cube around the model, which is an eighth of what keys reach.
const ROOT_BITS: u32 = 60;

/// A cell of the tree.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Cell {
    /// Times that the root was halved.
    pub depth: u32,
    /// Its first key.
    pub first: u64,
}

impl Cell {
    pub const ROOT: Self = Self { depth: 0, first: 0 };

    fn bits(self) -> u32 {
        ROOT_BITS - 3 * self.depth
    }

    /// One past its last key.
    pub fn end(self) -> u64 {
        self.first + (1 << self.bits())
    }

    /// The cell that a row is about.
    pub fn of(row: &Row) -> Self {
        let keys = row.end.saturating_sub(row.first).max(1);
        Self {
            depth: ROOT_BITS.saturating_sub(keys.ilog2()) / 3,
            first: row.first,
        }
    }

    /// The cell of twice its size around it; of the root, itself.
    pub fn parent(self) -> Self {
        if self.depth == 0 {
            return self;
        }
        let above = Self {
            depth: self.depth - 1,
            first: 0,
        };
        let first = self.first >> above.bits() << above.bits();
        Self { first, ..above }
    }

    pub fn children(self) -> [Self; 8] {
        let size = 1 << (self.bits() - 3);
        std::array::from_fn(|i| Self {
            depth: self.depth + 1,
            first: self.first + i as u64 * size,
        })
    }

    /// Its place among cells of its depth along x, y and z.
    pub fn place(self) -> [u32; 3] {
        let morton = self.first >> self.bits();
        std::array::from_fn(|axis| {
            let bit = |d: u32| (morton >> (3 * d + 2 - axis as u32) & 1) << d;
            (0..self.depth).map(bit).sum::<u64>() as u32
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn children_fill_their_parent(path in prop::collection::vec(0usize..8, 0..20)) {
            let cell = path.iter().fold(Cell::ROOT, |cell, &i| cell.children()[i]);
            let children = cell.children();
            prop_assert_eq!(children[0].first, cell.first);
            prop_assert_eq!(children[7].end(), cell.end());
            for (i, child) in children.into_iter().enumerate() {
                prop_assert_eq!(child.parent(), cell);
                let row = Row { first: child.first, end: child.end(), ..Row::default() };
                prop_assert_eq!(Cell::of(&row), child);
                let expected = [i >> 2 & 1, i >> 1 & 1, i & 1];
                let at = std::array::from_fn(|axis| 2 * cell.place()[axis] + expected[axis] as u32);
                prop_assert_eq!(child.place(), at);
            }
        }
    }
}
