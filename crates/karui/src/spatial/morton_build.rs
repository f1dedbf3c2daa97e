//! Construction of [`Bvh`](super::Bvh) along a Morton curve (Lauterbach and
//! others, Fast BVH construction on GPUs, 2009): sorted, the triangles of a
//! cell of any size lie next to each other, and only have to be cut apart.

use super::bvh::{LEAF, NONE, Node, corners_of};
use super::radix::{self, INDEX_BITS};
use crate::geom::Aabb;
use crate::mesh::TriMesh;
use glam::{Mat4, Vec3, Vec3A, Vec4, Vec4Swizzles};
use rayon::prelude::*;

/// Below this many triangles a subtree is built by one thread.
const TASK: usize = 4096;
/// Bits an axis: three of them fill what a key has beside the index.
const BITS: u32 = (u64::BITS - INDEX_BITS) / 3;
/// Cells an axis.
const CELLS: usize = 1 << BITS;

/// Nodes, the root first, and the triangles in leaf order with their corners.
type Built = (Vec<Node>, Vec<[Vec3; 3]>, Vec<u32>);

/// None if a triangle has no place on the curve: the mesh is damaged, its
/// coordinates are too large to be added up, or it has no triangles.
pub(super) fn build(mesh: &TriMesh) -> Option<Built> {
    if mesh.triangles.is_empty() || mesh.triangles.len() >= (NONE & !LEAF) as usize {
        return None;
    }
    let keys = radix::sort(keys(mesh)?);
    let triangle = |&key: &u64| key as u32 & !(1 << INDEX_BITS);
    let order: Vec<u32> = keys.par_iter().map(triangle).collect();
    let corners: Vec<_> = order.par_iter().map(|&t| corners_of(mesh, t)).collect();
    let sorted = Sorted {
        keys: &keys,
        corners: &corners,
    };
    Some((sorted.nodes(), corners, order))
}

/// Place on the curve and index of every triangle.
fn keys(mesh: &TriMesh) -> Option<Vec<u64>> {
    let bounds = finite_bounds(&mesh.positions)?;
    let size = bounds.size().max_element().max(f32::MIN_POSITIVE);
    // Corners are added up rather than averaged.
    let scale = ((CELLS - 1) as f32 / size) / 3.0;
    let offset = Vec3A::from(bounds.min) * 3.0;
    let largest = bounds.min.abs().max(bounds.max.abs()).max_element();
    if largest > f32::MAX / 8.0 || !scale.is_finite() {
        return None;
    }
    let mut keys = vec![0; mesh.triangles.len()];
    let parts = keys
        .par_chunks_mut(TASK)
        .zip(mesh.triangles.par_chunks(TASK));
    let sound = parts.enumerate().all(|(part, (keys, triangles))| {
        let first = (part * TASK) as u64;
        for (index, (key, &[a, b, c])) in (first..).zip(keys.iter_mut().zip(triangles)) {
            let at = |v: u32| mesh.positions.get(v as usize).map(|&p| Vec3A::from(p));
            let (Some(a), Some(b), Some(c)) = (at(a), at(b), at(c)) else {
                return false;
            };
            *key = code((a + b + c - offset) * scale) << INDEX_BITS | index;
        }
        true
    });
    sound.then_some(keys)
}

/// Box around all points; none if one of them is not finite.
fn finite_bounds(points: &[Vec3]) -> Option<Aabb> {
    let part = |points: &[Vec3]| {
        let (mut min, mut max) = (Vec3A::INFINITY, Vec3A::NEG_INFINITY);
        // Stays zero while all are finite.
        let mut zero = Vec3A::ZERO;
        for &point in points {
            let point = Vec3A::from(point);
            (min, max) = (min.min(point), max.max(point));
            zero += point * 0.0;
        }
        let (min, max) = (min.into(), max.into());
        (zero == Vec3A::ZERO).then_some(Aabb { min, max })
    };
    let parts = points.par_chunks(TASK).map(part);
    parts.try_reduce(|| Aabb::EMPTY, |a, b| Some(a.union(b)))
}

/// Place on the curve of the cell with these coordinates, each from 0 to
/// [`CELLS`] - 1.
fn code(cell: Vec3A) -> u64 {
    // Added to 2^23 a number is rounded, and its last bits are its value.
    let cell = cell + (1 << 23) as f32;
    let spread = |c: f32| u64::from(SPREAD[c.to_bits() as usize & (CELLS - 1)]);
    spread(cell.x) << 2 | spread(cell.y) << 1 | spread(cell.z)
}

/// Numbers with two zero bits put before every one of theirs.
static SPREAD: [u32; CELLS] = {
    let mut table = [0; CELLS];
    let mut i = 1;
    while i < table.len() {
        // All bits but the last have been spread.
        table[i] = table[i >> 1] << 3 | i as u32 & 1;
        i += 1;
    }
    table
};

/// Least and greatest corner; the last lanes mean nothing.
type Box4 = [Vec4; 2];

const EMPTY: Box4 = [Vec4::INFINITY, Vec4::NEG_INFINITY];

fn union(a: Box4, b: Box4) -> Box4 {
    [a[0].min(b[0]), a[1].max(b[1])]
}

/// Triangles in the order of their keys.
#[derive(Clone, Copy)]
struct Sorted<'a> {
    keys: &'a [u64],
    corners: &'a [[Vec3; 3]],
}

/// Triangles that make up one child of a node.
#[derive(Clone, Copy)]
struct Job {
    first: usize,
    end: usize,
    node: usize,
    lane: usize,
}

impl Sorted<'_> {
    fn nodes(self) -> Vec<Node> {
        let (mut nodes, mut jobs) = (Vec::new(), Vec::new());
        if self.keys.len() < TASK {
            nodes.reserve_exact(self.keys.len());
            self.push(0, self.keys.len(), &mut nodes);
            return nodes;
        }
        self.plan(0, self.keys.len(), &mut nodes, &mut jobs);
        let top = nodes.len();
        let build = |job: &Job| {
            let mut nodes = Vec::with_capacity(job.end - job.first);
            let (bounds, _) = self.child(job.first, job.end, &mut nodes);
            (nodes, bounds)
        };
        let built: Vec<(Vec<Node>, Box4)> = jobs.par_iter().map(build).collect();
        nodes.reserve_exact(built.iter().map(|(own, _)| own.len()).sum());
        for (job, (own, [min, max])) in jobs.iter().zip(built) {
            let base = nodes.len() as u32;
            let child = match own.is_empty() {
                true => LEAF | job.first as u32,
                false => base,
            };
            let (min, max) = (min.truncate(), max.truncate());
            nodes[job.node].set(job.lane, Aabb { min, max }, child);
            nodes.extend(own.into_iter().map(|node| node.moved(base)));
        }
        enclose(&mut nodes, top);
        nodes
    }

    /// Nodes over what is too much for one task, their boxes left to do, and
    /// the tasks below them.
    fn plan(self, first: usize, end: usize, nodes: &mut Vec<Node>, jobs: &mut Vec<Job>) {
        let cuts = self.cuts(first, end);
        let node = nodes.len();
        nodes.push(Node::EMPTY);
        for lane in 0..4 {
            let (first, end) = (cuts[lane], cuts[lane + 1]);
            if end - first < TASK {
                jobs.push(Job {
                    first,
                    end,
                    node,
                    lane,
                });
            } else {
                nodes[node].child[lane] = nodes.len() as u32;
                self.plan(first, end, nodes, jobs);
            }
        }
    }

    /// Box and child made of a range: a triangle, or nodes that are appended.
    #[inline(always)]
    fn child(self, first: usize, end: usize, nodes: &mut Vec<Node>) -> (Box4, u32) {
        if end - first == 1 {
            return (self.bounds_of(first), LEAF | first as u32);
        }
        let at = nodes.len() as u32;
        (self.push(first, end, nodes), at)
    }

    /// Appends the nodes over a range of two triangles or more; returns its
    /// box.
    fn push(self, first: usize, end: usize, nodes: &mut Vec<Node>) -> Box4 {
        let at = nodes.len();
        nodes.push(Node::EMPTY);
        let (mut boxes, mut child) = ([EMPTY; 4], [NONE; 4]);
        if end - first <= 4 {
            let slots = (first..end).zip(&mut boxes).zip(&mut child);
            for ((slot, bounds), child) in slots {
                (*bounds, *child) = (self.bounds_of(slot), LEAF | slot as u32);
            }
        } else {
            let cuts = self.cuts(first, end);
            for lane in 0..4 {
                (boxes[lane], child[lane]) = self.child(cuts[lane], cuts[lane + 1], nodes);
            }
        }
        nodes[at] = node_over(boxes, child);
        union(union(boxes[0], boxes[1]), union(boxes[2], boxes[3]))
    }

    fn bounds_of(self, slot: usize) -> Box4 {
        // Whole lanes are read, and what belongs to the next corner ignored.
        let [ax, ay, az, bx, by, bz, cx, cy, cz] = bytemuck::cast(self.corners[slot]);
        let a = Vec4::new(ax, ay, az, bx);
        let b = Vec4::new(bx, by, bz, cx);
        let c = Vec4::new(bz, cx, cy, cz).yzww();
        [a.min(b).min(c), a.max(b).max(c)]
    }

    /// Ends of four parts of a range of more than four triangles; none of them
    /// is empty. The largest part is cut next.
    fn cuts(self, first: usize, end: usize) -> [usize; 5] {
        let mut cuts = [first, self.cut(first, end), end, end, end];
        for parts in 2..4 {
            let mut largest = 0;
            for i in 1..parts {
                if cuts[i + 1] - cuts[i] > cuts[largest + 1] - cuts[largest] {
                    largest = i;
                }
            }
            let middle = self.cut(cuts[largest], cuts[largest + 1]);
            cuts[largest + 1..].rotate_right(1);
            cuts[largest + 1] = middle;
        }
        cuts
    }

    /// Where, in a range, the highest bit changes in which its keys differ. As
    /// they end in the index there is one, and equal places are cut by halves.
    fn cut(self, first: usize, end: usize) -> usize {
        let keys = &self.keys[first..end];
        let bit = (keys[0] ^ keys[keys.len() - 1]).ilog2();
        first + keys.partition_point(|key| key >> bit & 1 == 0)
    }
}

/// Puts boxes around the inner children of the first `top` nodes that are such
/// nodes themselves; they come after their parents.
fn enclose(nodes: &mut [Node], top: usize) {
    for at in (0..top).rev() {
        for lane in 0..4 {
            let child = nodes[at].child[lane];
            if (child as usize) < top {
                let bounds = nodes[child as usize].bounds();
                nodes[at].set(lane, bounds, child);
            }
        }
    }
}

fn node_over(boxes: [Box4; 4], child: [u32; 4]) -> Node {
    let lanes = |side: usize| {
        let [a, b, c, d] = boxes.map(|b| b[side]);
        let rows = Mat4::from_cols(a, b, c, d).transpose();
        [rows.x_axis, rows.y_axis, rows.z_axis]
    };
    Node {
        min: lanes(0),
        max: lanes(1),
        child,
    }
}
