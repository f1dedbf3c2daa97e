//! One mesh of any size, written as it is made.

use crate::console::Console;
use crate::failure::Failure;
use crate::output::refused;
use crate::progress::check_cancelled;
use crate::table::{bytes, count, seconds};
use anyhow::Result;
use karui_io::{Format, slices::PlyWriter};
use std::path::PathBuf;

/// Where to.
#[derive(Debug, clap::Args)]
pub(super) struct MeshOutput {
    /// The .ply to write
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
}

impl MeshOutput {
    /// Refuses other formats before any work is done.
    pub fn check(&self) -> Result<()> {
        let name = self.output.display();
        let is_gz = self.output.extension().is_some_and(|e| e == "gz");
        if !is_gz && Format::from_path(&self.output)? == Format::Ply {
            return Ok(());
        }
        let failure = Failure::input(format!("{name}: not a PLY file name"));
        let hint = "write a .ply; `karui convert` makes other formats of what fits into memory";
        Err(failure.hint(hint).into())
    }

    /// Starts the file.
    pub fn create(&self) -> Result<PlyWriter> {
        self.put(PlyWriter::create(&self.output))
    }

    /// What came of writing to it.
    pub fn put<T>(&self, result: karui_io::Result<T>) -> Result<T> {
        result.map_err(|error| refused(&self.output, error))
    }

    /// Puts the file in its place and says what it is.
    pub fn finish(&self, writer: PlyWriter, what: &str, console: &Console) -> Result<()> {
        let [vertices, triangles] = [writer.vertices(), writer.triangles()];
        check_cancelled()?;
        let size = self.put(writer.finish())?;
        console.summary(&format!(
            "{}: {what} of {} triangles, {} vertices; {} in {}",
            self.output.display(),
            count(triangles as usize),
            count(vertices as usize),
            bytes(size),
            seconds(console.elapsed()),
        ))?;
        console.document(&serde_json::json!({
            "output": self.output,
            "bytes": size,
            "vertices": vertices,
            "triangles": triangles,
        }))
    }
}
