//! The round-based driver on a whole mesh.

use super::log::Base;
use super::options::{
    Border, Cost, Placement, Quality, Simplified, SimplifyOptions, Stop, Topology, TopologyChanges,
};
use super::output::{Left, assemble};
use super::points::{Points, points};
use super::rounds::{Input, Level, Pace, Rules, Values, run};
use super::signal::Signal;
use super::wedges::Normals;
use super::{attach, blend::blend, exact::Target, target};
use crate::error::Result;
use crate::mesh::{Attributes, TriMesh};
use crate::spatial::Bvh;
use rayon::prelude::*;

/// As [`super::simplify_chain`], in rounds; none if the options or the mesh
/// ask for what only the exact driver does.
///
/// # Errors
/// [`Error::Cancelled`](crate::Error::Cancelled).
pub(super) fn simplify_chain(
    mesh: &TriMesh,
    stops: &[Stop],
    options: &SimplifyOptions<'_>,
) -> Result<Option<Vec<Simplified>>> {
    let share = match options.quality {
        Quality::Fast => 0.5,
        Quality::Balanced => 0.25,
        Quality::Exact => return Ok(None),
    };
    if !is_served(options) {
        return Ok(None);
    }
    let scale = scale_of(mesh);
    let mut points = points(mesh);
    let base = options.log.then(|| {
        let (source, wedge) = (&points.source, &points.wedge);
        Base::of(mesh, source, &points.triangle, wedge, points.normals)
    });
    let (mut record, mut ends) = (Vec::new(), Vec::new());
    let mut level = level_of(mesh, options, &mut points, scale);
    let mut attributes = if level.wedge.is_empty() {
        Attributes::default()
    } else {
        mesh.attributes.gathered(&points.wedge_vertex)
    };
    let input = Input::new(mesh, scale, options.quality == Quality::Balanced);
    let index = match points.normals {
        Normals::LookedUp => input.index()?,
        _ => None,
    };
    let pace = Pace { share };
    let mut done = (0, 0.0f64);
    let mut topology = TopologyChanges::default();
    let mut chain = Vec::with_capacity(stops.len());
    for stop in stops {
        let target = target(mesh, stop);
        let scaled = Target {
            error: target.error * f64::from(scale),
            ..target
        };
        let rules = rules(options, scaled);
        let mut ran = run(level, scaled, pace, rules, &input, options.progress)?;
        add_copies(&mut attributes, &mut ran.level);
        for change in std::mem::take(&mut ran.level.log) {
            blend(&mut attributes, change.wedge, &change.mix);
        }
        topology.add(&ran.changes);
        record.append(&mut ran.level.record);
        ends.push(record.len());
        done = (
            done.0 + ran.collapses,
            done.1.max(f64::from(ran.error / scale)),
        );
        chain.push(Simplified {
            mesh: output(
                mesh,
                &ran.level,
                (&attributes, ran.level.wedges),
                (points.normals, index, scale),
            ),
            error: done.1,
            stopped: ran.stopped,
            collapses: done.0,
            blocked: ran.blocked,
            log: None,
            topology,
        });
        level = ran.level;
    }
    if let Some(base) = base {
        record.iter_mut().for_each(|c| c.place.scale(1.0 / scale));
        attach(&mut chain, base, record, &ends);
    }
    Ok(Some(chain))
}

fn is_served(options: &SimplifyOptions<'_>) -> bool {
    options.cost == Cost::Memoryless && options.pairs.is_none()
}

fn rules(options: &SimplifyOptions<'_>, target: Target) -> Rules {
    Rules {
        least_turn: options.max_normal_turn.cos() as f32,
        hold_borders: options.border != Border::Free,
        lock_borders: options.border == Border::Lock,
        subset: options.placement == Placement::HalfEdge,
        even: (options.regularity * options.regularity) as f32,
        max_error: target.error as f32,
        log: options.log,
        // A log knows of collapses alone.
        ease: options.topology == Topology::Simplify && !options.log,
    }
}

/// A power of two, so that nothing is rounded, that brings the mesh to about
/// unit size: prices are fourth powers of lengths, which in `f32` would
/// otherwise run out of range.
pub(super) fn scale_of(mesh: &TriMesh) -> f32 {
    let diagonal = mesh.bounds().diagonal();
    if diagonal > 0.0 && diagonal.is_finite() {
        (-diagonal.log2().round()).exp2() as f32
    } else {
        1.0
    }
}

fn level_of<'a>(
    mesh: &'a TriMesh,
    options: &SimplifyOptions<'_>,
    points: &mut Points<'a>,
    scale: f32,
) -> Level<'a> {
    let mut level = Level {
        position: points.gathered(&mesh.positions),
        scale,
        weight: options
            .weights
            .map(|w| points.gathered(w).into_owned())
            .unwrap_or_default(),
        locked: options
            .locks
            .map(|l| points.gathered(l).into_owned())
            .unwrap_or_default(),
        triangle: std::mem::take(&mut points.triangle),
        source: std::mem::take(&mut points.source),
        fans: points.fans,
        input: mesh.triangles.len(),
        wedges: points.wedge_vertex.len(),
        ..Level::default()
    };
    if !points.wedge.is_empty() {
        let range_of = mesh.range_of_triangles();
        level.wedge = std::mem::take(&mut points.wedge);
        level.range = level.source.iter().map(|&t| range_of[t as usize]).collect();
        level.values = values(mesh, options, points, scale);
    }
    level
}

/// Makes room for the wedges that have been copied; what they show is in the
/// log.
fn add_copies(attributes: &mut Attributes, level: &mut Level) {
    let copies = std::mem::take(&mut level.copies);
    if !copies.is_empty() {
        let all: Vec<u32> = (0..level.wedges as u32).chain(copies).collect();
        *attributes = attributes.gathered(&all);
        level.wedges = all.len();
    }
}

/// The attributes that count, as lengths in scaled units.
fn values(mesh: &TriMesh, options: &SimplifyOptions<'_>, points: &Points, scale: f32) -> Values {
    let with_normals = points.normals == Normals::Kept;
    let mut signal = Signal::of(
        mesh,
        &points.wedge_vertex,
        &options.attributes,
        with_normals,
    );
    signal.add_skins(&mesh.attributes, &points.wedge_vertex);
    let uvs = if options.attributes.uv > 0.0 {
        signal.uvs.clone()
    } else {
        Vec::new()
    };
    Values {
        width: signal.width,
        value: signal.values.iter().map(|v| v * scale).collect(),
        uvs,
    }
}

/// The triangles that are left, in the input's order, and their vertices, in
/// the order of those they have come from.
pub(super) fn output(
    source: &TriMesh,
    level: &Level,
    (attributes, wedges): (&Attributes, usize),
    (normals, index, scale): (Normals, Option<&Bvh>, f32),
) -> TriMesh {
    if level.wedge.is_empty() {
        return bare_output(source, level, scale);
    }
    let left: Vec<Left> = (0..level.triangle.len())
        .map(|t| Left {
            source: level.source_of(t as u32),
            wedges: level.wedge[t],
            places: level.triangle[t].map(|p| level.place(p) / scale),
        })
        .collect();
    let attributes = (attributes.clone(), wedges);
    assemble(source, attributes, normals, &left, index)
}

fn bare_output(source: &TriMesh, level: &Level, scale: f32) -> TriMesh {
    let order = sorted(level.triangle.len(), |t| level.source_of(t));
    let from = |p: u32| level.origin.get(p as usize).copied().unwrap_or(p);
    let kept = sorted(level.position.len(), from);
    let mut index = vec![0; kept.len()];
    for (i, &p) in kept.iter().enumerate() {
        index[p as usize] = i as u32;
    }
    let triangle = |&t: &u32| level.triangle[t as usize].map(|p| index[p as usize]);
    let mut mesh = TriMesh {
        positions: kept.par_iter().map(|&p| level.place(p) / scale).collect(),
        triangles: order.par_iter().map(triangle).collect(),
        ..TriMesh::default()
    };
    let kept: Vec<u32> = order.iter().map(|&t| level.source_of(t)).collect();
    let face_attributes = source.face_attributes.iter();
    mesh.face_attributes = face_attributes.map(|a| a.gathered(&kept)).collect();
    mesh.ranges = source.ranges.clone();
    for range in &mut mesh.ranges {
        range.count = mesh.triangles.len() as u32;
    }
    mesh.remove_unreferenced_vertices();
    mesh
}

/// The numbers under `count` by their keys, equals in order.
fn sorted(count: usize, key: impl Fn(u32) -> u32 + Sync) -> Vec<u32> {
    let keyed = |i: u32| u64::from(key(i)) << 32 | u64::from(i);
    let mut keys: Vec<u64> = (0..count as u32).into_par_iter().map(keyed).collect();
    keys.par_sort_unstable();
    keys.into_iter().map(|k| k as u32).collect()
}
