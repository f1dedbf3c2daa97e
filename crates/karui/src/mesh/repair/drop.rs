//! Drops triangles and vertices.

use super::{RepairOptions, Repaired};
use crate::geom;
use crate::mesh::edges::is_proper;
use rayon::prelude::*;

impl Repaired {
    pub(super) fn drop_triangles(&mut self, options: &RepairOptions) {
        let triangles = self.ids.triangles(&self.mesh.triangles);
        let mut keep = vec![true; triangles.len()];
        if options.drop_degenerate {
            self.counts.degenerate = drop_if(&mut keep, |t| !is_proper(triangles[t]));
        }
        if options.drop_zero_area {
            let is_flat = |t| is_proper(triangles[t]) && geom::area(self.mesh.corners(t)) == 0.0;
            self.counts.zero_area = drop_if(&mut keep, is_flat);
        }
        if options.drop_duplicates {
            let repeated = repeated(&triangles);
            self.counts.duplicates = drop_if(&mut keep, |t| repeated[t]);
        }
        self.mesh.retain_triangles(|t| keep[t]);
    }

    pub(super) fn drop_unreferenced(&mut self) {
        let before = self.mesh.positions.len();
        let kept = self.mesh.remove_unreferenced_vertices();
        self.counts.unreferenced = before - kept.len();
        let labels = kept
            .iter()
            .map(|&v| self.ids.of_vertex[v as usize] as usize);
        self.ids = super::split::numbered(labels, self.ids.count);
    }
}

/// Unsets `keep` where `drop` says so; returns how many it unset.
fn drop_if(keep: &mut [bool], drop: impl Fn(usize) -> bool) -> usize {
    let mut dropped = 0;
    for (t, keep) in keep.iter_mut().enumerate() {
        if *keep && drop(t) {
            *keep = false;
            dropped += 1;
        }
    }
    dropped
}

/// Which triangles have the corners of an earlier one in the same cyclic order.
fn repeated(triangles: &[[u32; 3]]) -> Vec<bool> {
    let least_first = |&[a, b, c]: &[u32; 3]| [[a, b, c], [b, c, a], [c, a, b]].into_iter().min();
    let keys: Vec<_> = triangles.par_iter().map(least_first).collect();
    let mut order: Vec<usize> = (0..keys.len()).collect();
    order.par_sort_unstable_by_key(|&t| (keys[t], t));
    let mut repeated = vec![false; keys.len()];
    for pair in order.windows(2) {
        repeated[pair[1]] = keys[pair[0]] == keys[pair[1]];
    }
    repeated
}
