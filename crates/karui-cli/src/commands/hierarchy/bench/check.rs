//! Random walks, every frame of them checked.

use super::{Args, two_lights};
use crate::commands::bench::page::machine;
use crate::commands::hierarchy::{build, read_mesh};
use crate::console::{Console, to_stderr};
use crate::failure::Failure;
use crate::progress::check_cancelled;
use crate::table::{count, table};
use anyhow::Result;
use karui::TriMesh;
use karui::geom::{Camera, Light, Vec3, sin_cos};
use karui::hierarchy::{Budget, Cut, Hierarchy, ViewAndLight};
use karui::mesh::{Halfedge, PositionIds, RepairOptions, repair};
use serde::Serialize;
use std::path::Path;

#[derive(Debug, Serialize)]
struct Row {
    model: String,
    triangles: usize,
    manifold: bool,
    frames: u32,
    euler: Option<i64>,
    least: usize,
    most: usize,
}

/// Frames whose topology is looked at: one in so many, as that takes longest.
const STRIDE: u32 = 50;

/// Walks over every model; as Markdown. The first thing that is wrong is an error.
pub fn run(args: &Args, frames: u32, console: &Console) -> Result<String> {
    let mut rows = Vec::new();
    for file in &args.files {
        let (_, mesh) = read_mesh(file, console)?;
        if !console.quiet {
            to_stderr(&file.display().to_string());
        }
        let hierarchy = build(&mesh, args.build, file, console)?;
        rows.push(of_mesh(file, &mesh, &hierarchy, frames)?);
    }
    console.document(&rows)?;
    Ok(markdown(&rows))
}

fn of_mesh(file: &Path, mesh: &TriMesh, hierarchy: &Hierarchy, frames: u32) -> Result<Row> {
    let wrong = |i: u32, what: &str| {
        let message = format!("{}: frame {i}: {what}", file.display());
        anyhow::Error::from(Failure::input(message))
    };
    let repaired = repair(mesh, &RepairOptions::default())?;
    let manifold = repaired.counts.split_edges + repaired.counts.split_vertices == 0;
    let euler = Halfedge::of_mesh(&repaired.mesh, &repaired.ids)?.euler_characteristic();
    let mut cut = hierarchy.coarsest();
    let mut drawn = (usize::MAX, 0);
    let mut first = None;
    for i in 0..frames {
        check_cancelled()?;
        let criteria = random_view(hierarchy, i);
        let change = cut.refine(&criteria, Budget::UNLIMITED)?;
        drawn = (drawn.0.min(change.triangles), drawn.1.max(change.triangles));
        cut.validate().map_err(|e| wrong(i, &e.to_string()))?;
        first.get_or_insert_with(|| cut.triangles());
        if manifold && i % STRIDE == 0 && euler_of(&cut, mesh)? != euler {
            return Err(wrong(i, "another Euler characteristic"));
        }
    }
    cut.refine(&random_view(hierarchy, 0), Budget::UNLIMITED)?;
    if first != Some(cut.triangles()) {
        return Err(wrong(
            frames,
            "back at the first view there is another mesh",
        ));
    }
    Ok(Row {
        model: file
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned(),
        triangles: mesh.triangles.len(),
        manifold,
        frames,
        euler: manifold.then_some(euler),
        least: drawn.0,
        most: drawn.1,
    })
}

fn euler_of(cut: &Cut<'_>, mesh: &TriMesh) -> Result<i64> {
    let drawn = cut.to_mesh(mesh)?;
    let ids = PositionIds::of_mesh(&drawn);
    Ok(Halfedge::of_mesh(&drawn, &ids)?.euler_characteristic())
}

/// From anywhere within three diagonals, towards anywhere, lights anywhere.
fn random_view(hierarchy: &Hierarchy, i: u32) -> ViewAndLight {
    let bounds = hierarchy.bounds();
    let random = |k: u32| {
        let turns = f64::from(i + 1) * 0.618_033_988_749_895 * f64::from(2 * k + 1);
        sin_cos(std::f64::consts::TAU * turns.fract()).0 as f32
    };
    let far = bounds.diagonal() as f32;
    let at = |k: u32| bounds.center() + Vec3::new(random(k), random(k + 1), random(k + 2)) * far;
    let mut camera = Camera::looking_at(bounds, Vec3::Z, 0.8);
    // Steps alternate between a jump and a small move on from it.
    camera.eye = at(0) + Vec3::splat(0.01 * far * (i % 4) as f32);
    camera.target = bounds.center() + (at(5) - bounds.center()) * 0.2;
    let mut lights = two_lights(bounds);
    lights.push(Light::Directional {
        direction: Vec3::new(random(9), -1.0, random(10)),
        color: Vec3::ONE,
        intensity: 1.0,
    });
    ViewAndLight {
        camera,
        lights,
        size: [800, 600],
        ..ViewAndLight::default()
    }
}

fn markdown(rows: &[Row]) -> String {
    let header = [
        "model",
        "triangles",
        "manifold",
        "frames",
        "Euler",
        "drawn, least",
        "most",
    ];
    let cells: Vec<Vec<String>> = rows
        .iter()
        .map(|row| {
            vec![
                format!("`{}`", row.model),
                count(row.triangles),
                if row.manifold { "yes" } else { "no" }.to_owned(),
                count(row.frames as usize),
                row.euler.map_or("-".to_owned(), |e| e.to_string()),
                count(row.least),
                count(row.most),
            ]
        })
        .collect();
    format!(
        "## Half-edge hierarchies, random walks\n\n\
         Written by `karui hierarchy bench FILES --check N -o FILE`. After every frame `Cut::validate`\n\
         held, every {STRIDE}th was a manifold of the Euler characteristic of the input (where that is\n\
         manifold), and back at the first view and light the mesh was the first, byte for byte; the\n\
         command fails otherwise.\n\n{}\n\n{}\n",
        machine(),
        table(&header, &cells, true)
    )
}
