//! OBJ in slices.

use crate::{common, corners, corners_of, damaged_everywhere, outcome, unpacked};
use karui::{TriMesh, mesh::shapes};
use karui_io::{Format, read_poly, read_poly_bytes, slices};
use proptest::{collection::vec, prelude::*};
use std::{fmt::Write, fs, path::Path};

/// The mesh read whole, in the order of the file: not sorted by material.
fn whole(path: &Path) -> TriMesh {
    let mut mesh = read_poly(path).unwrap();
    mesh.face_materials.clear();
    mesh.triangulate()
}

#[test]
fn real_models() {
    let Some(models) = common::models() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    for name in [
        "scans/armadillo.obj",
        "scans/boot.obj",
        "terrain/mountain.obj.gz",
        "hard/sponza.obj.gz",
        "hard/chair_model.obj",
        "hard/concave_polygon.obj",
        "hard/cube-minimal-degenerated.obj",
        "hard/box_longline.obj",
        "gltf/pirate.obj",
    ] {
        let path = unpacked(&models.join(name), folder.path());
        let source = slices::open(&path).unwrap();
        assert!(corners(&*source) == corners_of(&whole(&path)), "{name}");
    }
}

#[test]
fn portions_are_read_from_their_marks() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    let mesh = shapes::landscape(300, 250, 9);
    let mut text = String::new();
    // Vertices and faces by turns, and indices from the end.
    for row in 0..=250 {
        for p in &mesh.positions[row * 301..(row + 1) * 301] {
            writeln!(text, "v {} {} {} 0.25 0.5 {}", p.x, p.y, p.z, row % 2).unwrap();
        }
        for i in 0..300 * i32::from(row > 0) {
            writeln!(
                text,
                "f {} {} {} \\\r\n {}",
                i - 602,
                i - 301,
                i - 300,
                i - 601
            )
            .unwrap();
        }
    }
    fs::write(&path, &text).unwrap();
    assert!(text.len() > 3 << 20, "{}", text.len());
    let source = slices::open(&path).unwrap();
    assert!(source.chunks() >= 3);
    let whole = whole(&path);
    crate::assert_same(&*source, &whole, 5_003, "turns");
}

proptest! {
    #[test]
    fn made_files(
        statements in vec((0u8..12, vec(-9i32..9, 0..6)), 0..60),
        colors in any::<bool>(),
    ) {
        let mut text = String::from("v 0 0 0\nv 1 0 0\nv 1 1 0.5\n");
        let mut count = 3;
        for (kind, numbers) in &statements {
            match kind {
                0..4 => {
                    let at = |i: usize| numbers.get(i).copied().unwrap_or(i as i32);
                    let color = if colors { " 0.5 0 1" } else { "" };
                    writeln!(text, "v {} {} {}{color}", at(0), at(1), at(2)).unwrap();
                    count += 1;
                }
                4..10 => {
                    let index = |&n: &i32| {
                        let n = n.clamp(-count, count);
                        if n == 0 { 1 } else { n }
                    };
                    let corners: Vec<_> = numbers.iter().map(|n| index(n).to_string()).collect();
                    writeln!(text, "f {} # end", corners.join(" ")).unwrap();
                }
                10 => text.push_str("g x\nusemtl y\n\n"),
                _ => text.push_str("# v 1 2 3\nvp 1\n"),
            }
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.obj");
        fs::write(&path, &text).unwrap();
        let source = slices::open(&path).unwrap();
        let mut whole = read_poly_bytes(Format::Obj, text.as_bytes(), "a.obj").unwrap();
        whole.face_materials.clear();
        crate::assert_same(&*source, &whole.triangulate(), 7, "made");
    }
}

#[test]
fn what_is_wrong_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    let good = "v 0 0 0\nv 1 0 0 1 0 0\nv 1 1 0\nv 0 1 0 0 0 255\nf 1/1/1 2//1 3/1 -1\nf 4 3 2\n";
    damaged_everywhere(good.as_bytes(), "a.obj");
    let outcome = |text: &str| {
        fs::write(&path, text).unwrap();
        outcome(&path)
    };
    let (slices, triangles) = outcome(good).unwrap();
    assert_eq!(triangles, [[0, 1, 2], [0, 2, 3], [3, 2, 1]]);
    let colors: Vec<_> = slices[0].attributes.colors[0]
        .iter()
        .map(|c| c.to_array())
        .collect();
    assert_eq!(colors[1], [1.0 / 255.0, 0.0, 0.0, 1.0]);
    assert_eq!((colors[0], colors[3]), ([1.0; 4], [0.0, 0.0, 1.0, 1.0]));
    for (text, expected) in [
        (
            good.replace("f 4", "f 5"),
            "line 6: vertex index 5 is out of range; there are 4",
        ),
        (good.replace("f 4", "f 0"), "line 6: vertex index 0"),
        (good.replace("f 4", "f -5"), "line 6: vertex index -5"),
        (
            good.replace("f 4", "f x"),
            "line 6: expected a vertex index",
        ),
        (
            good.replace("f 4", "f 1/1/1/1"),
            "line 6: expected at most v/vt/vn",
        ),
        (
            good.replace("v 1 1 0", "v 1 nan 0"),
            "line 3: vertex coordinate is not finite",
        ),
        (
            good.replace("v 1 1 0", "v 1 0"),
            "line 3: expected 3 numbers, found 2",
        ),
        ("hello\n".into(), "line 1: expected an OBJ statement"),
        (String::new(), "an empty file"),
    ] {
        let error = outcome(&text).unwrap_err();
        assert!(error.contains(expected), "{error}");
    }
    fs::write(&path, "vt 0 0\nvn 0 0 1\nv 0 0 0\nusemtl a\nl 1 1\nxyz\n").unwrap();
    let warnings = slices::open_with(&path).unwrap().warnings;
    let expected = [
        "statements such as `xyz` (line 6) were passed over",
        "texture coordinates were left aside",
        "normals were left aside",
        "materials were left aside",
        "lines and points were passed over",
        "the file holds no faces",
    ];
    assert_eq!(warnings, expected);
}
