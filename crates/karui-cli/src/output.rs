//! Files written all or none.

use crate::failure::Failure;
use crate::progress::check_cancelled;
use anyhow::Result;
use karui::Scene;
use karui_io::{ErrorKind, WriteOptions, Written};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Files that are written aside and appear in their directory together, once
/// all of them are complete.
#[derive(Debug)]
pub struct Staged {
    directory: PathBuf,
    // Dropped before `created`, so that a directory made for nothing is empty
    // when its turn to vanish comes.
    aside: TempDir,
    created: Created,
}

/// Directories of ours, innermost first, that go away again unless used.
#[derive(Debug)]
struct Created(Vec<PathBuf>);

impl Created {
    fn with_parents(directory: &Path) -> std::io::Result<Self> {
        let missing = directory.ancestors().take_while(|d| !d.exists());
        let missing = missing.filter(|d| !d.as_os_str().is_empty());
        let created = Self(missing.map(Path::to_owned).collect());
        std::fs::create_dir_all(directory)?;
        Ok(created)
    }
}

impl Drop for Created {
    fn drop(&mut self) {
        for path in &self.0 {
            // Fails if something else lies in it by now, which is right.
            let _ = std::fs::remove_dir(path);
        }
    }
}

impl Staged {
    /// Prepares to write into `directory`, which is created if need be.
    pub fn in_directory(directory: &Path) -> Result<Self> {
        let fail = |error| Failure::output(directory, &error);
        Self::new(directory, Created::with_parents(directory).map_err(fail)?)
    }

    /// Prepares to write `file` and what belongs beside it; its directory has
    /// to exist.
    pub fn beside(file: &Path) -> Result<Self> {
        let directory = file.parent().unwrap_or(Path::new(""));
        Self::new(directory, Created(Vec::new()))
    }

    fn new(directory: &Path, created: Created) -> Result<Self> {
        let aside = tempfile::Builder::new()
            .prefix(".karui-")
            .tempdir_in(Path::new(".").join(directory))
            .map_err(|error| Failure::output(directory, &error))?;
        Ok(Self {
            directory: directory.to_owned(),
            aside,
            created,
        })
    }

    /// Writes `bytes` to the file that is to be called `name`.
    pub fn bytes(&self, name: &str, bytes: &[u8]) -> Result<()> {
        let aside = self.aside.path().join(name);
        let fail = |error| Failure::output(&self.directory.join(name), &error);
        Ok(std::fs::write(aside, bytes).map_err(fail)?)
    }

    /// Writes `scene` to the file that is to be called `name`, together with
    /// the files it refers to; returns their size in bytes.
    pub fn scene(&self, name: &str, scene: &Scene, options: &WriteOptions) -> Result<u64> {
        let aside = self.aside.path().join(name);
        let written = karui_io::write_with(aside, scene, options);
        Ok(written
            .map_err(|e| refused(&self.directory.join(name), e))?
            .bytes)
    }

    /// Moves all files to their places and returns these, in order of names.
    /// A user's wish to stop is heard a last time before.
    pub fn publish(mut self) -> Result<Vec<PathBuf>> {
        check_cancelled()?;
        let fail = |error| Failure::output(&self.directory, &error);
        let names = files_below(self.aside.path()).map_err(fail)?;
        let targets: Vec<_> = names.iter().map(|n| self.directory.join(n)).collect();
        if let Some(folder) = targets.iter().find(|t| t.is_dir()) {
            let error = std::io::ErrorKind::IsADirectory.into();
            return Err(Failure::output(folder, &error).into());
        }
        for (name, target) in names.iter().zip(&targets) {
            let fail = |error| Failure::output(target, &error);
            std::fs::create_dir_all(target.parent().unwrap_or(target)).map_err(fail)?;
            std::fs::rename(self.aside.path().join(name), target).map_err(fail)?;
        }
        self.created.0.clear();
        Ok(targets)
    }
}

/// Paths of all files below `root`, relative to it and in order.
fn files_below(root: &Path) -> std::io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    let mut folders = vec![PathBuf::new()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(root.join(&folder))? {
            let entry = entry?;
            let list = if entry.file_type()?.is_dir() {
                &mut folders
            } else {
                &mut files
            };
            list.push(folder.join(entry.file_name()));
        }
    }
    files.sort();
    Ok(files)
}

/// A file of these bytes, to appear when it is published.
pub fn staged(path: &Path, bytes: &[u8]) -> Result<Staged> {
    let name = path.file_name().and_then(|name| name.to_str());
    let fail = || Failure::output(path, &std::io::ErrorKind::IsADirectory.into());
    let staged = Staged::beside(path)?;
    staged.bytes(name.ok_or_else(fail)?, bytes)?;
    Ok(staged)
}

/// Writes a scene to one file and those it refers to.
pub fn write_one(path: &Path, scene: &Scene, options: &WriteOptions) -> Result<Written> {
    check_cancelled()?;
    karui_io::write_with(path, scene, options).map_err(|e| refused(path, e))
}

/// A writer's error: the device's fault or the content's.
pub fn refused(path: &Path, error: karui_io::Error) -> anyhow::Error {
    match *error.kind {
        ErrorKind::Io(io) => Failure::output(path, &io).into(),
        kind => karui_io::Error::file(path, kind).into(),
    }
}
