//! Holes that have come down to three edges are closed with a triangle.

use super::Limits;
use super::net::{BORDER, Net};
use crate::simplify::rounds::level::Level;
use std::collections::HashMap;

impl Level<'_> {
    /// Closes holes of three edges; returns how many.
    pub(super) fn close_holes(&mut self, net: &Net, limits: &Limits) -> usize {
        if limits.lock_borders {
            return 0;
        }
        let borders = (0..net.mate.len() as u32).filter(|&h| net.mate[h as usize] == BORDER);
        // The one half-edge of a border that begins at a point.
        let mut out: HashMap<u32, Option<u32>> = HashMap::new();
        for h in borders.clone() {
            let known = out.entry(net.ends(h)[0]);
            known.and_modify(|one| *one = None).or_insert(Some(h));
        }
        let after = |h: u32| out.get(&net.ends(h)[1]).copied().flatten();
        let mut closed = 0;
        for h in borders {
            let Some(g) = after(h).filter(|&g| g > h) else {
                continue;
            };
            let Some(f) = after(g).filter(|&f| f > h && after(f) == Some(h)) else {
                continue;
            };
            let points = [h, g, f].map(|h| net.ends(h)[0]);
            let is_last = [h, g, f].iter().all(|i| i / 3 == h / 3);
            let (area, size) = self.extent(points, limits);
            let opposed = [h, g, f].iter().any(|&h| {
                net.triangle[h as usize / 3]
                    .iter()
                    .all(|p| points.contains(p))
            });
            if is_last || opposed || !limits.allow(area, size) {
                continue;
            }
            let [a, b, c] = points;
            let wedges = [(h, a), (f, c), (g, b)].map(|(h, p)| self.wedge_of(h / 3, p));
            self.add_triangle([a, c, b], h / 3, wedges);
            closed += 1;
        }
        closed
    }
}
