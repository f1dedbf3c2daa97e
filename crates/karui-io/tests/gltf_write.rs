//! What the glTF writer makes of scenes that were read, changed or built.
#![allow(clippy::unwrap_used, reason = "it is a test")]

use karui::{
    Scene, TriMesh,
    geom::{Vec2, Vec3},
    mesh::{
        Image, ImageData, LodLinks, Material, NamedMesh, Node, Texture, TextureRef, Transform, Wrap,
    },
};
use karui_io::{Format, read_bytes};
use serde_json::{Value, json};
use std::{fs, path::Path, sync::Arc};

fn data_uri(bytes: &[u8]) -> String {
    let text: String = bytes.iter().map(|b| format!("%{b:02x}")).collect();
    format!("data:application/octet-stream,{text}")
}

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|f| f.to_le_bytes()).collect()
}

/// A document with something of everything that Karui does not model.
fn rich() -> Value {
    let square = [0., 0., 0., 1., 0., 0., 0., 1., 0., 1., 1., 0.];
    let times = [0., 1., 0.25, 0.75];
    let bytes = [
        floats(&square),                                    // 0: positions, 48 bytes
        vec![0, 1, 2, 3],                                   // 48: strip, 4 bytes
        floats(&times),                                     // 52: times and weights, 16 bytes
        [vec![2, 0, 0, 0], floats(&[0., 0., 5.])].concat(), // 68: sparse morph, 16 bytes
        b"opaque".to_vec(),                                 // 84: 6 bytes
    ]
    .concat();
    json!({
        "asset": {"version": "2.0", "copyright": "nobody", "generator": "a test"},
        "extensionsUsed": ["VENDOR_all", "KHR_materials_variants"],
        "extras": {"root": [1, {"deep": null}]},
        "scene": 1,
        "scenes": [{"nodes": [1]}, {"name": "shown", "nodes": [0], "extras": 3}],
        "nodes": [
            {"mesh": 0, "weights": [0.5], "extensions": {"VENDOR_all": {"n": 1}}, "extras": "e"},
            {"camera": 0, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 1.5,2,3,1]}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}],
        "meshes": [{
            "weights": [0.5],
            "extras": {"targetNames": ["lift"]},
            "extensions": {"VENDOR_all": {"mesh": true}},
            "primitives": [
                {"mode": 0, "attributes": {"POSITION": 0}, "extras": "points",
                 "targets": [{"POSITION": 4}]},
                {"mode": 5, "attributes": {"POSITION": 0}, "indices": 1, "material": 0,
                 "targets": [{"POSITION": 4}],
                 "extensions": {"VENDOR_all": {"p": 1},
                     "KHR_materials_variants": {"mappings": [{"material": 0, "variants": [0]}]}}}]
        }],
        "materials": [{"name": "m", "extensions": {"VENDOR_all": {"shine": 9}},
            "pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.2, 0.3, 1], "extras": "k"}}],
        "samplers": [{"minFilter": 9987}],
        "textures": [{"sampler": 0, "source": 0}],
        "images": [{"uri": data_uri(b"\x89PNG"), "extras": "pic"}],
        "animations": [{"name": "a", "channels": [
            {"sampler": 0, "target": {"node": 0, "path": "weights"}}],
            "samplers": [{"input": 2, "output": 3, "interpolation": "STEP"}]}],
        "extensions": {
            "KHR_materials_variants": {"variants": [{"name": "v"}]},
            "VENDOR_all": {"blob": {"bufferView": 4}}},
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
             "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5121, "count": 4, "type": "SCALAR"},
            {"bufferView": 2, "componentType": 5126, "count": 2, "type": "SCALAR",
             "min": [0], "max": [1], "name": "times"},
            {"bufferView": 2, "byteOffset": 8, "componentType": 5126, "count": 2,
             "type": "SCALAR"},
            {"componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0],
             "max": [0, 0, 5], "sparse": {"count": 1,
                "indices": {"bufferView": 3, "componentType": 5125},
                "values": {"bufferView": 3, "byteOffset": 4}}}],
        "bufferViews": [
            {"buffer": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 4},
            {"buffer": 0, "byteOffset": 52, "byteLength": 16},
            {"buffer": 0, "byteOffset": 68, "byteLength": 16},
            {"buffer": 0, "byteOffset": 84, "byteLength": 6, "name": "blob"}],
        "buffers": [{"byteLength": 90, "uri": data_uri(&bytes)}]
    })
}

fn read(json: &Value) -> Scene {
    let text = serde_json::to_vec(json).unwrap();
    read_bytes(Format::Gltf, &text, "test").unwrap().scene
}

/// Document and binary chunk of a GLB.
fn parts(path: &Path) -> (Value, Vec<u8>) {
    let bytes = fs::read(path).unwrap();
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let json = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
    (json, bytes.get(28 + length..).unwrap_or_default().to_vec())
}

fn written(scene: &Scene) -> (Value, Vec<u8>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.glb");
    karui_io::write(&path, scene).unwrap();
    parts(&path)
}

#[test]
fn everything_else_comes_out_as_it_went_in() {
    let before = rich();
    let (after, bin) = written(&read(&before));
    for key in [
        "extras",
        "scene",
        "scenes",
        "nodes",
        "cameras",
        "materials",
        "samplers",
        "textures",
        "extensionsUsed",
    ] {
        assert_eq!(after[key], before[key], "{key}");
    }
    assert_eq!(after["asset"]["copyright"], "nobody");
    assert!(
        after["asset"]["generator"]
            .as_str()
            .unwrap()
            .starts_with("karui ")
    );
    assert_eq!(after["images"][0]["extras"], "pic");
    assert_eq!(
        after["animations"][0]["channels"],
        before["animations"][0]["channels"]
    );
    let mesh = &after["meshes"][0];
    assert_eq!(mesh["extras"], before["meshes"][0]["extras"]);
    assert_eq!(mesh["extensions"], before["meshes"][0]["extensions"]);
    assert_eq!(mesh["weights"], json!([0.5]));
    let [points, strip] = [0, 1].map(|p| &mesh["primitives"][p]);
    assert_eq!(
        (&points["mode"], &points["extras"]),
        (&json!(0), &json!("points"))
    );
    let extensions = &before["meshes"][0]["primitives"][1]["extensions"];
    assert_eq!(&strip["extensions"], extensions);
    assert!(strip.get("mode").is_none(), "strips become lists");
    let view = |index: &Value| {
        let view = &after["bufferViews"][index.as_u64().unwrap() as usize];
        let number = |key: &str| view[key].as_u64().unwrap() as usize;
        &bin[number("byteOffset")..][..number("byteLength")]
    };
    assert_eq!(
        view(&after["extensions"]["VENDOR_all"]["blob"]["bufferView"]),
        b"opaque"
    );
    let sampler = &after["animations"][0]["samplers"][0];
    let accessor = |index: &Value| &after["accessors"][index.as_u64().unwrap() as usize];
    assert_eq!(accessor(&sampler["input"])["name"], "times");
    let data = [&sampler["input"], &sampler["output"]].map(|a| view(&accessor(a)["bufferView"]));
    assert_eq!(data.concat(), floats(&[0., 1., 0.25, 0.75]));
    // The sparse morph target, now dense, for points and triangles alike.
    for primitive in [points, strip] {
        let target = accessor(&primitive["targets"][0]["POSITION"]);
        assert_eq!(target["max"][2].as_f64(), Some(5.0));
        let data = view(&target["bufferView"]);
        assert_eq!(data[32..36], 5f32.to_le_bytes());
    }
}

#[test]
fn changes_are_written_over_what_was_there() {
    let mut scene = read(&rich());
    scene.materials[0].roughness = 0.25;
    scene.nodes[1].transform = Transform::default();
    scene.roots = vec![0, 1];
    scene.textures[0].wrap = [Wrap::Clamp, Wrap::Repeat];
    let (after, _) = written(&scene);
    let material = &after["materials"][0];
    assert_eq!(
        material["pbrMetallicRoughness"]["roughnessFactor"],
        json!(0.25)
    );
    assert_eq!(material["pbrMetallicRoughness"]["extras"], "k");
    assert_eq!(material["extensions"]["VENDOR_all"]["shine"], 9);
    assert_eq!(after["nodes"][1], json!({"camera": 0}));
    assert_eq!(after["scenes"][1]["nodes"], json!([0, 1]));
    assert_eq!(after["scenes"][0], json!({"nodes": [1]}));
    assert_eq!(
        after["samplers"][1],
        json!({"minFilter": 9987, "wrapS": 33071, "magFilter": 9729})
    );
}

#[test]
fn levels_of_detail_are_appended() {
    let mut scene = read(&rich());
    let mut coarse = scene.meshes[0].mesh.clone();
    coarse.retain_triangles(|t| t == 0);
    coarse.remove_unreferenced_vertices();
    scene.meshes.push(NamedMesh {
        name: Some("coarse".into()),
        mesh: coarse,
    });
    scene.nodes.push(Node {
        mesh: Some(1),
        ..Node::default()
    });
    scene.nodes[0].lods = Some(LodLinks {
        nodes: vec![2],
        coverage: vec![0.5, 0.01],
    });
    let (after, _) = written(&scene);
    assert_eq!(
        after["nodes"][0]["extensions"]["MSFT_lod"]["ids"],
        json!([2])
    );
    assert_eq!(after["nodes"][0]["extensions"]["VENDOR_all"]["n"], 1);
    assert!(
        after["extensionsUsed"]
            .as_array()
            .unwrap()
            .contains(&json!("MSFT_lod"))
    );
    // The new mesh has what its triangles had where they come from.
    let mesh = &after["meshes"][1];
    assert_eq!(mesh["name"], "coarse");
    assert_eq!(mesh["extras"]["targetNames"], json!(["lift"]));
    assert_eq!(mesh["weights"], json!([0.5]));
    let extensions = &mesh["primitives"][0]["extensions"];
    assert!(extensions["KHR_materials_variants"]["mappings"].is_array());
    assert_eq!(
        mesh["primitives"].as_array().unwrap().len(),
        1,
        "points stay with the original"
    );
    // It morphs with the original.
    let channels = after["animations"][0]["channels"].as_array().unwrap();
    assert_eq!(channels.len(), 2);
    assert_eq!(channels[1]["target"], json!({"node": 2, "path": "weights"}));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lods.glb");
    karui_io::write(&path, &scene).unwrap();
    let again = karui_io::read(&path).unwrap();
    assert_eq!(again.nodes[0].lods, scene.nodes[0].lods);
}

#[test]
fn meshes_without_triangles_leave_no_trace() {
    let mut scene = read(&rich());
    let empty = NamedMesh::default();
    let triangle = TriMesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
    let mesh = NamedMesh {
        name: None,
        mesh: triangle,
    };
    scene.meshes.extend([empty, mesh]);
    for mesh in [1, 2] {
        scene.nodes.push(Node {
            mesh: Some(mesh),
            ..Node::default()
        });
    }
    let (after, _) = written(&scene);
    assert_eq!(after["meshes"].as_array().unwrap().len(), 2);
    assert_eq!(after["nodes"][2], json!({}));
    assert_eq!(after["nodes"][3], json!({"mesh": 1}));
    let (nothing, bin) = written(&Scene::from_mesh(TriMesh::default()));
    assert!(nothing.get("meshes").is_none() && nothing.get("buffers").is_none());
    assert!(bin.is_empty());
}

fn textured() -> Scene {
    let positions = vec![Vec3::ZERO, Vec3::X * 0.1, Vec3::Y, Vec3::ONE];
    let mut mesh = TriMesh::new(positions, vec![[0, 1, 2], [2, 1, 3]]);
    mesh.attributes.uvs = vec![vec![Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::ONE]];
    let range = |first, material| karui::mesh::MaterialRange {
        first,
        count: 1,
        material,
        source: None,
    };
    mesh.ranges = vec![range(0, Some(0)), range(1, None)];
    let mut scene = Scene::from_mesh(mesh);
    scene.images = ["tex/wood 1.png", "../tex/wood 1.png"]
        .iter()
        .map(|uri| Image {
            name: None,
            mime: String::new(),
            data: ImageData::Bytes {
                bytes: Arc::from(format!("\u{89}PNG {uri}").as_bytes()),
                uri: Some((*uri).to_owned()),
            },
        })
        .collect();
    scene.textures = vec![Texture {
        image: Some(0),
        wrap: [Wrap::Mirror; 2],
        nearest: true,
    }];
    scene.materials = vec![Material {
        base_color_texture: Some(TextureRef {
            texture: 0,
            uv_set: 0,
            transform: None,
        }),
        ..Material::default()
    }];
    scene
}

#[test]
fn scenes_from_elsewhere_get_a_fresh_document() {
    let scene = textured();
    let (json, bin) = written(&scene);
    assert_eq!(json["asset"]["version"], "2.0");
    assert_eq!(json["scene"], 0);
    assert_eq!(json["scenes"], json!([{"nodes": [0]}]));
    let primitives = json["meshes"][0]["primitives"].as_array().unwrap();
    assert_eq!(primitives.len(), 2);
    assert_eq!(
        primitives[0]["attributes"], primitives[1]["attributes"],
        "shared vertices"
    );
    let position = primitives[0]["attributes"]["POSITION"].as_u64().unwrap() as usize;
    assert_eq!(json["accessors"][position]["max"], json!([1.0, 1.0, 1.0]));
    let length = json["buffers"][0]["byteLength"].as_u64().unwrap() as usize;
    assert_eq!(length.next_multiple_of(4), bin.len());
    assert_eq!(json["images"][0]["uri"], Value::Null, "embedded");
}

#[test]
fn companions_lie_beside_a_gltf() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out/room.v2.gltf");
    fs::create_dir(folder.path().join("out")).unwrap();
    let scene = textured();
    karui_io::write(&path, &scene).unwrap();
    let json: Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
    assert_eq!(json["buffers"][0]["uri"], "room.v2.bin");
    assert_eq!(json["images"][0]["uri"], "tex/wood%201.png");
    assert_eq!(
        json["images"][1]["uri"], "wood%201.png",
        "never above the folder"
    );
    assert!(folder.path().join("out/tex/wood 1.png").is_file());
    let again = karui_io::read(&path).unwrap();
    assert_eq!(
        again.meshes[0].mesh.positions,
        scene.meshes[0].mesh.positions
    );
    assert_eq!(again.textures, scene.textures);
    assert_eq!(again.images[0].data, scene.images[0].data);
}

#[test]
fn attributes_that_a_primitive_lacked_stay_away() {
    let mut json = rich();
    json["meshes"][0]["primitives"][0]["mode"] = json!(4);
    json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(0);
    let scene = read(&json);
    assert!(scene.meshes[0].mesh.attributes.normals.is_some());
    let (after, _) = written(&scene);
    let primitives = &after["meshes"][0]["primitives"];
    assert!(primitives[0]["attributes"].get("NORMAL").is_some());
    assert!(primitives[1]["attributes"].get("NORMAL").is_none());
    // One that an operation added is written for all.
    let mut scene = read(&rich());
    scene.meshes[0].mesh.attributes.normals = Some(vec![Vec3::Z; 4]);
    let (after, _) = written(&scene);
    assert!(
        after["meshes"][0]["primitives"][1]["attributes"]
            .get("NORMAL")
            .is_some()
    );
}

#[test]
fn files_that_many_name_are_read_once() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.bin"), vec![7; 100_000]).unwrap();
    fs::write(folder.path().join("a.png"), b"\x89PNG").unwrap();
    let path = folder.path().join("a.gltf");
    let json = json!({
        "asset": {"version": "2.0"},
        "buffers": vec![json!({"byteLength": 100_000, "uri": "a.bin"}); 20_000],
        "images": vec![json!({"uri": "a.png"}); 20_000]
    });
    fs::write(&path, serde_json::to_vec(&json).unwrap()).unwrap();
    // 2 GB if each buffer had its own copy.
    let scene = karui_io::read(&path).unwrap();
    let bytes = |i: usize| match &scene.images[i].data {
        ImageData::Bytes { bytes, .. } => Arc::clone(bytes),
        other => unreachable!("{other:?}"),
    };
    assert!(Arc::ptr_eq(&bytes(0), &bytes(19_999)));
}
