//! Which format a file is in: by name, checked against the content.

use crate::error::{Error, ErrorKind, Result};
use std::{ffi::OsStr, fmt, path::Path};

/// Extensions that are understood, for messages.
pub(crate) const KNOWN: &str = ".obj, .ply, .stl, .off (each also with .gz), .gltf, .glb";

/// Bytes at the head of a file that are searched for the marks of a format.
const HEAD: usize = 4096;

/// A file format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Wavefront OBJ, with its MTL.
    Obj,
    /// Stanford PLY, ASCII or binary.
    Ply,
    /// Stereolithography STL, ASCII or binary.
    Stl,
    /// Object File Format (Geomview).
    Off,
    /// glTF 2.0, JSON with separate or embedded buffers.
    Gltf,
    /// glTF 2.0 in one binary file.
    Glb,
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Obj => "OBJ",
            Self::Ply => "PLY",
            Self::Stl => "STL",
            Self::Off => "OFF",
            Self::Gltf => "glTF",
            Self::Glb => "GLB",
        })
    }
}

impl Format {
    /// All formats.
    pub const ALL: [Self; 6] = [
        Self::Obj,
        Self::Ply,
        Self::Stl,
        Self::Off,
        Self::Gltf,
        Self::Glb,
    ];

    /// The format named by an extension without its dot, in any case.
    #[must_use]
    pub fn from_extension(extension: &str) -> Option<Self> {
        Some(match extension.to_ascii_lowercase().as_str() {
            "obj" => Self::Obj,
            "ply" => Self::Ply,
            "stl" => Self::Stl,
            "off" | "coff" | "noff" | "cnoff" => Self::Off,
            "gltf" => Self::Gltf,
            "glb" => Self::Glb,
            _ => return None,
        })
    }

    /// The format named by a path, a final `.gz` left aside.
    ///
    /// # Errors
    /// [`ErrorKind::UnknownFormat`] if the extension is missing or unknown.
    pub fn from_path(path: &Path) -> Result<Self> {
        let extension = extension_within_gz(path);
        let format = extension.as_deref().and_then(Self::from_extension);
        format.ok_or_else(|| unknown(path))
    }

    /// The format of a file by its name and content, which must agree where
    /// the content is unmistakable. OBJ has no marks, so it goes by the name.
    ///
    /// # Errors
    /// [`ErrorKind::UnknownFormat`] or [`ErrorKind::Mismatch`].
    pub fn detect(path: &Path, content: &[u8]) -> Result<Self> {
        match (Self::from_path(path), sniff(content)) {
            (Ok(name), Some(content)) if name != content => {
                Err(Error::file(path, ErrorKind::mismatch(name, content)))
            }
            (Ok(format), _) | (Err(_), Some(format)) => Ok(format),
            (Err(unknown), None) => Err(unknown),
        }
    }
}

/// Whether the name ends in `.gz`.
#[must_use]
pub(crate) fn is_gz(path: &Path) -> bool {
    path.extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("gz"))
}

fn extension_within_gz(path: &Path) -> Option<String> {
    let name = if is_gz(path) {
        Path::new(path.file_stem()?)
    } else {
        path
    };
    name.extension().and_then(OsStr::to_str).map(str::to_owned)
}

fn unknown(path: &Path) -> Error {
    let kind = ErrorKind::UnknownFormat {
        extension: extension_within_gz(path),
        known: KNOWN,
    };
    Error::file(path, kind)
}

/// The format by content alone, if that is unmistakable.
fn sniff(content: &[u8]) -> Option<Format> {
    let head = &content[..content.len().min(HEAD)];
    if head.starts_with(b"glTF") {
        return Some(Format::Glb);
    }
    if head.starts_with(b"ply\n") || head.starts_with(b"ply\r") {
        return Some(Format::Ply);
    }
    if is_binary_stl(content) || is_ascii_stl(head) {
        return Some(Format::Stl);
    }
    if crate::off::keyword(head).is_some() {
        return Some(Format::Off);
    }
    let is_json = head.trim_ascii_start().starts_with(b"{");
    (is_json && find(head, b"\"asset\"")).then_some(Format::Gltf)
}

/// Whether the size is exactly what the triangle count at byte 80 asks for.
/// In a text file that count is at least 0x09090909, so it cannot match by
/// chance below 7.5 GB.
pub(crate) fn is_binary_stl(content: &[u8]) -> bool {
    let Some(&[a, b, c, d]) = content.get(80..84) else {
        return false;
    };
    let count = u64::from(u32::from_le_bytes([a, b, c, d]));
    content.len() as u64 == 84 + 50 * count
}

fn is_ascii_stl(head: &[u8]) -> bool {
    head.trim_ascii_start().starts_with(b"solid") && find(head, b"facet")
}

fn find(haystack: &[u8], needle: &[u8]) -> bool {
    haystack.windows(needle.len()).any(|w| w == needle)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names() {
        let by_name = |name: &str| Format::from_path(Path::new(name)).ok();
        assert_eq!(by_name("a/b.OBJ"), Some(Format::Obj));
        assert_eq!(by_name("x.unitsmm.STL.gz"), Some(Format::Stl));
        assert_eq!(by_name("x.ply.GZ"), Some(Format::Ply));
        assert_eq!(by_name("gz"), None);
        assert_eq!(by_name(".gz"), None);
        assert_eq!(by_name("x.fbx"), None);
    }

    #[test]
    fn content_wins_only_where_the_name_is_silent() {
        let detect = |name: &str, content: &[u8]| Format::detect(Path::new(name), content);
        assert_eq!(detect("x", b"ply\nformat").ok(), Some(Format::Ply));
        assert_eq!(detect("x.dat", b"# c\nCOFF 1 2").ok(), Some(Format::Off));
        assert_eq!(detect("x.obj", b"v 0 0 0").ok(), Some(Format::Obj));
        let error = detect("x.obj", b"ply\nformat").unwrap_err();
        assert_eq!(
            error.to_string(),
            "x.obj: the name says OBJ, but the content is PLY"
        );
        let error = detect("x.fbx", b"Kaydara").unwrap_err();
        assert!(error.to_string().contains(".fbx"), "{error}");
        assert!(error.to_string().contains(".stl"), "{error}");
    }

    #[test]
    fn binary_stl_by_size() {
        let mut stl = vec![b'x'; 80];
        stl.extend(1u32.to_le_bytes());
        assert!(!is_binary_stl(&stl));
        stl.extend([0; 50]);
        assert_eq!(sniff(&stl), Some(Format::Stl));
    }
}
