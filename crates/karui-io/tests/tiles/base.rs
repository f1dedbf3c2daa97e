//! A tileset with a bit of everything, right in every respect.

use karui::{
    Scene,
    geom::Vec3,
    mesh::{TriMesh, shapes},
};
use serde_json::{Value, json};
use std::{
    fs,
    path::{Path, PathBuf},
};
use tempfile::TempDir;

/// A folder with a tileset.
pub struct Tiles {
    folder: TempDir,
}

/// A cube between two corners in tile space (z up), as a glTF has it (y up).
pub fn cube(min: [f32; 3], max: [f32; 3]) -> Scene {
    let mut mesh: TriMesh = shapes::cube(1);
    let bounds = mesh.bounds();
    let (min, max) = (Vec3::from(min), Vec3::from(max));
    for p in &mut mesh.positions {
        let part = (*p - bounds.min) / bounds.size();
        let z_up = min + (max - min) * part;
        *p = Vec3::new(z_up.x, z_up.z, -z_up.y);
    }
    Scene::from_mesh(mesh)
}

/// A box around two corners.
pub fn a_box(min: [f64; 3], max: [f64; 3]) -> Value {
    let half: Vec<f64> = (0..3).map(|i| (max[i] - min[i]) / 2.0).collect();
    let center: Vec<f64> = (0..3).map(|i| min[i] + half[i]).collect();
    let [x, y, z] = [half[0], half[1], half[2]];
    let axes = [x, 0.0, 0.0, 0.0, y, 0.0, 0.0, 0.0, z];
    json!({ "box": center.iter().chain(&axes).collect::<Vec<_>>() })
}

/// A binary subtree.
pub fn subtree(json: &Value, binary: &[u8]) -> Vec<u8> {
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(8), b' ');
    let mut bytes = b"subt".to_vec();
    bytes.extend(1u32.to_le_bytes());
    bytes.extend((text.len() as u64).to_le_bytes());
    bytes.extend((binary.len() as u64).to_le_bytes());
    bytes.extend(text);
    bytes.extend(binary);
    bytes
}

/// The JSON of the subtree: all five tiles, contents below the root.
pub fn subtree_json() -> Value {
    json!({
        "buffers": [{ "byteLength": 24 }],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": 1 },
            { "buffer": 0, "byteOffset": 8, "byteLength": 10 }
        ],
        "tileAvailability": { "constant": 1 },
        "contentAvailability": [{ "bitstream": 0, "availableCount": 4 }],
        "childSubtreeAvailability": { "constant": 0 },
        "propertyTables": [{ "class": "tile", "count": 5, "properties": { "n": { "values": 1 } } }],
        "tileMetadata": 0
    })
}

pub fn subtree_binary() -> Vec<u8> {
    let mut binary = vec![0; 24];
    binary[0] = 0b1_1110;
    binary
}

fn tileset() -> Value {
    json!({
        "asset": { "version": "1.1", "tilesetVersion": "7" },
        "geometricError": 32.0,
        "schema": { "id": "s", "classes": {
            "tile": { "properties": { "n": { "type": "SCALAR", "componentType": "UINT16", "required": true } } },
            "group": { "properties": { "name": { "type": "STRING" } } }
        } },
        "groups": [{ "class": "group", "properties": { "name": "all" } }],
        "metadata": { "class": "group", "properties": { "name": "set" } },
        "extensionsUsed": ["3DTILES_content_gltf"],
        "extras": { "kept": [1, { "as": "is" }] },
        "root": {
            "boundingVolume": a_box([0.0, 0.0, 0.0], [8.0, 8.0, 4.0]),
            "geometricError": 16.0,
            "refine": "REPLACE",
            "transform": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 100, 200, 300, 1],
            "content": { "uri": "root.glb", "group": 0 },
            "children": [
                {
                    "boundingVolume": { "sphere": [2, 2, 2, 1.8] },
                    "geometricError": 4.0,
                    "contents": [
                        {
                            "uri": "near%20it.glb",
                            "boundingVolume": a_box([1.0, 1.0, 1.0], [3.0, 3.0, 3.0]),
                            "metadata": { "class": "tile", "properties": { "n": 3 } }
                        },
                        { "uri": "root.glb" }
                    ],
                    "metadata": { "class": "tile", "properties": { "n": 3 } }
                },
                {
                    "boundingVolume": a_box([4.0, 0.0, 0.0], [8.0, 4.0, 4.0]),
                    "geometricError": 8.0,
                    "content": { "uri": "more/tileset.json" }
                },
                {
                    "boundingVolume": a_box([0.0, 4.0, 0.0], [4.0, 8.0, 4.0]),
                    "geometricError": 2.0,
                    "content": { "uri": "cells/{level}-{x}-{y}.glb" },
                    "implicitTiling": {
                        "subdivisionScheme": "QUADTREE",
                        "subtreeLevels": 2,
                        "availableLevels": 2,
                        "subtrees": { "uri": "trees/{level}/{x}.{y}.subtree" }
                    }
                }
            ]
        }
    })
}

fn external() -> Value {
    json!({
        "asset": { "version": "1.1" },
        "geometricError": 8.0,
        "root": {
            "boundingVolume": a_box([4.0, 0.0, 0.0], [8.0, 4.0, 4.0]),
            "geometricError": 8.0,
            "refine": "ADD",
            "children": [{
                "geometricError": 0.0,
                "transform": [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, -4, 0, 0, 1],
                "boundingVolume": a_box([4.0, 0.0, 0.0], [5.0, 1.0, 1.0]),
                "content": { "uri": "../small.glb" }
            }]
        }
    })
}

impl Tiles {
    /// The tileset as it should be.
    pub fn new() -> Self {
        let tiles = Self {
            folder: tempfile::tempdir().unwrap(),
        };
        for folder in ["more", "cells", "trees/0"] {
            fs::create_dir_all(tiles.path(folder)).unwrap();
        }
        tiles.write("tileset.json", tileset().to_string().as_bytes());
        tiles.write("more/tileset.json", external().to_string().as_bytes());
        tiles.write(
            "trees/0/0.0.subtree",
            &subtree(&subtree_json(), &subtree_binary()),
        );
        tiles.model("root.glb", &cube([1.2, 1.2, 1.2], [2.8, 2.8, 2.8]));
        tiles.model("near it.glb", &cube([1.0, 1.0, 1.0], [3.0, 3.0, 3.0]));
        tiles.model("small.glb", &cube([4.0, 0.0, 0.0], [5.0, 1.0, 1.0]));
        for (x, y) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let low = [2.0 * x as f32, 4.0 + 2.0 * y as f32, 0.0];
            let high = [low[0] + 2.0, low[1] + 2.0, 4.0];
            tiles.model(&format!("cells/1-{x}-{y}.glb"), &cube(low, high));
        }
        tiles
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn write(&self, name: &str, bytes: &[u8]) {
        fs::write(self.path(name), bytes).unwrap();
    }

    pub fn model(&self, name: &str, scene: &Scene) {
        karui_io::write(self.path(name), scene).unwrap();
    }

    /// Changes a JSON file.
    pub fn edit(&self, name: &str, change: impl FnOnce(&mut Value)) {
        let mut json: Value = serde_json::from_slice(&self.read(name)).unwrap();
        change(&mut json);
        self.write(name, json.to_string().as_bytes());
    }

    pub fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap()
    }

    pub fn root(&self) -> PathBuf {
        self.path("tileset.json")
    }
}

/// All files below a folder, in order.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}
