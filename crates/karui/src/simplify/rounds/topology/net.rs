//! Which triangles meet at which edges.

use rayon::prelude::*;

/// The mate of a border's half-edge.
pub(super) const BORDER: u32 = u32::MAX;
/// The mate of a half-edge of more than two triangles, or of two that are not
/// oriented alike.
pub(super) const ODD: u32 = u32::MAX - 1;

/// Triangles and, of every half-edge (three times the triangle, and the corner
/// where it begins), the one that runs the other way.
pub(super) struct Net {
    pub triangle: Vec<[u32; 3]>,
    pub mate: Vec<u32>,
}

impl Net {
    pub fn of(triangle: &[[u32; 3]]) -> Self {
        let side = |h: u32| {
            let [p, q] = ends(triangle, h);
            (u64::from(p.min(q)) << 32 | u64::from(p.max(q)), h)
        };
        let halves = 0..3 * triangle.len() as u32;
        let mut sides: Vec<(u64, u32)> = halves.into_par_iter().map(side).collect();
        sides.par_sort_unstable();
        let mut mate = vec![ODD; sides.len()];
        for edge in sides.chunk_by(|a, b| a.0 == b.0) {
            match *edge {
                [(_, h)] => mate[h as usize] = BORDER,
                [(_, h), (_, g)] if ends(triangle, h)[0] != ends(triangle, g)[0] => {
                    mate[h as usize] = g;
                    mate[g as usize] = h;
                }
                _ => {}
            }
        }
        Self {
            triangle: triangle.to_vec(),
            mate,
        }
    }

    /// Where a half-edge begins and ends.
    pub fn ends(&self, h: u32) -> [u32; 2] {
        ends(&self.triangle, h)
    }

    /// The mate of a half-edge that has one.
    pub fn mate(&self, h: u32) -> Option<u32> {
        let mate = self.mate[h as usize];
        (mate != BORDER && mate != ODD).then_some(mate)
    }

    /// Whether one of the triangles of an edge has this point besides.
    pub fn is_side(&self, h: u32, p: u32) -> bool {
        let third = |h: u32| self.ends(previous(h))[0];
        third(h) == p || self.mate(h).is_some_and(|mate| third(mate) == p)
    }
}

fn ends(triangle: &[[u32; 3]], h: u32) -> [u32; 2] {
    let points = triangle[h as usize / 3];
    [points[h as usize % 3], points[next(h) as usize % 3]]
}

/// The half-edge after this one in its triangle.
pub(super) fn next(h: u32) -> u32 {
    h - h % 3 + (h + 1) % 3
}

/// The half-edge before this one in its triangle.
pub(super) fn previous(h: u32) -> u32 {
    h - h % 3 + (h + 2) % 3
}
