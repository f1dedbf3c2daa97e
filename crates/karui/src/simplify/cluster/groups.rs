//! What hangs together within a cell.

use crate::mesh::{PositionIds, TriMesh};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// Vertices in wedges, wedges in points.
pub(super) struct Groups {
    /// Wedge of every vertex: the vertices that edges within one cell join.
    /// All of a wedge is one piece of one UV chart.
    pub wedge_of: Vec<u32>,
    /// Number of wedges.
    pub wedges: usize,
    /// Point of every vertex: wedges that share a position are one point.
    pub point_of: Vec<u32>,
    /// Number of points.
    pub points: usize,
    /// The first vertex of every point.
    pub first_vertex: Vec<u32>,
}

impl Groups {
    /// Groups the vertices of `mesh`, whose cells have these keys.
    pub fn of(mesh: &TriMesh, ids: &PositionIds, keys: &[u64]) -> Self {
        let sets = Sets::new(mesh.positions.len());
        mesh.triangles.par_chunks(CHUNK).for_each(|chunk| {
            chunk.iter().for_each(|&t| sets.join_within(t, keys));
        });
        let (wedge_of, first_of_wedge) = sets.numbered();
        if ids.count == mesh.positions.len() {
            return Self {
                wedges: first_of_wedge.len(),
                point_of: wedge_of.clone(),
                points: first_of_wedge.len(),
                first_vertex: first_of_wedge,
                wedge_of,
            };
        }
        let first = ids.first_vertices();
        let positions = ids.of_vertex.par_iter().map(|&id| first[id as usize]);
        positions.enumerate().for_each(|(v, f)| {
            sets.join(v as u32, f);
        });
        let (point_of, first_vertex) = sets.numbered();
        Self {
            wedges: first_of_wedge.len(),
            wedge_of,
            points: first_vertex.len(),
            point_of,
            first_vertex,
        }
    }
}

/// Triangles a task takes.
const CHUNK: usize = 1 << 14;

/// Union-find for many threads at once: links go from greater to lesser
/// numbers only, so the sets, each named by its least member, do not depend on
/// the order of the unions (R. Anderson, H. Woll: Wait-free parallel
/// algorithms for the union-find problem, STOC 1991).
struct Sets(Vec<AtomicU32>);

impl Sets {
    fn new(count: usize) -> Self {
        Self((0..count as u32).map(AtomicU32::new).collect())
    }

    fn parent(&self, x: u32) -> u32 {
        self.0[x as usize].load(Relaxed)
    }

    fn find(&self, mut x: u32) -> u32 {
        let mut parent = self.parent(x);
        while parent != x {
            let grandparent = self.parent(parent);
            if grandparent != parent {
                // Whatever another thread has written meanwhile is an ancestor
                // as well; so is this.
                self.0[x as usize].store(grandparent, Relaxed);
            }
            (x, parent) = (parent, grandparent);
        }
        x
    }

    fn join(&self, a: u32, b: u32) {
        let (mut x, mut y) = (a, b);
        loop {
            (x, y) = (self.find(x), self.find(y));
            if x == y {
                return;
            }
            let (least, greatest) = (x.min(y), x.max(y));
            let root = &self.0[greatest as usize];
            if root
                .compare_exchange(greatest, least, Relaxed, Relaxed)
                .is_ok()
            {
                return;
            }
        }
    }

    /// Joins the corners of a triangle that lie in one cell.
    fn join_within(&self, [a, b, c]: [u32; 3], keys: &[u64]) {
        // Most have been joined already, as corners of other triangles.
        let [p, q, r] = [a, b, c].map(|v| self.parent(v));
        if p == q && q == r {
            return;
        }
        let [x, y, z] = [a, b, c].map(|v| keys[v as usize]);
        if x == y && p != q {
            self.join(a, b);
        }
        if y == z && q != r {
            self.join(b, c);
        }
        if z == x && x != y && r != p {
            self.join(c, a);
        }
    }

    /// Sets numbered by their least members: number of every element, and the
    /// least member of every set.
    fn numbered(&self) -> (Vec<u32>, Vec<u32>) {
        let mut number = Vec::with_capacity(self.0.len());
        let mut least = Vec::new();
        for v in 0..self.0.len() as u32 {
            let parent = self.parent(v);
            if parent == v {
                number.push(least.len() as u32);
                least.push(v);
            } else {
                number.push(number[parent as usize]);
            }
        }
        (number, least)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_do_not_depend_on_threads() {
        let pairs: Vec<[u32; 2]> = (0..20_000u32)
            .map(|i| [i, i.wrapping_mul(2_654_435_761) % 997 * 20 + i % 20])
            .collect();
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            pool.build().unwrap().install(|| {
                let sets = Sets::new(20_000);
                pairs.par_iter().for_each(|&[a, b]| sets.join(a, b));
                sets.numbered()
            })
        };
        let one = run(1);
        assert!(one.1.len() > 1 && one.1.len() < 20_000);
        assert_eq!(one, run(8));
    }
}
