//! Real glTF models: what is read agrees with the counts of `MANIFEST.tsv`,
//! which other tools made.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "it is a test")]

mod common;

use common::models;
use karui::{Scene, TriMesh, mesh::SkinWeights};
use karui_io::{GltfOptions, WriteOptions};
use serde_json::Value;
use std::{fs, path::Path};

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

/// Every triangle corner as a vertex of its own, so that meshes compare
/// whatever the order of their vertices.
fn corners(mesh: &TriMesh) -> TriMesh {
    let mut corners = mesh.clone();
    corners.gather_vertices(mesh.triangles.as_flattened());
    corners.triangles.clear();
    for range in &mut corners.ranges {
        range.source = None;
    }
    corners
}

/// Takes out what the writer may repair: directions that are not unit, weights
/// that do not sum to 1.
fn split_repaired(mesh: &mut TriMesh) -> (Vec<[f32; 3]>, Vec<SkinWeights>) {
    let directions = mesh.attributes.normals.take().unwrap_or_default();
    let directions = directions.iter().map(|n| n.normalize_or_zero().to_array());
    let mut skins: Vec<SkinWeights> = mesh.attributes.skins.drain(..).flatten().collect();
    for skin in &mut skins {
        let sum: f32 = skin.weights.iter().sum();
        skin.weights = skin.weights.map(|w| w / sum);
    }
    mesh.attributes.tangents = None;
    (directions.collect(), skins)
}

fn assert_same_meshes(a: &Scene, b: &Scene, file: &str) {
    assert_eq!(a.meshes.len(), b.meshes.len(), "{file}");
    for (a, b) in a.meshes.iter().zip(&b.meshes) {
        assert_eq!(a.name, b.name, "{file}");
        let (mut a, mut b) = (corners(&a.mesh), corners(&b.mesh));
        let ((na, sa), (nb, sb)) = (split_repaired(&mut a), split_repaired(&mut b));
        assert_eq!(a, b, "{file}");
        let near = |a: f32, b: f32| (a - b).abs() < 1e-5;
        assert_eq!(na.len(), nb.len(), "{file}");
        for (a, b) in na.iter().zip(&nb).filter(|(a, _)| **a != [0.0; 3]) {
            assert!(
                a.iter().zip(b).all(|(a, b)| near(*a, *b)),
                "{file}: {a:?} {b:?}"
            );
        }
        assert_eq!(sa.len(), sb.len(), "{file}");
        for (a, b) in sa.iter().zip(&sb) {
            assert_eq!(a.joints, b.joints, "{file}");
            assert!(
                a.weights.iter().zip(b.weights).all(|(a, b)| near(*a, b)),
                "{file}"
            );
        }
    }
}

#[test]
fn every_model_survives_a_round_trip() {
    let Some(folder) = models() else { return };
    let out = tempfile::tempdir().unwrap();
    let [first, second] = ["1.glb", "2.glb"].map(|name| out.path().join(name));
    for model in listed(&folder) {
        let file = &model.file;
        let read = karui_io::read(folder.join(file)).unwrap();
        karui_io::write(&first, &read).unwrap();
        let again = karui_io::read(&first).unwrap();
        assert_same_meshes(&read, &again, file);
        assert_eq!(read.nodes, again.nodes, "{file}");
        assert_eq!(read.roots, again.roots, "{file}");
        assert_eq!(read.materials, again.materials, "{file}");
        assert_eq!(read.textures, again.textures, "{file}");
        assert_eq!(read.images.len(), again.images.len(), "{file}");
        // What Karui has written, it writes again byte for byte.
        karui_io::write(&second, &again).unwrap();
        assert!(
            fs::read(&first).unwrap() == fs::read(&second).unwrap(),
            "{file}"
        );
    }
}

#[test]
fn compression_is_without_loss() {
    let Some(folder) = models() else { return };
    let out = tempfile::tempdir().unwrap();
    let [plain, packed] = ["plain.glb", "packed.glb"].map(|name| out.path().join(name));
    let options = WriteOptions {
        gltf: GltfOptions {
            meshopt: true,
            quantize: false,
            ..GltfOptions::default()
        },
        ..WriteOptions::default()
    };
    for file in [
        "gltf/Fox.glb",
        "gltf/MorphStressTest.gltf",
        "gltf/chr_knight.glb",
    ] {
        let read = karui_io::read(folder.join(file)).unwrap();
        karui_io::write(&plain, &read).unwrap();
        karui_io::write_with(&packed, &read, &options).unwrap();
        let size = |path: &Path| fs::metadata(path).unwrap().len();
        assert!(size(&packed) < size(&plain), "{file}");
        let [plain, packed] = [&plain, &packed].map(|path| karui_io::read(path).unwrap());
        for (a, b) in plain.meshes.iter().zip(&packed.meshes) {
            assert_eq!(a.mesh.positions, b.mesh.positions, "{file}");
            assert_eq!(a.mesh.attributes, b.mesh.attributes, "{file}");
            // The codec may rotate triangles.
            let rotations = |t: [u32; 3]| [t, [t[1], t[2], t[0]], [t[2], t[0], t[1]]];
            let mut pairs = a.mesh.triangles.iter().zip(&b.mesh.triangles);
            assert!(pairs.all(|(a, b)| rotations(*a).contains(b)), "{file}");
        }
    }
}

#[test]
fn quantisation_stays_within_its_steps() {
    let Some(folder) = models() else { return };
    let out = tempfile::tempdir().unwrap();
    let path = out.path().join("quantized.glb");
    let options = WriteOptions {
        gltf: GltfOptions {
            meshopt: true,
            quantize: true,
            ..GltfOptions::default()
        },
        ..WriteOptions::default()
    };
    for file in [
        "gltf/FlightHelmet/FlightHelmet.gltf",
        "gltf/PalmTree/PalmTree.gltf",
        "gltf/2CylinderEngine.glb",
        "gltf/MorphStressTest.gltf",
    ] {
        let read = karui_io::read(folder.join(file)).unwrap();
        karui_io::write_with(&path, &read, &options).unwrap();
        let again = karui_io::read(&path).unwrap();
        let [a, b] = [read, again].map(|scene| scene.into_single_mesh().unwrap());
        // The codec may rotate triangles: compare their centres.
        let centres = |m: &TriMesh| -> Vec<_> {
            (0..m.triangles.len())
                .map(|t| m.corners(t).iter().sum::<karui::geom::DVec3>() / 3.0)
                .collect()
        };
        let step = a.bounds().diagonal() / 65535.0;
        for (a, b) in centres(&a).iter().zip(centres(&b)) {
            assert!(a.distance(b) < step, "{file}: {a} {b}");
        }
    }
}

/// A document and its buffers, by means other than the reader's.
struct Raw {
    json: Value,
    buffers: Vec<Vec<u8>>,
}

fn raw(path: &Path) -> Raw {
    let bytes = fs::read(path).unwrap();
    let word = |i: usize| u32::from_le_bytes(bytes[i..i + 4].try_into().unwrap()) as usize;
    if !bytes.starts_with(b"glTF") {
        let json: Value = serde_json::from_slice(&bytes).unwrap();
        let buffer = |b: &Value| {
            let uri = b["uri"].as_str().unwrap();
            fs::read(path.with_file_name(uri)).unwrap_or_default()
        };
        let buffers = json["buffers"]
            .as_array()
            .unwrap()
            .iter()
            .map(buffer)
            .collect();
        return Raw { json, buffers };
    }
    let json = serde_json::from_slice(&bytes[20..20 + word(12)]).unwrap();
    let bin = bytes[28 + word(12)..].to_vec();
    Raw {
        json,
        buffers: vec![bin],
    }
}

impl Raw {
    fn view(&self, view: &Value) -> &[u8] {
        let view = &self.json["bufferViews"][view.as_u64().unwrap() as usize];
        let number = |key: &str| view[key].as_u64().unwrap_or(0) as usize;
        let buffer = &self.buffers[number("buffer")];
        &buffer[number("byteOffset")..][..number("byteLength")]
    }

    /// Accessor without what tells where its data are, and 4-byte data.
    fn accessor(&self, index: &Value) -> (Value, Vec<u8>) {
        let mut accessor = self.json["accessors"][index.as_u64().unwrap() as usize].clone();
        let offset = accessor["byteOffset"].as_u64().unwrap_or(0) as usize;
        let width = match accessor["type"].as_str().unwrap() {
            "SCALAR" => 1,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 16,
        };
        let length = accessor["count"].as_u64().unwrap() as usize * width * 4;
        let data = self.view(&accessor["bufferView"])[offset..][..length].to_vec();
        for key in ["bufferView", "byteOffset"] {
            accessor.as_object_mut().unwrap().remove(key);
        }
        (accessor, data)
    }

    /// Everything that is passed through, with data in place of references.
    fn passed(&self) -> Vec<(String, Value, Vec<u8>)> {
        let mut passed = Vec::new();
        let keys = [
            "cameras",
            "materials",
            "samplers",
            "scene",
            "scenes",
            "nodes",
            "extras",
        ];
        for key in keys {
            passed.push((key.to_owned(), self.json[key].clone(), Vec::new()));
        }
        for (s, skin) in self.json["skins"]
            .as_array()
            .into_iter()
            .flatten()
            .enumerate()
        {
            let (accessor, data) = self.accessor(&skin["inverseBindMatrices"]);
            passed.push((format!("skin {s}"), skin["joints"].clone(), Vec::new()));
            passed.push((format!("skin {s} matrices"), accessor, data));
        }
        for (a, animation) in self.json["animations"]
            .as_array()
            .into_iter()
            .flatten()
            .enumerate()
        {
            passed.push((
                format!("animation {a}"),
                animation["channels"].clone(),
                Vec::new(),
            ));
            for sampler in animation["samplers"].as_array().unwrap() {
                for key in ["input", "output"] {
                    let (accessor, data) = self.accessor(&sampler[key]);
                    passed.push((format!("animation {a} {key}"), accessor, data));
                }
            }
        }
        for mesh in self.json["meshes"].as_array().unwrap() {
            passed.push(("mesh".into(), mesh["extras"].clone(), Vec::new()));
            for primitive in mesh["primitives"].as_array().unwrap() {
                passed.push((
                    "primitive".into(),
                    primitive["extensions"].clone(),
                    Vec::new(),
                ));
            }
        }
        let tables =
            self.json["extensions"]["EXT_structural_metadata"]["propertyTables"].as_array();
        for property in tables
            .into_iter()
            .flatten()
            .filter_map(|t| t["properties"].as_object())
        {
            for (name, property) in property {
                passed.push((
                    name.clone(),
                    Value::Null,
                    self.view(&property["values"]).to_vec(),
                ));
            }
        }
        passed
    }
}

#[test]
fn what_is_not_modelled_is_passed_through() {
    let Some(folder) = models() else { return };
    let out = tempfile::tempdir().unwrap();
    let path = out.path().join("out.glb");
    let below = "scenes/3d-tiles-samples/glTF";
    for file in [
        "gltf/CesiumMan.glb",
        "gltf/Fox.glb",
        "gltf/SimpleSkin.gltf",
        "gltf/DragonAttenuation.glb",
        "gltf/MixedLightingExample/MixedLightingExample.gltf",
        "gltf/AnisotropyBarnLamp/AnisotropyBarnLamp.gltf",
        "gltf/many-cubes.gltf",
        &format!(
            "{below}/EXT_structural_metadata/FeatureIdAttributeAndPropertyTable/FeatureIdAttributeAndPropertyTable.gltf"
        ),
    ] {
        let source = folder.join(file);
        if fs::read_to_string(&source).is_ok_and(|text| text.contains("data:application")) {
            // The comparison here reads no data URIs; reading them is tested above.
            continue;
        }
        karui_io::write(&path, &karui_io::read(&source).unwrap()).unwrap();
        let (before, after) = (raw(&source).passed(), raw(&path).passed());
        assert_eq!(before.len(), after.len(), "{file}");
        for (before, after) in before.into_iter().zip(after) {
            assert!(before == after, "{file}: {}", before.0);
        }
    }
}

#[test]
fn damaged_compressed_models_are_never_a_panic() {
    let Some(folder) = models() else { return };
    for file in ["gltf/DenseSphere.glb", "gltf/pirate.glb"] {
        let original = fs::read(folder.join(file)).unwrap();
        for round in 0..60usize {
            let mut bytes = original.clone();
            // Spread over the compressed data behind the JSON.
            let at = bytes.len() - 1 - round * 7919 % (bytes.len() - 4000);
            bytes[at] ^= 1 << (round % 8);
            if let Ok(loaded) = karui_io::read_bytes(karui_io::Format::Glb, &bytes, file) {
                loaded.scene.validate().unwrap();
            }
        }
    }
}
