//! Clusters into groups that share as little border as may be.
//!
//! Groups grow by joining: the smallest takes the neighbour with which it
//! shares most edges for its size (as meshoptimizer's `partition.cpp` does).
//! Borders that were locked before have not been simplified and so have more
//! edges than others: they pull clusters of different groups together, and what
//! was locked on one level lies inside on the next.

use super::split::edge_key;
use crate::mesh::DisjointSets;
use crate::spatial::morton;
use glam::Vec3;
use rayon::prelude::*;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Edges that two clusters share, from either one's side.
type Neighbours = Vec<(u32, u32)>;

/// Groups of at most `most` of the clusters that these are: the triangles of
/// each, by position id, and its middle. Lists in each group ascend.
pub(super) fn groups(triangles: &[Vec<[u32; 3]>], middles: &[Vec3], most: usize) -> Vec<Vec<u32>> {
    let mut joining = Joining::new(neighbours(triangles), most);
    joining.run();
    gather_small(joining.into_groups(), middles, most)
}

/// The neighbours of every cluster.
fn neighbours(triangles: &[Vec<[u32; 3]>]) -> Vec<Neighbours> {
    let rims = triangles.par_iter().enumerate();
    let mut edges: Vec<(u64, u32)> = rims
        .flat_map_iter(|(c, triangles)| rim(triangles).into_iter().map(move |e| (e, c as u32)))
        .collect();
    edges.par_sort_unstable();
    let mut pairs = Vec::new();
    for same in edges.chunk_by(|a, b| a.0 == b.0) {
        for (i, &(_, a)) in same.iter().enumerate() {
            let others = same[i + 1..].iter().filter(|o| o.1 != a);
            // An edge of a thousand clusters is no reason to list a million.
            pairs.extend(others.take(8).map(|&(_, b)| edge_key(a, b)));
        }
    }
    pairs.par_sort_unstable();
    let mut found = vec![Neighbours::new(); triangles.len()];
    for same in pairs.chunk_by(|a, b| a == b) {
        let (a, b) = ((same[0] >> 32) as u32, same[0] as u32);
        found[a as usize].push((b, same.len() as u32));
        found[b as usize].push((a, same.len() as u32));
    }
    found.iter_mut().for_each(|list| list.sort_unstable());
    found
}

/// Edges that have not two triangles in the cluster.
fn rim(triangles: &[[u32; 3]]) -> Vec<u64> {
    let edges = |&[a, b, c]: &[u32; 3]| [edge_key(a, b), edge_key(b, c), edge_key(c, a)];
    let mut edges: Vec<u64> = triangles.iter().flat_map(edges).collect();
    edges.sort_unstable();
    let single = edges.chunk_by(|a, b| a == b).filter(|same| same.len() != 2);
    single.map(|same| same[0]).collect()
}

struct Joining {
    sets: DisjointSets,
    /// By the set's first.
    size: Vec<u32>,
    neighbours: Vec<Neighbours>,
    most: u32,
}

impl Joining {
    fn new(neighbours: Vec<Neighbours>, most: usize) -> Self {
        Self {
            sets: DisjointSets::new(neighbours.len()),
            size: vec![1; neighbours.len()],
            neighbours,
            most: most as u32,
        }
    }

    fn run(&mut self) {
        let all = 0..self.size.len() as u32;
        let mut queue: BinaryHeap<_> = all.map(|c| Reverse((1, c))).collect();
        while let Some(Reverse((size, c))) = queue.pop() {
            if self.sets.find(c) != c || self.size[c as usize] != size {
                continue;
            }
            if let Some(other) = self.best(c) {
                let joined = self.join(c, other);
                queue.push(Reverse((self.size[joined as usize], joined)));
            }
        }
    }

    /// The neighbour to join with; none if there is none or all are too large.
    fn best(&self, c: u32) -> Option<u32> {
        let size = self.size[c as usize];
        let share = |s: u32| 1.0 / f64::from(s).sqrt();
        let mut best = None;
        for &(n, edges) in &self.neighbours[c as usize] {
            let other = self.size[n as usize];
            if size + other > self.most {
                continue;
            }
            let score = f64::from(edges) * (share(size) + share(other));
            if best.is_none_or(|(most, _)| score > most) {
                best = Some((score, n));
            }
        }
        best.map(|(_, n)| n)
    }

    fn join(&mut self, a: u32, b: u32) -> u32 {
        let size = self.size[a as usize] + self.size[b as usize];
        let mut list = std::mem::take(&mut self.neighbours[a as usize]);
        list.append(&mut self.neighbours[b as usize]);
        self.sets.unite(a, b);
        let kept = self.sets.find(a);
        let gone = if kept == a { b } else { a };
        self.size[kept as usize] = size;
        list.retain(|n| n.0 != a && n.0 != b);
        list.sort_unstable();
        list.dedup_by(|next, sum| {
            let same = next.0 == sum.0;
            sum.1 += if same { next.1 } else { 0 };
            same
        });
        for &(n, edges) in &list {
            rename(&mut self.neighbours[n as usize], gone, kept, edges);
        }
        self.neighbours[kept as usize] = list;
        kept
    }

    fn into_groups(mut self) -> Vec<Vec<u32>> {
        let count = self.size.len() as u32;
        let mut keyed: Vec<(u32, u32)> = (0..count).map(|c| (self.sets.find(c), c)).collect();
        keyed.sort_unstable();
        let same = keyed.chunk_by(|a, b| a.0 == b.0);
        same.map(|group| group.iter().map(|k| k.1).collect())
            .collect()
    }
}

/// A neighbour `gone` has become part of `kept`, with so many edges in all.
fn rename(list: &mut Neighbours, gone: u32, kept: u32, edges: u32) {
    list.retain(|n| n.0 != gone);
    match list.binary_search_by_key(&kept, |n| n.0) {
        Ok(at) => list[at].1 = edges,
        Err(at) => list.insert(at, (kept, edges)),
    }
}

/// Groups of less than half the size that have no neighbour to join are the
/// small parts of a model: those close to each other are simplified together.
fn gather_small(groups: Vec<Vec<u32>>, middles: &[Vec3], most: usize) -> Vec<Vec<u32>> {
    let (small, mut found): (Vec<_>, Vec<_>) = groups.into_iter().partition(|g| g.len() * 2 < most);
    let middle = |g: &Vec<u32>| {
        let sum: Vec3 = g.iter().map(|&c| middles[c as usize]).sum();
        sum / g.len() as f32
    };
    let places: Vec<Vec3> = small.iter().map(middle).collect();
    let mut open: Vec<u32> = Vec::new();
    for i in morton::order(&places) {
        let group = &small[i as usize];
        if open.len() + group.len() > most {
            found.push(std::mem::take(&mut open));
        }
        open.extend(group);
    }
    if !open.is_empty() {
        found.push(open);
    }
    found.iter_mut().for_each(|g| g.sort_unstable());
    found.sort_unstable();
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A row of quads, every one a cluster.
    fn row(count: u32) -> (Vec<Vec<[u32; 3]>>, Vec<Vec3>) {
        let quad = |i: u32| vec![[2 * i, 2 * i + 1, 2 * i + 3], [2 * i, 2 * i + 3, 2 * i + 2]];
        let middle = |i: u32| Vec3::new(i as f32, 0.0, 0.0);
        (
            (0..count).map(quad).collect(),
            (0..count).map(middle).collect(),
        )
    }

    #[test]
    fn every_cluster_is_in_one_group_of_neighbours() {
        let (triangles, middles) = row(64);
        let groups = groups(&triangles, &middles, 8);
        let mut all: Vec<u32> = groups.iter().flatten().copied().collect();
        all.sort_unstable();
        assert_eq!(all, (0..64).collect::<Vec<_>>());
        for group in &groups {
            assert!(group.len() <= 8);
        }
        assert!(groups.len() <= 12, "{groups:?}");
    }

    #[test]
    fn parts_without_neighbours_are_grouped_by_place() {
        let (mut triangles, middles) = row(10);
        for (i, cluster) in (0..).zip(&mut triangles) {
            cluster.iter_mut().flatten().for_each(|p| *p += 100 * i);
        }
        let groups = groups(&triangles, &middles, 5);
        assert_eq!(groups, [vec![0, 1, 2, 3, 4], vec![5, 6, 7, 8, 9]]);
    }
}
