//! Triangles into clusters: connected where the surface is, compact, and as
//! full as their number allows.
//!
//! A piece of the surface is halved until it fits: a front sweeps over it from
//! triangle to triangle, along the direction in which the piece is longest,
//! until it has the half. What it has swept hangs together, and on a flat piece
//! the cut is straight. Where the whole mesh is to be split, planes cut it into
//! pieces small enough first.

use glam::{DMat3, DVec3, Vec3};
use rayon::prelude::*;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Clusters of a piece that is cut along the surface, not by planes.
const PIECE: usize = 32;
/// How often a sweep that leaves pockets behind is repeated.
const TRIES: usize = 4;
/// No neighbour.
const NONE: u32 = u32::MAX;

/// The triangles to be split.
pub(super) struct Surface<'a> {
    /// By vertex.
    pub triangles: &'a [[u32; 3]],
    /// By position id.
    pub linked: &'a [[u32; 3]],
    /// Middle of every triangle.
    pub middles: &'a [Vec3],
}

/// How large a cluster may be.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    pub triangles: usize,
    pub vertices: usize,
}

/// Splits these triangles of the surface; every cluster lists its own.
pub(super) fn split(surface: &Surface<'_>, mut chosen: Vec<u32>, limits: Limits) -> Vec<Vec<u32>> {
    let clusters = chosen.len().div_ceil(limits.triangles);
    let mut pieces = Vec::new();
    cut_by_planes(surface, &mut chosen, clusters, &mut pieces);
    let swept: Vec<_> = pieces
        .into_par_iter()
        .map(|(piece, clusters)| Piece::new(surface, piece, limits).into_clusters(clusters))
        .collect();
    swept.into_iter().flatten().collect()
}

/// Halves at the plane across the longest side of the box around the middles,
/// until few clusters are left to be made of a piece.
fn cut_by_planes<'a>(
    surface: &Surface<'_>,
    chosen: &'a mut [u32],
    clusters: usize,
    pieces: &mut Vec<(&'a [u32], usize)>,
) {
    if clusters <= PIECE {
        pieces.push((chosen, clusters));
        return;
    }
    let middle = |t: u32| surface.middles[t as usize];
    let grow = |(lo, hi): (Vec3, Vec3), &t: &u32| (lo.min(middle(t)), hi.max(middle(t)));
    let (lo, hi) = chosen
        .iter()
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), grow);
    let size = (hi - lo).to_array();
    let axis = (0..3).fold(0, |best, k| if size[k] > size[best] { k } else { best });
    let first = clusters / 2;
    let at = (chosen.len() * first).div_ceil(clusters);
    let key = |t: &u32| (ordered(middle(*t).to_array()[axis]), *t);
    chosen.select_nth_unstable_by_key(at, key);
    let (left, right) = chosen.split_at_mut(at);
    let (mut ones, mut others) = (Vec::new(), Vec::new());
    rayon::join(
        || cut_by_planes(surface, left, first, &mut ones),
        || cut_by_planes(surface, right, clusters - first, &mut others),
    );
    pieces.append(&mut ones);
    pieces.append(&mut others);
}

/// The bits of a number that is not NaN in an order that integers have.
fn ordered(value: f32) -> u32 {
    let bits = value.to_bits();
    if bits >> 31 == 1 {
        !bits
    } else {
        bits | 1 << 31
    }
}

/// A piece of the surface, its triangles numbered from 0.
struct Piece<'a> {
    surface: &'a Surface<'a>,
    /// Triangle of the surface of every one.
    source: Vec<u32>,
    middle: Vec<Vec3>,
    /// Where it is along the direction of the sweep, as an integer.
    along: Vec<u32>,
    neighbours: Vec<[u32; 3]>,
    /// The sweep after which it was last looked at.
    seen: Vec<u32>,
    /// Which part of the piece every triangle is in now.
    part: Vec<u32>,
    parts: u32,
    limits: Limits,
    front: BinaryHeap<Reverse<(u32, u32)>>,
}

impl<'a> Piece<'a> {
    fn new(surface: &'a Surface<'a>, source: &[u32], limits: Limits) -> Self {
        let mut source = source.to_vec();
        source.sort_unstable();
        Self {
            surface,
            middle: source
                .iter()
                .map(|&t| surface.middles[t as usize])
                .collect(),
            along: vec![0; source.len()],
            neighbours: neighbours(surface, &source),
            seen: vec![0; source.len()],
            part: vec![0; source.len()],
            parts: 0,
            limits,
            front: BinaryHeap::new(),
            source,
        }
    }

    fn into_clusters(mut self, clusters: usize) -> Vec<Vec<u32>> {
        let mut found = Vec::with_capacity(clusters);
        let mut all: Vec<u32> = (0..self.source.len() as u32).collect();
        self.halve(&mut all, clusters, &mut found);
        found
    }

    fn halve(&mut self, list: &mut [u32], clusters: usize, found: &mut Vec<Vec<u32>>) {
        if list.is_empty() {
            return;
        }
        let fits = clusters <= 1 && self.vertices_of(list) <= self.limits.vertices;
        if fits || list.len() == 1 {
            found.push(list.iter().map(|&t| self.source[t as usize]).collect());
            return;
        }
        let clusters = clusters.max(2);
        let first = clusters / 2;
        let at = (list.len() * first).div_ceil(clusters).min(list.len() - 1);
        self.sweep(list, at);
        let (left, right) = list.split_at_mut(at);
        self.halve(left, first, found);
        self.halve(right, clusters - first, found);
    }

    /// Brings `count` triangles to the front of the list, as the sweep meets
    /// them.
    fn sweep(&mut self, list: &mut [u32], count: usize) {
        let axis = longest_direction(list.iter().map(|&t| self.middle[t as usize]));
        for &t in list.iter() {
            self.along[t as usize] = ordered(self.middle[t as usize].dot(axis));
        }
        let part = self.part[list[0] as usize];
        let first = list.iter().copied();
        let first = first.min_by_key(|&t| (self.along[t as usize], t));
        let mut swept = self.swept(list, first, count);
        for _ in 0..TRIES {
            let pockets = self.pockets(list, part);
            if pockets.is_empty() {
                break;
            }
            // Next time they are taken as soon as the sweep meets them.
            pockets.iter().for_each(|&t| self.along[t as usize] = 0);
            swept.iter().for_each(|&t| self.part[t as usize] = part);
            swept = self.swept(list, first, count);
        }
        swept.extend(list.iter().filter(|&&t| self.part[t as usize] == part));
        list.copy_from_slice(&swept);
    }

    /// So many triangles, which become another part, from the first one on.
    fn swept(&mut self, list: &mut [u32], first: Option<u32>, count: usize) -> Vec<u32> {
        let part = self.part[list[0] as usize];
        self.parts += 1;
        self.front.clear();
        self.front.extend(first.map(|t| Reverse((0, t))));
        let mut swept = Vec::with_capacity(list.len());
        self.follow(part, count, &mut swept);
        if swept.len() < count {
            // The rest does not hang together with that.
            list.sort_unstable_by_key(|&t| (self.along[t as usize], t));
            for &t in list.iter() {
                self.front.push(Reverse((self.along[t as usize], t)));
                self.follow(part, count, &mut swept);
            }
        }
        swept
    }

    /// Triangles of the part that the sweep has cut off from the most of it.
    fn pockets(&mut self, list: &[u32], part: u32) -> Vec<u32> {
        let mut found: Vec<Vec<u32>> = Vec::new();
        for &t in list {
            if self.part[t as usize] == part && self.seen[t as usize] != self.parts {
                found.extend(self.touching(t, part));
            }
        }
        let largest = (0..found.len()).max_by_key(|&i| found[i].len());
        largest.map(|i| found.swap_remove(i));
        found.into_iter().flatten().collect()
    }

    /// What of the part hangs together with `t`, if it touches what was swept.
    fn touching(&mut self, t: u32, part: u32) -> Option<Vec<u32>> {
        let mut reached = vec![t];
        let mut touches = false;
        let mut next = 0;
        self.seen[t as usize] = self.parts;
        while let Some(&t) = reached.get(next) {
            next += 1;
            for n in self.neighbours[t as usize]
                .into_iter()
                .filter(|&n| n != NONE)
            {
                touches |= self.part[n as usize] == self.parts;
                if self.part[n as usize] == part && self.seen[n as usize] != self.parts {
                    self.seen[n as usize] = self.parts;
                    reached.push(n);
                }
            }
        }
        touches.then_some(reached)
    }

    /// Sweeps on from the front until so many triangles are swept or none is
    /// left that hangs together with it.
    fn follow(&mut self, part: u32, count: usize, swept: &mut Vec<u32>) {
        while swept.len() < count {
            let Some(Reverse((_, t))) = self.front.pop() else {
                return;
            };
            if self.part[t as usize] != part {
                continue;
            }
            self.part[t as usize] = self.parts;
            swept.push(t);
            for &n in &self.neighbours[t as usize] {
                if n != NONE && self.part[n as usize] == part {
                    self.front.push(Reverse((self.along[n as usize], n)));
                }
            }
        }
    }

    fn vertices_of(&self, list: &[u32]) -> usize {
        let corners = |&t: &u32| self.surface.triangles[self.source[t as usize] as usize];
        let mut vertices: Vec<u32> = list.iter().flat_map(corners).collect();
        vertices.sort_unstable();
        vertices.dedup();
        vertices.len()
    }
}

/// The triangles across the three edges of every one; where more than two meet
/// in an edge, each has the next.
fn neighbours(surface: &Surface<'_>, source: &[u32]) -> Vec<[u32; 3]> {
    let mut edges: Vec<(u64, u32)> = Vec::with_capacity(3 * source.len());
    for (i, &t) in source.iter().enumerate() {
        let [a, b, c] = surface.linked[t as usize];
        for (k, (p, q)) in [(a, b), (b, c), (c, a)].into_iter().enumerate() {
            edges.push((edge_key(p, q), (3 * i + k) as u32));
        }
    }
    edges.sort_unstable();
    let mut found = vec![[NONE; 3]; source.len()];
    for same in edges.chunk_by(|a, b| a.0 == b.0) {
        for (i, &(_, corner)) in same.iter().enumerate() {
            let next = same[(i + 1) % same.len()].1 / 3;
            if next != corner / 3 {
                found[corner as usize / 3][corner as usize % 3] = next;
            }
        }
    }
    found
}

/// An edge between two positions, whichever way.
pub(super) fn edge_key(a: u32, b: u32) -> u64 {
    u64::from(a.min(b)) << 32 | u64::from(a.max(b))
}

/// Along which these points are spread most (power iteration).
fn longest_direction(points: impl Iterator<Item = Vec3> + Clone) -> Vec3 {
    let count = points.clone().count().max(1) as f64;
    let mean = points.clone().map(|p| p.as_dvec3()).sum::<DVec3>() / count;
    let mut spread = DMat3::ZERO;
    for p in points {
        let d = p.as_dvec3() - mean;
        spread += DMat3::from_cols(d * d.x, d * d.y, d * d.z);
    }
    let columns = [spread.x_axis, spread.y_axis, spread.z_axis];
    let longer = |a: DVec3, b: DVec3| {
        if b.length_squared() > a.length_squared() {
            b
        } else {
            a
        }
    };
    let mut axis = columns
        .into_iter()
        .fold(DVec3::ZERO, longer)
        .normalize_or(DVec3::X);
    for _ in 0..8 {
        axis = (spread * axis).normalize_or(axis);
    }
    axis.as_vec3()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{PositionIds, TriMesh, shapes};

    fn clusters_of(mesh: &TriMesh, limits: Limits) -> Vec<Vec<u32>> {
        let linked = PositionIds::of_mesh(mesh).triangles(&mesh.triangles);
        let middle = |t| {
            let [a, b, c] = mesh.corners(t);
            ((a + b + c) / 3.0).as_vec3()
        };
        let middles: Vec<Vec3> = (0..mesh.triangles.len()).map(middle).collect();
        let surface = Surface {
            triangles: &mesh.triangles,
            linked: &linked,
            middles: &middles,
        };
        split(&surface, (0..mesh.triangles.len() as u32).collect(), limits)
    }

    #[test]
    fn every_triangle_is_in_one_cluster_and_none_is_too_large() {
        let limits = Limits {
            triangles: 16,
            vertices: 12,
        };
        for (name, mesh) in shapes::zoo() {
            let clusters = clusters_of(&mesh, limits);
            let mut all: Vec<u32> = clusters.iter().flatten().copied().collect();
            all.sort_unstable();
            let expected: Vec<u32> = (0..mesh.triangles.len() as u32).collect();
            assert_eq!(all, expected, "{name}");
            for cluster in clusters {
                assert!(cluster.len() <= 16, "{name}");
                let corners = cluster.iter().flat_map(|&t| mesh.triangles[t as usize]);
                let mut vertices: Vec<u32> = corners.collect();
                vertices.sort_unstable();
                vertices.dedup();
                assert!(vertices.len() <= 12, "{name}");
            }
        }
    }

    #[test]
    fn clusters_are_full_and_hang_together() {
        let limits = Limits {
            triangles: 128,
            vertices: 255,
        };
        for mesh in [shapes::terrain(256, 256, 3), shapes::icosphere(6)] {
            let clusters = clusters_of(&mesh, limits);
            assert_eq!(clusters.len(), mesh.triangles.len().div_ceil(128));
            let linked = PositionIds::of_mesh(&mesh).triangles(&mesh.triangles);
            let whole = clusters.iter().filter(|c| is_connected(&linked, c)).count();
            assert!(
                whole * 100 >= clusters.len() * 97,
                "{whole} of {}",
                clusters.len()
            );
        }
    }

    fn is_connected(linked: &[[u32; 3]], cluster: &[u32]) -> bool {
        let shares = |a: u32, b: u32| {
            let (a, b) = (linked[a as usize], linked[b as usize]);
            a.iter().filter(|p| b.contains(p)).count() >= 2
        };
        let mut reached = vec![cluster[0]];
        let mut rest = cluster[1..].to_vec();
        let mut next = 0;
        while next < reached.len() {
            let t = reached[next];
            next += 1;
            let (near, far): (Vec<u32>, Vec<u32>) = rest.iter().partition(|&&r| shares(t, r));
            reached.extend(near);
            rest = far;
        }
        rest.is_empty()
    }
}
