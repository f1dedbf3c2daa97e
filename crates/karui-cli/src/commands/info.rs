//! `karui info`: what a model holds.

mod tiles;

use crate::console::Console;
use crate::failure::Failure;
use crate::input::{self, Input};
use crate::table::{bytes, count, number, table};
use anyhow::Result;
use karui::geom::Aabb;
use karui::mesh::{NamedMesh, diagnose};
use karui::{Scene, TriMesh};
use karui_io::tiles::Report;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Show what models hold
///
/// A 3D Tiles tileset (a .json file) is followed through its external tilesets, subtrees and
/// contents, and checked against the rules of the specification; a tileset that breaks one ends
/// the command with exit code 1.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The models, or tilesets
    #[arg(required = true, value_name = "INPUT")]
    inputs: Vec<PathBuf>,
}

#[derive(Debug, Serialize)]
struct Info {
    file: PathBuf,
    bytes: u64,
    triangles: usize,
    vertices: usize,
    /// Triangles counted once an instance.
    drawn_triangles: usize,
    instances: usize,
    /// Those that are placements of an instanced node, and the memory they take.
    placements: usize,
    placement_bytes: usize,
    materials: usize,
    textures: usize,
    images: usize,
    nodes: usize,
    bounds: Option<Bounds>,
    meshes: Vec<MeshInfo>,
}

#[derive(Debug, Serialize)]
struct Bounds {
    min: [f32; 3],
    max: [f32; 3],
    diagonal: f64,
}

#[derive(Debug, Serialize)]
struct MeshInfo {
    name: Option<String>,
    triangles: usize,
    vertices: usize,
    positions: usize,
    diagonal: f64,
    attributes: Vec<String>,
    material_ranges: usize,
    components: usize,
    closed: bool,
    manifold: bool,
    oriented: bool,
    uv_charts: Option<usize>,
    area: f64,
    volume: Option<f64>,
}

/// What was asked about.
#[derive(Debug, Serialize)]
#[serde(untagged)]
enum Subject {
    Model(Info),
    Tileset(Report),
}

/// Reads all models before the first is shown.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    let read = |path: &PathBuf| subject(path, console);
    let subjects = args.inputs.iter().map(read).collect::<Result<Vec<_>>>()?;
    for (i, subject) in subjects.iter().enumerate() {
        let gap = if i > 0 { "\n" } else { "" };
        let text = match subject {
            Subject::Model(info) => text(info),
            Subject::Tileset(report) => tiles::text(report),
        };
        console.data(&format!("{gap}{text}"))?;
    }
    console.document(&subjects)?;
    verdict(&subjects)
}

fn subject(path: &Path, console: &Console) -> Result<Subject> {
    if tiles::is_tileset(path) {
        return Ok(Subject::Tileset(karui_io::tiles::check(path)?));
    }
    Ok(Subject::Model(of_input(&input::read(path, console)?)?))
}

/// A tileset that breaks a rule is a failure.
fn verdict(subjects: &[Subject]) -> Result<()> {
    let errors = |subject: &Subject| match subject {
        Subject::Model(_) => 0,
        Subject::Tileset(report) => report.findings.error_count(),
    };
    match subjects.iter().map(errors).sum() {
        0 => Ok(()),
        1 => Err(Failure::check("1 rule of 3D Tiles is broken").into()),
        n => Err(Failure::check(format!("rules of 3D Tiles are broken at {n} places")).into()),
    }
}

fn of_input(input: &Input) -> Result<Info> {
    let scene = &input.scene;
    let [_, drawn_triangles] = scene.unfolded();
    Ok(Info {
        file: input.path.clone(),
        bytes: input.bytes,
        triangles: scene.triangle_count(),
        vertices: scene.meshes.iter().map(|m| m.mesh.positions.len()).sum(),
        drawn_triangles,
        instances: scene.instance_count(),
        placements: placements(scene),
        placement_bytes: scene.placement_memory(),
        materials: scene.materials.len(),
        textures: scene.textures.len(),
        images: scene.images.len(),
        nodes: scene.nodes.len(),
        bounds: bounds(scene.bounds()),
        meshes: scene.meshes.iter().map(of_mesh).collect::<Result<_>>()?,
    })
}

fn placements(scene: &Scene) -> usize {
    let all = scene.iter_instances();
    all.filter(|i| i.placement.is_some()).count()
}

fn bounds(bounds: Aabb) -> Option<Bounds> {
    (!bounds.is_empty()).then(|| Bounds {
        min: bounds.min.to_array(),
        max: bounds.max.to_array(),
        diagonal: bounds.diagonal(),
    })
}

fn of_mesh(named: &NamedMesh) -> Result<MeshInfo> {
    let mesh = &named.mesh;
    let found = diagnose(mesh)?;
    Ok(MeshInfo {
        name: named.name.clone(),
        triangles: mesh.triangles.len(),
        vertices: mesh.positions.len(),
        positions: found.positions,
        diagonal: mesh.bounds().diagonal(),
        attributes: attributes(mesh),
        material_ranges: mesh.ranges_or_whole().len(),
        components: found.components,
        closed: found.closed,
        manifold: found.manifold,
        oriented: found.oriented,
        uv_charts: found.uv_charts,
        area: found.area,
        volume: found.volume,
    })
}

fn attributes(mesh: &TriMesh) -> Vec<String> {
    let attributes = &mesh.attributes;
    let mut names = Vec::new();
    let mut add = |there: bool, name: &str| names.extend(there.then(|| name.to_owned()));
    add(attributes.normals.is_some(), "normal");
    add(attributes.tangents.is_some(), "tangent");
    let sets = [
        ("uv", attributes.uvs.len()),
        ("color", attributes.colors.len()),
        ("skin", attributes.skins.len()),
        ("morph", attributes.morphs.len()),
    ];
    for (name, count) in sets {
        add(count == 1, name);
        add(count > 1, &format!("{name} x{count}"));
    }
    names.extend(attributes.custom.iter().map(|a| a.name.clone()));
    names
}

fn text(info: &Info) -> String {
    let size = bytes(info.bytes);
    let mut lines = vec![format!("{}: {size}", info.file.display())];
    lines.push(format!(
        "{} triangles, {} vertices in {} meshes; {} instances draw {} triangles",
        count(info.triangles),
        count(info.vertices),
        count(info.meshes.len()),
        count(info.instances),
        count(info.drawn_triangles),
    ));
    let [m, t, i, n] = [info.materials, info.textures, info.images, info.nodes].map(count);
    lines.push(format!(
        "{m} materials, {t} textures, {i} images, {n} nodes"
    ));
    if info.placements > 0 {
        let (placements, memory) = (count(info.placements), bytes(info.placement_bytes as u64));
        lines.push(format!(
            "{placements} of the instances are placements, {memory} of memory"
        ));
    }
    if let Some(bounds) = &info.bounds {
        let [min, max] = [bounds.min, bounds.max].map(|p| p.map(|x| number(x.into())).join(", "));
        let diagonal = number(bounds.diagonal);
        lines.push(format!("from ({min}) to ({max}), diagonal {diagonal}"));
    }
    lines.push(mesh_table(&info.meshes));
    lines.join("\n")
}

fn mesh_table(meshes: &[MeshInfo]) -> String {
    let row = |(i, mesh): (usize, &MeshInfo)| {
        vec![
            mesh.name.clone().unwrap_or_else(|| format!("#{i}")),
            count(mesh.triangles),
            count(mesh.vertices),
            count(mesh.components),
            yes(mesh.closed),
            yes(mesh.manifold),
            number(mesh.diagonal),
            mesh.attributes.join(" "),
        ]
    };
    let rows: Vec<_> = meshes.iter().enumerate().map(row).collect();
    let header = [
        "mesh",
        "triangles",
        "vertices",
        "parts",
        "closed",
        "manifold",
        "diagonal",
        "attributes",
    ];
    table(&header, &rows, false)
}

fn yes(yes: bool) -> String {
    if yes { "yes" } else { "no" }.into()
}
