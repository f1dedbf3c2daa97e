//! Where blocks and manifests are kept.

use super::{Error, Result};
use std::{
    fs::{self, File},
    hash::{BuildHasher as _, RandomState},
    io::{self, Read as _, Seek as _, SeekFrom, Write as _},
    ops::Range,
    path::{Path, PathBuf},
    sync::atomic::{AtomicU64, Ordering},
};

/// Objects by name, each put as a whole and never changed afterwards.
///
/// Names are plain (letters, digits, `-`, `.`), without folders. Two tasks may put the same
/// object at the same time: they put the same bytes.
pub trait Store: Sync {
    /// The whole object.
    ///
    /// # Errors
    /// [`Error::Missing`], [`Error::Store`].
    fn get(&self, name: &str) -> Result<Vec<u8>>;

    /// Some bytes of an object.
    ///
    /// # Errors
    /// [`Error::Missing`], [`Error::Damaged`] if the object ends before, [`Error::Store`].
    fn get_range(&self, name: &str, range: Range<u64>) -> Result<Vec<u8>>;

    /// Puts an object: afterwards it is there as a whole or not at all.
    ///
    /// # Errors
    /// [`Error::Store`], among others if there is no room.
    fn put(&self, name: &str, bytes: &[u8]) -> Result<()>;

    /// Whether there is such an object.
    ///
    /// # Errors
    /// [`Error::Store`].
    fn exists(&self, name: &str) -> Result<bool>;

    /// Names of all objects, in order.
    ///
    /// # Errors
    /// [`Error::Store`].
    fn list(&self) -> Result<Vec<String>>;

    /// Takes an object away; one that is not there is no error.
    ///
    /// # Errors
    /// [`Error::Store`].
    fn remove(&self, name: &str) -> Result<()>;
}

/// A folder as a store: one file an object, written under another name and renamed.
#[derive(Debug)]
pub struct Folder {
    root: PathBuf,
    /// Tells this writer from all others: on a folder that machines share, numbers of
    /// processes are not enough.
    writer: u64,
    written: AtomicU64,
}

/// Begins the names of files that are being written.
const ASIDE: &str = "~";

impl Folder {
    /// Opens `root`, which is created if need be.
    ///
    /// # Errors
    /// [`Error::Store`].
    pub fn create(root: &Path) -> Result<Self> {
        let folder = Self::open(root);
        fs::create_dir_all(root).map_err(|e| folder.failed("", e))?;
        Ok(folder)
    }

    /// Opens `root` as it is.
    #[must_use]
    pub fn open(root: &Path) -> Self {
        Self {
            root: root.to_owned(),
            writer: RandomState::new().hash_one(std::process::id()),
            written: AtomicU64::new(0),
        }
    }

    /// The folder.
    #[must_use]
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Takes away what writers that died have left. Not while others may write.
    ///
    /// # Errors
    /// [`Error::Store`].
    pub fn sweep(&self) -> Result<()> {
        let mut names = self.names()?;
        names.retain(|name| name.starts_with(ASIDE));
        names.iter().try_for_each(|name| self.remove(name))
    }

    fn names(&self) -> Result<Vec<String>> {
        let failed = |cause| self.failed("", cause);
        let mut names = Vec::new();
        for entry in fs::read_dir(&self.root).map_err(failed)? {
            names.push(entry.map_err(failed)?.file_name().to_string_lossy().into());
        }
        names.sort_unstable();
        Ok(names)
    }

    fn file(&self, name: &str) -> Result<File> {
        File::open(self.root.join(name)).map_err(|cause| match cause.kind() {
            io::ErrorKind::NotFound => Error::Missing { name: name.into() },
            _ => self.failed(name, cause),
        })
    }

    fn failed(&self, name: &str, cause: io::Error) -> Error {
        let path = self.root.join(name);
        Error::Store { path, cause }
    }
}

impl Store for Folder {
    fn get(&self, name: &str) -> Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let read = self.file(name)?.read_to_end(&mut bytes);
        read.map_err(|cause| self.failed(name, cause))?;
        Ok(bytes)
    }

    fn get_range(&self, name: &str, range: Range<u64>) -> Result<Vec<u8>> {
        let failed = |cause| self.failed(name, cause);
        let mut file = self.file(name)?;
        file.seek(SeekFrom::Start(range.start)).map_err(failed)?;
        let expected = range.end.saturating_sub(range.start);
        let mut bytes = Vec::new();
        file.take(expected)
            .read_to_end(&mut bytes)
            .map_err(failed)?;
        if bytes.len() as u64 == expected {
            return Ok(bytes);
        }
        Err(Error::Damaged {
            name: name.into(),
            problem: "it ends early",
        })
    }

    fn put(&self, name: &str, bytes: &[u8]) -> Result<()> {
        let number = self.written.fetch_add(1, Ordering::Relaxed);
        let writer = self.writer;
        let aside = format!("{ASIDE}{writer:016x}-{number}-{name}");
        let aside = self.root.join(aside);
        let write = || {
            File::create(&aside)?.write_all(bytes)?;
            fs::rename(&aside, self.root.join(name))
        };
        write().map_err(|cause| {
            // Half a file is of no use to anybody; if even this fails, `sweep` is left.
            let _ = fs::remove_file(&aside);
            self.failed(name, cause)
        })
    }

    fn exists(&self, name: &str) -> Result<bool> {
        let there = self.root.join(name).try_exists();
        there.map_err(|cause| self.failed(name, cause))
    }

    fn list(&self) -> Result<Vec<String>> {
        let mut names = self.names()?;
        names.retain(|name| !name.starts_with(ASIDE));
        Ok(names)
    }

    fn remove(&self, name: &str) -> Result<()> {
        match fs::remove_file(self.root.join(name)) {
            Err(cause) if cause.kind() != io::ErrorKind::NotFound => Err(self.failed(name, cause)),
            _ => Ok(()),
        }
    }
}
