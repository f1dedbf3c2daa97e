//! `karui convert`: from one format to another.

use crate::args::WriteArgs;
use crate::console::Console;
use crate::table::{bytes, count, seconds};
use crate::{input, output};
use anyhow::Result;
use std::path::PathBuf;

/// Convert a model to another format
///
/// The formats go by the file names. glTF keeps everything; what the other formats cannot hold
/// is left out.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The model to read
    input: PathBuf,
    /// The file to write
    output: PathBuf,
    #[command(flatten)]
    write: WriteArgs,
}

/// Reads and writes.
pub fn run(args: &Args, console: &Console) -> Result<()> {
    input::output_format(&args.output)?;
    let options = args.write.resolve();
    let input = input::read(&args.input, console)?;
    let written = output::write_one(&args.output, &input.scene, &options)?;
    console.summary(&format!(
        "{}: {} triangles, {} in {}",
        args.output.display(),
        count(input.scene.triangle_count()),
        bytes(written.bytes),
        seconds(console.elapsed()),
    ))?;
    console.document(&serde_json::json!({
        "input": input.path,
        "output": args.output,
        "files": written.files,
        "bytes": written.bytes,
        "triangles": input.scene.triangle_count(),
    }))
}
