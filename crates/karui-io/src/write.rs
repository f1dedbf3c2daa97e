//! Writing a scene in any format.

use crate::{
    Format, GltfOptions,
    atomic::{Sink, Transaction, Written},
    error::{Error, Result},
    format::is_gz,
    gltf, image,
    lost::lost,
    obj, off,
    ply::{self, PlyEncoding},
    stl,
};
use flate2::{Compression, write::GzEncoder};
use karui::{Scene, TriMesh, geom::DMat4};
use std::{borrow::Cow, io, path::Path};

/// How to write.
#[derive(Debug, Clone, Default)]
pub struct WriteOptions {
    /// Encoding of PLY. Default binary, little endian.
    pub ply: PlyEncoding,
    /// STL as text instead of binary. Default `false`.
    pub stl_ascii: bool,
    /// How glTF and GLB are written.
    pub gltf: GltfOptions,
}

/// Writes a scene in the format its name asks for; a final `.gz` compresses.
/// Files the model refers to (materials, textures, buffers) are written beside
/// it. Either every file is complete or none is there.
///
/// # Errors
/// [`UnknownFormat`](crate::ErrorKind::UnknownFormat) for an unknown extension,
/// [`Io`](crate::ErrorKind::Io) if the files cannot be written,
/// [`Geometry`](crate::ErrorKind::Geometry) if the scene is not valid.
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
    let scene = &*image::encoded(scene).map_err(|e| e.in_file(path))?;
    let mut files = Transaction::default();
    write_format(format, &mut files, path, scene, options).map_err(|e| e.in_file(path))?;
    let mut written = files.commit()?;
    written.lost = lost(format, scene);
    Ok(written)
}

/// A scene as the bytes of a GLB file, as [`write_with`] would write it.
///
/// # Errors
/// As [`write()`].
pub fn glb_bytes(scene: &Scene, options: &GltfOptions) -> Result<Vec<u8>> {
    let scene = image::encoded(scene)?;
    gltf::glb_bytes(&scene, options)
}

fn write_format(
    format: Format,
    files: &mut Transaction,
    path: &Path,
    scene: &Scene,
    options: &WriteOptions,
) -> Result<()> {
    match format {
        Format::Obj => obj::write(files, path, scene),
        Format::Ply => {
            let mesh = single_mesh(scene)?;
            write_file(files, path, |sink| ply::write(sink, &mesh, options.ply))
        }
        Format::Stl => {
            let mesh = single_mesh(scene)?;
            write_file(files, path, |sink| {
                stl::write(sink, &mesh, options.stl_ascii)
            })
        }
        Format::Off => {
            let mesh = single_mesh(scene)?;
            write_file(files, path, |sink| off::write(sink, &mesh))
        }
        Format::Gltf | Format::Glb => gltf::write(files, path, scene, &options.gltf, format),
    }
}

/// All instances in one mesh, checked, without copying if the scene is just
/// one mesh in place.
fn single_mesh(scene: &Scene) -> Result<Cow<'_, TriMesh>> {
    let fail = |error: karui::Error| Error::file("", error.into());
    let mut instances = scene.iter_instances();
    let first = [instances.next(), instances.next()];
    let mesh = match (&scene.meshes[..], first) {
        ([mesh], [Some(only), None]) if only.world_from_mesh == DMat4::IDENTITY => {
            Cow::Borrowed(&mesh.mesh)
        }
        _ => Cow::Owned(scene.clone().into_single_mesh().map_err(fail)?),
    };
    mesh.validate().map_err(fail)?;
    Ok(mesh)
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

#[cfg(test)]
mod tests {
    use super::*;
    use karui::mesh::shapes;

    #[test]
    fn a_glb_in_memory_is_the_glb_on_disk() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.glb");
        let mut scene = Scene::from_mesh(shapes::torus(1.0, 0.3, 12, 6));
        write(&path, &scene).unwrap();
        let bytes = glb_bytes(&scene, &GltfOptions::default()).unwrap();
        assert_eq!(bytes, std::fs::read(&path).unwrap());
        scene.meshes[0].mesh.triangles[0] = [0, 1, 1_000_000];
        assert!(glb_bytes(&scene, &GltfOptions::default()).is_err());
    }
}
