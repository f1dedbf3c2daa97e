//! Every OBJ, PLY, STL and OFF file of the model collection loads, with the
//! numbers of faces and vertices that another tool counted (MANIFEST.tsv).

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test")]

mod common;

use common::models;
use karui::PolyMesh;
use karui_io::{ErrorKind, Format, ReadOptions};
use std::{fs, path::Path};

/// A line of the manifest.
struct Row {
    file: String,
    vertices: usize,
    faces: usize,
    triangles: usize,
}

fn rows(folder: &Path) -> Vec<Row> {
    let manifest = fs::read_to_string(folder.join("MANIFEST.tsv")).unwrap();
    let parse = |line: &str| {
        let fields: Vec<&str> = line.split('\t').collect();
        let number = |i: usize| fields[i].parse().ok();
        Some(Row {
            file: fields[0].to_owned(),
            vertices: number(3)?,
            faces: number(4)?,
            triangles: number(5)?,
        })
    };
    let text_format = |row: &Row| {
        let format = Format::from_path(Path::new(&row.file));
        format.is_ok_and(|f| !matches!(f, Format::Gltf | Format::Glb))
    };
    manifest
        .lines()
        .skip(1)
        .filter_map(parse)
        .filter(text_format)
        .collect()
}

/// Files that are meant to fail, with the reason.
fn expected_error(file: &str) -> Option<fn(&ErrorKind) -> bool> {
    Some(match file {
        // No bytes at all.
        "hard/stl-broken/empty.stl" => |k| matches!(k, ErrorKind::Truncated { .. }),
        // The header says 66 facets, the file ends after 4: nothing tells this
        // from a copy that was cut off.
        "hard/stl-broken/incorrectFaceCounter.bin.stl" => {
            |k| matches!(k, ErrorKind::Truncated { .. })
        }
        // A facet of two corners: something is missing.
        "hard/stl-broken/twoVertices.ascii.stl" => |k| matches!(k, ErrorKind::Syntax { .. }),
        _ => return None,
    })
}

/// Files whose numbers differ from the manifest's: triangles here, and why.
fn deviation(file: &str) -> Option<usize> {
    Some(match file {
        // The manifest takes the corners three by three across facets; here a
        // facet of four corners is two triangles: 3 + 2.
        "hard/stl-broken/fourVertices.ascii.stl" | "hard/stl-broken/quad.ascii.stl" => 5,
        _ => return None,
    })
}

#[test]
fn all_models_have_the_numbers_of_the_manifest() {
    let Some(folder) = models() else {
        return;
    };
    let mut seen = 0;
    let mut wrong = Vec::new();
    for row in rows(&folder) {
        let path = folder.join(&row.file);
        seen += 1;
        let loaded = karui_io::read_with(&path, &ReadOptions::default());
        if let Some(expected) = expected_error(&row.file) {
            let error = loaded.map(drop).expect_err(&row.file);
            assert!(expected(&error.kind), "{error}");
            continue;
        }
        let mesh = loaded.unwrap().scene.into_single_mesh().unwrap();
        mesh.validate()
            .unwrap_or_else(|e| panic!("{}: {e}", row.file));
        let triangles = deviation(&row.file).unwrap_or(row.triangles);
        if mesh.triangles.len() != triangles {
            let found = mesh.triangles.len();
            wrong.push(format!(
                "{}: {found} triangles, expected {triangles}",
                row.file
            ));
        }
        wrong.extend(check_polygons(&row, &path));
    }
    assert!(seen >= 190, "only {seen} files in the manifest");
    assert!(
        wrong.is_empty(),
        "{} files:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
}

/// Vertices and faces as they are in the file.
fn check_polygons(row: &Row, path: &Path) -> Vec<String> {
    let mut wrong = Vec::new();
    let mesh: PolyMesh = karui_io::read_poly(path).unwrap();
    if Format::from_path(path).unwrap() == Format::Stl {
        // The manifest counts every corner of STL as a vertex.
        if mesh.positions.len() > row.vertices {
            wrong.push(format!("{}: {} vertices", row.file, mesh.positions.len()));
        }
        return wrong;
    }
    if mesh.face_count() != row.faces {
        let found = mesh.face_count();
        wrong.push(format!(
            "{}: {found} faces, expected {}",
            row.file, row.faces
        ));
    }
    let has_seams = !mesh.attributes.uvs.is_empty() || mesh.attributes.normals.is_some();
    let is_obj = Format::from_path(path).unwrap() == Format::Obj;
    // OBJ vertices are split at seams and dropped if no face uses them.
    if mesh.positions.len() != row.vertices && !(is_obj && has_seams) {
        let found = mesh.positions.len();
        wrong.push(format!(
            "{}: {found} vertices, expected {}",
            row.file, row.vertices
        ));
    }
    wrong
}

#[test]
fn missing_libraries_are_told() {
    let Some(folder) = models() else {
        return;
    };
    let path = folder.join("hard/chair_model.obj");
    let loaded = karui_io::read_with(path, &ReadOptions::default()).unwrap();
    let told = |w: &String| w.contains("was not found");
    assert!(loaded.warnings.iter().any(told), "{:?}", loaded.warnings);
    assert_eq!(loaded.scene.materials.len(), 3);
}
