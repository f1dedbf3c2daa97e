//! One cell: the meshes of its children together, simplified, and how far that is from them.

use super::super::block::{Head, Part, place};
use super::super::manifest::{Phase, Row};
use super::super::region::Asked;
use super::super::weld::weld;
use super::super::write::whole;
use super::super::{Result, Store};
use super::cell::Cell;
use super::edges::shared;
use super::gather::{mesh, packed};
use crate::mesh::TriMesh;
use crate::metrics::{Samples, SurfaceDistanceOptions, surface_distance};
use crate::progress::Progress;
use crate::simplify::{Quality, SimplifyOptions, Stop, simplify};
use glam::Vec3;

/// The block of the cell that `row` names.
///
/// # Errors
/// Those of the store, of damaged blocks, of the simplifier and of the measurement.
pub(in super::super) fn parent(
    store: &dyn Store,
    phase: &Phase,
    row: &Row,
    progress: &dyn Progress,
) -> Result<Vec<u8>> {
    let mut all = Part::default();
    let mut error = 0.0f64;
    for (name, ..) in &row.inputs {
        let (part, Head { error: own, .. }) = whole(store, name)?;
        error = error.max(own);
        all.append(part);
    }
    let fine = mesh(weld(all));
    let shared = shared(store, phase, row.id)?;
    let is_held = |&position: &Vec3| shared.contains(&place(position));
    let held: Vec<bool> = fine.positions.iter().map(is_held).collect();
    let within = phase.aligned.then(|| {
        let keys = phase.keys.as_ref()?;
        let cell = Cell::of(row);
        Some(keys.cube(cell.place(), cell.depth))
    });
    let coarse = coarse(&fine, &held, row.target, within.flatten(), progress)?;
    let distance = match &coarse {
        Some(coarse) => distance(&fine, coarse, progress)?,
        None => 0.0,
    };
    let head = Head {
        level: phase.level,
        number: row.id,
        error: error + distance,
        price: distance,
        ..Head::default()
    };
    packed(coarse.unwrap_or(fine), phase, head)
}

/// The mesh with about so many triangles, what moved brought back into a box; nothing where
/// that changes nothing or leaves nothing.
fn coarse(
    fine: &TriMesh,
    held: &[bool],
    target: u64,
    within: Option<[Vec3; 2]>,
    progress: &dyn Progress,
) -> Result<Option<TriMesh>> {
    if target >= fine.triangles.len() as u64 {
        return Ok(None);
    }
    let options = SimplifyOptions {
        quality: Quality::Fast,
        stop: Stop {
            triangles: Some(target as usize),
            ..Stop::default()
        },
        locks: Some(held),
        progress: &Asked(progress),
        ..SimplifyOptions::default()
    };
    let mut coarse = simplify(fine, &options)?.mesh;
    if let Some([min, max]) = within {
        let positions = coarse.positions.iter_mut();
        positions.for_each(|p| *p = p.clamp(min, max));
    }
    Ok((!coarse.triangles.is_empty()).then_some(coarse))
}

/// Samples of faces, and of edges, at least.
const SAMPLES: u64 = 20_000;

/// Two-sided distance at samples: every vertex, and one of faces and of edges for each
/// triangle of the finer mesh, or [`SAMPLES`].
fn distance(fine: &TriMesh, coarse: &TriMesh, progress: &dyn Progress) -> Result<f64> {
    let options = SurfaceDistanceOptions {
        samples: Samples::Count(SAMPLES.max(fine.triangles.len() as u64)),
        progress: &Asked(progress),
        ..SurfaceDistanceOptions::default()
    };
    Ok(surface_distance(fine, coarse, &options)?.max())
}
