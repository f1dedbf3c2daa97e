//! The folder of a tileset.

use crate::error::{Error, Result};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Files of a tileset that are kept track of.
const MAX_FILES: usize = 1_000_000;

/// A tileset and the files below its folder, listed once: what a client asks for is looked
/// up here and never on the disk.
#[derive(Debug)]
pub struct Tileset {
    /// Where in the list the root is.
    pub root: String,
    /// Size of its file.
    pub bytes: u64,
    files: BTreeMap<String, PathBuf>,
}

impl Tileset {
    /// Lists the folder of `path`. Links are not followed.
    pub fn open(path: &Path) -> Result<Self> {
        let found = fs::metadata(path).map_err(|e| failed(path, e))?;
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        let mut files = BTreeMap::new();
        let mut folders = vec![(String::new(), folder.to_owned())];
        while let Some((prefix, folder)) = folders.pop() {
            list(&prefix, &folder, &mut files, &mut folders)?;
        }
        let root = path.file_name().unwrap_or_default();
        Ok(Self {
            root: root.to_string_lossy().into_owned(),
            bytes: found.len(),
            files,
        })
    }

    /// The file of an address below the tileset.
    pub fn file(&self, name: &str) -> Option<&Path> {
        self.files.get(name).map(PathBuf::as_path)
    }

    /// Files there are.
    pub fn count(&self) -> usize {
        self.files.len()
    }
}

fn list(
    prefix: &str,
    folder: &Path,
    files: &mut BTreeMap<String, PathBuf>,
    folders: &mut Vec<(String, PathBuf)>,
) -> Result<()> {
    for entry in fs::read_dir(folder).map_err(|e| failed(folder, e))? {
        let entry = entry.map_err(|e| failed(folder, e))?;
        let kind = entry.file_type().map_err(|e| failed(folder, e))?;
        // A name that is no text has no address.
        let Ok(name) = entry.file_name().into_string() else {
            continue;
        };
        let name = format!("{prefix}{name}");
        if kind.is_dir() {
            folders.push((format!("{name}/"), entry.path()));
        } else if kind.is_file() {
            files.insert(name, entry.path());
        }
        if files.len() + folders.len() > MAX_FILES {
            let (path, limit) = (folder.to_owned(), MAX_FILES);
            return Err(Error::TooManyFiles { path, limit });
        }
    }
    Ok(())
}

fn failed(path: &Path, error: std::io::Error) -> Error {
    let path = path.to_owned();
    Error::Folder { path, error }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_below_the_folder() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir_all(at("city/tiles")).unwrap();
        for name in ["secret.txt", "city/tileset.json", "city/tiles/0.glb"] {
            fs::write(at(name), "x").unwrap();
        }
        #[cfg(unix)]
        std::os::unix::fs::symlink(at("secret.txt"), at("city/link.txt")).unwrap();
        let set = Tileset::open(&at("city/tileset.json")).unwrap();
        assert_eq!((set.count(), set.root.as_str()), (2, "tileset.json"));
        assert_eq!(set.file("tiles/0.glb"), Some(&*at("city/tiles/0.glb")));
        for name in [
            "../secret.txt",
            "link.txt",
            "tiles/../tileset.json",
            "tiles",
            "/",
            "",
        ] {
            assert_eq!(set.file(name), None, "{name}");
        }
        assert!(Tileset::open(&at("none.json")).is_err());
    }
}
