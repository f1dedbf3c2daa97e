//! Where a plan is kept: a folder, or a prefix of a bucket.

use super::told;
use crate::failure::Failure;
use anyhow::Result;
use karui::outofcore::{self, Folder, Store};
#[cfg(feature = "cloud")]
use karui_io::Cloud;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Begin the names of places in clouds.
const SCHEMES: [&str; 3] = ["s3://", "gs://", "az://"];

/// Where a plan is kept.
pub enum Place {
    /// A folder.
    Folder(Folder),
    /// A prefix of a bucket.
    #[cfg(feature = "cloud")]
    Cloud(Cloud),
}

impl Place {
    /// Opens a place; a folder is made if need be.
    pub fn create(name: &Path) -> Result<Self> {
        match cloudy(name) {
            Some(url) => cloud(url),
            None => Ok(Self::Folder(Folder::create(name).map_err(told)?)),
        }
    }

    /// Opens a place as it is.
    pub fn open(name: &Path) -> Result<Self> {
        match cloudy(name) {
            Some(url) => cloud(url),
            None => Ok(Self::Folder(Folder::open(name))),
        }
    }

    /// The folder's path or the URL.
    pub fn name(&self) -> &Path {
        match self {
            Self::Folder(folder) => folder.root(),
            #[cfg(feature = "cloud")]
            Self::Cloud(cloud) => Path::new(cloud.url()),
        }
    }

    /// Takes away what writers that died have left; a cloud keeps nothing of what was not put
    /// as a whole.
    pub fn sweep(&self) -> Result<()> {
        match self {
            Self::Folder(folder) => folder.sweep().map_err(told),
            #[cfg(feature = "cloud")]
            Self::Cloud(_) => Ok(()),
        }
    }

    /// Takes all of it away.
    pub fn clear(&self) -> Result<()> {
        self.sweep()?;
        for name in self.list().map_err(told)? {
            self.remove(&name).map_err(told)?;
        }
        match self {
            // Fails if there is something of somebody else's in it, which is right.
            Self::Folder(folder) => drop(std::fs::remove_dir(folder.root())),
            #[cfg(feature = "cloud")]
            Self::Cloud(_) => {}
        }
        Ok(())
    }

    fn store(&self) -> &dyn Store {
        match self {
            Self::Folder(folder) => folder,
            #[cfg(feature = "cloud")]
            Self::Cloud(cloud) => cloud,
        }
    }
}

impl Store for Place {
    fn get(&self, name: &str) -> outofcore::Result<Vec<u8>> {
        self.store().get(name)
    }

    fn get_range(&self, name: &str, range: Range<u64>) -> outofcore::Result<Vec<u8>> {
        self.store().get_range(name, range)
    }

    fn put(&self, name: &str, bytes: &[u8]) -> outofcore::Result<()> {
        self.store().put(name, bytes)
    }

    fn exists(&self, name: &str) -> outofcore::Result<bool> {
        self.store().exists(name)
    }

    fn list(&self) -> outofcore::Result<Vec<String>> {
        self.store().list()
    }

    fn remove(&self, name: &str) -> outofcore::Result<()> {
        self.store().remove(name)
    }
}

/// Place and name of a manifest, of `PLACE/NAME`.
pub fn split(manifest: &Path) -> Result<(PathBuf, &str)> {
    let name = manifest.file_name().and_then(|name| name.to_str());
    let Some(name) = name else {
        return Err(Failure::input("the manifest has no name").into());
    };
    let place = match manifest.parent() {
        Some(place) if place != Path::new("") => place.to_owned(),
        _ => PathBuf::from("."),
    };
    Ok((place, name))
}

/// Refuses a URL that makes no sense, or that this program does not know.
pub fn known(name: &Path) -> Result<()> {
    cloudy(name).map_or(Ok(()), |url| cloud(url).map(drop))
}

/// The name, if it is a URL.
pub fn cloudy(name: &Path) -> Option<&str> {
    let name = name.to_str()?;
    let mut schemes = SCHEMES.iter();
    schemes
        .any(|scheme| name.starts_with(scheme))
        .then_some(name)
}

#[cfg(feature = "cloud")]
fn cloud(url: &str) -> Result<Place> {
    Ok(Place::Cloud(Cloud::open(url).map_err(told)?))
}

#[cfg(not(feature = "cloud"))]
fn cloud(url: &str) -> Result<Place> {
    let message = format!("{url}: this karui knows folders only");
    let hint = "build it with `--features cloud` for s3://, gs:// and az:// URLs";
    Err(Failure::input(message).hint(hint).into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn urls_are_told_from_folders() {
        for url in ["s3://bucket/prefix", "gs://b/p", "az://b/p"] {
            assert_eq!(cloudy(Path::new(url)), Some(url));
        }
        for folder in ["s3", "s3:/bucket", "work/s3://x", "C:\\work", "/tmp/gs"] {
            assert_eq!(cloudy(Path::new(folder)), None);
        }
    }

    #[test]
    fn manifests_have_a_place_and_a_name() {
        for (manifest, place) in [
            ("01-read.tasks", "."),
            ("work/01-read.tasks", "work"),
            ("s3://bucket/a/01-read.tasks", "s3://bucket/a"),
        ] {
            let (found, name) = split(Path::new(manifest)).expect("split");
            assert_eq!(found.to_str(), Some(place));
            assert_eq!(name, "01-read.tasks");
        }
        assert!(split(Path::new("..")).is_err());
    }
}
