//! Models read in slices, for those that do not fit into memory.
//!
//! A source keeps the file open and at most a sparse list of offsets, about 24 bytes for
//! every 65,536 faces; a slice is read when it is asked for. Counts in headers are checked
//! against the length of the file when it is opened, indices when they are read.
//!
//! | | what a vertex is | carried besides positions |
//! |-|-|-|
//! | PLY | as in the file | all but lists |

mod file;
mod ply;

use crate::{
    Format,
    error::{Error, ErrorKind, Result},
    format::is_gz,
    warnings::Warnings,
};
use file::FileAt;
use karui::outofcore::{self, Source};
use std::path::Path;

/// Bytes at the head of a file that tell its format.
const HEAD: u64 = 4096;

/// A model that is open.
pub struct Opened {
    /// The model.
    pub source: Box<dyn Source + Send>,
    /// What is passed over: unknown elements and the like.
    pub warnings: Vec<String>,
}

/// Opens a model to be read in slices.
///
/// # Errors
/// [`Error`] with the file, the place in it and what is wrong. Gzipped files are refused:
/// they can be read from the start only.
pub fn open(path: impl AsRef<Path>) -> Result<Box<dyn Source + Send>> {
    Ok(open_with(path)?.source)
}

/// [`open`], telling also what is passed over.
///
/// # Errors
/// As [`open`].
pub fn open_with(path: impl AsRef<Path>) -> Result<Opened> {
    let path = path.as_ref();
    let file = FileAt::open(path)?;
    let mut warnings = Warnings::default();
    let source = opened(file, &mut warnings).map_err(|e| e.in_file(path))?;
    Ok(Opened {
        source,
        warnings: warnings.into_messages(),
    })
}

fn opened(file: FileAt, warnings: &mut Warnings) -> Result<Box<dyn Source + Send>> {
    let head = file.read(0, file.len.min(HEAD))?;
    if is_gz(&file.path) || head.starts_with(&[0x1f, 0x8b]) {
        let feature = "reading a gzipped file in slices (unpack it first, with `gzip -d`)";
        return Err(Error::file("", ErrorKind::unsupported(feature)));
    }
    Ok(match Format::detect(&file.path, &head)? {
        Format::Ply => Box::new(ply::open(file, warnings)?),
        other => {
            let feature = format!("reading {other} in slices");
            return Err(Error::file("", ErrorKind::unsupported(feature)));
        }
    })
}

/// An error of this crate as one of a source.
fn failed(error: Error, file: &FileAt) -> outofcore::Error {
    outofcore::Error::Source(Box::new(error.in_file(&file.path)))
}
