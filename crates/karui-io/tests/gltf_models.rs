//! Real glTF models: what is read agrees with the counts of `MANIFEST.tsv`,
//! which other tools made.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "it is a test")]

use std::{
    fs,
    path::{Path, PathBuf},
};

/// The folder of test models, if it is there.
fn models() -> Option<PathBuf> {
    let default = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/models");
    let folder = std::env::var_os("KARUI_MODELS").map_or(default, PathBuf::from);
    if folder.join("MANIFEST.tsv").is_file() {
        return Some(folder);
    }
    println!("SKIPPED: no models at {}", folder.display());
    None
}

/// A line of the manifest about a glTF file.
struct Listed {
    file: String,
    vertices: Option<usize>,
    triangles: Option<usize>,
    notes: String,
}

fn listed(folder: &Path) -> Vec<Listed> {
    let manifest = fs::read_to_string(folder.join("MANIFEST.tsv")).unwrap();
    let parse = |line: &str| {
        let fields: Vec<&str> = line.split('\t').collect();
        let file = fields[0].to_owned();
        let is_gltf = file.ends_with(".gltf") || file.ends_with(".glb");
        is_gltf.then(|| Listed {
            file,
            vertices: fields[3].parse().ok(),
            triangles: fields[5].parse().ok(),
            notes: fields[11].to_owned(),
        })
    };
    manifest.lines().filter_map(parse).collect()
}

#[test]
fn counts_agree_with_the_manifest() {
    let Some(folder) = models() else { return };
    let models = listed(&folder);
    assert!(models.len() > 100);
    for model in models {
        let scene = karui_io::read(folder.join(&model.file)).unwrap();
        scene.validate().unwrap();
        let vertices: usize = scene.meshes.iter().map(|m| m.mesh.positions.len()).sum();
        if model.notes.contains("EXT_meshopt_compression") {
            // The manifest's tool could not decode it; the file's own counts.
            assert_eq!((vertices, scene.triangle_count()), (2887, 5010));
            continue;
        }
        assert_eq!(Some(vertices), model.vertices, "{}", model.file);
        assert_eq!(
            Some(scene.triangle_count()),
            model.triangles,
            "{}",
            model.file
        );
    }
}
