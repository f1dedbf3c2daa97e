//! `karui scene fused`: a model many times over as one mesh.

use super::mesh_output::MeshOutput;
use crate::console::Console;
use crate::failure::Failure;
use crate::input;
use anyhow::{Context, Result};
use karui::TriMesh;
use karui::geom::{Aabb, Vec3};
use karui::outofcore::{Memory, Source, Vertices};
use karui_io::ErrorKind;
use std::path::PathBuf;

/// Vertices that are in memory at once.
const PORTION: u64 = 1 << 17;
/// From one model to the next, in sizes of a model.
const APART: f32 = 1.125;

/// Make one mesh of a model many times over
///
/// Copies stand in a square, each turned by another quarter, and are written as binary PLY one
/// after the other: a few megabytes of memory, if the model can be read in slices (not if it is
/// gzipped).
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The model
    #[arg(value_name = "MODEL")]
    model: PathBuf,
    /// Number of copies, exactly
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..))]
    count: u32,
    #[command(flatten)]
    output: MeshOutput,
}

/// Makes and writes it.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    args.output.check()?;
    match karui_io::slices::open_with(&args.model) {
        Ok(opened) => {
            for warning in &opened.warnings {
                console.warn(&format!("{}: {warning}", args.model.display()));
            }
            fuse(args, &*opened.source, console)
        }
        Err(error) if matches!(*error.kind, ErrorKind::Unsupported(_)) => {
            let mesh = whole(args, console)?;
            fuse(args, &Memory(&mesh), console)
        }
        Err(error) => Err(error.into()),
    }
}

/// The model in memory, for what cannot be read in slices.
fn whole(args: &Args, console: &Console) -> Result<TriMesh> {
    let input = input::read(&args.model, console)?;
    let mesh = input.scene.into_single_mesh();
    Ok(mesh.map_err(|e| karui_io::Error::file(&args.model, e.into()))?)
}

fn fuse(args: &Args, source: &dyn Source, console: &Console) -> Result<()> {
    let mut writer = args.output.create()?;
    let progress = console.progress();
    let bounds = bounds(source)?;
    if bounds.is_empty() {
        let message = format!("{}: the model has no vertices", args.model.display());
        return Err(Failure::input(message).into());
    }
    let side = (1..).find(|s: &u32| u64::from(*s).pow(2) >= args.count.into());
    let apart = bounds.size().x.max(bounds.size().z) * APART;
    let place = |copy: u32| {
        let side = side.unwrap_or(1);
        Vec3::new((copy % side) as f32, 0.0, (copy / side) as f32) * apart
    };
    for copy in 0..args.count {
        super::check(
            &*progress,
            "vertices",
            0.5 * copy as f32 / args.count as f32,
        )?;
        for start in starts(source) {
            let end = (start + PORTION).min(source.vertices());
            let mut slice = source.read_vertices(start..end)?;
            turn(&mut slice, bounds.center(), copy % 4);
            slice.positions.iter_mut().for_each(|p| *p += place(copy));
            args.output.put(writer.write_vertices(slice))?;
        }
    }
    for copy in 0..args.count {
        super::check(
            &*progress,
            "triangles",
            0.5 + 0.5 * copy as f32 / args.count as f32,
        )?;
        let base = u64::from(copy) * source.vertices();
        for chunk in 0..source.chunks() {
            let mut triangles = source.read_triangles(chunk)?;
            triangles
                .as_flattened_mut()
                .iter_mut()
                .for_each(|v| *v += base);
            args.output.put(writer.write_triangles(&triangles))?;
        }
    }
    drop(progress);
    let what = format!("{} copies of {}", args.count, args.model.display());
    args.output.finish(writer, &what, console)
}

fn starts(source: &dyn Source) -> impl Iterator<Item = u64> {
    (0..source.vertices()).step_by(PORTION as usize)
}

fn bounds(source: &dyn Source) -> Result<Aabb> {
    let mut bounds = Aabb::EMPTY;
    for start in starts(source) {
        let end = (start + PORTION).min(source.vertices());
        let slice = source
            .read_vertices(start..end)
            .context("cannot read the model")?;
        bounds = bounds.union(Aabb::of(slice.positions));
    }
    Ok(bounds)
}

/// Turns by quarters around the vertical through `center`, without rounding directions.
fn turn(slice: &mut Vertices, center: Vec3, quarters: u32) {
    // Not even by rounding.
    if quarters == 0 {
        return;
    }
    let quarter = |v: Vec3| match quarters {
        1 => Vec3::new(v.z, v.y, -v.x),
        2 => Vec3::new(-v.x, v.y, -v.z),
        _ => Vec3::new(-v.z, v.y, v.x),
    };
    for position in &mut slice.positions {
        *position = quarter(*position - center) + center;
    }
    for normal in slice.attributes.normals.iter_mut().flatten() {
        *normal = quarter(*normal);
    }
    for tangent in slice.attributes.tangents.iter_mut().flatten() {
        *tangent = quarter(tangent.truncate()).extend(tangent.w);
    }
}
