//! Blocks: parts of a model in the store. Version 2, little-endian:
//!
//! - `KARUIBLK`, the version and 0 (`u32` each), bytes of the head and their checksum
//!   (`u64` each);
//! - the head: level (`u32`); number, triangles, vertices (`u64` each); error, price
//!   (`f64` each); why simplification stopped (`u32`: 0 if it was not simplified); then,
//!   each list after its length (`u32`): attributes (name, components,
//!   type), pages, samples and rim buckets, as [`Page`], [`Sample`] and [`Bucket`] have them;
//! - the pages: triangles of consecutive keys with the vertices they need. Vertices,
//!   triangles (`u32` each), positions (three `f32` each), for each vertex whether it is on
//!   the rim of the block (`u8`), triangles (three `u32` into the page each), the columns
//!   of the attributes;
//! - the rim buckets: [`Rim`]s by hash of their place.
//!
//! Every byte after the first 32 is under a checksum: of the head, which holds those of the
//! pages and buckets.

use super::bytes::{Reader, kind, put_kind, put_triples, read_values};
use super::checksum::checksum;
use super::{Error, Result, Store};
use crate::mesh::Attribute;
use crate::simplify::Stopped;
use glam::Vec3;
use std::ops::Range;

const MAGIC: [u8; 8] = *b"KARUIBLK";
const VERSION: u32 = 2;
/// Bytes before the head.
const PREFIX: u64 = 32;

/// A place in space: bits of a position in which -0 is 0.
pub(super) type Place = [u32; 3];

/// The place of a position.
pub(super) fn place(position: Vec3) -> Place {
    position.to_array().map(|x| (x + 0.0).to_bits())
}

/// What is known of a block without its triangles.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Head {
    pub level: u32,
    pub number: u64,
    pub triangles: u64,
    /// Over all pages: those at which pages meet count in each.
    pub vertices: u64,
    /// How far its surface may be from the input's, model units.
    pub error: f64,
    /// What the dearest collapse cost: the error of this level alone, model units.
    pub price: f64,
    /// Why simplification stopped, if there was one.
    pub stopped: Option<Stopped>,
    /// Columns without values.
    pub layout: Vec<Attribute>,
    pub pages: Vec<Page>,
    pub samples: Vec<Sample>,
    pub buckets: Vec<Bucket>,
}

/// A page: triangles whose keys lie in `first..=last`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Page {
    pub first: u64,
    pub last: u64,
    pub bytes: u64,
    pub vertices: u32,
    pub triangles: u32,
    pub checksum: u64,
}

/// So many triangles from this key on.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Sample {
    pub key: u64,
    pub triangles: u32,
    /// Costs of collapses there: the middles of eight equal parts, as [`super::load`] has
    /// them. 0 where nobody has looked.
    pub costs: [u16; COSTS],
}

/// Costs of a sample.
pub(super) const COSTS: usize = 8;

/// Rims whose places have the same hash.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Bucket {
    pub rims: u32,
    pub checksum: u64,
}

/// A place that other blocks may share, and the key of a triangle there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Rim {
    pub place: Place,
    pub key: u64,
}

/// Bytes of a [`Rim`] in a block.
const RIM: u64 = 20;

/// Rims of a block are dealt to so many buckets.
pub(super) const BUCKETS: usize = 256;

/// The triangles of a page, or of several.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Part {
    pub positions: Vec<Vec3>,
    /// Whether each vertex is on the rim of its block.
    pub rim: Vec<bool>,
    pub triangles: Vec<[u32; 3]>,
    pub columns: Vec<Attribute>,
}

/// Puts a block together.
pub(super) fn block_bytes(head: &Head, pages: &[Vec<u8>], buckets: &[Vec<u8>]) -> Vec<u8> {
    let head = head.to_bytes();
    let body = pages.iter().chain(buckets).map(Vec::len).sum::<usize>();
    let mut bytes = Vec::with_capacity(PREFIX as usize + head.len() + body);
    bytes.extend(MAGIC);
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend(0u32.to_le_bytes());
    bytes.extend((head.len() as u64).to_le_bytes());
    bytes.extend(checksum(&head).to_le_bytes());
    bytes.extend(head);
    let bodies = pages.iter().chain(buckets);
    bodies.for_each(|body| bytes.extend(body));
    bytes
}

/// Reasons to stop by their number in a block, from 1.
const STOPS: [Stopped; 7] = [
    Stopped::Target,
    Stopped::ErrorBound,
    Stopped::Exhausted,
    Stopped::Locked,
    Stopped::Topology,
    Stopped::Seams,
    Stopped::Flips,
];

fn stop_code(stopped: Option<Stopped>) -> u32 {
    let number = |s| STOPS.iter().position(|&other| other == s);
    stopped.and_then(number).map_or(0, |at| at as u32 + 1)
}

/// `None` for a number that means nothing.
fn stop_of_code(code: u32) -> Option<Option<Stopped>> {
    match code.checked_sub(1) {
        None => Some(None),
        Some(at) => STOPS.get(at as usize).copied().map(Some),
    }
}

impl Head {
    fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        bytes.extend(self.level.to_le_bytes());
        for number in [self.number, self.triangles, self.vertices] {
            bytes.extend(number.to_le_bytes());
        }
        for number in [self.error, self.price] {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend(stop_code(self.stopped).to_le_bytes());
        let length = |bytes: &mut Vec<u8>, n: usize| bytes.extend((n as u32).to_le_bytes());
        length(&mut bytes, self.layout.len());
        self.layout.iter().for_each(|c| put_kind(&mut bytes, c));
        length(&mut bytes, self.pages.len());
        for page in &self.pages {
            for number in [page.first, page.last, page.bytes, page.checksum] {
                bytes.extend(number.to_le_bytes());
            }
            bytes.extend(page.vertices.to_le_bytes());
            bytes.extend(page.triangles.to_le_bytes());
        }
        length(&mut bytes, self.samples.len());
        for sample in &self.samples {
            bytes.extend(sample.key.to_le_bytes());
            bytes.extend(sample.triangles.to_le_bytes());
            bytes.extend(sample.costs.map(u16::to_le_bytes).as_flattened());
        }
        length(&mut bytes, self.buckets.len());
        for bucket in &self.buckets {
            bytes.extend(bucket.rims.to_le_bytes());
            bytes.extend(bucket.checksum.to_le_bytes());
        }
        bytes
    }

    fn of_bytes(bytes: &[u8]) -> Option<Self> {
        let mut reader = Reader(bytes);
        let r = &mut reader;
        let mut head = Self {
            level: r.u32()?,
            number: r.u64()?,
            triangles: r.u64()?,
            vertices: r.u64()?,
            error: r.f64()?,
            price: r.f64()?,
            stopped: stop_of_code(r.u32()?)?,
            ..Self::default()
        };
        let count = r.u32()? as usize;
        head.layout = r.many(count, kind)?;
        let count = r.u32()? as usize;
        head.pages = r.many(count, |r| {
            let [first, last, bytes, checksum] = [r.u64()?, r.u64()?, r.u64()?, r.u64()?];
            Some(Page {
                first,
                last,
                bytes,
                checksum,
                vertices: r.u32()?,
                triangles: r.u32()?,
            })
        })?;
        let count = r.u32()? as usize;
        head.samples = r.many(count, |r| {
            Some(Sample {
                key: r.u64()?,
                triangles: r.u32()?,
                costs: r.words()?,
            })
        })?;
        let count = r.u32()? as usize;
        head.buckets = r.many(count, |r| {
            Some(Bucket {
                rims: r.u32()?,
                checksum: r.u64()?,
            })
        })?;
        reader.0.is_empty().then_some(head)
    }
}

/// A block in the store, of which the head has been read.
#[derive(Debug)]
pub(super) struct Block<'a> {
    store: &'a dyn Store,
    name: &'a str,
    /// Where the pages begin.
    body: u64,
    /// Checksum of the head, and by it of all.
    pub checksum: u64,
    pub head: Head,
}

impl std::fmt::Debug for dyn Store + '_ {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Store")
    }
}

impl<'a> Block<'a> {
    /// Reads the head.
    ///
    /// # Errors
    /// As [`Store::get_range`]; [`Error::Damaged`].
    pub fn open(store: &'a dyn Store, name: &'a str) -> Result<Self> {
        let damaged = |problem| damaged(name, problem);
        let prefix = store.get_range(name, 0..PREFIX)?;
        let mut reader = Reader(&prefix);
        if reader.take(MAGIC.len()) != Some(&MAGIC) {
            return Err(damaged("it does not begin with KARUIBLK"));
        }
        if [reader.u32(), reader.u32()] != [Some(VERSION), Some(0)] {
            return Err(damaged("the version is not 1, the only one known"));
        }
        let short = || damaged("it ends within the head");
        let length = reader.u64().ok_or_else(short)?;
        let expected = reader.u64().ok_or_else(short)?;
        let body = PREFIX.checked_add(length).ok_or_else(short)?;
        let bytes = store.get_range(name, PREFIX..body)?;
        if checksum(&bytes) != expected {
            return Err(damaged("the checksum of the head is another"));
        }
        let head = Head::of_bytes(&bytes).ok_or_else(|| damaged("the head makes no sense"))?;
        Ok(Self {
            store,
            name,
            body,
            checksum: expected,
            head,
        })
    }

    /// Reads consecutive pages, each as a part.
    ///
    /// # Errors
    /// As [`Store::get_range`]; [`Error::Damaged`].
    pub fn pages(&self, pages: Range<usize>) -> Result<Vec<Part>> {
        let damaged = |problem| damaged(self.name, problem);
        let before = self.head.pages.get(..pages.start);
        let wanted = self.head.pages.get(pages);
        let (Some(before), Some(wanted)) = (before, wanted) else {
            return Err(damaged("it has fewer pages"));
        };
        let start = self.body.saturating_add(bytes_of(before));
        let end = start.saturating_add(bytes_of(wanted));
        let bytes = self.store.get_range(self.name, start..end)?;
        let mut reader = Reader(&bytes);
        let parts = wanted.iter().map(|page| {
            let bytes = reader.take(page.bytes as usize).unwrap_or_default();
            if checksum(bytes) != page.checksum {
                return Err(damaged("the checksum of a page is another"));
            }
            let part = Part::of_bytes(bytes, &self.head.layout);
            part.ok_or_else(|| damaged("a page makes no sense"))
        });
        parts.collect()
    }

    /// Reads consecutive buckets of rims.
    ///
    /// # Errors
    /// As [`Store::get_range`]; [`Error::Damaged`].
    pub fn rims(&self, buckets: Range<usize>) -> Result<Vec<Rim>> {
        let damaged = |problem| damaged(self.name, problem);
        let before = self.head.buckets.get(..buckets.start);
        let wanted = self.head.buckets.get(buckets);
        let (Some(before), Some(wanted)) = (before, wanted) else {
            return Err(damaged("it has fewer buckets of rims"));
        };
        let bytes = |b: &[Bucket]| b.iter().map(|b| u64::from(b.rims) * RIM).sum::<u64>();
        let pages = bytes_of(&self.head.pages);
        let start = self
            .body
            .saturating_add(pages)
            .saturating_add(bytes(before));
        let end = start.saturating_add(bytes(wanted));
        let all = self.store.get_range(self.name, start..end)?;
        let mut reader = Reader(&all);
        let mut rims = Vec::new();
        for bucket in wanted {
            let bytes = reader.take(bytes(&[*bucket]) as usize).unwrap_or_default();
            if checksum(bytes) != bucket.checksum {
                return Err(damaged("the checksum of a bucket is another"));
            }
            rims.extend(bytes.as_chunks::<{ RIM as usize }>().0.iter().map(rim));
        }
        Ok(rims)
    }

    /// Reads everything, to see whether it is whole.
    ///
    /// # Errors
    /// As [`Block::pages`], [`Block::rims`].
    pub fn verify(&self) -> Result<()> {
        for page in 0..self.head.pages.len() {
            self.pages(page..page + 1)?;
        }
        self.rims(0..self.head.buckets.len()).map(drop)
    }
}

/// Bytes of some pages; a damaged head may say anything.
fn bytes_of(pages: &[Page]) -> u64 {
    let sum = |sum: u64, page: &Page| sum.saturating_add(page.bytes);
    pages.iter().fold(0, sum)
}

/// Reads the whole of a block; the number of its triangles.
///
/// # Errors
/// [`Error::Missing`], [`Error::Damaged`], those of the store.
pub fn verify_block(store: &dyn Store, name: &str) -> Result<u64> {
    let block = Block::open(store, name)?;
    block.verify()?;
    Ok(block.head.triangles)
}

fn damaged(name: &str, problem: &'static str) -> Error {
    Error::Damaged {
        name: name.into(),
        problem,
    }
}

fn rim(bytes: &[u8; RIM as usize]) -> Rim {
    let (words, _) = bytes.as_chunks::<4>();
    let [x, y, z, low, high] = std::array::from_fn(|i| u32::from_le_bytes(words[i]));
    Rim {
        place: [x, y, z],
        key: u64::from(low) | u64::from(high) << 32,
    }
}

/// A bucket as bytes.
pub(super) fn rim_bytes(rims: &[Rim]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(rims.len() * RIM as usize);
    for rim in rims {
        put_triples(&mut bytes, std::iter::once(rim.place));
        bytes.extend(rim.key.to_le_bytes());
    }
    bytes
}

impl Part {
    fn of_bytes(bytes: &[u8], layout: &[Attribute]) -> Option<Self> {
        let mut reader = Reader(bytes);
        let [vertices, triangles] = [reader.u32()? as usize, reader.u32()? as usize];
        let position = |bits: [u32; 3]| Vec3::from(bits.map(f32::from_bits));
        let positions: Vec<Vec3> = reader.triples(vertices)?.map(position).collect();
        let rim = reader.take(vertices)?.iter().map(|&b| b != 0).collect();
        let triangles: Vec<[u32; 3]> = reader.triples(triangles)?.collect();
        let is_whole = positions.iter().all(|p| p.is_finite());
        let exists = |t: &[u32; 3]| t.iter().all(|&v| (v as usize) < vertices);
        if !is_whole || !triangles.iter().all(exists) {
            return None;
        }
        let read = |kind| read_values(&mut reader, kind, vertices);
        let columns = layout.iter().map(read).collect::<Option<_>>()?;
        reader.0.is_empty().then_some(Self {
            positions,
            rim,
            triangles,
            columns,
        })
    }

    /// Adds another part of the same kind.
    pub fn append(&mut self, other: Self) {
        let first = self.positions.len() as u32;
        let moved = other.triangles.iter().map(|t| t.map(|v| v + first));
        self.triangles.extend(moved);
        self.positions.extend(other.positions);
        self.rim.extend(other.rim);
        if self.columns.is_empty() {
            self.columns = other.columns;
            return;
        }
        for (column, more) in self.columns.iter_mut().zip(other.columns) {
            column.values.append(more.values);
        }
    }
}
