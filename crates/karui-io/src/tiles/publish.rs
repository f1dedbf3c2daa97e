//! A tileset that appears whole or not at all: a folder, or a place in a cloud.

#[cfg(feature = "cloud")]
use super::upload::Upload;
use super::{model::Tileset, read::read};
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

/// The root file of a tileset.
pub(super) const ROOT: &str = "tileset.json";

/// A tileset that is being filled, unseen.
pub(super) enum Draft {
    Folder(Aside),
    #[cfg(feature = "cloud")]
    Upload(Upload),
}

impl Draft {
    /// Starts a tileset that is to be at `target`.
    pub fn new(target: &Path, overwrite: bool) -> Result<Self> {
        #[cfg(feature = "cloud")]
        if let Some(url) = Upload::url(target) {
            return Ok(Self::Upload(Upload::new(url, overwrite)?));
        }
        Ok(Self::Folder(Aside::new(target, overwrite)?))
    }

    /// Writes a file of it that is not the root; returns its size.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<u64> {
        match self {
            Self::Folder(aside) => aside.write(name, bytes)?,
            #[cfg(feature = "cloud")]
            Self::Upload(upload) => upload.write(name, bytes)?,
        }
        Ok(bytes.len() as u64)
    }

    /// Writes the root file, after which it is there for all to see; returns its size.
    pub fn publish(self, root: &[u8]) -> Result<u64> {
        let size = self.write(ROOT, root)?;
        match self {
            Self::Folder(aside) => aside.publish()?,
            // Whoever has the root file finds the others.
            #[cfg(feature = "cloud")]
            Self::Upload(_) => {}
        }
        Ok(size)
    }
}

/// Whether a tileset may be written to `target`, before any work is done for it: a folder, or
/// with the feature `cloud` an `s3://`, `gs://` or `az://` URL.
///
/// # Errors
/// [`Io`](ErrorKind::Io) if there is something else than a tileset of Karui's, or one and
/// `overwrite` is not set; [`Blocks`](ErrorKind::Blocks) if a cloud does not answer.
pub fn may_write(target: impl AsRef<Path>, overwrite: bool) -> Result<()> {
    let target = target.as_ref();
    #[cfg(feature = "cloud")]
    if let Some(url) = Upload::url(target) {
        return Upload::may_write(url, overwrite);
    }
    refuse(target, overwrite).map_err(|e| Error::file(target, ErrorKind::Io(e)))
}

/// A folder that is being filled beside its target.
pub(super) struct Aside {
    aside: TempDir,
    target: PathBuf,
}

impl Aside {
    fn new(target: &Path, overwrite: bool) -> Result<Self> {
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
        let folder = Self {
            aside,
            target: target.to_owned(),
        };
        // A folder within, as temporary ones are private.
        fs::create_dir(folder.path()).map_err(fail)?;
        Ok(folder)
    }

    /// The folder to fill.
    fn path(&self) -> PathBuf {
        self.aside.path().join("tileset")
    }

    fn write(&self, name: &str, bytes: &[u8]) -> Result<()> {
        let path = self.path().join(name);
        let fail = |error| Error::file(self.target.join(name), ErrorKind::Io(error));
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).map_err(fail)?;
        }
        fs::write(&path, bytes).map_err(fail)
    }

    /// Puts the folder in its place.
    fn publish(self) -> Result<()> {
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
    match fs::symlink_metadata(target) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(error),
        Ok(found) if !found.is_dir() => return Err(there("is there and is no folder")),
        Ok(_) => {}
    }
    if fs::read_dir(target)?.next().is_none() {
        return Ok(());
    }
    let ours = read(target.join(ROOT)).is_ok_and(|tileset| is_ours(&tileset));
    may_replace(ours, overwrite)
}

/// Whether what is there, a tileset of ours or not, may be replaced.
pub(super) fn may_replace(ours: bool, overwrite: bool) -> io::Result<()> {
    match (ours, overwrite) {
        (true, true) => Ok(()),
        (true, false) => Err(there(
            "the folder holds a tileset, and overwriting was not asked for",
        )),
        (false, _) => Err(there(
            "the folder holds something else than a tileset of Karui",
        )),
    }
}

fn there(what: &str) -> io::Error {
    io::Error::new(io::ErrorKind::AlreadyExists, what.to_owned())
}

/// Whether Karui wrote a tileset.
pub(super) fn is_ours(tileset: &Tileset) -> bool {
    let generator = tileset
        .asset
        .other
        .get("extras")
        .and_then(|e| e.get("generator"));
    generator
        .and_then(Value::as_str)
        .is_some_and(|g| g.starts_with("karui "))
}
