//! A file that is there as a whole or not at all.

use crate::errors::FileError;
use pyo3::PyResult;
use std::{fs, path::Path, process};

/// Writes beside the place and renames.
pub fn write_whole(path: &Path, bytes: &[u8]) -> PyResult<()> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let beside = path.with_file_name(format!(".karui-{}-{name}.part", process::id()));
    let written = fs::write(&beside, bytes).and_then(|()| fs::rename(&beside, path));
    written.map_err(|error| {
        // What there is of it is of no use; if nothing is, nothing needs to go.
        drop(fs::remove_file(&beside));
        FileError::new_err(format!("{}: {error}", path.display()))
    })
}
