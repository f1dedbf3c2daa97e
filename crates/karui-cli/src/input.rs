//! Models read from files.

use crate::console::Console;
use crate::failure::Failure;
use anyhow::Result;
use karui::Scene;
use karui_io::Format;
use std::path::{Path, PathBuf};

/// A model and where it came from.
#[derive(Debug)]
pub struct Input {
    /// The file.
    pub path: PathBuf,
    /// Its size on disk.
    pub bytes: u64,
    /// What it holds.
    pub scene: Scene,
}

/// Reads a model and passes on the reader's warnings.
pub fn read(path: &Path, console: &Console) -> Result<Input> {
    let loaded = karui_io::read_with(path, &karui_io::ReadOptions::default())?;
    for warning in &loaded.warnings {
        console.warn(&format!("{}: {warning}", path.display()));
    }
    let bytes = std::fs::metadata(path).map_or(0, |m| m.len());
    Ok(Input {
        path: path.to_owned(),
        bytes,
        scene: loaded.scene,
    })
}

impl Input {
    /// The file's name without folder and extensions; `model` if nothing is
    /// left.
    pub fn stem(&self) -> String {
        let name = self.path.file_name().unwrap_or_default();
        let name = name.to_string_lossy();
        let stem = name.split('.').find(|part| !part.is_empty());
        stem.unwrap_or("model").to_owned()
    }

    /// Refuses a model without triangles.
    pub fn require_triangles(&self) -> Result<()> {
        if self.scene.triangle_count() > 0 {
            return Ok(());
        }
        let message = format!("{}: the model has no triangles", self.path.display());
        let hint = "points and lines are not handled; `karui info` shows what there is";
        Err(Failure::input(message).hint(hint).into())
    }
}

/// Refuses a name no writer knows, before any work is done for it.
pub fn output_format(path: &Path) -> Result<Format> {
    Ok(Format::from_path(path)?)
}
