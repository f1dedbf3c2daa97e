//! Turns triangles over until neighbours agree.

use super::Repaired;
use crate::mesh::edges::{Corners, EdgeTable, TriangleCorners};

const NONE: u32 = u32::MAX;

impl Repaired {
    /// Every part that hangs together by edges of two triangles gets the
    /// orientation of the majority of its triangles; of its first in a tie.
    pub(super) fn orient(&mut self) {
        let triangles = self.ids.triangles(&self.mesh.triangles);
        let across = across(&triangles, self.ids.count);
        let mut flip = vec![None; triangles.len()];
        for t in 0..triangles.len() as u32 {
            if flip[t as usize].is_none() {
                let part = spread(t, &triangles, &across, &mut flip);
                let flipped = |t: &&u32| flip[**t as usize] == Some(true);
                if part.iter().filter(flipped).count() * 2 > part.len() {
                    let turn = |t: &u32| flip[*t as usize] = flip[*t as usize].map(|f| !f);
                    part.iter().for_each(turn);
                }
            }
        }
        let to_flip = self.mesh.triangles.iter_mut().zip(&flip);
        for (triangle, _) in to_flip.filter(|(_, flip)| **flip == Some(true)) {
            triangle.swap(1, 2);
            self.counts.flipped += 1;
        }
    }
}

/// For every corner the one that starts the same edge in the only other
/// triangle there.
fn across(triangles: &[[u32; 3]], positions: usize) -> Vec<u32> {
    let mut across = vec![NONE; triangles.len() * 3];
    for edge in EdgeTable::new(&TriangleCorners(triangles), positions).iter() {
        if let [c, d] = *edge {
            across[c as usize] = d;
            across[d as usize] = c;
        }
    }
    across
}

/// Decides for the part of triangle `start`, which stays as it is; returns the
/// part's triangles.
fn spread(
    start: u32,
    triangles: &[[u32; 3]],
    across: &[u32],
    flip: &mut [Option<bool>],
) -> Vec<u32> {
    let corners = TriangleCorners(triangles);
    flip[start as usize] = Some(false);
    let mut part = vec![start];
    let mut done = 0;
    while let Some(&t) = part.get(done) {
        done += 1;
        for c in [3 * t, 3 * t + 1, 3 * t + 2] {
            let d = across[c as usize];
            if d == NONE || flip[d as usize / 3].is_some() {
                continue;
            }
            let same_way = corners.vertex(c) == corners.vertex(d);
            flip[d as usize / 3] = flip[t as usize].map(|f| f != same_way);
            part.push(d / 3);
        }
    }
    part
}
