//! `karui bench one`: the figures of one model, in a process of its own.

use crate::console::Console;
use crate::input;
use anyhow::{Context, Result, ensure};
use karui::mesh::diagnose;
use karui::metrics::{Samples, Surface, SurfaceDistanceOptions, flipped, surface_distance_between};
use karui::simplify::{SimplifyOptions, Stop, simplify};
use karui::{Scene, TriMesh};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use std::time::SystemTime;

/// Measure one model (used by `karui bench models`)
#[derive(Debug, clap::Args)]
#[command(hide = true)]
pub struct Args {
    /// The model
    input: PathBuf,
    /// Shares of the triangles to keep
    #[arg(long, value_delimiter = ',', required = true)]
    ratio: Vec<f64>,
}

/// The figures of one model.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Figures {
    pub triangles: usize,
    /// Memory at most, MB (10^6 bytes), for reading and simplifying; `None`
    /// where the system does not tell.
    pub peak_mb: Option<f64>,
    pub levels: Vec<Level>,
}

/// The figures at one ratio.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Level {
    pub triangles: usize,
    /// For simplifying all meshes one after the other.
    pub seconds: f64,
    /// Largest measured error, share of each mesh's diagonal.
    pub max: f64,
    /// Largest RMS error of any mesh, likewise.
    pub rms: f64,
    /// Triangles that face away from the original, beyond those that do in
    /// the original itself.
    pub new_flips: usize,
    pub new_non_manifold: usize,
}

/// Simplifies at every ratio, then measures, so that the peak of memory is
/// that of simplification.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    let input = input::read(&args.input, console)?;
    input.require_triangles()?;
    input.scene.validate()?;
    let simplified: Vec<(Scene, f64)> = (args.ratio.iter())
        .map(|&ratio| coarser(&input.scene, ratio))
        .collect::<Result<_>>()?;
    let peak_mb = peak_mb();
    let reference = Reference::of(&input.scene)?;
    let level = |(scene, seconds): &(Scene, f64)| {
        written_and_read_again(scene)?;
        reference.compare(scene, *seconds)
    };
    console.document(&Figures {
        triangles: input.scene.triangle_count(),
        peak_mb,
        levels: simplified.iter().map(level).collect::<Result<_>>()?,
    })
}

fn coarser(scene: &Scene, ratio: f64) -> Result<(Scene, f64)> {
    let options = SimplifyOptions {
        stop: Stop::ratio(ratio),
        ..SimplifyOptions::default()
    };
    let mut coarse = scene.clone();
    let before = seconds();
    for named in &mut coarse.meshes {
        if !named.mesh.triangles.is_empty() {
            named.mesh = simplify(&named.mesh, &options)?.mesh;
        }
    }
    Ok((coarse, seconds() - before))
}

/// Processor time of this thread where the Linux kernel tells, so that other
/// work on the machine does not count; else the time of day.
fn seconds() -> f64 {
    let on_cpu = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = on_cpu.and_then(|s| s.split_whitespace().next()?.parse::<f64>().ok());
    let since = || SystemTime::UNIX_EPOCH.elapsed().unwrap_or_default();
    nanoseconds.map_or_else(|| since().as_secs_f64(), |ns| ns * 1e-9)
}

/// What levels of one scene are compared with.
struct Reference {
    meshes: Vec<Option<MeshReference>>,
}

struct MeshReference {
    surface: Surface,
    flips: usize,
    non_manifold: usize,
}

impl Reference {
    fn of(scene: &Scene) -> Result<Self> {
        let of_mesh = |mesh: &TriMesh| -> Result<Option<MeshReference>> {
            if mesh.triangles.is_empty() {
                return Ok(None);
            }
            let surface = Surface::new(mesh)?;
            Ok(Some(MeshReference {
                flips: flipped(mesh, surface.bvh())?,
                non_manifold: diagnose(mesh)?.nonmanifold_edges,
                surface,
            }))
        };
        let meshes = scene.meshes.iter().map(|m| of_mesh(&m.mesh));
        Ok(Self {
            meshes: meshes.collect::<Result<_>>()?,
        })
    }

    fn compare(&self, scene: &Scene, seconds: f64) -> Result<Level> {
        let mut level = Level {
            triangles: scene.triangle_count(),
            seconds,
            max: 0.0,
            rms: 0.0,
            new_flips: 0,
            new_non_manifold: 0,
        };
        for (named, reference) in scene.meshes.iter().zip(&self.meshes) {
            if let Some(reference) = reference {
                reference.compare(&named.mesh, &mut level)?;
            }
        }
        Ok(level)
    }
}

/// Enough for the third digit of a mean.
const SAMPLES: u64 = 100_000;

impl MeshReference {
    fn compare(&self, mesh: &TriMesh, level: &mut Level) -> Result<()> {
        if mesh.triangles.is_empty() {
            level.max = f64::INFINITY;
            return Ok(());
        }
        let options = SurfaceDistanceOptions {
            samples: Samples::Count(SAMPLES.min(20 * mesh.triangles.len() as u64 + 1000)),
            ..SurfaceDistanceOptions::default()
        };
        let distance = surface_distance_between(&self.surface, &Surface::new(mesh)?, &options)?;
        let unit = distance.diagonal.max(f64::MIN_POSITIVE);
        level.max = level.max.max(distance.max() / unit);
        level.rms = level.rms.max(distance.rms() / unit);
        let flips = flipped(mesh, self.surface.bvh())?;
        level.new_flips += flips.saturating_sub(self.flips);
        let non_manifold = diagnose(mesh)?.nonmanifold_edges;
        level.new_non_manifold += non_manifold.saturating_sub(self.non_manifold);
        Ok(())
    }
}

/// A GLB has to hold all of it.
fn written_and_read_again(scene: &Scene) -> Result<()> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("level.glb");
    karui_io::write(&path, scene).context("writing GLB")?;
    let again = karui_io::read(&path).context("reading the GLB written")?;
    let (before, after) = (scene.triangle_count(), again.triangle_count());
    ensure!(
        before == after,
        "{before} triangles written as GLB, {after} read again"
    );
    Ok(())
}

/// The process's largest resident size so far, by the Linux kernel.
fn peak_mb() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM:"))?;
    let kib: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kib * 1024.0 / 1e6)
}
