//! Fewer triangles: edge collapse under quadric error.
//!
//! - M. Garland, P. Heckbert: Surface Simplification Using Quadric Error
//!   Metrics, SIGGRAPH 1997.
//! - P. Lindstrom, G. Turk: Fast and Memory Efficient Polygonal
//!   Simplification, IEEE Visualization 1998.
//! - H. Hoppe: New Quadric Metric for Simplifying Meshes with Appearance
//!   Attributes, IEEE Visualization 1999.

mod blend;
mod candidate;
mod check;
mod cluster;
mod collapse;
mod exact;
mod fast;
mod features;
mod foliage;
mod guard;
pub(crate) mod log;
mod options;
mod output;
mod pairs;
mod points;
mod prune;
mod quadric;
mod refused;
pub(crate) mod rounds;
mod sheets;
mod signal;
mod state;
mod surface;
mod wedges;

pub use cluster::{ClusterOptions, Clustered, cluster};
pub use foliage::{Foliage, FoliageOptions, foliage};
pub use log::{CollapseLog, Replay, Replayed};
pub use options::{
    AttributeWeights, Blocked, Border, Cost, Placement, Quality, Simplified, SimplifyOptions, Stop,
    Stopped, Topology, TopologyChanges,
};
pub use prune::{PruneOptions, Pruned, prune};
pub use quadric::Quadric;
pub(crate) use wedges::{Normals, classes};

use crate::error::{Error, Result};
use crate::mesh::TriMesh;
use exact::{Driver, Target};
use rounds::Collapse;

/// Collapses edges of `mesh`, cheapest first, until `options.stop` is met or
/// nothing more can go.
///
/// Triangles without three different positions and exact duplicates are left
/// out first. Vertices with the same position are simplified together, so that
/// a seam does not open; attributes are kept apart across it. The result is
/// the same for any number of threads.
///
/// # Errors
/// What [`TriMesh::validate`] finds, [`Error::BadOption`] for an option out of
/// its range, [`Error::LengthMismatch`] for weights or locks of another length
/// than the vertices, [`Error::Cancelled`].
///
/// # Examples
/// ```
/// use karui::{mesh::shapes, simplify::{SimplifyOptions, Stop, simplify}};
///
/// let sphere = shapes::icosphere(4);
/// let coarse = simplify(&sphere, &SimplifyOptions {
///     stop: Stop::ratio(0.1),
///     ..Default::default()
/// })?;
/// assert_eq!(coarse.mesh.triangles.len(), sphere.triangles.len() / 10);
/// assert!(coarse.error < 0.05);
/// # Ok::<(), karui::Error>(())
/// ```
pub fn simplify(mesh: &TriMesh, options: &SimplifyOptions<'_>) -> Result<Simplified> {
    let mut levels = simplify_chain(mesh, &[options.stop], options)?;
    levels.pop().ok_or(Error::Empty { what: "chain" })
}

/// As [`simplify`], to one stop after another, each going on from the level
/// before: the levels of a chain in little more time than the coarsest takes.
/// `options.stop` is not looked at. Errors and counts are those since the
/// input, not since the level before.
///
/// # Errors
/// As [`simplify`].
pub fn simplify_chain(
    mesh: &TriMesh,
    stops: &[Stop],
    options: &SimplifyOptions<'_>,
) -> Result<Vec<Simplified>> {
    mesh.validate()?;
    check(mesh, options)?;
    stops.iter().try_for_each(check_stop)?;
    if let Some(levels) = fast::simplify_chain(mesh, stops, options)? {
        return Ok(levels);
    }
    let prepared = wedges::prepare(mesh);
    let state = state::State::new(mesh, &prepared, options);
    if state.surface.alive == 0 {
        let rest = output::output(mesh, &prepared, &state, None);
        let level = |stop| unchanged(rest.clone(), target(mesh, stop));
        let mut chain: Vec<Simplified> = stops.iter().map(level).collect();
        if options.log {
            let ends = vec![0; chain.len()];
            attach(&mut chain, base(mesh, &prepared), Vec::new(), &ends);
        }
        return Ok(chain);
    }
    let guard = guard::Guard::new(mesh)?;
    let mut driver = Driver::new(state, &guard);
    let level = |stop| {
        let reached = driver.advance(target(mesh, stop))?;
        Ok(Simplified {
            mesh: output::output(mesh, &prepared, driver.state(), Some(guard.index())),
            error: reached.error,
            stopped: reached.stopped,
            collapses: reached.collapses,
            blocked: reached.blocked,
            log: None,
            topology: TopologyChanges::default(),
        })
    };
    let mut chain: Vec<Simplified> = stops.iter().map(level).collect::<Result<_>>()?;
    if options.log && options.pairs.is_none() {
        let ends: Vec<usize> = chain.iter().map(|level| level.collapses).collect();
        let base = base(mesh, &prepared);
        attach(&mut chain, base, driver.into_record(), &ends);
    }
    Ok(chain)
}

fn base(mesh: &TriMesh, prepared: &wedges::Prepared) -> log::Base {
    log::Base::of(
        mesh,
        &prepared.source_triangle,
        &prepared.surface.points,
        &prepared.surface.wedges,
        prepared.normals,
    )
}

/// Gives every level of a chain its part of what was written down.
fn attach(chain: &mut [Simplified], base: log::Base, record: Vec<Collapse>, ends: &[usize]) {
    let logs = CollapseLog::chain(base, record, ends);
    for (level, log) in chain.iter_mut().zip(logs) {
        level.log = Some(log);
    }
}

fn unchanged(mesh: TriMesh, target: Target) -> Simplified {
    let met = mesh.triangles.len() <= target.triangles;
    Simplified {
        mesh,
        error: 0.0,
        stopped: if met {
            Stopped::Target
        } else {
            Stopped::Exhausted
        },
        collapses: 0,
        blocked: Blocked::default(),
        log: None,
        topology: TopologyChanges::default(),
    }
}

fn target(mesh: &TriMesh, stop: &Stop) -> Target {
    let count = mesh.triangles.len();
    let by_ratio = stop.ratio.map(|r| (r * count as f64).round() as usize);
    let relative = stop.relative_error.map(|e| e * mesh.bounds().diagonal());
    let bounds = [stop.error, relative];
    Target {
        triangles: stop
            .triangles
            .into_iter()
            .chain(by_ratio)
            .max()
            .unwrap_or(0),
        error: bounds.into_iter().flatten().fold(f64::INFINITY, f64::min),
    }
}

fn check_stop(stop: &Stop) -> Result<()> {
    in_range("stop.ratio", stop.ratio, 0.0..=1.0, "between 0 and 1")?;
    in_range("stop.error", stop.error, 0.0..=f64::MAX, "0 or more")?;
    in_range(
        "stop.relative_error",
        stop.relative_error,
        0.0..=f64::MAX,
        "0 or more",
    )
}

fn check(mesh: &TriMesh, options: &SimplifyOptions<'_>) -> Result<()> {
    let turn = Some(options.max_normal_turn);
    in_range("max_normal_turn", turn, 0.0..=1.57, "between 0 and pi/2")?;
    let regularity = Some(options.regularity);
    in_range("regularity", regularity, 0.0..=100.0, "between 0 and 100")?;
    in_range(
        "pairs",
        options.pairs,
        f64::MIN_POSITIVE..=f64::MAX,
        "more than 0",
    )?;
    let weights = &options.attributes;
    for (name, weight) in [
        ("attributes.normal", weights.normal),
        ("attributes.uv", weights.uv),
        ("attributes.color", weights.color),
        ("attributes.skin", weights.skin),
    ] {
        in_range(name, Some(weight), 0.0..=f64::MAX, "0 or more")?;
    }
    same_length("weights", options.weights.map(<[f32]>::len), mesh)?;
    same_length("locks", options.locks.map(<[bool]>::len), mesh)?;
    match options
        .weights
        .and_then(|w| w.iter().find(|w| !(w.is_finite() && **w >= 0.0)))
    {
        None => Ok(()),
        Some(weight) => bad("weights", weight, "0 or more"),
    }
}

fn in_range(
    option: &'static str,
    value: Option<f64>,
    range: std::ops::RangeInclusive<f64>,
    expected: &'static str,
) -> Result<()> {
    match value {
        Some(value) if !range.contains(&value) => bad(option, &value, expected),
        _ => Ok(()),
    }
}

fn bad(option: &'static str, found: &dyn std::fmt::Display, expected: &'static str) -> Result<()> {
    Err(Error::BadOption {
        option,
        found: found.to_string(),
        expected,
    })
}

fn same_length(what: &str, found: Option<usize>, mesh: &TriMesh) -> Result<()> {
    match found {
        Some(found) if found != mesh.positions.len() => Err(Error::LengthMismatch {
            what: what.into(),
            expected: mesh.positions.len(),
            found,
        }),
        _ => Ok(()),
    }
}
