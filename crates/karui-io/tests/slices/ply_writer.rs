//! PLY written in slices.

use crate::{common, triangles, vertices};
use karui::{
    TriMesh,
    geom::Vec3,
    mesh::{Attributes, shapes},
    outofcore::{Memory, Vertices},
};
use karui_io::slices::PlyWriter;
use proptest::prelude::*;
use std::{fs, path::Path};

/// Writes a mesh in pieces.
fn write(path: &Path, mesh: &TriMesh, step: u64) -> karui_io::Result<u64> {
    let mut writer = PlyWriter::create(path)?;
    let source = Memory(mesh);
    for slice in vertices(&source, step).unwrap() {
        writer.write_vertices(slice)?;
    }
    for piece in triangles(&source).unwrap().chunks(step as usize) {
        writer.write_triangles(piece)?;
    }
    writer.finish()
}

/// The mesh with colours as bytes hold them.
fn rounded(mut mesh: TriMesh) -> TriMesh {
    for color in mesh.attributes.colors.iter_mut().flatten() {
        *color = (*color * 255.0)
            .round()
            .clamp(karui::geom::Vec4::ZERO, karui::geom::Vec4::splat(255.0))
            / 255.0;
    }
    mesh.attributes.skins.clear();
    mesh.attributes.morphs.clear();
    mesh.face_attributes.clear();
    mesh.ranges.clear();
    mesh
}

#[test]
fn real_models_read_back_as_they_were() {
    let Some(models) = common::models() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ply");
    for name in [
        "scans/armadillo.off.gz",
        "scans/bun_zipper.ply.gz",
        "gltf/Fox.glb",
        "gltf/pirate.glb",
        "hard/sponza.obj.gz",
    ] {
        let mesh = karui_io::read(models.join(name))
            .unwrap()
            .into_single_mesh()
            .unwrap();
        let bytes = write(&path, &mesh, 10_007).unwrap();
        assert_eq!(bytes, fs::metadata(&path).unwrap().len());
        let back = karui_io::read(&path).unwrap().into_single_mesh().unwrap();
        let wanted = rounded(mesh);
        assert!(back.positions == wanted.positions, "{name}");
        assert!(back.triangles == wanted.triangles, "{name}");
        assert!(back.attributes == wanted.attributes, "{name}");
    }
}

proptest! {
    #[test]
    fn pieces_of_any_size_give_the_same_bytes(step in 1u64..100) {
        let folder = tempfile::tempdir().unwrap();
        let paths = ["a.ply", "b.ply"].map(|name| folder.path().join(name));
        let mesh = shapes::textured_sphere(6, 9);
        write(&paths[0], &mesh, 1_000_000).unwrap();
        write(&paths[1], &mesh, step).unwrap();
        let [a, b] = paths.map(|path| fs::read(path).unwrap());
        prop_assert!(a == b);
    }
}

#[test]
fn nothing_is_left_unless_it_is_finished() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ply");
    let left = || fs::read_dir(folder.path()).unwrap().count();
    let mut writer = PlyWriter::create(&path).unwrap();
    let positions = vec![Vec3::ZERO; 3];
    let attributes = Attributes::default();
    writer
        .write_vertices(Vertices {
            positions,
            attributes,
        })
        .unwrap();
    assert_eq!((left(), path.exists()), (1, false));
    drop(writer);
    assert_eq!(left(), 0);
    let empty = PlyWriter::create(&path).unwrap().finish().unwrap();
    assert_eq!((left(), fs::read(&path).unwrap().len() as u64), (1, empty));
    let source = karui_io::slices::open(&path).unwrap();
    assert_eq!((source.vertices(), source.chunks()), (0, 0));
    let error = PlyWriter::create(folder.path().join("none/a.ply"))
        .err()
        .unwrap();
    assert!(error.to_string().contains("no such file or folder"));
}

#[test]
fn what_does_not_fit_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ply");
    let positions = |x: f32| vec![Vec3::splat(x); 3];
    let plain = |x: f32| Vertices {
        positions: positions(x),
        attributes: Attributes::default(),
    };
    let mut writer = PlyWriter::create(&path).unwrap();
    writer.write_vertices(plain(0.0)).unwrap();
    let error = |result: karui_io::Result<()>| result.unwrap_err().to_string();
    assert!(error(writer.write_vertices(plain(f32::NAN))).contains("not finite"));
    let mut other = plain(0.0);
    other.attributes.normals = Some(positions(1.0));
    assert!(error(writer.write_vertices(other.clone())).contains("other attributes"));
    other.attributes.normals = Some(vec![Vec3::X]);
    let short = error(writer.write_vertices(other));
    assert!(short.contains("normals"), "{short}");
    let bad = error(writer.write_triangles(&[[0, 1, 3]]));
    assert!(
        bad.contains("index 3 is out of range; there are 3"),
        "{bad}"
    );
    assert!(error(writer.write_triangles(&[[0, u64::MAX, 1]])).contains("out of range"));
    writer.write_triangles(&[[0, 1, 2]]).unwrap();
    assert!(error(writer.write_vertices(plain(0.0))).contains("after triangles"));
}
