//! `--seams`: the error where borders of regions were, and that of the whole in one piece.

use super::super::page::machine;
use super::land::Size;
use crate::commands::plan::threads;
use crate::outofcore::{Work, told};
use crate::table::{count, number, table};
use anyhow::{Context as _, Result};
use karui::geom::Vec3;
use karui::mesh::Attributes;
use karui::metrics::{
    Surface, SurfaceDistanceOptions, directed_distance, surface_distance_between,
};
use karui::outofcore::{
    self, Kind, Manifest, PlanOptions, RunOptions, Sink, Vertices, manifests, run as run_all, write,
};
use karui::simplify::{Quality, SimplifyOptions, Stop, simplify};
use karui::{Silent, TriMesh};
use serde::Serialize;
use serde_json::{Value, json};
use std::collections::{HashMap, HashSet};
use std::path::Path;

/// Blocks that the land would fill.
const BLOCKS: u64 = 32;
/// So near to a vertex on a border is near it, units of the land: an edge of it is 1 long,
/// one of what is left about 3.
const NEAR: f32 = 4.0;

#[derive(Debug, Serialize)]
struct Found {
    triangles: [usize; 2],
    /// RMS of the distance, both sides, model units: in blocks, and in one piece.
    rms: [f64; 2],
    levels: Vec<Level>,
}

#[derive(Debug, Serialize)]
struct Level {
    regions: usize,
    /// Share of the land's vertices that are near borders.
    share: f64,
    /// From the land to what is left of it, model units: near borders and elsewhere.
    rms: [f64; 2],
    max: [f64; 2],
}

/// Simplifies in blocks and in one piece, and measures both.
pub fn run(size: Size, ratio: f64, folder: &Path) -> Result<(String, Value)> {
    let land = size.make(folder, false)?;
    let options = PlanOptions {
        ratio: Some(ratio),
        block_triangles: size.triangles() / BLOCKS,
        ..PlanOptions::default()
    };
    let work = Work::create(&land, &folder.join("blocks"), options)?;
    let run = RunOptions {
        workers: threads(),
        ..RunOptions::default()
    };
    let last = run_all(&work.store, &*work.source, &work.plan, &run).map_err(told)?;
    let coarse = gathered(&work, &last)?;
    let mesh = karui_io::read(&land)?.into_single_mesh()?;
    let found = compared(&work, &mesh, &coarse)?;
    Ok((markdown(size, &found), json!(found)))
}

/// Puts a result together in memory.
impl Sink for Gathered {
    fn begin(&mut self, _: u64, _: u64, _: &Attributes) -> outofcore::Result<()> {
        Ok(())
    }

    fn vertices(&mut self, vertices: &Vertices) -> outofcore::Result<()> {
        self.0.positions.extend(&vertices.positions);
        Ok(())
    }

    fn triangles(&mut self, triangles: &[[u64; 3]]) -> outofcore::Result<()> {
        let triangles = triangles.iter().map(|t| t.map(|v| v as u32));
        self.0.triangles.extend(triangles);
        Ok(())
    }
}

#[derive(Default)]
struct Gathered(TriMesh);

fn gathered(work: &Work, manifest: &Manifest) -> Result<TriMesh> {
    let mut whole = Gathered::default();
    write(&work.store, manifest, &mut whole, &Silent).map_err(told)?;
    Ok(whole.0)
}

fn compared(work: &Work, mesh: &TriMesh, coarse: &TriMesh) -> Result<Found> {
    let options = SimplifyOptions {
        quality: Quality::Fast,
        stop: Stop::triangles(coarse.triangles.len()),
        ..SimplifyOptions::default()
    };
    let whole = Surface::new(&simplify(mesh, &options)?.mesh)?;
    let [surface, blocks] = [Surface::new(mesh)?, Surface::new(coarse)?];
    let both =
        |other| surface_distance_between(&surface, other, &SurfaceDistanceOptions::default());
    let mut levels = Vec::new();
    for manifest in manifests(&work.store).map_err(told)? {
        if manifest.phase.kind == Kind::Simplify && manifest.rows.len() > 1 {
            let near = near(&borders(work, &manifest)?, mesh);
            levels.push(level(manifest.rows.len(), &near, &surface, &blocks)?);
        }
    }
    Ok(Found {
        triangles: [mesh.triangles.len(), coarse.triangles.len()],
        rms: [both(&blocks)?.rms(), both(&whole)?.rms()],
        levels,
    })
}

/// Places that several regions of a level have.
fn borders(work: &Work, manifest: &Manifest) -> Result<Vec<Vec3>> {
    let mut regions: HashMap<[u32; 3], u32> = HashMap::new();
    let mut borders = Vec::new();
    for row in &manifest.rows {
        let one = Manifest {
            phase: manifest.phase.clone(),
            rows: vec![row.clone()],
        };
        for position in gathered(work, &one)?.positions {
            let count = regions
                .entry(position.to_array().map(f32::to_bits))
                .or_default();
            *count += 1;
            if *count == 2 {
                borders.push(position);
            }
        }
    }
    Ok(borders)
}

/// For each vertex 1 if it is near a border, else 0.
fn near(borders: &[Vec3], mesh: &TriMesh) -> Vec<f32> {
    let cell = |p: Vec3| (p / NEAR).floor().as_ivec3().to_array();
    let cells: HashSet<[i32; 3]> = borders.iter().map(|&p| cell(p)).collect();
    let around = |[x, y, z]: [i32; 3]| {
        (0..27).any(|i| cells.contains(&[x + i % 3 - 1, y + i / 3 % 3 - 1, z + i / 9 - 1]))
    };
    let weight = |&p: &Vec3| f32::from(u8::from(around(cell(p))));
    mesh.positions.iter().map(weight).collect()
}

fn level(regions: usize, near: &[f32], land: &Surface, coarse: &Surface) -> Result<Level> {
    let elsewhere: Vec<f32> = near.iter().map(|w| 1.0 - w).collect();
    let distance = |weights: &[f32]| {
        let options = SurfaceDistanceOptions {
            weights: Some(weights),
            ..SurfaceDistanceOptions::default()
        };
        directed_distance(land, coarse, &options).context("no vertex is near a border, or all are")
    };
    let [close, far] = [distance(near)?, distance(&elsewhere)?];
    Ok(Level {
        regions,
        share: near.iter().map(|&w| f64::from(w)).sum::<f64>() / near.len() as f64,
        rms: [close.rms, far.rms],
        max: [close.max, far.max],
    })
}

fn markdown(size: Size, found: &Found) -> String {
    let header = [
        "borders of level",
        "regions",
        "vertices near",
        "RMS near",
        "RMS elsewhere",
        "near / elsewhere",
        "max near",
        "max elsewhere",
    ];
    let row = |(number, level): (usize, &Level)| {
        vec![
            (number + 1).to_string(),
            level.regions.to_string(),
            format!("{:.1} %", 100.0 * level.share),
            number_of(level.rms[0]),
            number_of(level.rms[1]),
            format!("{:.3}", level.rms[0] / level.rms[1]),
            number_of(level.max[0]),
            number_of(level.max[1]),
        ]
    };
    let rows: Vec<_> = found.levels.iter().enumerate().map(row).collect();
    let [blocks, whole] = found.rms;
    format!(
        "{} Land of {size} vertices, {} triangles to {}. RMS of the distance, both sides: {} in \
         blocks, {} in one piece (ratio {:.3}). From the land to what is left, within some {NEAR} \
         units of a border and elsewhere:\n\n{}",
        machine(),
        count(found.triangles[0]),
        count(found.triangles[1]),
        number(blocks),
        number(whole),
        blocks / whole,
        table(&header, &rows, true)
    )
}

fn number_of(x: f64) -> String {
    format!("{x:.4}")
}
