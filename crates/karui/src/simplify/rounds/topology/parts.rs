//! Parts that have become too small to be worth their triangles.

use super::Limits;
use crate::geom::Aabb;
use crate::mesh::DisjointSets;
use crate::simplify::rounds::level::Level;

/// A connected part.
#[derive(Debug, Clone, Copy)]
struct Part {
    triangles: usize,
    /// Of the input's surface that it stands for.
    area: f32,
    /// The same, by weight.
    worth: f32,
    bounds: Aabb,
    locked: bool,
}

impl Level<'_> {
    /// Removes parts, cheapest first, never the last; returns how many.
    pub(super) fn let_go(&mut self, limits: &Limits) -> usize {
        let (part_of, parts) = self.parts(limits);
        let largest = (0..parts.len()).max_by(|&a, &b| parts[a].area.total_cmp(&parts[b].area));
        let price = |part: &Part| {
            let size = part.bounds.diagonal() as f32;
            (2.0 * part.worth / part.triangles as f32, size)
        };
        let mut cheap: Vec<(f32, usize)> = Vec::new();
        for (i, part) in parts.iter().enumerate() {
            let (area, size) = price(part);
            if !part.locked && Some(i) != largest && limits.allow(area, size) {
                cheap.push((area * size * size, i));
            }
        }
        cheap.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut left = self.triangle.len();
        let mut gone = vec![false; parts.len()];
        let mut count = 0;
        for (_, i) in cheap {
            if left < limits.triangles + parts[i].triangles {
                break;
            }
            left -= parts[i].triangles;
            gone[i] = true;
            count += 1;
        }
        if count > 0 {
            let first: Vec<u32> = self.triangle.iter().map(|points| points[0]).collect();
            self.retain(|t| !gone[part_of[first[t] as usize] as usize]);
        }
        count
    }

    /// The part of every point, and the parts, by first appearance.
    fn parts(&self, limits: &Limits) -> (Vec<u32>, Vec<Part>) {
        const NONE: u32 = u32::MAX;
        let count = self.position.len();
        let mut sets = DisjointSets::new(count);
        for &[a, b, c] in self.triangle.iter() {
            sets.unite(a, b);
            sets.unite(a, c);
        }
        let mut parts: Vec<Part> = Vec::new();
        let mut part_of = vec![NONE; count];
        let mut used = vec![false; count];
        for points in self.triangle.iter() {
            let root = sets.find(points[0]) as usize;
            if part_of[root] == NONE {
                part_of[root] = parts.len() as u32;
                parts.push(Part {
                    triangles: 0,
                    area: 0.0,
                    worth: 0.0,
                    bounds: Aabb::EMPTY,
                    locked: false,
                });
            }
            let part = &mut parts[part_of[root] as usize];
            part.triangles += 1;
            for &p in points {
                if !std::mem::replace(&mut used[p as usize], true) {
                    let area = self.memory[p as usize].area() as f32;
                    part.area += area;
                    let own = self.weight.get(p as usize).copied().unwrap_or(1.0);
                    part.worth += area * own.max(limits.weights.mean);
                    part.bounds = part.bounds.with(self.place(p));
                    part.locked |= self.is_locked(p);
                }
            }
        }
        for p in 0..count {
            part_of[p] = part_of[sets.find(p as u32) as usize];
        }
        (part_of, parts)
    }
}
