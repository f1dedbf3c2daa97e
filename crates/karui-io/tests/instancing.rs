//! `EXT_mesh_gpu_instancing` in and out.
#![allow(clippy::unwrap_used, reason = "it is a test")]

mod common;

use karui::{
    Error as GeometryError, Scene,
    geom::{Quat, Vec3},
    mesh::{Attribute, AttributeValues, Node, Placements, shapes},
};
use karui_io::{ErrorKind, Format, GltfOptions, WriteOptions, read, read_bytes, write, write_with};
use serde_json::{Value, json};
use std::sync::Arc;

/// A triangle with two instances, all values in one buffer.
fn instanced() -> Value {
    let mut bytes = Vec::new();
    let mut put = |values: &[f32]| bytes.extend(values.iter().flat_map(|f| f.to_le_bytes()));
    put(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    put(&[1.0, 2.0, 3.0, -1.0, -2.0, -3.0]);
    // A quarter turn about z in shorts, half a turn in bytes, scales, ids.
    let half = (32767.0 * 0.5f32.sqrt()).round() as i16;
    for i in [0, 0, half, half, 0, 0, 0, 32767] {
        bytes.extend(i.to_le_bytes());
    }
    bytes.extend([0u8, 0, 127, 0, 0, 0, 0, 127]);
    for f in [1f32, 2.0, 3.0, -1.0, 1.0, 1.0] {
        bytes.extend(f.to_le_bytes());
    }
    bytes.extend([7u8, 0, 0, 0, 9, 0, 0, 0]);
    let hex: String = bytes.iter().map(|b| format!("%{b:02x}")).collect();
    json!({
        "asset": {"version": "2.0"},
        "extensionsUsed": ["EXT_mesh_gpu_instancing", "EXT_instance_features"],
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "extensions": {
            "EXT_mesh_gpu_instancing": {"attributes":
                {"TRANSLATION": 1, "ROTATION": 2, "SCALE": 4, "_FEATURE_ID_0": 5}, "mine": 1},
            "EXT_instance_features": {"featureIds": [{"featureCount": 2, "attribute": 0}]}}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
             "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5126, "count": 2, "type": "VEC3"},
            {"bufferView": 2, "componentType": 5122, "normalized": true, "count": 2,
             "type": "VEC4"},
            {"bufferView": 3, "componentType": 5120, "normalized": true, "count": 2,
             "type": "VEC4"},
            {"bufferView": 4, "componentType": 5126, "count": 2, "type": "VEC3"},
            {"bufferView": 5, "componentType": 5121, "count": 2, "type": "SCALAR"}],
        "bufferViews": [
            {"buffer": 0, "byteLength": 36},
            {"buffer": 0, "byteOffset": 36, "byteLength": 24},
            {"buffer": 0, "byteOffset": 60, "byteLength": 16},
            {"buffer": 0, "byteOffset": 76, "byteLength": 8},
            {"buffer": 0, "byteOffset": 84, "byteLength": 24},
            {"buffer": 0, "byteOffset": 108, "byteLength": 8, "byteStride": 4}],
        "buffers": [{"byteLength": 116, "uri": format!("data:application/octet-stream,{hex}")}]
    })
}

fn parse(json: &Value) -> karui_io::Result<Scene> {
    let bytes = serde_json::to_vec(json).unwrap();
    read_bytes(Format::Gltf, &bytes, "instanced").map(|l| l.scene)
}

fn attributes(json: &mut Value) -> &mut Value {
    &mut json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]
}

fn placements(scene: &Scene) -> &Placements {
    scene.nodes[0].placements.as_ref().unwrap()
}

fn written(scene: &Scene, options: GltfOptions) -> (Scene, Value) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gltf");
    let options = WriteOptions {
        gltf: options,
        ..WriteOptions::default()
    };
    write_with(&path, scene, &options).unwrap();
    let json = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    (read(&path).unwrap(), json)
}

#[test]
fn all_attributes_are_read() {
    let scene = parse(&instanced()).unwrap();
    let found = placements(&scene);
    assert_eq!(found.translations[1], Vec3::new(-1.0, -2.0, -3.0));
    assert_eq!(found.scales.as_ref().unwrap()[0], Vec3::new(1.0, 2.0, 3.0));
    let turn = found.rotations.as_ref().unwrap()[0];
    assert!(turn.is_normalized() && turn.angle_between(Quat::from_rotation_z(1.5707964)) < 1e-3);
    assert_eq!(found.attributes[0].name, "_FEATURE_ID_0");
    assert_eq!(found.attributes[0].values, AttributeValues::U8(vec![7, 9]));
    assert_eq!(scene.instance_count(), 2);
    let mesh = scene.into_single_mesh().unwrap();
    // Scaled, turned by 90 degrees about z, moved.
    let expected = Vec3::new(1.0, 3.0, 3.0);
    assert!(
        mesh.positions[1].distance(expected) < 1e-4,
        "{}",
        mesh.positions[1]
    );
}

#[test]
fn what_is_missing_is_the_default_and_bytes_turn_too() {
    let mut json = instanced();
    *attributes(&mut json) = json!({"ROTATION": 3});
    let scene = parse(&json).unwrap();
    let found = placements(&scene);
    assert_eq!(found.translations, [Vec3::ZERO; 2]);
    assert_eq!(
        found.rotations.as_ref().unwrap()[0],
        Quat::from_xyzw(0.0, 0.0, 1.0, 0.0)
    );
    assert_eq!(found.scales, None);
    for none in [json!({}), Value::Null] {
        *attributes(&mut json) = none;
        let scene = parse(&json).unwrap();
        assert_eq!(
            (scene.instance_count(), &scene.nodes[0].placements),
            (1, &None)
        );
    }
}

#[test]
fn what_is_unchanged_stays_and_follows_its_mesh() {
    let mut scene = parse(&instanced()).unwrap();
    let (again, json) = written(&scene, GltfOptions::default());
    assert_eq!(placements(&again), placements(&scene));
    let extension = &json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"];
    assert_eq!(extension["mine"], 1);
    let rotation = extension["attributes"]["ROTATION"].as_u64().unwrap() as usize;
    assert_eq!(json["accessors"][rotation]["componentType"], 5122);
    assert!(json.get("extensionsRequired").is_none());
    // The mesh moves to a child, as levels of detail make it.
    let moved = Node {
        mesh: scene.nodes[0].mesh.take(),
        placements: scene.nodes[0].placements.take(),
        ..Node::default()
    };
    scene.nodes[0].children = vec![1, 2];
    scene.nodes.extend([moved.clone(), moved]);
    let (again, json) = written(&scene, GltfOptions::default());
    assert_eq!(again.instance_count(), 4);
    assert!(json["nodes"][0].get("extensions").is_none());
    for n in [1, 2] {
        let extensions = &json["nodes"][n]["extensions"];
        assert_eq!(extensions["EXT_mesh_gpu_instancing"]["mine"], 1);
        assert_eq!(
            extensions["EXT_instance_features"]["featureIds"][0]["attribute"],
            0
        );
    }
}

#[test]
fn changed_placements_are_written() {
    let mut scene = parse(&instanced()).unwrap();
    let shared = scene.nodes[0].placements.as_mut().unwrap();
    Arc::make_mut(shared).translations[0] = Vec3::splat(5.0);
    let (again, json) = written(&scene, GltfOptions::default());
    assert_eq!(
        placements(&again).translations,
        placements(&scene).translations
    );
    assert_eq!(placements(&again).attributes, placements(&scene).attributes);
    let extensions = &json["nodes"][0]["extensions"];
    assert!(extensions.get("EXT_instance_features").is_some());
    scene.nodes[0].placements = None;
    let (again, json) = written(&scene, GltfOptions::default());
    assert_eq!(again.instance_count(), 1);
    assert!(json["nodes"][0].get("extensions").is_none());
}

fn forest(count: usize) -> Scene {
    let mut scene = Scene::from_mesh(shapes::icosphere(1));
    let place = |i: usize| Vec3::new((i % 100) as f32, 0.0, (i / 100) as f32);
    let ids = (0..count as u32).collect();
    scene.nodes[0].placements = Some(Arc::new(Placements {
        translations: (0..count).map(place).collect(),
        rotations: Some(vec![Quat::IDENTITY; count]),
        scales: Some((0..count).map(|i| Vec3::splat(1.0 + i as f32)).collect()),
        attributes: vec![Attribute {
            name: "_FEATURE_ID_0".into(),
            components: 1,
            values: AttributeValues::U32(ids),
        }],
    }));
    scene
}

#[test]
fn new_placements_round_trip_and_are_small() {
    let scene = forest(1000);
    for (quantize, meshopt) in [(false, false), (true, false), (true, true)] {
        let (again, json) = written(
            &scene,
            GltfOptions {
                quantize,
                meshopt,
                ..GltfOptions::default()
            },
        );
        let (before, after) = (placements(&scene), placements(&again));
        assert_eq!(before.translations, after.translations);
        assert_eq!((&before.scales, &after.rotations), (&after.scales, &None));
        let ids = (0..1000).collect::<Vec<u16>>();
        assert_eq!(after.attributes[0].values, AttributeValues::U16(ids));
        assert!(scene.bounds().min.distance(again.bounds().min) < 1e-2);
        let required = json["extensionsRequired"].as_array().unwrap();
        assert!(required.contains(&json!("EXT_mesh_gpu_instancing")));
    }
    // Nodes that share placements share their accessors.
    let mut twice = scene.clone();
    twice.nodes.push(scene.nodes[0].clone());
    twice.roots.push(1);
    let (again, json) = written(&twice, GltfOptions::default());
    assert_eq!(again.instance_count(), 2000);
    let extension = |n: usize| &json["nodes"][n]["extensions"];
    assert_eq!(extension(0), extension(1));
    let shared = again.nodes.iter().map(|n| n.placements.as_ref().unwrap());
    let shared: Vec<_> = shared.collect();
    assert!(Arc::ptr_eq(shared[0], shared[1]));
}

#[test]
fn placements_without_any_and_at_one_place() {
    let mut scene = forest(3);
    scene.nodes[0].placements = Some(Arc::default());
    let (again, _) = written(&scene, GltfOptions::default());
    assert_eq!(again.instance_count(), 0);
    scene.nodes[0].placements = Some(Arc::new(Placements {
        translations: vec![Vec3::ZERO; 3],
        ..Placements::default()
    }));
    let (again, _) = written(&scene, GltfOptions::default());
    assert_eq!(again.instance_count(), 3);
}

#[test]
fn damaged_instances_are_refused() {
    let mut cases: Vec<(Value, &str)> = Vec::new();
    let mut with = |change: &dyn Fn(&mut Value), message| {
        let mut json = instanced();
        change(&mut json);
        cases.push((json, message));
    };
    with(
        &|j| j["accessors"][1]["count"] = json!(1),
        "expected 1 elements",
    );
    with(
        &|j| j["accessors"][1]["count"] = json!(1u64 << 40),
        "a buffer view of 24",
    );
    with(
        &|j| j["accessors"][5]["count"] = json!(3),
        "a buffer view of 8",
    );
    with(&|j| attributes(j)["SCALE"] = json!(99), "99");
    with(&|j| attributes(j)["SCALE"] = json!("x"), "index");
    with(&|j| attributes(j)["SCALE"] = json!(5), "VEC3");
    with(&|j| attributes(j)["ROTATION"] = json!(1), "VEC4");
    with(
        &|j| j["accessors"][2]["normalized"] = json!(false),
        "normalised",
    );
    for (json, message) in cases {
        let error = parse(&json).unwrap_err().to_string();
        assert!(error.contains(message), "{error}\nexpected: {message}");
    }
    let mut json = instanced();
    // Minus one in all bits is no number as a float.
    json["accessors"][4]["bufferView"] = json!(6);
    let all_ones = format!("data:application/octet-stream,{}", "%ff".repeat(24));
    json["bufferViews"]
        .as_array_mut()
        .unwrap()
        .push(json!({"buffer": 1, "byteLength": 24}));
    json["buffers"]
        .as_array_mut()
        .unwrap()
        .push(json!({"byteLength": 24, "uri": all_ones}));
    let error = parse(&json).unwrap_err();
    assert!(
        matches!(
            &*error.kind,
            ErrorKind::Geometry(GeometryError::NotFinite { .. })
        ),
        "{error}"
    );
}

/// Zero-filled accessors of a million placements each, on a hundred nodes.
#[test]
fn a_small_file_cannot_place_millions() {
    let mut json = instanced();
    let accessor = json!({"componentType": 5126, "count": 1_000_000, "type": "VEC3"});
    json["accessors"].as_array_mut().unwrap().push(accessor);
    *attributes(&mut json) = json!({"TRANSLATION": 6});
    let node = json["nodes"][0].clone();
    json["nodes"] = vec![node; 100].into();
    json["scenes"][0]["nodes"] = (0..100).collect();
    let error = parse(&json).unwrap_err();
    assert!(
        matches!(&*error.kind, ErrorKind::TooLarge { .. }),
        "{error}"
    );
}

#[test]
fn formats_without_instances_copy_or_refuse() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.obj", "a.ply", "a.stl"] {
        let path = folder.path().join(name);
        write(&path, &forest(50)).unwrap();
        let again = read(&path).unwrap();
        assert_eq!(again.triangle_count(), 50 * 80, "{name}");
        let error = write(folder.path().join("b").join(name), &forest(4_000_000)).unwrap_err();
        assert!(
            matches!(
                &*error.kind,
                ErrorKind::Geometry(GeometryError::Unfolds { .. })
            ),
            "{error}"
        );
    }
}

#[test]
fn the_sample_of_cesium_is_read() {
    let path = "scenes/3d-tiles-samples/glTF/GpuInstancesMetadata/GpuInstancesMetadata.gltf";
    let Some(path) = common::models().map(|m| m.join(path)) else {
        return;
    };
    let scene = read(&path).unwrap();
    assert!(scene.instance_count() > 1);
    let (again, json) = written(&scene, GltfOptions::default());
    assert_eq!(scene.instances(), again.instances());
    let node = json["nodes"].as_array().unwrap().iter();
    let mut extensions = node.filter_map(|n| n.get("extensions"));
    assert!(extensions.any(|e| e.get("EXT_instance_features").is_some()));
}
