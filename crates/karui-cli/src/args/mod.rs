//! The command line as a whole; each command's own options are in its file.

mod metric;
mod picture;
mod screen;
mod simplify;

pub use metric::MetricArgs;
pub use picture::{PictureArgs, size};
pub use screen::ScreenArgs;
pub use simplify::SimplifyArgs;

use crate::commands::Command;
use clap::Parser;
use karui_io::{GltfOptions, PlyEncoding, WriteOptions};
use std::num::NonZeroUsize;

const EXIT_CODES: &str = "\
Exit codes:
  0    success
  1    a check that was asked for failed (validate, measure)
  2    bad usage or bad input; nothing was written
  3    output cannot be written; nothing was left behind
  130  interrupted; nothing was left behind

Formats: OBJ, PLY, STL, OFF (each also as .gz), glTF and GLB; read by name and content, written by name.";

/// Level of detail for 3D models: fewer triangles, with measured errors.
#[derive(Debug, Parser)]
#[command(name = "karui", version, after_long_help = EXIT_CODES, max_term_width = 100)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// Options of every command.
    #[command(flatten)]
    pub global: Global,
}

/// Options of every command.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Global options")]
pub struct Global {
    /// Print one JSON document on standard output instead of text
    #[arg(long, global = true)]
    pub json: bool,
    /// Print results and errors only: no progress, warnings or summary
    #[arg(long, short, global = true)]
    pub quiet: bool,
    /// Worker threads; the output does not depend on it [default: one a core]
    #[arg(long, global = true, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
}

/// How files are written.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "Output options")]
pub struct WriteArgs {
    /// Compress glTF buffers, without loss (EXT_meshopt_compression)
    #[arg(long)]
    compress: bool,
    /// Store glTF attributes as small integers (KHR_mesh_quantization)
    #[arg(long)]
    quantize: bool,
    /// Write PLY and STL as text
    #[arg(long)]
    ascii: bool,
}

impl WriteArgs {
    /// As the writers want it.
    pub fn resolve(&self) -> WriteOptions {
        WriteOptions {
            ply: match self.ascii {
                true => PlyEncoding::Ascii,
                false => PlyEncoding::default(),
            },
            stl_ascii: self.ascii,
            gltf: GltfOptions {
                quantize: self.quantize,
                meshopt: self.compress,
                ..GltfOptions::default()
            },
        }
    }
}
