//! Binary STL in slices.

use crate::{common, corners, corners_of, damaged_everywhere, outcome, unpacked, whole};
use karui::mesh::shapes;
use karui_io::slices;
use std::{fs, path::Path};

#[test]
fn real_models() {
    let Some(models) = common::models() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    for name in [
        "hard/BONERibcage.stl.gz",
        "hard/Spider_binary.stl",
        "hard/angle_block.STL",
        "hard/gearwheel.bin.stl",
        "hard/counter.unitsmm.STL.gz",
        "hard/head.stl.gz",
        "hard/video_part.stl.gz",
    ] {
        let path = unpacked(&models.join(name), folder.path());
        match slices::open(&path) {
            Ok(source) => assert!(corners(&*source) == corners_of(&whole(&path)), "{name}"),
            Err(error) => assert!(error.to_string().contains("text STL"), "{name}: {error}"),
        }
    }
}

/// A sphere of 20 facets, or 80.
fn sphere(folder: &Path, subdivisions: u32) -> Vec<u8> {
    let path = folder.join("whole.stl");
    let scene = karui::Scene::from_mesh(shapes::icosphere(subdivisions));
    karui_io::write(&path, &scene).unwrap();
    fs::read(path).unwrap()
}

#[test]
fn corners_are_numbered_by_facet() {
    let folder = tempfile::tempdir().unwrap();
    damaged_everywhere(&sphere(folder.path(), 0), "a.stl");
    let bytes = sphere(folder.path(), 1);
    // Without a name, the length tells.
    let path = folder.path().join("nameless");
    fs::write(&path, &bytes).unwrap();
    let source = slices::open(&path).unwrap();
    assert_eq!((source.vertices(), source.chunks()), (240, 1));
    assert_eq!(source.read_triangles(0).unwrap()[79], [237, 238, 239]);
    let all = source.read_vertices(0..240).unwrap().positions;
    for (start, end) in [
        (0, 1),
        (1, 2),
        (2, 7),
        (100, 240),
        (239, 240),
        (240, 240),
        (5, 5),
    ] {
        let some = source.read_vertices(start..end).unwrap().positions;
        assert_eq!(some, all[start as usize..end as usize], "{start}..{end}");
    }
}

#[test]
fn what_is_wrong_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let good = sphere(folder.path(), 1);
    let path = folder.path().join("a.stl");
    let error = |at: usize, bytes: &[u8]| {
        let mut bad = good.clone();
        bad[at..at + bytes.len()].copy_from_slice(bytes);
        fs::write(&path, &bad).unwrap();
        outcome(&path).unwrap_err()
    };
    assert!(error(80, &[255; 4]).contains("byte 80: the file ends early"));
    assert!(error(80, &[79, 0, 0, 0]).contains("byte 80: expected 79 facets, found 80"));
    let nan = error(84 + 50 + 12, &f32::NAN.to_le_bytes());
    assert!(
        nan.contains("byte 146: vertex coordinate is not finite"),
        "{nan}"
    );
    fs::write(&path, "solid a\nfacet normal 0 0 1\n").unwrap();
    assert!(outcome(&path).unwrap_err().contains("text STL in slices"));
}
