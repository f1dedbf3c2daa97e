//! Models read in slices against the same models read whole.
#![allow(clippy::unwrap_used, reason = "it is a test")]
#![allow(clippy::print_stdout, reason = "a test that is skipped says so")]

#[path = "../common/mod.rs"]
mod common;
mod gltf;
mod obj;
mod ply;
mod ply_writer;
mod raw;
mod stl;

use flate2::read::MultiGzDecoder;
use karui::{
    TriMesh,
    outofcore::{Source, Vertices},
};
use std::{
    fs::{self, File},
    io,
    path::{Path, PathBuf},
};

/// The mesh read whole.
fn whole(path: &Path) -> TriMesh {
    karui_io::read(path).unwrap().into_single_mesh().unwrap()
}

/// All vertices, read in pieces of a size that nothing divides by.
fn vertices(source: &dyn Source, step: u64) -> Result<Vec<Vertices>, String> {
    let count = source.vertices();
    let starts = (0..count.max(1)).step_by(step as usize);
    starts
        .map(|s| source.read_vertices(s..(s + step).min(count)))
        .collect::<Result<_, _>>()
        .map_err(|e| e.to_string())
}

/// All triangles, the last portion first.
fn triangles(source: &dyn Source) -> Result<Vec<[u64; 3]>, String> {
    let portions: Result<Vec<_>, _> = (0..source.chunks())
        .rev()
        .map(|c| source.read_triangles(c))
        .collect();
    let mut portions = portions.map_err(|e| e.to_string())?;
    portions.reverse();
    Ok(portions.concat())
}

/// Whether the slices, one after the other, are the mesh.
fn assert_same(source: &dyn Source, whole: &TriMesh, step: u64, name: &str) {
    assert_eq!(source.vertices(), whole.positions.len() as u64, "{name}");
    let mut start = 0;
    for slice in vertices(source, step).unwrap() {
        let end = start + slice.positions.len();
        assert!(
            slice.positions == whole.positions[start..end],
            "{name} {start}"
        );
        let ids: Vec<u32> = (start as u32..end as u32).collect();
        let mut attributes = whole.attributes.clone();
        attributes.gather(&ids);
        assert!(slice.attributes == attributes, "{name}: {start}");
        start = end;
    }
    assert_eq!(start, whole.positions.len(), "{name}");
    let expected: Vec<_> = whole.triangles.iter().map(|t| t.map(u64::from)).collect();
    assert!(triangles(source).unwrap() == expected, "{name}");
}

/// The model as a file that is not compressed.
fn unpacked(model: &Path, folder: &Path) -> PathBuf {
    if model.extension().is_none_or(|e| e != "gz") {
        return model.to_path_buf();
    }
    let target = folder.join(model.file_stem().unwrap());
    let mut packed = MultiGzDecoder::new(File::open(model).unwrap());
    io::copy(&mut packed, &mut File::create(&target).unwrap()).unwrap();
    target
}

/// The model's corners, triangle by triangle: what is left if vertices are joined otherwise.
fn corners(source: &dyn Source) -> Vec<[[u32; 3]; 3]> {
    let positions: Vec<_> = vertices(source, 77_777).unwrap();
    let positions: Vec<_> = positions.into_iter().flat_map(|v| v.positions).collect();
    let place = |v: u64| positions[v as usize].to_array().map(f32::to_bits);
    triangles(source)
        .unwrap()
        .into_iter()
        .map(|t| t.map(place))
        .collect()
}

/// The corners of a mesh read whole.
fn corners_of(mesh: &TriMesh) -> Vec<[[u32; 3]; 3]> {
    let place = |v: u32| mesh.positions[v as usize].to_array().map(f32::to_bits);
    mesh.triangles.iter().map(|t| t.map(place)).collect()
}

/// Reads a small file cut off after every byte, and with every byte changed: nothing
/// panics, and what is refused is refused by name.
fn damaged_everywhere(bytes: &[u8], name: &str) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    let read = |bytes: &[u8]| {
        fs::write(&path, bytes).unwrap();
        if let Err(error) = outcome(&path) {
            assert!(error.contains(name), "{error}");
        }
    };
    for end in 0..bytes.len() {
        read(&bytes[..end]);
        for change in [0x01, 0x10, 0x80, 0xff] {
            let mut bad = bytes.to_vec();
            bad[end] ^= change;
            read(&bad);
        }
    }
}

/// What opening and reading all of it comes to.
fn outcome(path: &Path) -> Result<(Vec<Vertices>, Vec<[u64; 3]>), String> {
    let source = karui_io::slices::open(path).map_err(|e| e.to_string())?;
    let triangles = triangles(&*source)?;
    Ok((vertices(&*source, 1000)?, triangles))
}

#[test]
fn what_cannot_be_sliced_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let error = |name: &str, content: &[u8]| {
        let path = folder.path().join(name);
        fs::write(&path, content).unwrap();
        karui_io::slices::open(&path).err().unwrap().to_string()
    };
    for (name, content) in [("a.ply.gz", &[0x1f, 0x8b][..]), ("a.ply", &[0x1f, 0x8b])] {
        assert!(error(name, content).contains("gzip -d"));
    }
    assert!(error("a.off", b"OFF 0 0 0\n").contains("OFF in slices"));
    assert!(error("a.xyz", b"").contains("unknown format"));
    let missing = karui_io::slices::open(folder.path().join("none.ply"));
    assert!(missing.err().unwrap().to_string().contains("no such file"));
    let error = karui_io::slices::open(folder.path()).err().unwrap();
    assert!(error.to_string().contains("is a folder"));
}
