//! The bytes of a file and of the files it refers to.

use crate::{
    ReadOptions, Warnings,
    error::{Error, ErrorKind, INFLATED_SIZE, Result},
    format::is_gz,
};
use flate2::bufread::MultiGzDecoder;
use std::{
    borrow::Cow,
    fs,
    io::{self, Read},
    path::{Component, Path, PathBuf},
};

/// Inflated size that is accepted whatever the compressed size, bytes.
const INFLATED_BASE: u64 = 64 << 20;
/// Inflated size that is never exceeded, bytes.
const INFLATED_LIMIT: u64 = 16 << 30;

/// What a reader is given: one file in memory and where its companions lie.
pub(crate) struct Source<'a> {
    /// Name for messages.
    pub name: &'a Path,
    /// The content, inflated.
    pub bytes: &'a [u8],
    /// The folder companions (materials, textures, buffers) are read from;
    /// `None` if the model lies in memory only.
    pub folder: Option<&'a Path>,
    /// Where the reader tells what it had to pass over.
    pub warnings: Warnings,
}

impl<'a> Source<'a> {
    /// A file whose companions lie beside it.
    pub fn of_file(path: &'a Path, bytes: &'a [u8]) -> Self {
        Self {
            folder: path.parent(),
            ..Self::in_memory(path, bytes)
        }
    }

    /// A model without companions; `name` is for messages.
    pub fn in_memory(name: &'a Path, bytes: &'a [u8]) -> Self {
        Self {
            name,
            bytes,
            folder: None,
            warnings: Warnings::default(),
        }
    }
}

/// Reads a file, inflating it if its name ends in `.gz`.
pub(crate) fn load(path: &Path, options: &ReadOptions) -> Result<Vec<u8>> {
    let raw = load_raw(path).map_err(|e| Error::file(path, ErrorKind::Io(e)))?;
    let inflated = match inflated(path, &raw, options)? {
        Cow::Owned(bytes) => Some(bytes),
        Cow::Borrowed(_) => None,
    };
    Ok(inflated.unwrap_or(raw))
}

/// What is in a file whose bytes are `raw`, inflated if its name ends in `.gz`.
pub(crate) fn inflated<'a>(
    path: &Path,
    raw: &'a [u8],
    options: &ReadOptions,
) -> Result<Cow<'a, [u8]>> {
    let compressed = raw.starts_with(&[0x1f, 0x8b]);
    match (is_gz(path), compressed) {
        (true, true) => {
            let bytes = inflate(raw, options.max_inflation).map_err(|e| e.in_file(path))?;
            Ok(Cow::Owned(bytes))
        }
        (false, false) => Ok(Cow::Borrowed(raw)),
        (true, false) if raw.is_empty() => Err(Error::file(
            path,
            ErrorKind::truncated("a gzip stream", "an empty file"),
        )),
        (named, _) => {
            let [yes, no] = ["a gzip stream", "not a gzip stream"].map(String::from);
            let (name, content) = if named { (yes, no) } else { (no, yes) };
            Err(Error::file(path, ErrorKind::Mismatch { name, content }))
        }
    }
}

/// Reads a regular file; a device or pipe might never end.
fn load_raw(path: &Path) -> io::Result<Vec<u8>> {
    let found = fs::metadata(path)?;
    if found.is_dir() {
        return Err(io::ErrorKind::IsADirectory.into());
    }
    if !found.is_file() {
        return Err(io::Error::other("is not a regular file"));
    }
    fs::read(path)
}

/// Inflates a gzip stream of one or several members. Memory grows with what
/// is really inflated; a stream that grows more than `ratio` times (beyond a
/// base of 64 MiB) is refused.
fn inflate(raw: &[u8], ratio: u64) -> Result<Vec<u8>> {
    let limit = (raw.len() as u64)
        .saturating_mul(ratio)
        .clamp(INFLATED_BASE, INFLATED_LIMIT);
    let mut bytes = Vec::new();
    let mut stream = MultiGzDecoder::new(raw).take(limit + 1);
    stream.read_to_end(&mut bytes).map_err(|e| gzip_error(&e))?;
    if bytes.len() as u64 > limit {
        return Err(Error::file(
            "",
            ErrorKind::TooLarge {
                what: INFLATED_SIZE,
                found: bytes.len() as u64,
                limit,
            },
        ));
    }
    Ok(bytes)
}

fn gzip_error(error: &io::Error) -> Error {
    let kind = match error.kind() {
        io::ErrorKind::UnexpectedEof => ErrorKind::truncated("the rest of the gzip stream", "none"),
        _ => ErrorKind::syntax("a valid gzip stream", error.to_string()),
    };
    Error::file("", kind)
}

impl Source<'_> {
    /// Reads the companion file `uri` (a relative path with `/` or `\`).
    /// `None` if it does not exist or the model lies in memory only.
    ///
    /// # Errors
    /// [`ErrorKind::UnsafePath`] if it lies outside the model's folder, even
    /// if it exists; [`ErrorKind::Io`] if it cannot be read.
    pub fn companion(&self, uri: &str) -> Result<Option<Vec<u8>>> {
        let relative = relative_path(uri)
            .ok_or_else(|| Error::file(self.name, ErrorKind::UnsafePath(uri.to_owned())))?;
        let Some(folder) = self.folder else {
            return Ok(None);
        };
        let path = folder.join(relative);
        match load_raw(&path) {
            Ok(bytes) => Ok(Some(bytes)),
            Err(e) if e.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(e) => Err(Error::file(path, ErrorKind::Io(e))),
        }
    }
}

/// `uri` as a path below the model's folder, or `None` if it is absolute, has
/// a scheme or drive, or climbs out with `..`.
pub(crate) fn relative_path(uri: &str) -> Option<PathBuf> {
    let uri = uri.replace('\\', "/");
    if uri.contains(':') || uri.contains('\0') {
        return None;
    }
    let mut path = PathBuf::new();
    for part in Path::new(&uri).components() {
        match part {
            Component::Normal(name) => path.push(name),
            Component::CurDir => {}
            Component::ParentDir if path.pop() => {}
            _ => return None,
        }
    }
    (!path.as_os_str().is_empty()).then_some(path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::{Compression, write::GzEncoder};
    use std::io::Write;

    fn gz(content: &[u8]) -> Vec<u8> {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(content).unwrap();
        encoder.finish().unwrap()
    }

    #[test]
    fn inflates_members_one_after_the_other() {
        let two = [gz(b"one "), gz(b"two")].concat();
        assert_eq!(inflate(&two, 64).unwrap(), b"one two");
        let error = inflate(&two[..10], 64).unwrap_err();
        assert!(matches!(*error.kind, ErrorKind::Truncated { .. }));
    }

    #[test]
    fn bombs_are_refused() {
        let bomb = gz(&vec![0; 70 << 20]);
        assert!(bomb.len() < 80_000);
        let error = inflate(&bomb, 64).unwrap_err();
        assert!(matches!(*error.kind, ErrorKind::TooLarge { .. }));
        assert!(error.hint().is_some_and(|h| h.contains("bomb")));
        assert_eq!(inflate(&bomb, 2000).unwrap().len(), 70 << 20);
    }

    #[test]
    fn paths_stay_below_the_folder() {
        let safe = |uri| relative_path(uri).map(|p| p.to_str().unwrap().to_owned());
        assert_eq!(safe("a/b.png").as_deref(), Some("a/b.png"));
        assert_eq!(safe("tex\\b.png").as_deref(), Some("tex/b.png"));
        assert_eq!(safe("./a/../b.png").as_deref(), Some("b.png"));
        for uri in [
            "../b",
            "a/../../b",
            "/etc/passwd",
            "C:\\b",
            "http://b",
            "\\\\srv\\b",
            "",
        ] {
            assert_eq!(safe(uri), None, "{uri}");
        }
    }
}
