//! A folder that appears whole or not at all.

use super::read::read;
use crate::error::{Error, ErrorKind, Result};
use serde_json::{Value, json};
use std::{
    fs, io,
    path::{Path, PathBuf},
};
use tempfile::TempDir;

/// Who wrote a tileset, in the `extras` of its `asset`.
pub(super) fn signature() -> Value {
    json!({ "generator": concat!("karui ", env!("CARGO_PKG_VERSION")) })
}

/// A folder that is being filled beside its target.
pub(super) struct Draft {
    aside: TempDir,
    target: PathBuf,
}

impl Draft {
    /// Starts a folder that is to become `target`.
    pub fn new(target: &Path, overwrite: bool) -> Result<Self> {
        let fail = |error| Error::file(target, ErrorKind::Io(error));
        refuse(target, overwrite).map_err(fail)?;
        let parent = match target.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        };
        let mut builder = tempfile::Builder::new();
        let aside = builder.prefix(".karui-").suffix(".part").tempdir_in(parent);
        // Only the kind: the name of the temporary folder would confuse.
        let aside = aside.map_err(|e| fail(e.kind().into()))?;
        let draft = Self {
            aside,
            target: target.to_owned(),
        };
        // A folder within, as temporary ones are private.
        fs::create_dir(draft.path()).map_err(fail)?;
        Ok(draft)
    }

    /// The folder to fill.
    pub fn path(&self) -> PathBuf {
        self.aside.path().join("tileset")
    }

    /// Writes a file below the folder; returns its size.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<u64> {
        let path = self.path().join(name);
        let fail = |error| Error::file(self.target.join(name), ErrorKind::Io(error));
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).map_err(fail)?;
        }
        fs::write(&path, bytes).map_err(fail)?;
        Ok(bytes.len() as u64)
    }

    /// Puts the folder in its place.
    pub fn publish(self) -> Result<()> {
        let fail = |error| Error::file(&self.target, ErrorKind::Io(error));
        let old = self.aside.path().join("old");
        let replaced = self.target.exists();
        if replaced {
            fs::rename(&self.target, &old).map_err(fail)?;
        }
        if let Err(error) = fs::rename(self.path(), &self.target) {
            if replaced {
                // Nothing more can be done if this fails as well.
                let _ = fs::rename(&old, &self.target);
            }
            return Err(fail(error));
        }
        Ok(())
    }
}

/// Refuses to replace anything but an empty folder or, if asked, a tileset of
/// our own.
fn refuse(target: &Path, overwrite: bool) -> io::Result<()> {
    let exists = |what: &str| {
        Err(io::Error::new(
            io::ErrorKind::AlreadyExists,
            what.to_owned(),
        ))
    };
    match fs::symlink_metadata(target) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(error),
        Ok(found) if !found.is_dir() => return exists("is there and is no folder"),
        Ok(_) => {}
    }
    if fs::read_dir(target)?.next().is_none() {
        return Ok(());
    }
    if !is_ours(target) {
        return exists("the folder holds something else than a tileset of Karui");
    }
    if !overwrite {
        return exists("the folder holds a tileset, and overwriting was not asked for");
    }
    Ok(())
}

fn is_ours(folder: &Path) -> bool {
    let Ok(tileset) = read(folder.join("tileset.json")) else {
        return false;
    };
    let generator = tileset
        .asset
        .other
        .get("extras")
        .and_then(|e| e.get("generator"));
    generator
        .and_then(Value::as_str)
        .is_some_and(|g| g.starts_with("karui "))
}
