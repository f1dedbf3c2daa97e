#![no_main]
//! Any bytes as a file of any format, read in slices.

use libfuzzer_sys::fuzz_target;
use std::fs;

/// Vertices and portions read at most: instances may make billions of a small file.
const MOST: u64 = 100_000;
const PORTIONS: u64 = 8;

fuzz_target!(|input: &[u8]| {
    let Some((&kind, bytes)) = input.split_first() else {
        return;
    };
    let names = ["a.ply", "a.stl", "a.obj", "a.glb", "a.gltf", "a.tm"];
    let folder = std::env::temp_dir().join(format!("karui-slices-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a folder for temporary files");
    let path = folder.join(names[usize::from(kind) % names.len()]);
    fs::write(&path, bytes).expect("room for temporary files");
    let Ok(source) = karui_io::slices::open(&path) else {
        return;
    };
    let vertices = source.vertices().min(MOST);
    for start in (0..vertices).step_by(1000) {
        let end = (start + 1000).min(vertices);
        if let Ok(slice) = source.read_vertices(start..end) {
            assert_eq!(slice.positions.len() as u64, end - start);
            assert!(slice.positions.iter().all(|p| p.is_finite()));
        }
    }
    for portion in 0..source.chunks().min(PORTIONS) {
        if let Ok(triangles) = source.read_triangles(portion) {
            assert!(
                triangles
                    .as_flattened()
                    .iter()
                    .all(|&v| v < source.vertices())
            );
        }
    }
});
