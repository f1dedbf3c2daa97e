//! The result, streamed out of its blocks with the vertices that they share made one.

use super::block::{Block, Head, Part, Place, place};
use super::columns::attributes;
use super::drive::before_writing;
use super::weld::{hash, weld};
use super::{Manifest, Plan, Result, Store, Vertices};
use crate::mesh::{Attribute, Attributes};
use crate::progress::{Progress, step};
use crate::simplify::Stopped;

/// Takes a mesh in pieces: [`begin`](Sink::begin), all vertices, then all triangles.
pub trait Sink {
    /// How much will come; `layout` has the attributes without values.
    ///
    /// # Errors
    /// [`super::Error::Sink`].
    fn begin(&mut self, vertices: u64, triangles: u64, layout: &Attributes) -> Result<()>;

    /// The next vertices.
    ///
    /// # Errors
    /// [`super::Error::Sink`].
    fn vertices(&mut self, vertices: &Vertices) -> Result<()>;

    /// The next triangles, by the numbers of their vertices in the order they came.
    ///
    /// # Errors
    /// [`super::Error::Sink`].
    fn triangles(&mut self, triangles: &[[u64; 3]]) -> Result<()>;
}

/// What was written.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Summary {
    /// Triangles of the input.
    pub input: u64,
    /// Vertices of the result.
    pub vertices: u64,
    /// Triangles of the result.
    pub triangles: u64,
    /// How far the result may be from the input as the simplifier estimates it, summed over
    /// all levels, model units.
    pub error: f64,
    /// Triangles that were wanted; 0 if only the error counted.
    pub target: u64,
    /// Why there are more: what stopped the regions that have most beyond their share.
    /// `None` if there are as many as were wanted, or fewer.
    pub stopped: Option<Stopped>,
}

/// A vertex that several blocks may have: place and attributes.
type Shared = (Place, u64);

/// Streams the blocks of the last manifest into `sink`. Takes the memory of one block and
/// of the rims of all.
///
/// # Errors
/// Those of the store, of damaged blocks and of the sink; [`crate::Error::Cancelled`].
pub fn write(
    store: &dyn Store,
    manifest: &Manifest,
    sink: &mut dyn Sink,
    progress: &dyn Progress,
) -> Result<Summary> {
    let count = manifest.rows.len();
    let start = before_writing(&Plan::load(store)?);
    let report = |done: usize| -> Result<()> {
        let share = done as f32 / (3 * count.max(1)) as f32;
        Ok(step(progress, "write", start + (1.0 - start) * share)?)
    };
    let mut summary = Summary {
        input: manifest.phase.whole,
        target: manifest.phase.target,
        ..Summary::default()
    };
    let mut layout = Attributes::default();
    let (mut shared, mut stops) = (Vec::new(), Vec::new());
    for (done, row) in manifest.rows.iter().enumerate() {
        report(done)?;
        let (part, head) = whole(store, &row.output)?;
        summary.triangles += head.triangles;
        summary.error = summary.error.max(head.error);
        let beyond = head.triangles.saturating_sub(row.target);
        stops.extend(head.stopped.map(|stopped| (stopped, beyond)));
        let rims = (0..part.positions.len()).filter_map(|v| rim(&part, v));
        shared.extend(rims.map(|shared| (shared, done as u32)));
        summary.vertices += part.rim.iter().filter(|&&rim| !rim).count() as u64;
        layout = attributes(part.columns.iter().map(Attribute::empty_like).collect());
    }
    let is_short = summary.triangles > summary.target;
    summary.stopped = is_short.then(|| most_short(&stops)).flatten();
    let mut numbers = Numbers::of(shared);
    summary.vertices += numbers.owned.len() as u64;
    sink.begin(summary.vertices, summary.triangles, &layout)?;
    let mut next = 0;
    for (done, row) in manifest.rows.iter().enumerate() {
        report(count + done)?;
        let (part, _) = whole(store, &row.output)?;
        let (new, after) = numbers.number(&part, done as u32, next);
        sink.vertices(&chosen(&part, &new))?;
        next = after;
    }
    next = 0;
    for (done, row) in manifest.rows.iter().enumerate() {
        report(2 * count + done)?;
        let (part, _) = whole(store, &row.output)?;
        let (vertices, after) = numbers.numbered(&part, done as u32, next);
        let triangles = part.triangles.iter();
        let triangles: Vec<_> = triangles.map(|t| t.map(|v| vertices[v as usize])).collect();
        sink.triangles(&triangles)?;
        next = after;
    }
    report(3 * count)?;
    Ok(summary)
}

/// The reason with most triangles beyond the shares of its regions; of equals the first.
fn most_short(stops: &[(Stopped, u64)]) -> Option<Stopped> {
    let beyond = |reason| {
        let same = stops.iter().filter(|s| s.0 == reason);
        same.map(|s| s.1).sum::<u64>()
    };
    let short = stops.iter().filter(|s| s.1 > 0).rev();
    short.max_by_key(|s| beyond(s.0)).map(|s| s.0)
}

/// A block with every vertex once, and its head.
pub(super) fn whole(store: &dyn Store, name: &str) -> Result<(Part, Head)> {
    let block = Block::open(store, name)?;
    let mut all = Part::default();
    for part in block.pages(0..block.head.pages.len())? {
        all.append(part);
    }
    Ok((weld(all), block.head))
}

/// What a vertex is to other blocks, if it may be something to them.
fn rim(part: &Part, vertex: usize) -> Option<Shared> {
    let shared = || (place(part.positions[vertex]), hash(&part.columns, vertex));
    part.rim[vertex].then(shared)
}

fn chosen(part: &Part, vertices: &[u32]) -> Vertices {
    let columns = part.columns.iter().map(|c| c.gathered(vertices)).collect();
    Vertices {
        positions: vertices
            .iter()
            .map(|&v| part.positions[v as usize])
            .collect(),
        attributes: attributes(columns),
    }
}

/// Numbers of the vertices that several blocks may have. The first block that has one
/// brings it.
struct Numbers {
    shared: Vec<Shared>,
    /// The block that brings each, and the number it gets.
    owned: Vec<(u32, u64)>,
}

impl Numbers {
    fn of(mut shared: Vec<(Shared, u32)>) -> Self {
        shared.sort_unstable();
        shared.dedup_by_key(|s| s.0);
        Self {
            owned: shared.iter().map(|s| (s.1, 0)).collect(),
            shared: shared.into_iter().map(|s| s.0).collect(),
        }
    }

    /// The entry of a vertex that several blocks may have.
    fn entry(&self, part: &Part, vertex: usize) -> Option<usize> {
        self.shared.binary_search(&rim(part, vertex)?).ok()
    }

    /// Gives the vertices that this block brings their numbers from `next` on; these
    /// vertices, and what is next.
    fn number(&mut self, part: &Part, block: u32, mut next: u64) -> (Vec<u32>, u64) {
        let mut new = Vec::new();
        for v in 0..part.positions.len() {
            match self.entry(part, v).map(|entry| &mut self.owned[entry]) {
                Some((owner, _)) if *owner != block => continue,
                Some((_, number)) => *number = next,
                None => {}
            }
            new.push(v as u32);
            next += 1;
        }
        (new, next)
    }

    /// The number of every vertex, and what is next.
    fn numbered(&self, part: &Part, block: u32, mut next: u64) -> (Vec<u64>, u64) {
        let number = |v| match self.entry(part, v).map(|entry| self.owned[entry]) {
            Some((owner, number)) if owner != block => number,
            _ => {
                next += 1;
                next - 1
            }
        };
        let numbers = (0..part.positions.len()).map(number).collect();
        (numbers, next)
    }
}
