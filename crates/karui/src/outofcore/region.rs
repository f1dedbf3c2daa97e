//! One region: its triangles, gathered from all blocks that have some; its borders held;
//! simplified.

use super::block::{Block, Head, Part, place};
use super::borders::{region_of, shared};
use super::columns::{attributes, columns};
use super::fans::Fans;
use super::keys::Keys;
use super::manifest::{Phase, Row};
use super::pack::{Contents, pack};
use super::weld::weld;
use super::{Error, Result, Store};
use crate::mesh::{PositionIds, TriMesh};
use crate::progress::Progress;
use crate::simplify::{Quality, SimplifyOptions, Stop, simplify};

impl Phase {
    /// An error for a phase that lacks what its rows need.
    pub(super) fn broken(&self, problem: &str) -> Error {
        Error::Manifest {
            name: self.name(".tasks"),
            line: 1,
            problem: problem.into(),
        }
    }
}

/// The block of the region that `row` names.
///
/// # Errors
/// Those of the store, of damaged blocks and of the simplifier.
pub(super) fn region(
    store: &dyn Store,
    phase: &Phase,
    row: &Row,
    progress: &dyn Progress,
) -> Result<Vec<u8>> {
    let (part, error) = gathered(store, phase, row)?;
    let locks = held(store, phase, row, &part)?;
    let mesh = TriMesh {
        positions: part.positions,
        triangles: part.triangles,
        attributes: attributes(part.columns),
        ..TriMesh::default()
    };
    let stop = Stop {
        triangles: Some(row.target as usize),
        error: phase.error,
        ..Stop::default()
    };
    let options = SimplifyOptions {
        quality: Quality::Fast,
        stop,
        locks: Some(&locks),
        progress: &Asked(progress),
        ..SimplifyOptions::default()
    };
    let simplified = simplify(&mesh, &options)?;
    drop(mesh);
    let head = Head {
        level: phase.level + 1,
        number: row.id,
        error: error + simplified.error,
        price: simplified.error,
        stopped: Some(simplified.stopped),
        ..Head::default()
    };
    let coarse = simplified.mesh;
    let columns = columns(coarse.attributes);
    let contents = Contents {
        positions: &coarse.positions,
        triangles: &coarse.triangles,
        columns: &columns,
        costs: None,
        sample: phase.sample,
    };
    let keys = phase.next.as_ref().ok_or_else(|| phase.broken("no keys"))?;
    Ok(pack(&contents, keys, head))
}

/// Lets the work be stopped, but not told: one region's share says nothing of the whole.
pub(super) struct Asked<'a>(pub &'a dyn Progress);

impl Progress for Asked<'_> {
    fn report(&self, _: &'static str, _: f32) {}
    fn cancelled(&self) -> bool {
        self.0.cancelled()
    }
}

/// The triangles of the region with every vertex once, and the largest error so far.
fn gathered(store: &dyn Store, phase: &Phase, row: &Row) -> Result<(Part, f64)> {
    let keys = phase.keys.as_ref().ok_or_else(|| phase.broken("no keys"))?;
    let mut all = Part::default();
    let mut error = 0.0f64;
    for (name, first, end) in &row.inputs {
        let block = Block::open(store, name)?;
        error = error.max(block.head.error);
        for mut part in block.pages(*first as usize..*end as usize)? {
            keep_region(&mut part, keys, &phase.cuts, row.first as usize);
            all.append(part);
        }
    }
    Ok((weld(all), error))
}

/// Leaves out the triangles of other regions.
fn keep_region(part: &mut Part, keys: &Keys, cuts: &[u64], region: usize) {
    let positions = &part.positions;
    part.triangles.retain(|t| {
        let key = keys.key(t.map(|v| positions[v as usize]));
        region_of(cuts, key) == region
    });
}

/// Which vertices other regions use, too.
fn held(store: &dyn Store, phase: &Phase, row: &Row, part: &Part) -> Result<Vec<bool>> {
    let shared = shared(store, phase, row.first)?;
    let places = PositionIds::of(&part.positions);
    // What is not on the rim of its block had all its triangles there: if some are not
    // here, a cut has gone through.
    let inside = |v: u32| !part.rim[v as usize];
    let fans = Fans::of(&places, &part.triangles, inside);
    let is_held =
        |(v, &position)| fans.is_open(places.of_vertex[v]) || shared.contains(&place(position));
    Ok(part.positions.iter().enumerate().map(is_held).collect())
}
