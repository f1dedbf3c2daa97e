//! Which files `karui lod` writes, decided before any work.

use crate::failure::Failure;
use crate::output::Staged;
use anyhow::Result;
use clap::ValueEnum;
use karui_io::Format;
use std::path::{Path, PathBuf};

/// Format of the file a level.
#[derive(Debug, Clone, Copy, Default, ValueEnum)]
pub enum LevelFormat {
    #[default]
    Glb,
    Gltf,
    Ply,
    Obj,
    Stl,
    Off,
}

/// The files to write.
#[derive(Debug)]
pub struct Plan {
    output: PathBuf,
    /// Whether the output is one file with all levels.
    is_file: bool,
    /// Whether there is a file a level.
    pub separate: bool,
    combined: bool,
    format: LevelFormat,
}

impl Plan {
    /// From what the user wrote.
    pub fn new(output: &Path, separate: bool, format: LevelFormat) -> Result<Self> {
        let is_file = names_file(output)?;
        Ok(Self {
            output: output.to_owned(),
            is_file,
            separate: separate || !is_file,
            combined: !separate,
            format,
        })
    }

    /// Prepares the folder.
    pub fn stage(&self) -> Result<Staged> {
        if self.is_file {
            return Staged::beside(&self.output);
        }
        Staged::in_directory(&self.output)
    }

    /// `name_lod2.glb`.
    pub fn level_name(&self, stem: &str, level: usize) -> String {
        let value = self.format.to_possible_value();
        let extension = value.as_ref().map_or("glb", |v| v.get_name());
        format!("{}_lod{level}.{extension}", self.stem(stem))
    }

    /// Name of the file with all levels, if there is to be one.
    pub fn combined_name(&self, stem: &str) -> Option<String> {
        let name = match self.is_file {
            true => self.output.file_name()?.to_string_lossy().into_owned(),
            false => format!("{stem}.glb"),
        };
        self.combined.then_some(name)
    }

    /// Name of the report.
    pub fn report_name(&self) -> String {
        match self.is_file {
            true => format!("{}.report.json", self.stem("")),
            false => "report.json".into(),
        }
    }

    fn stem(&self, of_input: &str) -> String {
        let own = self.output.file_stem().filter(|_| self.is_file);
        own.map_or_else(|| of_input.to_owned(), |s| s.to_string_lossy().into_owned())
    }
}

/// Whether the output names a glTF file rather than a folder.
fn names_file(output: &Path) -> Result<bool> {
    if output.is_dir() || output.as_os_str().to_string_lossy().ends_with('/') {
        return Ok(false);
    }
    match Format::from_path(output) {
        Ok(Format::Glb | Format::Gltf) => Ok(true),
        Ok(other) => {
            let message = format!("{}: {other} cannot hold several levels", output.display());
            let hint = "name a folder and use --format, or a .glb file";
            Err(Failure::input(message).hint(hint).into())
        }
        Err(_) => Ok(false),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_or_folder() {
        let plan =
            |output: &str, separate| Plan::new(Path::new(output), separate, LevelFormat::Ply);
        let folder = plan("none/out", false).unwrap();
        assert_eq!(folder.level_name("cow", 2), "cow_lod2.ply");
        assert_eq!(folder.combined_name("cow").as_deref(), Some("cow.glb"));
        assert_eq!(folder.report_name(), "report.json");
        let file = plan("none/calf.glb", false).unwrap();
        assert!(!file.separate);
        assert_eq!(file.combined_name("cow").as_deref(), Some("calf.glb"));
        assert_eq!(file.report_name(), "calf.report.json");
        let separate = plan("none/calf.glb", true).unwrap();
        assert_eq!(separate.combined_name("cow"), None);
        assert_eq!(separate.level_name("cow", 0), "calf_lod0.ply");
        assert!(plan("none/calf.obj", false).is_err());
        assert!(!plan("none/calf.glb/", false).unwrap().is_file);
    }
}
