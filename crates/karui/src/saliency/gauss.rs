//! Gaussian means over the samples of a surface, at a cost a sample that hardly
//! grows with their density.
//!
//! A tree over the samples serves every width. Its leaves hold eight samples, the
//! lanes of the vector unit, and ask together: a node that the cut leaves whole and
//! that is narrow beside the Gaussian stands for its samples, with their number and
//! the sum and first moments of their values about their centroid. Where the cut
//! goes through, samples count one by one, down to nodes so small that the noise of
//! what lies on which side is lost: the cut makes small maxima, and suppression
//! counts every one of them.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Where the Gaussian is cut, in its widths.
pub(super) const CUT: f64 = 2.0;
/// Samples of a leaf, all filled but for the last.
const LANES: usize = 8;
/// Widest diagonal of a node that stands for its samples, in widths.
const WIDEST: f32 = 0.4;
/// Narrowest node that the cut divides, in widths; of a narrower one the share inside
/// is taken from how far its samples lie apart.
const NARROWEST: f32 = 0.15;
/// Samples for which building a tree is worth a task.
const TASK: usize = 4096;

/// Samples by place. Everything is in a power of two of the model's unit that makes the
/// diagonal about 1, so that no position is rounded.
pub(super) struct Tree {
    scale: f64,
    /// Samples by leaf.
    order: Vec<u32>,
    leaves: Vec<Leaf>,
    /// A node, then its left half, then its right half.
    nodes: Vec<Node>,
}

#[derive(Clone, Copy)]
struct Sample {
    place: Vec3,
    value: f32,
    index: u32,
}

struct Leaf {
    place: [[f32; LANES]; 3],
    value: [f32; LANES],
    filled: usize,
    least: Vec3,
    most: Vec3,
}

struct Node {
    least: Vec3,
    most: Vec3,
    diagonal: f32,
    centroid: Vec3,
    count: f32,
    sum: f32,
    moment: Vec3,
    /// Width of the samples along one direction.
    breadth: f32,
    /// The node after all below this one.
    skip: u32,
    /// Its samples, if it is a leaf.
    leaf: Option<u32>,
}

/// What a node knows of its samples while the tree is made.
#[derive(Clone, Copy)]
struct Gathered {
    least: Vec3,
    most: Vec3,
    count: f64,
    centroid: DVec3,
    sum: f64,
    moment: DVec3,
    /// Squared distances from the centroid.
    apart: f64,
}

impl Tree {
    /// Of `points` within f32 in a box of this `diagonal`; values are within f32.
    pub(super) fn new(points: &[DVec3], values: &[f64], diagonal: f64) -> Self {
        let scale = match diagonal > 0.0 {
            true => (-diagonal.log2().ceil()).exp2(),
            false => 1.0,
        };
        let sample = |(i, (p, v)): (usize, (&DVec3, &f64))| Sample {
            place: (*p * scale).as_vec3(),
            value: *v as f32,
            index: i as u32,
        };
        let each = points.par_iter().zip(values).enumerate();
        let mut samples: Vec<Sample> = each.map(sample).collect();
        arrange(&mut samples);
        let mut tree = Self {
            scale,
            order: samples.iter().map(|s| s.index).collect(),
            leaves: samples.par_chunks(LANES).map(Leaf::of).collect(),
            nodes: Vec::new(),
        };
        if !samples.is_empty() {
            tree.gather(&samples, 0);
        }
        tree
    }

    /// Adds the node of `samples`, the first of which are of leaf `first`.
    fn gather(&mut self, samples: &[Sample], first: usize) -> Gathered {
        let own = self.nodes.len();
        let leaf = (samples.len() <= LANES).then_some(first as u32);
        let gathered = if leaf.is_some() {
            let gathered = Gathered::of(samples);
            self.nodes.push(gathered.node(leaf));
            gathered
        } else {
            let half = half(samples.len());
            self.nodes.push(Gathered::of(&samples[..1]).node(None));
            let left = self.gather(&samples[..half], first);
            let right = self.gather(&samples[half..], first + half / LANES);
            let gathered = left.join(&right);
            self.nodes[own] = gathered.node(None);
            gathered
        };
        self.nodes[own].skip = self.nodes.len() as u32;
        gathered
    }

    /// For every point the mean of the values within [`CUT`] `width` of it, weighted by a
    /// Gaussian of this `width`.
    pub(super) fn means(&self, width: f64) -> Vec<f64> {
        let width = (width * self.scale) as f32;
        let leaves = self.leaves.par_iter();
        let found: Vec<[f32; LANES]> = leaves.map(|leaf| self.look(leaf, width)).collect();
        let mut means = vec![0.0; self.order.len()];
        for (&index, mean) in self.order.iter().zip(found.into_iter().flatten()) {
            means[index as usize] = f64::from(mean);
        }
        means
    }

    /// Means at the samples of a leaf.
    fn look(&self, home: &Leaf, width: f32) -> [f32; LANES] {
        // Boxes so close to the cut that rounding decides are asked for their samples.
        const CLOSE: f32 = 1e-5;
        let cut = (CUT * CUT) as f32 * width * width;
        let (inside, outside) = (cut * (1.0 - CLOSE), cut * (1.0 + CLOSE));
        let (widest, narrowest) = (WIDEST * width, NARROWEST * width);
        let mut sums = Sums::at(home, width);
        let mut at = 0;
        while let Some(node) = self.nodes.get(at) {
            let skip = node.skip as usize;
            let whole = home.reach_squared(node) < inside;
            let narrow = node.diagonal <= if whole { widest } else { narrowest };
            at = match node.leaf {
                _ if home.gap_squared(node) > outside => skip,
                _ if narrow && whole => sums.add_whole(node, skip),
                _ if narrow => sums.add_share(node, skip),
                Some(leaf) if whole => sums.add_each::<true>(&self.leaves[leaf as usize], skip),
                Some(leaf) => sums.add_each::<false>(&self.leaves[leaf as usize], skip),
                None => at + 1,
            };
        }
        sums.means()
    }
}

/// Samples of the left half: whole leaves.
fn half(count: usize) -> usize {
    count.div_ceil(LANES) / 2 * LANES
}

/// Orders samples by leaf, every node halved across its longest side.
fn arrange(samples: &mut [Sample]) {
    if samples.len() <= LANES {
        return;
    }
    let half = half(samples.len());
    let (least, most) = bounds(samples);
    let axis = (most - least).max_position();
    let along = |a: &Sample, b: &Sample| {
        let places = a.place[axis].total_cmp(&b.place[axis]);
        places.then(a.index.cmp(&b.index))
    };
    samples.select_nth_unstable_by(half, along);
    let (left, right) = samples.split_at_mut(half);
    if left.len() < TASK {
        arrange(left);
        arrange(right);
    } else {
        rayon::join(|| arrange(left), || arrange(right));
    }
}

fn bounds(samples: &[Sample]) -> (Vec3, Vec3) {
    let none = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let widen = |(least, most): (Vec3, Vec3), s: &Sample| (least.min(s.place), most.max(s.place));
    samples.iter().fold(none, widen)
}

impl Leaf {
    /// Lanes left over repeat the first sample.
    fn of(samples: &[Sample]) -> Self {
        let at = |l: usize| samples.get(l).unwrap_or(&samples[0]);
        let (least, most) = bounds(samples);
        Self {
            place: [0, 1, 2].map(|k| std::array::from_fn(|l| at(l).place[k])),
            value: std::array::from_fn(|l| at(l).value),
            filled: samples.len(),
            least,
            most,
        }
    }

    /// Squared distance between the boxes.
    fn gap_squared(&self, node: &Node) -> f32 {
        let gap = (node.least - self.most).max(self.least - node.most);
        gap.max(Vec3::ZERO).length_squared()
    }

    /// Squared distance between the farthest corners of the boxes.
    fn reach_squared(&self, node: &Node) -> f32 {
        let reach = (node.most - self.least).max(self.most - node.least);
        reach.length_squared()
    }
}

impl Gathered {
    fn of(samples: &[Sample]) -> Self {
        let place = |s: &Sample| s.place.as_dvec3();
        let each = samples.iter();
        let count = samples.len() as f64;
        let centroid = each.clone().map(place).sum::<DVec3>() / count;
        let moment = |s: &Sample| f64::from(s.value) * (place(s) - centroid);
        let (least, most) = bounds(samples);
        Self {
            least,
            most,
            count,
            centroid,
            sum: each.clone().map(|s| f64::from(s.value)).sum(),
            moment: each.clone().map(moment).sum(),
            apart: each.map(|s| place(s).distance_squared(centroid)).sum(),
        }
    }

    fn join(&self, other: &Self) -> Self {
        let count = self.count + other.count;
        let centroid = (self.centroid * self.count + other.centroid * other.count) / count;
        let moment = |g: &Self| g.moment + g.sum * (g.centroid - centroid);
        let apart = |g: &Self| g.apart + g.count * g.centroid.distance_squared(centroid);
        Self {
            least: self.least.min(other.least),
            most: self.most.max(other.most),
            count,
            centroid,
            sum: self.sum + other.sum,
            moment: moment(self) + moment(other),
            apart: apart(self) + apart(other),
        }
    }

    fn node(&self, leaf: Option<u32>) -> Node {
        // A surface has two directions, and what is spread evenly is sqrt(12) times as
        // wide as its deviation.
        let breadth = (6.0 * self.apart / self.count).sqrt();
        Node {
            least: self.least,
            most: self.most,
            diagonal: self.least.distance(self.most),
            centroid: self.centroid.as_vec3(),
            count: self.count as f32,
            sum: self.sum as f32,
            moment: self.moment.as_vec3(),
            breadth: breadth as f32,
            skip: 0,
            leaf,
        }
    }
}

/// Weighted sums at the samples of a leaf, a lane each, in an order that does not depend
/// on the machine.
struct Sums<'a> {
    home: &'a Leaf,
    /// By the width squared.
    inverse: f32,
    sums: [f32; LANES],
    weights: [f32; LANES],
}

impl<'a> Sums<'a> {
    fn at(home: &'a Leaf, width: f32) -> Self {
        Self {
            home,
            inverse: (width * width).recip(),
            sums: [0.0; LANES],
            weights: [0.0; LANES],
        }
    }

    /// Sample by sample, those within the cut; all are if the leaf is `WHOLE`.
    #[inline]
    fn add_each<const WHOLE: bool>(&mut self, leaf: &Leaf, skip: usize) -> usize {
        let [x, y, z] = self.home.place;
        let (mut sums, mut weights) = (self.sums, self.weights);
        for s in 0..leaf.filled {
            let [at, up, off] = leaf.place.map(|p| p[s]);
            let value = leaf.value[s];
            for l in 0..LANES {
                let squared = square([at - x[l], up - y[l], off - z[l]]) * self.inverse;
                let weight = match WHOLE {
                    true => gaussian(squared),
                    false => cut(squared, gaussian(squared.min(CUT_SQUARED))),
                };
                sums[l] += value * weight;
                weights[l] += weight;
            }
        }
        (self.sums, self.weights) = (sums, weights);
        skip
    }

    fn add_whole(&mut self, node: &Node, skip: usize) -> usize {
        self.add_node(node, |_| 1.0);
        skip
    }

    fn add_share(&mut self, node: &Node, skip: usize) -> usize {
        let breadth = node.breadth * self.inverse.sqrt();
        let slope = 0.5 / CUT as f32 / breadth.max(1e-6);
        let inside = |squared: f32| ((CUT_SQUARED - squared) * slope + 0.5).clamp(0.0, 1.0);
        self.add_node(node, inside);
        skip
    }

    #[inline]
    fn add_node(&mut self, node: &Node, inside: impl Fn(f32) -> f32) {
        let moment = node.moment * self.inverse;
        let [x, y, z] = self.home.place;
        for l in 0..LANES {
            let way = node.centroid - Vec3::new(x[l], y[l], z[l]);
            let squared = square(way.into()) * self.inverse;
            let weight = gaussian(squared.min(2.0 * CUT_SQUARED)) * inside(squared);
            let sum = node.sum - (way.x * moment.x + way.y * moment.y + way.z * moment.z);
            self.sums[l] += sum * weight;
            self.weights[l] += node.count * weight;
        }
    }

    fn means(&self) -> [f32; LANES] {
        let mean = |l: usize| match self.weights[l] > 0.0 {
            true => self.sums[l] / self.weights[l],
            false => 0.0,
        };
        std::array::from_fn(mean)
    }
}

const CUT_SQUARED: f32 = (CUT * CUT) as f32;

/// The weight if inside, else 0; without a branch, for the vector unit.
#[inline]
fn cut(squared: f32, weight: f32) -> f32 {
    let mask = u32::from(squared < CUT_SQUARED).wrapping_neg();
    f32::from_bits(weight.to_bits() & mask)
}

#[inline]
fn square([x, y, z]: [f32; 3]) -> f32 {
    x * x + y * y + z * z
}

/// `exp(-squared / 2)` to 1e-4 of itself up to the cut and a little beyond: the eighth
/// power of a cubic, which meets the exponential at four places, without libm.
#[inline]
fn gaussian(squared: f32) -> f32 {
    let y = squared * -0.0625;
    let cubic = 0.999_998_87 + y * (0.999_852_4 + y * (0.497_022_4 + y * 0.147_197_77));
    let square = cubic * cubic;
    let fourth = square * square;
    fourth * fourth
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gaussian_is_the_library_s() {
        for i in 0..400 {
            let squared = i as f32 / 100.0;
            let exact = (-f64::from(squared) / 2.0).exp();
            let off = f64::from(gaussian(squared)) / exact - 1.0;
            assert!(off.abs() < 1e-4, "{squared}: {off}");
        }
    }

    #[test]
    fn a_tree_holds_every_sample_once_in_full_leaves() {
        for count in [0, 1, 7, 8, 9, 64, 1001] {
            let place = |i: usize| DVec3::new((i % 10) as f64, (i / 10) as f64, 0.0);
            let places: Vec<DVec3> = (0..count).map(place).collect();
            let tree = Tree::new(&places, &vec![0.5; count], 100.0);
            let mut order = tree.order.clone();
            order.sort_unstable();
            assert!(order.into_iter().eq(0..count as u32));
            let full = |l: &&Leaf| l.filled == LANES;
            assert_eq!(tree.leaves.iter().filter(full).count(), count / LANES);
            assert_eq!(tree.nodes.len(), (2 * tree.leaves.len()).saturating_sub(1));
            assert!(tree.means(3.0).iter().all(|m| (m - 0.5).abs() < 1e-6));
        }
    }
}
