//! Construction of [`Bvh`](super::Bvh) by the surface area heuristic (Wald,
//! On fast construction of SAH-based bounding volume hierarchies, 2007).

use super::bvh::{LEAF, Node};
use crate::geom::Aabb;
use crate::mesh::TriMesh;
use glam::Vec3;
use rayon::prelude::*;
use smallvec::{SmallVec, smallvec};
use std::ops::Range;

/// Bins an axis of the surface area heuristic.
const BINS: usize = 16;
/// Below this many triangles a subtree is built by one thread.
const TASK: usize = 4096;
/// From this depth on ranges are halved, which bounds the depth of the tree.
const DEEP: u32 = 24;

/// A triangle to be put into a box.
#[derive(Clone, Copy)]
struct Item {
    bounds: Aabb,
    triangle: u32,
}

impl Item {
    /// Centre of the box; halved first so that it cannot overflow.
    fn center(&self) -> Vec3 {
        self.bounds.min * 0.5 + self.bounds.max * 0.5
    }
}

/// Nodes, the root first, and the triangles in leaf order. The mesh is valid
/// and has triangles.
pub(super) fn build(mesh: &TriMesh) -> (Vec<Node>, Vec<u32>) {
    let item = |(t, corners): (usize, &[u32; 3])| Item {
        bounds: Aabb::of(corners.map(|v| mesh.positions[v as usize])),
        triangle: t as u32,
    };
    let mut items: Vec<Item> = mesh.triangles.par_iter().enumerate().map(item).collect();
    let nodes = subtree(&mut items, 0, 0);
    (nodes, items.iter().map(|i| i.triangle).collect())
}

/// Nodes over `items`, which start at place `first` of the leaf order; inner
/// children count from the returned root.
fn subtree(items: &mut [Item], first: u32, depth: u32) -> Vec<Node> {
    let mut nodes = Vec::new();
    if items.len() < TASK {
        push_subtree(items, first, depth, &mut nodes);
        return nodes;
    }
    let parts = split_in_four(items, depth);
    let mut node = node_over(items, &parts, first);
    let blocks = build_parts(items, &parts, first, depth);
    nodes.push(node);
    for (lane, block) in blocks
        .into_iter()
        .enumerate()
        .filter(|(_, b)| !b.is_empty())
    {
        let base = nodes.len() as u32;
        node.child[lane] = base;
        nodes.extend(block.into_iter().map(|n| n.moved(base)));
    }
    nodes[0] = node;
    nodes
}

/// The subtrees of all parts in parallel; nothing for single triangles.
fn build_parts(
    mut items: &mut [Item],
    parts: &[Range<usize>],
    first: u32,
    depth: u32,
) -> Vec<Vec<Node>> {
    let mut jobs = Vec::with_capacity(parts.len());
    for part in parts {
        let (head, tail) = items.split_at_mut(part.len());
        jobs.push((head, first + part.start as u32));
        items = tail;
    }
    let build_one = |(items, first): (&mut [Item], u32)| match items.len() {
        0 | 1 => Vec::new(),
        _ => subtree(items, first, depth + 1),
    };
    jobs.into_par_iter().map(build_one).collect()
}

/// As [`subtree`], appended to `nodes` with children counted from its start.
fn push_subtree(items: &mut [Item], first: u32, depth: u32, nodes: &mut Vec<Node>) {
    let parts = split_in_four(items, depth);
    let at = nodes.len();
    nodes.push(node_over(items, &parts, first));
    for (lane, part) in parts.iter().enumerate().filter(|(_, p)| p.len() > 1) {
        nodes[at].child[lane] = nodes.len() as u32;
        let start = first + part.start as u32;
        push_subtree(&mut items[part.clone()], start, depth + 1, nodes);
    }
}

/// A node whose single triangles are set; other children are left to do.
fn node_over(items: &[Item], parts: &[Range<usize>], first: u32) -> Node {
    let mut node = Node::EMPTY;
    for (lane, part) in parts.iter().enumerate() {
        let bounds = union(&items[part.clone()]);
        node.set(lane, bounds, LEAF | (first + part.start as u32));
    }
    node
}

fn union(items: &[Item]) -> Aabb {
    items
        .iter()
        .fold(Aabb::EMPTY, |bounds, item| bounds.union(item.bounds))
}

/// Cuts `items` in up to four parts, always the part with the largest box
/// next; sorts the items accordingly.
fn split_in_four(items: &mut [Item], depth: u32) -> SmallVec<[Range<usize>; 4]> {
    let mut parts: SmallVec<[Range<usize>; 4]> = smallvec![0..items.len()];
    if items.len() <= 4 {
        return (0..items.len()).map(|i| i..i + 1).collect();
    }
    let mut areas: SmallVec<[f32; 4]> = smallvec![f32::INFINITY];
    while parts.len() < 4 {
        let splittable = (0..parts.len()).filter(|&i| parts[i].len() > 1);
        let Some(widest) = splittable.max_by(|&i, &j| areas[i].total_cmp(&areas[j])) else {
            break;
        };
        let part = parts[widest].clone();
        let middle = part.start + split_in_two(&mut items[part.clone()], depth);
        parts[widest] = part.start..middle;
        parts.insert(widest + 1, middle..part.end);
        areas[widest] = half_area(union(&items[part.start..middle]));
        areas.insert(widest + 1, half_area(union(&items[middle..part.end])));
    }
    parts
}

/// Half the surface of a box.
fn half_area(bounds: Aabb) -> f32 {
    let size = bounds.size();
    size.x * size.y + size.y * size.z + size.z * size.x
}

/// Cuts `items` (two or more) where the surface area heuristic says, and
/// returns the size of the first part, which is never empty nor all.
fn split_in_two(items: &mut [Item], depth: u32) -> usize {
    let centers = Aabb::of(items.iter().map(Item::center));
    if depth < DEEP
        && let Some(split) = best_split(items, centers)
    {
        let below = |item: &Item| split.grid.bin(item.center()) < split.bin;
        let middle = partition(items, below);
        if middle > 0 && middle < items.len() {
            return middle;
        }
    }
    halve(items, centers)
}

/// Cuts in the middle of the longest axis, by count.
fn halve(items: &mut [Item], centers: Aabb) -> usize {
    let axis = centers.size().max_position();
    let middle = items.len() / 2;
    items.select_nth_unstable_by(middle, |a, b| {
        let by_place = a.center()[axis].total_cmp(&b.center()[axis]);
        by_place.then(a.triangle.cmp(&b.triangle))
    });
    middle
}

/// Moves the items for which `below` holds to the front; returns how many.
fn partition(items: &mut [Item], below: impl Fn(&Item) -> bool) -> usize {
    let mut middle = 0;
    for i in 0..items.len() {
        if below(&items[i]) {
            items.swap(i, middle);
            middle += 1;
        }
    }
    middle
}

/// Equal intervals along one axis.
#[derive(Clone, Copy)]
struct Grid {
    axis: usize,
    origin: f32,
    scale: f32,
    bins: usize,
}

impl Grid {
    fn bin(&self, center: Vec3) -> usize {
        (((center[self.axis] - self.origin) * self.scale) as usize).min(self.bins - 1)
    }
}

/// Items in bins below `bin` go to the first part.
struct Split {
    grid: Grid,
    bin: usize,
}

/// The cheapest split over all axes and bins; `None` if all centres coincide
/// or are too far apart for `f32`.
fn best_split(items: &[Item], centers: Aabb) -> Option<Split> {
    let bins = BINS.min(4 + items.len() / 4);
    let mut best = None;
    for axis in 0..3 {
        let scale = bins as f32 / centers.size()[axis];
        if !scale.is_normal() {
            continue;
        }
        let grid = Grid {
            axis,
            origin: centers.min[axis],
            scale,
            bins,
        };
        let (cost, bin) = cheapest_bin(items, grid);
        if best.as_ref().is_none_or(|&(least, _)| cost < least) {
            best = Some((cost, Split { grid, bin }));
        }
    }
    best.map(|(_, split)| split)
}

/// Cost and first bin of the second part of the best split on a grid.
fn cheapest_bin(items: &[Item], grid: Grid) -> (f32, usize) {
    let mut bins = [(Aabb::EMPTY, 0usize); BINS];
    for item in items {
        let (bounds, count) = &mut bins[grid.bin(item.center())];
        *bounds = bounds.union(item.bounds);
        *count += 1;
    }
    let bins = &bins[..grid.bins];
    let grow =
        |(bounds, count): (Aabb, usize), bin: &(Aabb, usize)| (bounds.union(bin.0), count + bin.1);
    let cost = |(bounds, count): (Aabb, usize)| half_area(bounds) * count as f32;
    let mut above = [0.0; BINS];
    let mut suffix = (Aabb::EMPTY, 0);
    for i in (1..bins.len()).rev() {
        suffix = grow(suffix, &bins[i]);
        above[i] = cost(suffix);
    }
    let mut prefix = (Aabb::EMPTY, 0);
    let mut best = (f32::INFINITY, 1);
    for i in 1..bins.len() {
        prefix = grow(prefix, &bins[i - 1]);
        let total = cost(prefix) + above[i];
        if total < best.0 {
            best = (total, i);
        }
    }
    best
}
