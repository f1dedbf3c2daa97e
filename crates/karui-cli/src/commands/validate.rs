//! `karui validate`: whether models are sound.

use crate::console::{Console, to_stderr};
use crate::failure::{self, Failure};
use crate::input;
use crate::table::count;
use anyhow::Result;
use clap::ValueEnum;
use karui::mesh::{TopologyReport, diagnose};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Check that models can be read and are sound
///
/// A model that cannot be read, or whose content breaks the rules of its format, ends the command
/// with exit code 2. Holes and other defects are legal; they are listed, and are a failure (exit
/// code 1) where --require asks for their absence.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The models
    #[arg(required = true, value_name = "INPUT")]
    inputs: Vec<PathBuf>,
    /// What every mesh has to be
    #[arg(long, value_enum, value_delimiter = ',', value_name = "WHAT")]
    require: Vec<Requirement>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Requirement {
    /// No open edges
    Closed,
    /// No edges of three triangles, no fans that touch in a point
    Manifold,
    /// Neighbouring triangles face the same side
    Oriented,
    /// No degenerate or duplicate triangles, no unused vertices
    Clean,
    /// All of these
    All,
}

#[derive(Debug, Serialize)]
struct Report {
    file: PathBuf,
    valid: bool,
    error: Option<String>,
    meshes: Vec<MeshReport>,
}

#[derive(Debug, Serialize)]
struct MeshReport {
    name: String,
    triangles: usize,
    components: usize,
    defects: Vec<Defect>,
}

#[derive(Debug, Serialize)]
struct Defect {
    what: &'static str,
    count: usize,
    /// Whether it was asked to be absent.
    failure: bool,
}

/// Checks every model, whatever is found in those before it.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    let reports: Vec<Report> = args
        .inputs
        .iter()
        .map(|path| check(path, args, console))
        .collect::<Result<_>>()?;
    for report in &reports {
        console.data(&text(report))?;
    }
    console.document(&reports)?;
    verdict(&reports)
}

fn check(path: &Path, args: &Args, console: &Console) -> Result<Report> {
    let mut report = Report {
        file: path.to_owned(),
        valid: true,
        error: None,
        meshes: Vec::new(),
    };
    match meshes(path, args, console) {
        Ok(meshes) => report.meshes = meshes,
        Err(error) if failure::code_of(&error) == failure::code::CANCELLED => return Err(error),
        Err(error) => {
            report.valid = false;
            report.error = Some(format!("{error:#}"));
            failure::hint_of(&error).inspect(|hint| to_stderr(&format!("hint: {hint}")));
        }
    }
    Ok(report)
}

fn meshes(path: &Path, args: &Args, console: &Console) -> Result<Vec<MeshReport>> {
    let scene = input::read(path, console)?.scene;
    scene.validate()?;
    let mut reports = Vec::new();
    for (i, named) in scene.meshes.iter().enumerate() {
        crate::progress::check_cancelled()?;
        let found = diagnose(&named.mesh)?;
        reports.push(MeshReport {
            name: named.name.clone().unwrap_or_else(|| format!("#{i}")),
            triangles: found.triangles,
            components: found.components,
            defects: defects(&found, &args.require),
        });
    }
    Ok(reports)
}

fn defects(found: &TopologyReport, required: &[Requirement]) -> Vec<Defect> {
    use Requirement::{All, Clean, Closed, Manifold, Oriented};
    let kinds = [
        ("open edges", found.boundary_edges, Closed),
        ("non-manifold edges", found.nonmanifold_edges, Manifold),
        (
            "non-manifold vertices",
            found.nonmanifold_vertices,
            Manifold,
        ),
        (
            "edges between opposite sides",
            found.inconsistent_edges,
            Oriented,
        ),
        (
            "degenerate triangles",
            found.degenerate + found.zero_area,
            Clean,
        ),
        ("duplicate triangles", found.duplicate_faces, Clean),
        ("unused vertices", found.unreferenced_vertices, Clean),
    ];
    let there = kinds.into_iter().filter(|(_, count, _)| *count > 0);
    let defect = |(what, count, kind)| Defect {
        what,
        count,
        failure: required.iter().any(|r| *r == kind || *r == All),
    };
    there.map(defect).collect()
}

fn text(report: &Report) -> String {
    let file = report.file.display();
    if let Some(error) = &report.error {
        return format!("refused  {error}");
    }
    let defects = || report.meshes.iter().flat_map(|m| &m.defects);
    let word = if defects().any(|d| d.failure) {
        "fail"
    } else {
        "ok"
    };
    let triangles: usize = report.meshes.iter().map(|m| m.triangles).sum();
    let mut lines = vec![format!(
        "{word:<8} {file}: {} triangles in {} meshes",
        count(triangles),
        count(report.meshes.len()),
    )];
    for mesh in report.meshes.iter().filter(|m| !m.defects.is_empty()) {
        let defect = |d: &Defect| format!("{} {}", count(d.count), d.what);
        let list: Vec<String> = mesh.defects.iter().map(defect).collect();
        lines.push(format!("         {}: {}", mesh.name, list.join(", ")));
    }
    lines.join("\n")
}

fn verdict(reports: &[Report]) -> Result<()> {
    let refused = reports.iter().filter(|r| !r.valid).count();
    if refused > 0 {
        let message = format!("{refused} of {} models refused", reports.len());
        return Err(Failure::input(message).into());
    }
    let fails = |r: &&Report| r.meshes.iter().flat_map(|m| &m.defects).any(|d| d.failure);
    let failed = reports.iter().filter(fails).count();
    if failed > 0 {
        let message = format!(
            "{failed} of {} models fail what --require asks for",
            reports.len()
        );
        return Err(Failure::check(message).into());
    }
    Ok(())
}
