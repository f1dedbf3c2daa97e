//! Reading a file of any format.

use crate::{
    Format, Warnings,
    error::{ErrorKind, Result},
    source::{Source, load},
};
use karui::{PolyMesh, Scene};
use std::path::Path;

/// How to read.
#[derive(Debug, Clone)]
pub struct ReadOptions {
    /// How many times larger than the `.gz` file its content may be; beyond a
    /// base of 64 MiB more is refused as a decompression bomb. Meshes reach
    /// about 20. Default 64.
    pub max_inflation: u64,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self { max_inflation: 64 }
    }
}

/// What was read.
#[derive(Debug, Clone)]
pub struct Loaded {
    /// The content.
    pub scene: Scene,
    /// What was passed over: missing textures, unknown elements and the like.
    pub warnings: Vec<String>,
}

/// Reads a model of any format. Polygons are triangulated.
///
/// The format goes by the extension and must agree with the content; a file
/// without a known extension is recognised by its content.
///
/// # Errors
/// [`Error`](crate::Error) with the file, the place in it and what is wrong.
pub fn read(path: impl AsRef<Path>) -> Result<Scene> {
    Ok(read_with(path, &ReadOptions::default())?.scene)
}

/// [`read`] with options, telling also what was passed over.
///
/// # Errors
/// As [`read`].
pub fn read_with(path: impl AsRef<Path>, options: &ReadOptions) -> Result<Loaded> {
    let path = path.as_ref();
    let bytes = load(path, options)?;
    let format = Format::detect(path, &bytes)?;
    let mut source = Source {
        name: path,
        bytes: &bytes,
        folder: path.parent(),
        options,
        warnings: Warnings::default(),
    };
    scene(format, &mut source)
}

/// Reads a model that lies in memory, not compressed. `name` is used in
/// messages only; files the model refers to are not looked for.
///
/// # Errors
/// As [`read`].
pub fn read_bytes(format: Format, bytes: &[u8], name: impl AsRef<Path>) -> Result<Loaded> {
    let mut source = Source {
        name: name.as_ref(),
        bytes,
        folder: None,
        options: &ReadOptions::default(),
        warnings: Warnings::default(),
    };
    scene(format, &mut source)
}

/// Reads a model as one mesh whose polygons are kept (OBJ, PLY, OFF); the
/// other formats hold triangles only. Materials are left aside.
///
/// # Errors
/// As [`read`].
pub fn read_poly(path: impl AsRef<Path>) -> Result<PolyMesh> {
    let path = path.as_ref();
    let options = &ReadOptions::default();
    let bytes = load(path, options)?;
    let format = Format::detect(path, &bytes)?;
    let mut source = Source {
        name: path,
        bytes: &bytes,
        folder: path.parent(),
        options,
        warnings: Warnings::default(),
    };
    poly(format, &mut source)
}

/// [`read_poly`] of a model that lies in memory, not compressed.
///
/// # Errors
/// As [`read`].
pub fn read_poly_bytes(format: Format, bytes: &[u8], name: impl AsRef<Path>) -> Result<PolyMesh> {
    let mut source = Source {
        name: name.as_ref(),
        bytes,
        folder: None,
        options: &ReadOptions::default(),
        warnings: Warnings::default(),
    };
    poly(format, &mut source)
}

fn scene(format: Format, source: &mut Source<'_>) -> Result<Loaded> {
    let name = source.name;
    let scene = scene_of(format, source).map_err(|e| e.in_file(name))?;
    let warnings = std::mem::take(&mut source.warnings).into_messages();
    Ok(Loaded { scene, warnings })
}

fn scene_of(format: Format, source: &mut Source<'_>) -> Result<Scene> {
    match format {
        Format::Obj | Format::Ply | Format::Stl | Format::Off => unsupported("reading", format),
        Format::Gltf | Format::Glb => crate::gltf::read(source),
    }
}

fn poly(format: Format, source: &mut Source<'_>) -> Result<PolyMesh> {
    let name = source.name;
    let mesh: Result<PolyMesh> = unsupported("reading", format);
    mesh.map_err(|e| e.in_file(name))
}

pub(crate) fn unsupported<T>(doing: &str, format: Format) -> Result<T> {
    let kind = ErrorKind::unsupported(format!("{doing} {format}"));
    Err(crate::Error::file("", kind))
}
