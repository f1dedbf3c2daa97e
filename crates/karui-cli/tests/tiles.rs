//! `karui info` of 3D Tiles, end to end.
#![allow(clippy::unwrap_used, reason = "it is a test")]

mod common;

use common::Folder;
use karui::mesh::{Scene, shapes};
use serde_json::{Value, json};

/// A folder with a tileset of two tiles, one of them with a model.
fn tileset() -> Folder {
    let folder = Folder::new();
    folder.scene("cube.glb", &Scene::from_mesh(shapes::cube(1)));
    let sphere = json!({ "sphere": [0, 0, 0, 1000] });
    let json = json!({
        "asset": { "version": "1.1" },
        "geometricError": 8,
        "extensionsUsed": ["3DTILES_content_gltf"],
        "root": {
            "boundingVolume": sphere, "geometricError": 4, "refine": "REPLACE",
            "children": [{ "boundingVolume": sphere, "geometricError": 0, "content": { "uri": "cube.glb" } }]
        }
    });
    std::fs::write(folder.path("tileset.json"), json.to_string()).unwrap();
    folder
}

fn edit(folder: &Folder, change: impl FnOnce(&mut Value)) {
    let path = folder.path("tileset.json");
    let mut json: Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    change(&mut json);
    std::fs::write(&path, json.to_string()).unwrap();
}

#[test]
fn a_tileset_is_shown() {
    let folder = tileset();
    let ran = folder.ok("info tileset.json");
    for part in [
        "3D Tiles 1.1",
        "2 tiles in 2 levels",
        "1 contents in 1 files",
        "3DTILES_content_gltf",
    ] {
        assert!(ran.out.contains(part), "{part}: {}", ran.out);
    }
    let report = &folder.ok("info --json tileset.json").json()[0];
    assert_eq!(report["counts"]["tiles"], 2);
    assert_eq!(report["counts"]["depth"], 2);
    assert_eq!(report["levels"][0]["max_error"], 4.0);
    assert_eq!(report["errors"], json!([]));
}

#[test]
fn broken_rules_are_told_and_fail() {
    let folder = tileset();
    edit(&folder, |json| {
        json["root"]["children"][0]["geometricError"] = json!(5)
    });
    edit(&folder, |json| {
        json["root"]["content"] = json!({ "uri": "../cube.glb" })
    });
    let ran = folder.fails(1, "info tileset.json");
    assert!(ran.err.contains("2 places"), "{ran:?}");
    for rule in [
        "/root/children/0/geometricError",
        "[geometric-error-grows]",
        "[uri-outside]",
    ] {
        assert!(ran.out.contains(rule), "{rule}: {}", ran.out);
    }
    let ran = folder.fails(1, "info --json tileset.json");
    let report = &ran.json()[0];
    let rules: Vec<_> = report["errors"]
        .as_array()
        .unwrap()
        .iter()
        .map(|e| &e["rule"])
        .collect();
    assert_eq!(rules, ["uri-outside", "geometric-error-grows"]);
}

#[test]
fn what_is_no_tileset_is_bad_input() {
    let folder = Folder::new();
    std::fs::write(folder.path("tileset.json"), "[]").unwrap();
    folder.fails(2, "info tileset.json");
    folder.fails(2, "info none.json");
}
