//! Models read in slices, for those that do not fit into memory.
//!
//! A source keeps the file open and at most a sparse list of offsets, about 24 bytes for
//! every 65,536 faces; a slice is read when it is asked for. Counts in headers are checked
//! against the length of the file when it is opened, indices when they are read.
//!
//! | | what a vertex is | carried besides positions |
//! |-|-|-|
//! | PLY | as in the file | all but lists |
//! | OBJ | a position | colours |
//! | glTF, GLB | as in the file, for each place where its mesh stands | texture coordinates, colours; normals and tangents if all have them |
//! | STL, binary | corner c of facet f is 3 f + c | |
//! | raw | as in the file | |

mod cut;
pub(crate) mod file;
mod obj;
mod ply;
mod ply_writer;
pub mod raw;
mod stl;

use crate::{
    Format,
    error::{Error, ErrorKind, Result},
    format::is_gz,
    gltf,
    warnings::Warnings,
};
use file::FileAt;
use karui::outofcore::{self, Source};
use std::path::Path;

pub use ply_writer::PlyWriter;

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
    if head.starts_with(raw::MAGIC) {
        return Ok(Box::new(raw::open(file)?));
    }
    Ok(match detect(&file, &head)? {
        Format::Stl => Box::new(stl::open(file, &head, warnings)?),
        Format::Ply => Box::new(ply::open(file, warnings)?),
        Format::Obj => Box::new(obj::open(file, warnings)?),
        Format::Gltf | Format::Glb => Box::new(gltf::slices::open(file, warnings)?),
        Format::Off => {
            let feature = "OFF in slices (`karui convert` writes it as binary PLY)";
            return Err(Error::file("", ErrorKind::unsupported(feature)));
        }
    })
}

/// By name and head; a binary STL without a name by its length.
fn detect(file: &FileAt, head: &[u8]) -> Result<Format> {
    match Format::detect(&file.path, head) {
        Err(error)
            if matches!(*error.kind, ErrorKind::UnknownFormat { .. })
                && stl::is_binary(head, file.len) =>
        {
            Ok(Format::Stl)
        }
        found => found,
    }
}

/// An error of this crate as one of a source.
pub(crate) fn failed(error: Error, file: &FileAt) -> outofcore::Error {
    outofcore::Error::Source(Box::new(error.in_file(&file.path)))
}
