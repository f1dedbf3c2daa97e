//! Vertex pairs: points that are near each other without sharing an edge
//! (Garland & Heckbert 1997, 4).

use super::surface::{Marks, Surface};
use glam::DVec3;
use smallvec::SmallVec;

/// Pairs a point may have; more are noise at the caller's distance.
const MOST: usize = 12;

/// For every point, the points it may be joined with.
#[derive(Debug, Clone)]
pub(crate) struct Pairs(Vec<SmallVec<[u32; 2]>>);

impl Pairs {
    /// All points nearer than `distance` that share no triangle, the nearest
    /// few of each point.
    pub fn near(surface: &Surface, distance: f64) -> Self {
        let n = surface.position.len();
        let grid = Grid::of(&surface.position, distance);
        let mut lists = vec![SmallVec::new(); n];
        let (mut marks, mut ring) = (Marks::new(n), Vec::new());
        for p in 0..n as u32 {
            surface.neighbours(p, &mut marks, &mut ring);
            let mut found: Vec<(f64, u32)> = grid
                .around(p)
                .filter(|&q| !marks.has(q) && surface.corners(q).next().is_some())
                .map(|q| {
                    (
                        surface.position[p as usize].distance(surface.position[q as usize]),
                        q,
                    )
                })
                .filter(|&(d, _)| d <= distance)
                .take(64 * MOST)
                .collect();
            found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            lists[p as usize].extend(found.iter().take(MOST).map(|f| f.1));
        }
        let mut pairs = Self(lists);
        pairs.make_mutual();
        pairs
    }

    fn make_mutual(&mut self) {
        for p in 0..self.0.len() {
            for q in self.0[p].clone() {
                let other = &mut self.0[q as usize];
                if !other.contains(&(p as u32)) {
                    other.push(p as u32);
                }
            }
        }
    }

    /// Partners of `p`.
    pub fn of(&self, p: u32) -> &[u32] {
        &self.0[p as usize]
    }

    /// After `removed` was joined into `kept`.
    pub fn merge(&mut self, kept: u32, removed: u32) {
        let gone = std::mem::take(&mut self.0[removed as usize]);
        for q in gone {
            let list = &mut self.0[q as usize];
            list.retain(|p| *p != removed && *p != kept);
            if q != kept {
                list.push(kept);
                if !self.0[kept as usize].contains(&q) {
                    self.0[kept as usize].push(q);
                }
            }
        }
        self.0[kept as usize].retain(|p| *p != removed && *p != kept);
    }
}

/// Points sorted by the cell of a uniform grid they lie in.
struct Grid {
    cells: Vec<([i64; 3], u32)>,
    cell_of: Vec<[i64; 3]>,
}

impl Grid {
    fn of(points: &[DVec3], size: f64) -> Self {
        let cell = |p: &DVec3| (*p / size).floor().to_array().map(|x| x as i64);
        let cell_of: Vec<[i64; 3]> = points.iter().map(cell).collect();
        let mut cells: Vec<([i64; 3], u32)> = cell_of.iter().copied().zip(0..).collect();
        cells.sort_unstable();
        Self { cells, cell_of }
    }

    /// All points in the cell of `p` and those around it.
    fn around(&self, p: u32) -> impl Iterator<Item = u32> + '_ {
        let [x, y, z] = self.cell_of[p as usize];
        (0..27).flat_map(move |i| {
            let shifted = |c: i64, by: i64| c.saturating_add(by - 1);
            let cell = [shifted(x, i % 3), shifted(y, i / 3 % 3), shifted(z, i / 9)];
            let first = self.cells.partition_point(|c| c.0 < cell);
            self.cells[first..]
                .iter()
                .take_while(move |c| c.0 == cell)
                .map(|c| c.1)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_triangles(gap: f64) -> Surface {
        let p = |x: f64| DVec3::new(x, 0.0, 0.0);
        let mut places = vec![p(0.0), p(-1.0), DVec3::new(-1.0, 1.0, 0.0)];
        places.extend([p(gap), p(gap + 1.0), DVec3::new(gap + 1.0, 1.0, 0.0)]);
        let triangles = vec![[0, 1, 2], [3, 4, 5]];
        Surface::new(places, triangles.clone(), triangles)
    }

    #[test]
    fn near_points_of_two_parts_are_a_pair() {
        let pairs = Pairs::near(&two_triangles(0.1), 0.2);
        assert_eq!(pairs.of(0), [3]);
        assert_eq!(pairs.of(3), [0]);
        assert!(pairs.of(1).is_empty());
        assert!(Pairs::near(&two_triangles(0.3), 0.2).of(0).is_empty());
    }

    #[test]
    fn merging_hands_pairs_on() {
        let mut pairs = Pairs(vec![
            SmallVec::from_slice(&[1, 2]),
            SmallVec::from_slice(&[0]),
            SmallVec::from_slice(&[0]),
        ]);
        pairs.merge(1, 0);
        assert_eq!(pairs.of(1), [2]);
        assert_eq!(pairs.of(2), [1]);
        assert!(pairs.of(0).is_empty());
    }
}
