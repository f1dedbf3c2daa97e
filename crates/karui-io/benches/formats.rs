//! Speed of reading and writing a terrain of two million triangles from and
//! to memory or a temporary file: `cargo bench -p karui-io --bench formats`

#![allow(clippy::unwrap_used, reason = "a bench")]

use divan::{Bencher, black_box, counter::BytesCount};
use karui::{Scene, mesh::shapes};
use karui_io::{Format, PlyEncoding, WriteOptions};
use std::{fs, path::PathBuf};

fn main() {
    divan::main();
}

/// 2,000,000 triangles.
fn terrain() -> Scene {
    Scene::from_mesh(shapes::terrain(1000, 1000, 7))
}

const NAMES: [&str; 5] = ["a.ply", "text.ply", "a.stl", "a.obj", "a.off"];

fn options(name: &str) -> WriteOptions {
    let ply = if name == "text.ply" {
        PlyEncoding::Ascii
    } else {
        PlyEncoding::default()
    };
    WriteOptions {
        ply,
        ..WriteOptions::default()
    }
}

fn written(folder: &tempfile::TempDir, name: &str) -> PathBuf {
    let path = folder.path().join(name);
    karui_io::write_with(&path, &terrain(), &options(name)).unwrap();
    path
}

#[divan::bench(args = NAMES, sample_count = 5)]
fn read(bencher: Bencher, name: &str) {
    let folder = tempfile::tempdir().unwrap();
    let path = written(&folder, name);
    let bytes = fs::read(&path).unwrap();
    let format = Format::from_path(&path).unwrap();
    bencher
        .counter(BytesCount::new(bytes.len()))
        .bench(|| karui_io::read_bytes(format, black_box(&bytes), name).unwrap());
}

#[divan::bench(args = NAMES, sample_count = 5)]
fn write(bencher: Bencher, name: &str) {
    let folder = tempfile::tempdir().unwrap();
    let path = written(&folder, name);
    let scene = terrain();
    let bytes = fs::metadata(&path).unwrap().len();
    bencher
        .counter(BytesCount::new(bytes))
        .bench(|| karui_io::write_with(&path, black_box(&scene), &options(name)).unwrap());
}
