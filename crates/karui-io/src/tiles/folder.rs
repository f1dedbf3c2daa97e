//! Files of a tileset: below the folder of its root file, and nowhere else.

use crate::{
    error::{Error, ErrorKind, Result},
    gltf::uri,
    source::relative_path,
};
use std::path::{Path, PathBuf};

/// Why a URI names no file of the tileset.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Away {
    /// It has a scheme or names another machine.
    Remote,
    /// It leads out of the folder.
    Outside,
}

/// The file that `uri` names in a file of `folder` (relative to the folder of
/// the tileset's root), relative to the same. Query and fragment are cut off,
/// as a web server does before it looks for a file.
pub(super) fn resolve(folder: &Path, uri: &str) -> Result<PathBuf, Away> {
    let path = uri.split(['?', '#']).next().unwrap_or_default();
    if has_scheme(path) || path.starts_with("//") {
        return Err(Away::Remote);
    }
    let Ok(uri::Uri::Path(path)) = uri::decode(path) else {
        return Err(Away::Outside);
    };
    if path.starts_with(['/', '\\']) {
        return Err(Away::Outside);
    }
    // `b/c` and `../a` meet before they are judged: an external tileset may
    // well use files beside its own folder.
    let folder = folder.to_str().ok_or(Away::Outside)?;
    let joined = if folder.is_empty() {
        path
    } else {
        format!("{folder}/{path}")
    };
    relative_path(&joined).ok_or(Away::Outside)
}

fn has_scheme(uri: &str) -> bool {
    let Some((scheme, _)) = uri.split_once(':') else {
        return false;
    };
    let letter = |c: char| c.is_ascii_alphanumeric() || "+-.".contains(c);
    scheme.starts_with(|c: char| c.is_ascii_alphabetic()) && scheme.chars().all(letter)
}

/// A relative path below the tileset's folder; the folder that holds it.
pub(super) fn parent(path: &Path) -> PathBuf {
    path.parent().unwrap_or(Path::new("")).to_owned()
}

/// The file that `uri` names in the tileset file `tileset`.
///
/// # Errors
/// [`ErrorKind::UnsafePath`] if the URI leaves the folder of the tileset, is
/// absolute or has a scheme.
pub fn locate(tileset: impl AsRef<Path>, uri: &str) -> Result<PathBuf> {
    let tileset = tileset.as_ref();
    let below = resolve(Path::new(""), uri)
        .map_err(|_| Error::file(tileset, ErrorKind::UnsafePath(uri.to_owned())))?;
    Ok(parent(tileset).join(below))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_the_tileset() {
        let at = |folder: &str, uri| resolve(Path::new(folder), uri);
        assert_eq!(at("", "a%20b.glb?v=1#x").unwrap(), Path::new("a b.glb"));
        assert_eq!(at("sub", "../c/d.glb").unwrap(), Path::new("c/d.glb"));
        assert_eq!(at("sub", "./d.glb").unwrap(), Path::new("sub/d.glb"));
        for uri in [
            "../d.glb",
            "/d.glb",
            "%2e%2e/d",
            "a/../../d",
            "\\d",
            "",
            "%ff",
        ] {
            assert_eq!(at("", uri), Err(Away::Outside), "{uri}");
        }
        for uri in [
            "https://x/d.glb",
            "file:///d",
            "data:,x",
            "//host/d",
            "C:/d",
        ] {
            assert_eq!(at("", uri), Err(Away::Remote), "{uri}");
        }
        assert!(locate("a/tileset.json", "../b.glb").is_err());
        assert_eq!(
            locate("a/tileset.json", "b.glb").unwrap(),
            Path::new("a/b.glb")
        );
    }
}
