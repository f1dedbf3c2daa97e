//! `karui scene`: made-up scenes of very many objects, and meshes of any size.

pub(super) mod city;
mod forest;
mod fused;
mod kato1998;
mod mesh_output;
mod terrain;

use crate::args::WriteArgs;
use crate::console::Console;
use crate::output;
use crate::progress::check_cancelled;
use crate::table::{bytes, count, seconds};
use anyhow::Result;
use clap::Subcommand;
use karui::{Progress, Scene};
use karui_io::{ErrorKind, Format};
use std::path::PathBuf;

/// Make a scene of very many objects, or a mesh of any size
///
/// Objects are instances of few meshes (`EXT_mesh_gpu_instancing`): a million take as much as
/// their places. A mesh is written as it is made. Same arguments, same bytes.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    Forest(forest::Args),
    City(city::Args),
    Kato1998(kato1998::Args),
    Terrain(terrain::Args),
    Fused(fused::Args),
}

/// Runs the subcommand.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    match &args.what {
        What::Forest(args) => forest::run(args, console),
        What::City(args) => city::run(args, console),
        What::Kato1998(args) => kato1998::run(args, console),
        What::Terrain(args) => terrain::run(args, console),
        What::Fused(args) => fused::run(args, console),
    }
}

/// How many objects, and which.
#[derive(Debug, Clone, Copy, clap::Args)]
struct MadeArgs {
    /// Number of objects, exactly
    #[arg(long, value_name = "N", default_value_t = 1000)]
    count: u32,
    /// Another number, another scene
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
}

/// Where to.
#[derive(Debug, clap::Args)]
struct OutputArgs {
    /// The .glb or .gltf to write
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    #[command(flatten)]
    write: WriteArgs,
}

impl OutputArgs {
    /// Refuses other formats before any work is done: they have no instances.
    fn check(&self) -> Result<()> {
        let format = Format::from_path(&self.output)?;
        if matches!(format, Format::Gltf | Format::Glb) {
            return Ok(());
        }
        let name = self.output.display();
        let failure = crate::failure::Failure::input(format!("{name}: not a glTF file name"));
        let hint = "write a .glb; `karui convert` makes other formats of a small scene";
        Err(failure.hint(hint).into())
    }

    /// Writes the scene and says what it is.
    fn write(&self, scene: &Scene, what: &str, console: &Console) -> Result<()> {
        let written = output::write_one(&self.output, scene, &self.write.resolve())?;
        let (instances, memory) = (scene.instance_count(), scene.placement_memory());
        let [_, drawn] = scene.unfolded();
        console.summary(&format!(
            "{}: {what} of {} objects, {} triangles in {} meshes, {} if each object had its own; \
             {} of places, {} in {}",
            self.output.display(),
            count(instances),
            count(scene.triangle_count()),
            count(scene.meshes.len()),
            count(drawn),
            bytes(memory as u64),
            bytes(written.bytes),
            seconds(console.elapsed()),
        ))?;
        console.document(&serde_json::json!({
            "output": self.output,
            "files": written.files,
            "bytes": written.bytes,
            "instances": instances,
            "placement_bytes": memory,
            "meshes": scene.meshes.len(),
            "nodes": scene.nodes.len(),
            "triangles": scene.triangle_count(),
            "drawn_triangles": drawn,
        }))
    }
}

/// Reports progress and hears a wish to stop.
fn check(progress: &dyn Progress, stage: &'static str, fraction: f32) -> Result<()> {
    progress.report(stage, fraction);
    Ok(check_cancelled()?)
}

/// A scene or options that the library refuses: the user's input.
fn refused(args: &OutputArgs, error: karui::Error) -> anyhow::Error {
    karui_io::Error::file(&args.output, ErrorKind::Geometry(error)).into()
}
