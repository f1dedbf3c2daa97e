//! Files that appear whole or not at all.
//!
//! Everything is written to temporary files beside the targets; only when all
//! of them are complete are they renamed into place. An error, or dropping the
//! [`Transaction`], removes them.

use crate::error::{Error, ErrorKind, Result};
use std::{
    fs,
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
};
use tempfile::{Builder, NamedTempFile};

/// Bytes gathered before the operating system is asked to write.
pub(crate) const BUFFER: usize = 1 << 18;

/// A set of files that become visible together.
#[derive(Debug, Default)]
pub(crate) struct Transaction {
    finished: Vec<Finished>,
}

#[derive(Debug)]
struct Finished {
    file: NamedTempFile,
    target: PathBuf,
    bytes: u64,
}

/// What was written.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Written {
    /// The files, the model itself last.
    pub files: Vec<PathBuf>,
    /// Their size in total.
    pub bytes: u64,
    /// What the format could not hold and was left out, e.g. `materials`.
    pub lost: Vec<String>,
}

/// The stream a writer fills.
pub(crate) type Sink<'a> = dyn Write + 'a;

impl Transaction {
    /// Writes the file `target` by calling `fill`. The model itself must come
    /// after the files it refers to.
    pub fn write(
        &mut self,
        target: &Path,
        fill: impl FnOnce(&mut Sink<'_>) -> io::Result<()>,
    ) -> Result<()> {
        let fail = |error| Error::file(target, ErrorKind::Io(error));
        let file = temporary(target).map_err(fail)?;
        let bytes = fill_file(&file, fill).map_err(fail)?;
        let target = target.to_path_buf();
        self.finished.push(Finished {
            file,
            target,
            bytes,
        });
        Ok(())
    }

    /// Renames every file into place. If one cannot be renamed, those already
    /// in place are removed again.
    pub fn commit(self) -> Result<Written> {
        let mut written = Written::default();
        for Finished {
            file,
            target,
            bytes,
        } in self.finished
        {
            if let Err(error) = file.persist(&target) {
                let remove = |done: &PathBuf| drop(fs::remove_file(done));
                written.files.iter().for_each(remove);
                return Err(Error::file(target, ErrorKind::Io(error.error)));
            }
            written.files.push(target);
            written.bytes += bytes;
        }
        Ok(written)
    }
}

/// A new file beside `target` that is to become it.
pub(crate) fn temporary(target: &Path) -> io::Result<NamedTempFile> {
    // Renaming over a folder fails late, and over a device would destroy it.
    match fs::metadata(target) {
        Ok(found) if found.is_dir() => return Err(io::ErrorKind::IsADirectory.into()),
        Ok(found) if !found.is_file() => return Err(io::Error::other("is not a regular file")),
        _ => {}
    }
    let folder = match target.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut builder = Builder::new();
    builder.prefix(".karui-").suffix(".part");
    #[cfg(unix)]
    {
        // The usual mode of a new file (the umask still applies) instead of
        // the private one of temporary files.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    // Only the kind: the name of the temporary file would confuse.
    builder.tempfile_in(folder).map_err(|e| e.kind().into())
}

fn fill_file(
    file: &NamedTempFile,
    fill: impl FnOnce(&mut Sink<'_>) -> io::Result<()>,
) -> io::Result<u64> {
    let mut sink = BufWriter::with_capacity(BUFFER, file.as_file());
    fill(&mut sink)?;
    sink.flush()?;
    Ok(file.as_file().metadata()?.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<_> = entries
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn all_files_or_none() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let mut good = Transaction::default();
        good.write(&at("a.bin"), |w| w.write_all(b"123")).unwrap();
        assert_eq!(names(folder.path()).len(), 1, "only the temporary file");
        good.write(&at("a.gltf"), |w| w.write_all(b"4567")).unwrap();
        let written = good.commit().unwrap();
        assert_eq!(written.bytes, 7);
        assert_eq!(names(folder.path()), ["a.bin", "a.gltf"]);

        let mut bad = Transaction::default();
        bad.write(&at("b.bin"), |w| w.write_all(b"123")).unwrap();
        let full = |_: &mut Sink<'_>| Err(io::ErrorKind::StorageFull.into());
        let error = bad.write(&at("b.gltf"), full).unwrap_err();
        assert!(error.to_string().ends_with("no space left on the device"));
        drop(bad);
        assert_eq!(names(folder.path()), ["a.bin", "a.gltf"]);
    }

    #[test]
    fn folders_and_missing_folders_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let mut files = Transaction::default();
        let error = files.write(folder.path(), |_| Ok(())).unwrap_err();
        assert!(error.to_string().ends_with("is a folder, not a file"));
        let missing = folder.path().join("none/a.obj");
        let error = files.write(&missing, |_| Ok(())).unwrap_err();
        assert!(error.to_string().ends_with("no such file or folder"));
    }

    #[cfg(unix)]
    #[test]
    fn new_files_are_readable_by_others() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("a.obj");
        let plain = folder.path().join("plain");
        fs::write(&plain, "x").unwrap();
        let mut files = Transaction::default();
        files.write(&target, |w| w.write_all(b"1")).unwrap();
        files.commit().unwrap();
        let mode = |path| fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&target), mode(&plain));
    }
}
