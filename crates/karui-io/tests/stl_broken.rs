//! What becomes of each deliberately broken STL file of the collection: what
//! does no harm is passed over, what loses triangles is an error.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test")]

use karui_io::ReadOptions;
use std::{
    env,
    path::{Path, PathBuf},
};

/// Triangles, vertices and a word of the warning, or the error.
type Outcome = Result<(usize, usize, Option<&'static str>), &'static str>;

const FILES: [(&str, Outcome); 14] = [
    // Normals are not read, so whatever is wrong with them is no matter.
    ("missingNormal.ascii.stl", Ok((4, 4, None))),
    ("notANumberNormal.ascii.stl", Ok((4, 4, None))),
    ("wrongNormal.ascii.stl", Ok((4, 4, None))),
    ("wrongNormals.ascii.stl", Ok((4, 4, None))),
    // The size of a file says that it is binary, not its first word.
    ("wrongHeader.bin.stl", Ok((12, 8, None))),
    ("solidNameMismatch.ascii.stl", Ok((4, 4, None))),
    // It may have been cut off between two facets, so there is a warning.
    ("missingEndsolid.ascii.stl", Ok((4, 4, Some("endsolid")))),
    // Not closed, but nothing in the file is wrong.
    ("missingFace.ascii.stl", Ok((3, 4, None))),
    ("singleFace.ascii.stl", Ok((1, 3, None))),
    // What the author meant is plain: a polygon.
    ("quad.ascii.stl", Ok((5, 5, Some("4 vertices")))),
    ("fourVertices.ascii.stl", Ok((5, 4, Some("4 vertices")))),
    // A corner is missing, and nobody knows which.
    (
        "twoVertices.ascii.stl",
        Err("line 6: expected 3 vertices in a facet, found 2"),
    ),
    // Most likely the rest of the file is missing.
    (
        "incorrectFaceCounter.bin.stl",
        Err("byte 80: the file ends early: expected 66 facets, found 4"),
    ),
    (
        "empty.stl",
        Err("the file ends early: expected an STL model, found an empty file"),
    ),
];

#[test]
fn each_file_as_a_user_would_expect() {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/models");
    let models = env::var_os("KARUI_MODELS").map_or_else(beside, PathBuf::from);
    let folder = models.join("hard/stl-broken");
    if !folder.is_dir() {
        println!("SKIPPED: no models in {}", folder.display());
        return;
    }
    for (name, expected) in FILES {
        let path = folder.join(name);
        let loaded = karui_io::read_with(&path, &ReadOptions::default());
        match (loaded, expected) {
            (Ok(loaded), Ok((triangles, vertices, warning))) => {
                let mesh = &loaded.scene.meshes[0].mesh;
                assert_eq!(mesh.triangles.len(), triangles, "{name}");
                assert_eq!(mesh.positions.len(), vertices, "{name}");
                let told = loaded.warnings.join("; ");
                assert_eq!(told.is_empty(), warning.is_none(), "{name}: {told}");
                assert!(told.contains(warning.unwrap_or_default()), "{name}: {told}");
            }
            (Err(error), Err(expected)) => {
                assert_eq!(error.to_string(), format!("{}: {expected}", path.display()));
            }
            (found, _) => panic!("{name}: {:?}", found.map(|l| l.warnings)),
        }
    }
    let count = std::fs::read_dir(&folder).unwrap().count();
    assert_eq!(count, FILES.len(), "every file has an outcome");
}
