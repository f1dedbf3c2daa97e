//! Reading a file of any format.

use crate::{
    Format,
    error::{Error, ErrorKind, Result},
    gltf, obj, off, ply,
    source::{Source, inflated, load},
    stl,
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
    scene(format, &mut Source::of_file(path, &bytes))
}

/// Reads a model that lies in memory, not compressed. `name` is used in
/// messages only; files the model refers to are not looked for.
///
/// # Errors
/// As [`read`].
pub fn read_bytes(format: Format, bytes: &[u8], name: impl AsRef<Path>) -> Result<Loaded> {
    scene(format, &mut Source::in_memory(name.as_ref(), bytes))
}

/// Reads the bytes of a file that need not lie on this machine, e.g. one that was sent:
/// told apart and inflated by its name as [`read_with`] does. Files it refers to are not
/// looked for.
///
/// # Errors
/// As [`read`].
pub fn read_sent(name: impl AsRef<Path>, bytes: &[u8], options: &ReadOptions) -> Result<Loaded> {
    let name = name.as_ref();
    let bytes = inflated(name, bytes, options)?;
    let format = Format::detect(name, &bytes)?;
    scene(format, &mut Source::in_memory(name, &bytes))
}

/// Reads a model as one mesh whose polygons are kept (OBJ, PLY, OFF); the
/// other formats hold triangles only. Materials are left aside.
///
/// # Errors
/// As [`read`].
pub fn read_poly(path: impl AsRef<Path>) -> Result<PolyMesh> {
    let path = path.as_ref();
    let bytes = load(path, &ReadOptions::default())?;
    let format = Format::detect(path, &bytes)?;
    poly(format, &mut Source::of_file(path, &bytes))
}

/// [`read_poly`] of a model that lies in memory, not compressed.
///
/// # Errors
/// As [`read`].
pub fn read_poly_bytes(format: Format, bytes: &[u8], name: impl AsRef<Path>) -> Result<PolyMesh> {
    poly(format, &mut Source::in_memory(name.as_ref(), bytes))
}

fn scene(format: Format, source: &mut Source<'_>) -> Result<Loaded> {
    let name = source.name;
    let scene = scene_of(format, source).map_err(|e| e.in_file(name))?;
    let warnings = std::mem::take(&mut source.warnings).into_messages();
    Ok(Loaded { scene, warnings })
}

fn scene_of(format: Format, source: &mut Source<'_>) -> Result<Scene> {
    match format {
        Format::Obj => Ok(obj::read(source)?.into_scene()),
        Format::Ply => Ok(Scene::from_mesh(ply::read(source)?.triangulate())),
        Format::Off => Ok(Scene::from_mesh(off::read(source)?.triangulate())),
        Format::Stl => stl::read(source),
        Format::Gltf | Format::Glb => gltf::read(source),
    }
}

fn poly(format: Format, source: &mut Source<'_>) -> Result<PolyMesh> {
    let name = source.name;
    poly_of(format, source).map_err(|e| e.in_file(name))
}

pub(crate) fn poly_of(format: Format, source: &mut Source<'_>) -> Result<PolyMesh> {
    match format {
        Format::Obj => Ok(obj::read(source)?.mesh),
        Format::Ply => ply::read(source),
        Format::Off => off::read(source),
        Format::Stl | Format::Gltf | Format::Glb => {
            let whole = scene_of(format, source)?.into_single_mesh();
            Ok(whole.map_err(|e| Error::file("", e.into()))?.into())
        }
    }
}

/// Appends a face unless 32 bits cannot count the corners.
pub(crate) fn push_face(mesh: &mut PolyMesh, corners: &[u32]) -> Result<(), ErrorKind> {
    check_corners(mesh.indices.len() + corners.len())?;
    mesh.push_face(corners);
    Ok(())
}

pub(crate) fn check_corners(found: usize) -> Result<(), ErrorKind> {
    if found <= u32::MAX as usize {
        return Ok(());
    }
    Err(ErrorKind::TooLarge {
        what: "corners of faces",
        found: found as u64,
        limit: u64::from(u32::MAX),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use karui::mesh::shapes;

    #[test]
    fn what_is_sent_reads_like_the_file_it_was() {
        let folder = tempfile::tempdir().unwrap();
        let scene = Scene::from_mesh(shapes::torus(1.0, 0.3, 12, 6));
        for name in ["a.ply", "a.ply.gz", "a.obj.gz", "a.glb", "a.off", "a.stl"] {
            let path = folder.path().join(name);
            crate::write(&path, &scene).unwrap();
            let bytes = std::fs::read(&path).unwrap();
            let sent = read_sent(name, &bytes, &ReadOptions::default()).unwrap();
            let file = read(&path).unwrap();
            assert_eq!(sent.scene.meshes, file.meshes, "{name}");
            let named_wrong = read_sent("a.fbx", &bytes[..4], &ReadOptions::default());
            assert!(named_wrong.is_err());
        }
    }

    #[test]
    fn what_is_sent_has_no_companions() {
        let obj = b"mtllib /etc/passwd\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        let sent = read_sent("a.obj", obj, &ReadOptions::default()).unwrap();
        assert_eq!(sent.scene.triangle_count(), 1);
        let gltf = br#"{"asset":{"version":"2.0"},"buffers":[{"uri":"a.bin","byteLength":4}]}"#;
        let sent = read_sent("a.gltf", gltf, &ReadOptions::default());
        assert!(sent.is_err() || sent.is_ok_and(|s| s.scene.triangle_count() == 0));
    }
}
