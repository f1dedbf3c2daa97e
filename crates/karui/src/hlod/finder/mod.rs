//! Which of many clusters is most like one of them: a tree of boxes over places
//! that clusters take, come to and leave.
//!
//! What is found does not depend on how the tree is built: of all active clusters
//! the one of least `(Omega0, number)`.

mod layout;
mod node;

use super::omega::{OmegaOptions, Seen, between};
use node::{Frame, Node, Query};
use rayon::prelude::*;
use smallvec::SmallVec;

/// Stands for no cluster.
const NONE: u32 = u32::MAX;
/// Places that share a box of their own, at most.
const BUCKET: usize = 8;

/// Nodes that may hold a better partner, with their bounds.
type Open = SmallVec<[(f64, usize); 36]>;

/// Active clusters, ready to be searched.
pub(super) struct Finder<'a> {
    options: &'a OmegaOptions,
    frame: Frame,
    places: Vec<Place>,
    /// A binary tree in the order of a heap, the root at 1; its leaves are the
    /// buckets.
    nodes: Vec<Node>,
    /// A power of two.
    buckets: usize,
    /// Place of every cluster there ever was.
    place_of: Vec<u32>,
    alive: usize,
}

/// A place and who is there.
#[derive(Clone, Copy)]
struct Place {
    seen: Seen,
    cluster: u32,
}

/// The partner found for a cluster.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Nearest {
    pub omega: f64,
    pub cluster: u32,
}

impl Nearest {
    /// Whether no pair of at least `omega` with a cluster not before `cluster` is
    /// better.
    fn beats(&self, omega: f64, cluster: u32) -> bool {
        omega > self.omega || omega == self.omega && cluster >= self.cluster
    }
}

impl<'a> Finder<'a> {
    /// Clusters numbered by their order.
    pub fn new(clusters: &[Seen], options: &'a OmegaOptions) -> Self {
        let place = |(i, &seen): (usize, &Seen)| Place {
            seen,
            cluster: i as u32,
        };
        let mut finder = Self {
            options,
            frame: Frame::around(clusters.iter().map(|c| &c.object.bounds)),
            places: clusters.iter().enumerate().map(place).collect(),
            nodes: Vec::new(),
            buckets: 1,
            place_of: vec![NONE; clusters.len()],
            alive: clusters.len(),
        };
        finder.arrange();
        finder
    }

    pub fn is_active(&self, cluster: u32) -> bool {
        self.place_of[cluster as usize] != NONE
    }

    pub fn seen(&self, cluster: u32) -> &Seen {
        &self.places[self.place_of[cluster as usize] as usize].seen
    }

    /// The active partner of least `(Omega0, number)`, if one is below `limit`.
    pub fn nearest(&self, cluster: u32, limit: f64) -> Option<Nearest> {
        let place = self.place_of[cluster as usize] as usize;
        let seen = &self.places[place].seen;
        let query = Query::new(seen, &self.frame);
        let mut best = Nearest {
            omega: limit,
            cluster: 0,
        };
        let mut node = self.buckets + self.bucket_of(place);
        self.search_bucket(node, cluster, seen, &mut best);
        let mut open = Open::new();
        // From its own place upwards: what is near is mostly what is alike.
        while node > 1 {
            let beside = [self.bounded(node ^ 1, &query)];
            self.note(beside, &best, &mut open);
            self.search(cluster, &query, &mut open, &mut best);
            node /= 2;
        }
        (best.omega < limit).then_some(best)
    }

    /// Searches all that is open, the most promising of two children first.
    fn search(&self, cluster: u32, query: &Query<'_>, open: &mut Open, best: &mut Nearest) {
        while let Some((bound, node)) = open.pop() {
            if best.beats(bound, self.nodes[node].first) {
                continue;
            }
            if node >= self.buckets {
                self.search_bucket(node, cluster, query.seen, best);
                continue;
            }
            let [a, b] = [2 * node, 2 * node + 1].map(|child| self.bounded(child, query));
            let promise = |(bound, node): (f64, usize)| (bound, self.nodes[node].first);
            let children = if promise(a) <= promise(b) {
                [b, a]
            } else {
                [a, b]
            };
            self.note(children, best, open);
        }
    }

    fn bounded(&self, node: usize, query: &Query<'_>) -> (f64, usize) {
        let bound = query.bound(&self.nodes[node], &self.frame, self.options);
        (bound, node)
    }

    fn note<const N: usize>(&self, nodes: [(f64, usize); N], best: &Nearest, open: &mut Open) {
        let may_hold = |&(bound, node): &(f64, usize)| !best.beats(bound, self.nodes[node].first);
        for node in nodes.into_iter().filter(may_hold) {
            open.push(node);
        }
    }

    fn search_bucket(&self, node: usize, cluster: u32, seen: &Seen, best: &mut Nearest) {
        for other in &self.places[self.bucket(node - self.buckets)] {
            if other.cluster == NONE || other.cluster == cluster {
                continue;
            }
            let omega = between(seen, &other.seen, self.options);
            if !best.beats(omega, other.cluster) {
                *best = Nearest {
                    omega,
                    cluster: other.cluster,
                };
            }
        }
    }

    /// Puts a new cluster, the next in number, where `members` were.
    pub fn merge(&mut self, members: [u32; 2], seen: Seen) {
        let [kept, left] = members.map(|m| self.place_of[m as usize]);
        let cluster = self.place_of.len() as u32;
        for member in members {
            self.place_of[member as usize] = NONE;
        }
        self.place_of.push(kept);
        self.places[kept as usize] = Place { seen, cluster };
        self.places[left as usize].cluster = NONE;
        self.alive -= 1;
        if 2 * self.alive < self.places.len() && self.places.len() > BUCKET {
            self.places.retain(|p| p.cluster != NONE);
            self.arrange();
            return;
        }
        self.refit(kept as usize);
        self.refit(left as usize);
    }

    fn arrange(&mut self) {
        layout::sort(&mut self.places, self.options);
        self.buckets = layout::buckets(self.places.len());
        for (i, place) in self.places.iter().enumerate() {
            self.place_of[place.cluster as usize] = i as u32;
        }
        let leaves: Vec<Node> = (0..self.buckets)
            .into_par_iter()
            .map(|b| self.bucket_node(b))
            .collect();
        self.nodes = vec![Node::EMPTY; self.buckets];
        self.nodes.extend(leaves);
        for i in (1..self.buckets).rev() {
            self.nodes[i] = self.nodes[2 * i].union(&self.nodes[2 * i + 1]);
        }
    }

    fn refit(&mut self, place: usize) {
        let bucket = self.bucket_of(place);
        let mut node = self.buckets + bucket;
        self.nodes[node] = self.bucket_node(bucket);
        while node > 1 {
            node /= 2;
            let union = self.nodes[2 * node].union(&self.nodes[2 * node + 1]);
            if self.nodes[node] == union {
                break;
            }
            self.nodes[node] = union;
        }
    }

    fn bucket_node(&self, bucket: usize) -> Node {
        let places = self.places[self.bucket(bucket)].iter();
        places
            .filter(|p| p.cluster != NONE)
            .map(|p| Node::of(&p.seen, p.cluster, &self.frame))
            .fold(Node::EMPTY, |node, next| node.union(&next))
    }

    fn bucket(&self, bucket: usize) -> std::ops::Range<usize> {
        layout::start(bucket, self.buckets, self.places.len())
            ..layout::start(bucket + 1, self.buckets, self.places.len())
    }

    fn bucket_of(&self, place: usize) -> usize {
        ((place + 1) * self.buckets - 1) / self.places.len()
    }
}
