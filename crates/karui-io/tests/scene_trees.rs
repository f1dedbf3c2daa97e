//! Node trees of any shape: deep, cyclic, mirrored, empty, not finite.
#![allow(clippy::unwrap_used, reason = "it is a test")]

use karui::{
    Error as GeometryError, Scene,
    geom::{Quat, Vec3},
    lod::{Levels, LodOptions, chain_scene, to_msft_lod},
    mesh::{Node, Placements, Transform, shapes},
};
use karui_io::{ErrorKind, Format, GltfOptions, WriteOptions, read, read_bytes, write_with};
use serde_json::{Value, json};
use std::sync::Arc;

const DEPTH: u32 = 100_000;

fn moved(by: Vec3) -> Transform {
    Transform::Trs {
        translation: by,
        rotation: Quat::IDENTITY,
        scale: Vec3::ONE,
    }
}

/// One chain of nodes, the last of which shows a mesh twice.
fn chain() -> Scene {
    let mut scene = Scene::from_mesh(shapes::icosphere(2));
    let node = |n| Node {
        children: if n + 1 < DEPTH { vec![n + 1] } else { vec![] },
        transform: moved(Vec3::X),
        ..Node::default()
    };
    scene.nodes = (0..DEPTH).map(node).collect();
    let last = scene.nodes.last_mut().unwrap();
    last.mesh = Some(0);
    last.placements = Some(Arc::new(Placements {
        translations: vec![Vec3::ZERO, Vec3::Y * 3.0],
        ..Placements::default()
    }));
    scene
}

#[test]
fn a_hundred_thousand_levels_deep() {
    let folder = tempfile::tempdir().unwrap();
    let scene = chain();
    // A small stack would show any recursion.
    let work = move || {
        for (quantize, name) in [(false, "a.glb"), (true, "b.gltf")] {
            let path = folder.path().join(name);
            let options = WriteOptions {
                gltf: GltfOptions {
                    quantize,
                    meshopt: quantize,
                    ..GltfOptions::default()
                },
                ..WriteOptions::default()
            };
            write_with(&path, &scene, &options).unwrap();
            let again = read(&path).unwrap();
            again.validate().unwrap();
            assert_eq!(again.instances(), scene.instances());
            assert_eq!(again.bounds(), scene.bounds());
            let options = LodOptions {
                levels: Levels::Ratios(vec![0.5]),
                samples: 500,
                ..LodOptions::default()
            };
            let linked = to_msft_lod(&again, &chain_scene(&again, &options).unwrap());
            write_with(&path, &linked.scene, &WriteOptions::default()).unwrap();
            assert_eq!(read(&path).unwrap().instance_count(), 2);
        }
        assert_eq!(scene.into_single_mesh().unwrap().triangles.len(), 2 * 320);
    };
    let thread = std::thread::Builder::new().stack_size(1 << 20).spawn(work);
    thread.unwrap().join().unwrap();
}

fn parse(nodes: &Value) -> karui_io::Result<Scene> {
    let json = json!({"asset": {"version": "2.0"}, "nodes": nodes, "scenes": [{"nodes": [0]}]});
    let bytes = serde_json::to_vec(&json).unwrap();
    read_bytes(Format::Gltf, &bytes, "nodes").map(|l| l.scene)
}

#[test]
fn cycles_are_refused_with_their_node() {
    let mut long: Vec<Value> = (1..=DEPTH)
        .map(|n| json!({"children": [n % DEPTH]}))
        .collect();
    let cases = [
        json!([{"children": [0]}]),
        json!([{"children": [1]}, {"children": [2]}, {"children": [0]}]),
        Value::Array(std::mem::take(&mut long)),
        json!([{}, {"children": [2]}, {"children": [1]}]),
    ];
    for nodes in cases {
        let error = parse(&nodes).unwrap_err();
        let cyclic = GeometryError::BadReference {
            what: "node",
            index: 0,
            target: "node",
            to: 0,
            problem: "is its own ancestor",
        };
        let ErrorKind::Geometry(found) = *error.kind else {
            unreachable!("{error}");
        };
        assert_eq!(
            std::mem::discriminant(&found),
            std::mem::discriminant(&cyclic)
        );
    }
    // Stand-ins may name each other: only one of them is shown.
    let lod = |id: u32| json!({"MSFT_lod": {"ids": [id]}});
    let scene = parse(&json!([{"extensions": lod(1)}, {"extensions": lod(0)}])).unwrap();
    assert_eq!(scene.stand_ins(), [true, true]);
    assert_eq!(scene.instance_count(), 0);
}

#[test]
fn transforms_that_are_not_finite_are_refused() {
    let huge = "[{\"translation\": [1e300, 0, 0]}]";
    let word = "[{\"scale\": [1, \"NaN\", 0]}]";
    for nodes in [huge, word] {
        let nodes: Value = serde_json::from_str(nodes).unwrap();
        assert!(parse(&nodes).is_err(), "{nodes}");
    }
    let mut scene = Scene::from_mesh(shapes::triangle());
    scene.nodes[0].transform = moved(Vec3::new(0.0, f32::NAN, 0.0));
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.glb", "a.obj", "a.ply", "a.stl"] {
        let path = folder.path().join(name);
        let error = write_with(&path, &scene, &WriteOptions::default()).unwrap_err();
        let kind = &*error.kind;
        assert!(
            matches!(kind, ErrorKind::Geometry(GeometryError::NotFinite { .. })),
            "{name}: {error}"
        );
        assert!(!path.exists());
    }
}

#[test]
fn nodes_without_meshes_and_meshes_without_triangles() {
    let mut scene = Scene::from_mesh(shapes::empty());
    scene.nodes[0].placements = Some(Arc::new(Placements {
        translations: vec![Vec3::X; 5],
        ..Placements::default()
    }));
    scene.nodes[0].children = vec![1];
    scene.nodes.push(Node {
        mesh: None,
        placements: scene.nodes[0].placements.clone(),
        ..Node::default()
    });
    assert_eq!((scene.instance_count(), scene.unfolded()), (5, [0, 0]));
    assert!(scene.bounds().is_empty());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    write_with(&path, &scene, &WriteOptions::default()).unwrap();
    let again = read(&path).unwrap();
    // A mesh without triangles is not written; the places are.
    assert_eq!(again.instance_count(), 0);
    assert_eq!(again.nodes[1].placements, scene.nodes[1].placements);
    assert!(again.into_single_mesh().unwrap().triangles.is_empty());
}
