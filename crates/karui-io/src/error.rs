//! What can go wrong with a file, and where in the file it did.

use crate::Format;
use std::{fmt, io, path::PathBuf};

/// What a gzip stream that grows too much has too much of.
pub(crate) const INFLATED_SIZE: &str = "inflated size in bytes";
/// What an image that is too wide or too high has too much of.
pub(crate) const IMAGE_SIDE: &str = "longer side of an image in pixels";

/// A problem with one file: which file, which place in it, what is wrong.
///
/// Reads like `bunny.ply: line 12: expected 3 numbers, found 2`.
#[derive(Debug)]
pub struct Error {
    /// The file, as it was named by the caller.
    pub path: PathBuf,
    /// Where in the file.
    pub place: Place,
    /// What is wrong there.
    pub kind: Box<ErrorKind>,
}

/// Shorthand for results of this crate.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// A place in a file.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Place {
    /// The file as a whole.
    #[default]
    File,
    /// A line of a text file, the first being 1.
    Line(u64),
    /// An offset into a binary file (after inflating, if it was compressed).
    Byte(u64),
    /// A JSON pointer (RFC 6901) into a glTF document.
    Pointer(String),
}

/// What is wrong.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ErrorKind {
    /// The operating system refused.
    #[error("{}", io_message(.0))]
    Io(#[source] io::Error),
    /// Neither the name nor the content tells the format.
    #[error("unknown format{}; known are {known}", extension_message(.extension))]
    UnknownFormat {
        /// The extension, if the name has one.
        extension: Option<String>,
        /// Extensions that would have been understood.
        known: &'static str,
    },
    /// The content is certainly not what the name promises.
    #[error("the name says {name}, but the content is {content}")]
    Mismatch {
        /// Format by name, e.g. `OBJ` or `gzip`.
        name: String,
        /// Format by content.
        content: String,
    },
    /// A valid use of the format that Karui does not read or write.
    #[error("{0} is not supported")]
    Unsupported(String),
    /// The file breaks the rules of its format.
    #[error("expected {expected}, found {found}")]
    Syntax {
        /// What the format asks for.
        expected: String,
        /// What is there.
        found: String,
    },
    /// An index names an element that does not exist.
    #[error("{what} index {index} is out of range; there are {count}")]
    IndexOutOfRange {
        /// Kind of element, e.g. `vertex`.
        what: &'static str,
        /// The index as written in the file.
        index: i64,
        /// Number of elements it could have named.
        count: usize,
    },
    /// A coordinate or attribute is NaN or infinite.
    #[error("{what} is not finite (NaN or infinite, or too large for 32 bits)")]
    NotFinite {
        /// What the number stands for, e.g. `vertex coordinate`.
        what: &'static str,
    },
    /// The file ends early.
    #[error("the file ends early: expected {expected}, found {found}")]
    Truncated {
        /// What should have followed.
        expected: String,
        /// What is left.
        found: String,
    },
    /// A size is beyond what can be handled.
    #[error("{what}: {found} is more than the limit of {limit}")]
    TooLarge {
        /// What is too large.
        what: &'static str,
        /// The size found (or the least it must be).
        found: u64,
        /// The largest size accepted.
        limit: u64,
    },
    /// A reference to another file leaves the folder of the model.
    #[error("`{0}` leaves the folder of the model")]
    UnsafePath(String),
    /// The geometry itself is not acceptable.
    #[error(transparent)]
    Geometry(#[from] karui::Error),
    /// Blocks of a model larger than memory are not as they should be.
    #[error(transparent)]
    Blocks(#[from] karui::outofcore::Error),
}

fn io_message(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::NotFound => "no such file or folder".into(),
        io::ErrorKind::PermissionDenied => "permission denied".into(),
        io::ErrorKind::StorageFull => "no space left on the device".into(),
        io::ErrorKind::IsADirectory => "is a folder, not a file".into(),
        _ => error.to_string(),
    }
}

fn extension_message(extension: &Option<String>) -> String {
    extension
        .as_ref()
        .map_or_else(String::new, |e| format!(" `.{e}`"))
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File => Ok(()),
            Self::Line(line) => write!(f, "line {line}"),
            Self::Byte(byte) => write!(f, "byte {byte}"),
            Self::Pointer(pointer) => f.write_str(pointer),
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.path.as_os_str().is_empty() {
            write!(f, "{}: ", self.path.display())?;
        }
        if self.place != Place::File {
            write!(f, "{}: ", self.place)?;
        }
        self.kind.fmt(f)
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match &*self.kind {
            ErrorKind::Io(error) => Some(error),
            ErrorKind::Geometry(error) => Some(error),
            _ => None,
        }
    }
}

impl Error {
    /// A problem at `place` of a file that the caller will name with
    /// [`Error::in_file`].
    #[must_use]
    pub fn new(place: Place, kind: ErrorKind) -> Self {
        Self {
            path: PathBuf::new(),
            place,
            kind: Box::new(kind),
        }
    }

    /// A problem with the file as a whole.
    #[must_use]
    pub fn file(path: impl Into<PathBuf>, kind: ErrorKind) -> Self {
        Self::new(Place::File, kind).in_file(path)
    }

    /// Names the file, unless the error already names one.
    #[must_use]
    pub fn in_file(mut self, path: impl Into<PathBuf>) -> Self {
        if self.path.as_os_str().is_empty() {
            self.path = path.into();
        }
        self
    }

    /// What the user could do about it.
    #[must_use]
    pub fn hint(&self) -> Option<&str> {
        Some(match &*self.kind {
            ErrorKind::Io(error) => return io_hint(error),
            ErrorKind::UnknownFormat { .. } => {
                "give the file an extension of its format, or convert it first"
            }
            ErrorKind::Mismatch { .. } => "rename the file to match its content",
            ErrorKind::Truncated { .. } => {
                "the file is incomplete; copy, download or export it again"
            }
            ErrorKind::NotFinite { .. } => {
                "the model holds NaN or infinite numbers; clean it where it was made"
            }
            ErrorKind::UnsafePath(_) => {
                "place the file beside the model and name it by a relative path"
            }
            ErrorKind::TooLarge { what, .. } if *what == INFLATED_SIZE => {
                "this looks like a decompression bomb; if you trust it, unpack it first"
            }
            ErrorKind::TooLarge { what, .. } if *what == IMAGE_SIDE => "make the image smaller",
            ErrorKind::TooLarge { .. } => "split the model into parts",
            _ => return None,
        })
    }
}

fn io_hint(error: &io::Error) -> Option<&'static str> {
    Some(match error.kind() {
        io::ErrorKind::NotFound => "check the spelling of the path",
        io::ErrorKind::PermissionDenied => "check who may read or write there",
        io::ErrorKind::StorageFull => "free some space; nothing was written",
        _ => return None,
    })
}

impl ErrorKind {
    /// `expected` and `found` of a rule of the format that is broken.
    pub(crate) fn syntax(expected: impl Into<String>, found: impl Into<String>) -> Self {
        Self::Syntax {
            expected: expected.into(),
            found: found.into(),
        }
    }

    /// The file ends before `expected`.
    pub(crate) fn truncated(expected: impl Into<String>, found: impl Into<String>) -> Self {
        Self::Truncated {
            expected: expected.into(),
            found: found.into(),
        }
    }

    /// A feature that Karui does not have.
    pub(crate) fn unsupported(feature: impl Into<String>) -> Self {
        Self::Unsupported(feature.into())
    }

    /// The content is of another format than the name says.
    pub(crate) fn mismatch(name: Format, content: Format) -> Self {
        Self::Mismatch {
            name: name.to_string(),
            content: content.to_string(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_like_a_compiler_message() {
        let kind = ErrorKind::syntax("3 numbers", "2");
        let error = Error::new(Place::Line(12), kind).in_file("bunny.ply");
        assert_eq!(
            error.to_string(),
            "bunny.ply: line 12: expected 3 numbers, found 2"
        );
        assert_eq!(error.in_file("other.ply").path.to_str(), Some("bunny.ply"));
    }

    #[test]
    fn io_errors_have_hints() {
        let error = |kind: io::ErrorKind| Error::file("a.obj", ErrorKind::Io(kind.into()));
        let missing = error(io::ErrorKind::NotFound);
        assert_eq!(missing.to_string(), "a.obj: no such file or folder");
        assert!(missing.hint().is_some());
        assert!(error(io::ErrorKind::StorageFull).hint().is_some());
        assert!(error(io::ErrorKind::TimedOut).hint().is_none());
    }
}
