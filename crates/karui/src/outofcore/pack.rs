//! Makes a block of a mesh: triangles by key, in pages.

use super::block::{BUCKETS, Bucket, COSTS, Head, Page, Place, Rim, Sample};
use super::block::{block_bytes, place, rim_bytes};
use super::bytes::{put_triples, put_values};
use super::checksum::{checksum, mixed};
use super::fans::Fans;
use super::keys::Keys;
use crate::mesh::{Attribute, PositionIds};
use glam::Vec3;

/// Triangles of a page at least, but of the last.
const PAGE: usize = 8192;

/// What a block is made of.
pub(super) struct Contents<'a> {
    pub positions: &'a [Vec3],
    pub triangles: &'a [[u32; 3]],
    pub columns: &'a [Attribute],
    /// What collapses cost at each vertex ([`super::load`]), if somebody has looked.
    pub costs: Option<&'a [u16]>,
    /// Triangles of a sample at most.
    pub sample: u64,
}

/// The bytes of a block; `head` brings level, number, error and price.
pub(super) fn pack(contents: &Contents<'_>, keys: &Keys, head: Head) -> Vec<u8> {
    let sorted = sorted(contents, keys);
    let places = PositionIds::of(contents.positions);
    let fans = Fans::of(&places, contents.triangles, |_| true);
    let is_rim = |v: u32| fans.is_open(places.of_vertex[v as usize]);
    let mut local = Local::new(contents.positions.len());
    let mut head = Head {
        layout: contents.columns.iter().map(Attribute::empty_like).collect(),
        triangles: sorted.len() as u64,
        ..head
    };
    let mut pages = Vec::new();
    for run in runs(&sorted) {
        let (vertices, bytes) = local.page(contents, run, is_rim);
        head.pages.push(Page {
            first: run[0].0,
            last: run[run.len() - 1].0,
            bytes: bytes.len() as u64,
            vertices,
            triangles: run.len() as u32,
            checksum: checksum(&bytes),
        });
        head.vertices += u64::from(vertices);
        pages.push(bytes);
    }
    head.samples = samples(contents, &sorted);
    let buckets = rims(contents, &sorted, is_rim);
    head.buckets = buckets.iter().map(|rims| bucket(rims)).collect();
    block_bytes(&head, &pages, &buckets)
}

fn bucket(bytes: &[u8]) -> Bucket {
    Bucket {
        rims: (bytes.len() / rim_bytes(&[NO_RIM]).len()) as u32,
        checksum: checksum(bytes),
    }
}

const NO_RIM: Rim = Rim {
    place: [0; 3],
    key: 0,
};

/// Keys and triangles, in order.
fn sorted(contents: &Contents<'_>, keys: &Keys) -> Vec<(u64, u32)> {
    let corners = |t: &[u32; 3]| t.map(|v| contents.positions[v as usize]);
    let key = |(t, i)| (keys.key(corners(t)), i);
    let mut sorted: Vec<(u64, u32)> = contents.triangles.iter().zip(0..).map(key).collect();
    sorted.sort_unstable();
    sorted
}

/// Cuts into pages, never within one key.
fn runs(mut sorted: &[(u64, u32)]) -> Vec<&[(u64, u32)]> {
    let mut runs = Vec::new();
    while !sorted.is_empty() {
        let last = sorted[(PAGE - 1).min(sorted.len() - 1)].0;
        let end = sorted.partition_point(|&(key, _)| key <= last);
        let (run, rest) = sorted.split_at(end);
        runs.push(run);
        sorted = rest;
    }
    runs
}

fn samples(contents: &Contents<'_>, sorted: &[(u64, u32)]) -> Vec<Sample> {
    let mut samples: Vec<Sample> = Vec::new();
    let mut start = 0;
    let mut end = 0;
    let mut close = |range: std::ops::Range<usize>| {
        let few = &sorted[range];
        samples.extend(few.first().map(|&(key, _)| Sample {
            key,
            triangles: few.len() as u32,
            costs: costs(contents, few),
        }));
    };
    // Triangles of one key stay together: they cannot be cut apart.
    for run in sorted.chunk_by(|a, b| a.0 == b.0) {
        if (end - start + run.len()) as u64 > contents.sample {
            close(start..end);
            start = end;
        }
        end += run.len();
    }
    close(start..end);
    samples
}

/// Costs at the corners of some triangles: the middles of equal parts.
fn costs(contents: &Contents<'_>, few: &[(u64, u32)]) -> [u16; COSTS] {
    let Some(costs) = contents.costs else {
        return [0; COSTS];
    };
    let corners = few
        .iter()
        .flat_map(|&(_, t)| contents.triangles[t as usize]);
    let mut all: Vec<u16> = corners.map(|v| costs[v as usize]).collect();
    all.sort_unstable();
    std::array::from_fn(|i| all[(2 * i + 1) * all.len() / (2 * COSTS)])
}

/// Rims as bytes by bucket, each in order and once.
fn rims(
    contents: &Contents<'_>,
    sorted: &[(u64, u32)],
    is_rim: impl Fn(u32) -> bool,
) -> Vec<Vec<u8>> {
    let mut rims = Vec::new();
    for &(key, t) in sorted {
        let corners = contents.triangles[t as usize].into_iter();
        rims.extend(corners.filter(|&v| is_rim(v)).map(|v| Rim {
            place: place(contents.positions[v as usize]),
            key,
        }));
    }
    let mut buckets = vec![Vec::new(); BUCKETS];
    for rim in rims {
        buckets[bucket_of(rim.place)].push(rim);
    }
    let bytes = |mut rims: Vec<Rim>| {
        rims.sort_unstable();
        rims.dedup();
        rim_bytes(&rims)
    };
    buckets.into_iter().map(bytes).collect()
}

fn bucket_of(place: Place) -> usize {
    let hash = place.into_iter().fold(1, |h, x| mixed(h, x.into()));
    (hash >> 32) as usize % BUCKETS
}

/// Numbers of vertices within a page.
struct Local {
    number: Vec<u32>,
    /// The page that the number is of.
    page: Vec<u32>,
    now: u32,
}

impl Local {
    fn new(vertices: usize) -> Self {
        Self {
            number: vec![0; vertices],
            page: vec![0; vertices],
            now: 0,
        }
    }

    /// Vertices and bytes of a page.
    fn page(
        &mut self,
        contents: &Contents<'_>,
        run: &[(u64, u32)],
        is_rim: impl Fn(u32) -> bool,
    ) -> (u32, Vec<u8>) {
        self.now += 1;
        let mut vertices: Vec<u32> = Vec::new();
        let mut triangles = Vec::with_capacity(run.len());
        for &(_, t) in run {
            triangles.push(contents.triangles[t as usize].map(|v| self.number(v, &mut vertices)));
        }
        let mut bytes = Vec::new();
        bytes.extend((vertices.len() as u32).to_le_bytes());
        bytes.extend((run.len() as u32).to_le_bytes());
        let bits = |&v: &u32| contents.positions[v as usize].to_array().map(f32::to_bits);
        put_triples(&mut bytes, vertices.iter().map(bits));
        bytes.extend(vertices.iter().map(|&v| u8::from(is_rim(v))));
        put_triples(&mut bytes, triangles.into_iter());
        let columns = contents.columns.iter();
        columns.for_each(|column| put_values(&mut bytes, column, &vertices));
        (vertices.len() as u32, bytes)
    }

    fn number(&mut self, v: u32, vertices: &mut Vec<u32>) -> u32 {
        let i = v as usize;
        if self.page[i] != self.now {
            self.page[i] = self.now;
            self.number[i] = vertices.len() as u32;
            vertices.push(v);
        }
        self.number[i]
    }
}
