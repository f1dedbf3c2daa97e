//! Faces of any size as triangles, when only the faces are in memory.

use crate::error::Result;
use karui::{PolyMesh, geom::Vec3};
use std::ops::Range;

/// Vertices that may lie unused between two that are read at once.
const GAP: u64 = 1024;
/// Vertices that are read at once at most.
const RUN: u64 = 65_536;

/// The triangles that [`PolyMesh::triangulate`] makes of faces. How one is best cut depends
/// on where its corners are, so `read` is asked for positions if a face has more than three.
///
/// `lengths` are the numbers of corners of the faces that `indices` name one after the
/// other.
pub(super) fn cut(
    indices: &[u64],
    lengths: &[usize],
    read: impl Fn(Range<u64>) -> Result<Vec<Vec3>>,
) -> Result<Vec<[u64; 3]>> {
    if lengths.iter().all(|&l| l == 3) {
        return Ok(indices.as_chunks::<3>().0.to_vec());
    }
    let mut used = indices.to_vec();
    used.sort_unstable();
    used.dedup();
    let mut local = PolyMesh::default();
    if lengths.iter().any(|&l| l > 3) {
        local.positions = positions(&used, read)?;
    }
    let place = |v: &u64| used.partition_point(|u| u < v) as u32;
    let mut rest = indices;
    for &length in lengths {
        let (face, others) = rest.split_at(length.min(rest.len()));
        local.push_face(&face.iter().map(place).collect::<Vec<_>>());
        rest = others;
    }
    let triangles = local.triangulate().triangles;
    let whole = |t: [u32; 3]| t.map(|v| used[v as usize]);
    Ok(triangles.into_iter().map(whole).collect())
}

/// Positions of vertices given in ascending order.
fn positions(used: &[u64], read: impl Fn(Range<u64>) -> Result<Vec<Vec3>>) -> Result<Vec<Vec3>> {
    let mut found = Vec::with_capacity(used.len());
    let mut rest = used;
    while let Some(&first) = rest.first() {
        let near = |w: &&[u64]| w[1] - w[0] <= GAP && w[1] - first < RUN;
        let together = 1 + rest.windows(2).take_while(near).count();
        let (run, others) = rest.split_at(together);
        let piece = read(first..run[run.len() - 1] + 1)?;
        found.extend(run.iter().filter_map(|&v| piece.get((v - first) as usize)));
        rest = others;
    }
    Ok(found)
}
