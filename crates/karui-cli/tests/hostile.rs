//! Hostile files: a typed error, exit code 2, no output, within one second of
//! processor time and 200 MB of address space.
#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::{Folder, Ran};
use flate2::{Compression, write::GzEncoder};
use karui::Scene;
use karui::mesh::shapes;
use serde_json::{Value, json};
use std::io::Write as _;

type Files = Vec<(String, Vec<u8>)>;

#[test]
fn every_hostile_file_is_refused() {
    let files = [obj(), off(), ply(), stl(), gz(), glb(), gltf()].concat();
    assert!(files.len() >= 60, "{}", files.len());
    let mut complaints = Vec::new();
    for (name, content) in &files {
        let inside = Folder::new();
        inside.write(name, content);
        let before = inside.files();
        let ran = limited(&inside, &format!("simplify {name} -o out.glb --ratio 0.5"));
        let typed =
            ran.err.lines().any(|l| l.starts_with("error: ")) && !ran.err.contains("panicked");
        if ran.code != Some(2) || !typed || inside.files() != before {
            complaints.push(format!("{name}: {:?} {}", ran.code, ran.err));
        }
    }
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

/// Runs the binary with little memory and time.
fn limited(folder: &Folder, args: &str) -> Ran {
    let script = format!("ulimit -v 200000 -t 1; exec \"$0\" {args} --threads 1");
    let output = std::process::Command::new("bash")
        .args(["-c", &script, env!("CARGO_BIN_EXE_karui")])
        .env("MALLOC_ARENA_MAX", "1")
        .current_dir(folder.path("."))
        .output();
    output.unwrap().into()
}

fn texts(extension: &str, list: &[(&str, &str)]) -> Files {
    let file = |&(name, text): &(&str, &str)| (format!("{name}.{extension}"), text.into());
    list.iter().map(file).collect()
}

fn obj() -> Files {
    let v = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let with = |face: &str| format!("{v}{face}\n");
    let faces = [
        ("zero", "f 0 1 2"),
        ("beyond", "f 1 2 4"),
        ("before", "f -4 -1 -2"),
        ("overflow31", "f 1 2 2147483649"),
        ("overflow64", "f 1 2 99999999999999999999999"),
        ("word", "f 1 2 x"),
        ("texture", "f 1/9 2/9 3/9"),
        ("normal", "f 1//9 2//9 3//9"),
    ];
    let mut files: Files = (faces.iter())
        .map(|(name, face)| (format!("{name}.obj"), with(face).into()))
        .collect();
    files.extend(texts(
        "obj",
        &[
            ("nan", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
            ("inf", "v 0 0 0\nv inf 0 0\nv 0 1 0\nf 1 2 3\n"),
            ("huge", "v 0 0 0\nv 1e999 0 0\nv 0 1 0\nf 1 2 3\n"),
            ("two", "v 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
            ("empty", ""),
            ("lines", "v 0 0 0\nv 1 0 0\nl 1 2\n"),
        ],
    ));
    files.push(("binary.obj".into(), (0..=255).cycle().take(5000).collect()));
    files
}

fn off() -> Files {
    texts(
        "off",
        &[
            ("counts", "OFF\n2147483648 2147483648 0\n0 0 0\n"),
            ("negative", "OFF\n-3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
            ("beyond", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
            (
                "polygon",
                "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4000000000 0 1 2\n",
            ),
            ("nan", "OFF\n3 1 0\n0 0 nan\n1 0 0\n0 1 0\n3 0 1 2\n"),
            ("early", "OFF\n3 1 0\n0 0 0\n1 0"),
            ("head", "OFF\n3"),
        ],
    )
}

const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
    property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
    0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

fn ply() -> Files {
    let changed = |name: &str, from: &str, to: &str| {
        assert!(PLY.contains(from), "{from}");
        (
            format!("{name}.ply"),
            PLY.replacen(from, to, 1).into_bytes(),
        )
    };
    let mut files = vec![
        changed("count31", "vertex 3", "vertex 2147483648"),
        changed("count64", "vertex 3", "vertex 18446744073709551615"),
        changed("faces", "face 1", "face 2147483648"),
        changed("minus", "vertex 3", "vertex -3"),
        changed("type", "float x", "quaternion x"),
        changed("format", "ascii", "utf8"),
        changed("beyond", "3 0 1 2", "3 0 1 3"),
        changed("below", "3 0 1 2", "3 0 1 -2"),
        changed("corners", "3 0 1 2", "255 0 1 2"),
        changed("nan", "0 1 0\n", "0 nan 0\n"),
        changed("word", "0 1 0\n", "0 x 0\n"),
        changed("nolist", "list uchar int", "list float int"),
    ];
    // Cut off after every line of the header and of the content but the last.
    let ends = PLY.match_indices('\n').map(|(i, _)| i);
    let ends: Vec<usize> = ends.take(PLY.lines().count() - 1).collect();
    files.extend(
        ends.iter()
            .map(|&end| (format!("cut{end}.ply"), PLY[..end].into())),
    );
    let binary = written("ball.ply", &shapes::icosphere(1));
    let body = binary
        .windows(11)
        .position(|w| w == b"end_header\n")
        .unwrap()
        + 11;
    for cut in [
        body,
        body + 1,
        body + 100,
        binary.len() - 13,
        binary.len() - 1,
    ] {
        files.push((format!("binary{cut}.ply"), binary[..cut].to_vec()));
    }
    files
}

fn stl() -> Files {
    let binary = written("ball.stl", &shapes::icosphere(1));
    let mut files: Files = [3, 79, 83, 84, 100, binary.len() - 1]
        .map(|cut| (format!("cut{cut}.stl"), binary[..cut].to_vec()))
        .into();
    let mut count = binary.clone();
    count[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    files.push(("count.stl".into(), count));
    let mut nan = binary;
    nan[84 + 12..84 + 16].copy_from_slice(&f32::NAN.to_le_bytes());
    files.push(("nan.stl".into(), nan));
    let facet = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n";
    files.push(("early.stl".into(), facet.into()));
    files
}

/// The bytes a mesh is written as.
fn written(name: &str, mesh: &karui::TriMesh) -> Vec<u8> {
    let folder = Folder::new();
    folder.scene(name, &Scene::from_mesh(mesh.clone()));
    folder.read(name)
}

fn gz() -> Files {
    let good = written("ball.ply.gz", &shapes::icosphere(2));
    let mut flipped = good.clone();
    let middle = flipped.len() / 2;
    flipped[middle] ^= 0x55;
    let mut bomb = GzEncoder::new(Vec::new(), Compression::best());
    bomb.write_all(b"OFF\n3 1 0\n").unwrap();
    let zeros = vec![b' '; 1 << 20];
    (0..100).for_each(|_| bomb.write_all(&zeros).unwrap());
    vec![
        ("cut.ply.gz".into(), good[..middle].to_vec()),
        ("head.ply.gz".into(), good[..9].to_vec()),
        ("tail.ply.gz".into(), good[..good.len() - 4].to_vec()),
        ("flipped.ply.gz".into(), flipped),
        ("empty.ply.gz".into(), Vec::new()),
        ("plain.ply.gz".into(), PLY.into()),
        ("bomb.off.gz".into(), bomb.finish().unwrap()),
    ]
}

fn glb() -> Files {
    let good = written("ball.glb", &shapes::icosphere(1));
    let json_end = 20 + u32::from_le_bytes(good[12..16].try_into().unwrap()) as usize;
    let cuts = [
        0,
        3,
        4,
        8,
        12,
        16,
        20,
        30,
        json_end,
        json_end + 4,
        json_end + 8,
        good.len() - 1,
    ];
    let mut files: Files = cuts
        .map(|cut| (format!("cut{cut}.glb"), good[..cut].to_vec()))
        .into();
    let mut patch = |name: &str, at: usize, bytes: &[u8]| {
        let mut bad = good.clone();
        bad[at..at + bytes.len()].copy_from_slice(bytes);
        files.push((format!("{name}.glb"), bad));
    };
    patch("magic", 0, b"glTG");
    patch("version", 4, &[9, 0, 0, 0]);
    patch("length", 8, &[0xff; 4]);
    patch("chunk", 12, &[0xff; 4]);
    patch("kind", 16, b"XXXX");
    patch("bin", json_end, &[0xff; 4]);
    patch("json", 20, b"[[[[[[[[");
    files
}

/// A triangle in JSON, its buffer embedded: 36 bytes of positions, 3 of indices.
fn triangle() -> Value {
    let buffer = "data:application/octet-stream;base64,\
        AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAEC";
    json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" },
            { "bufferView": 1, "componentType": 5121, "count": 3, "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": 36 },
            { "buffer": 0, "byteOffset": 36, "byteLength": 3 },
        ],
        "buffers": [{ "byteLength": 39, "uri": buffer }],
    })
}

fn gltf() -> Files {
    let sound = Folder::new();
    sound.write("good.gltf", triangle().to_string());
    sound.ok("info good.gltf");
    let cases: &[(&str, &str, Value)] = &[
        ("count31", "/accessors/0/count", json!(2_147_483_648u64)),
        ("count64", "/accessors/0/count", json!(u64::MAX)),
        ("minus", "/accessors/0/count", json!(-1)),
        ("zero", "/accessors/0/count", json!(0)),
        ("component", "/accessors/0/componentType", json!(9999)),
        ("shape", "/accessors/0/type", json!("MAT9")),
        ("floats", "/accessors/1/componentType", json!(5126)),
        ("view", "/accessors/0/bufferView", json!(7)),
        (
            "offset",
            "/bufferViews/1/byteOffset",
            json!(4_000_000_000u64),
        ),
        ("length", "/bufferViews/0/byteLength", json!(u64::MAX)),
        ("buffer", "/bufferViews/0/buffer", json!(3)),
        ("bytes", "/buffers/0/byteLength", json!(1u64 << 40)),
        ("base64", "/buffers/0/uri", json!("data:;base64,@@@@")),
        ("missing", "/buffers/0/uri", json!("nosuch.bin")),
        ("outside", "/buffers/0/uri", json!("../../../../etc/passwd")),
        (
            "escaped",
            "/buffers/0/uri",
            json!("%2e%2e/%2e%2e/etc/passwd"),
        ),
        ("absolute", "/buffers/0/uri", json!("/etc/passwd")),
        ("scheme", "/buffers/0/uri", json!("file:///etc/passwd")),
        (
            "position",
            "/meshes/0/primitives/0/attributes/POSITION",
            json!(9),
        ),
        ("mesh", "/nodes/0/mesh", json!(9)),
        ("root", "/scenes/0/nodes/0", json!(9)),
        ("version", "/asset/version", json!("1.0")),
        ("noasset", "/asset", json!(null)),
        ("meshes", "/meshes", json!(17)),
        // Two nodes that are each other's children.
        (
            "cycle",
            "/nodes",
            json!([{ "mesh": 0, "children": [1] }, { "children": [0] }]),
        ),
        ("self", "/nodes", json!([{ "mesh": 0, "children": [0] }])),
        // A few bytes that stand for gigabytes.
        (
            "sparse",
            "/accessors/0",
            json!({
                "componentType": 5126, "count": 2_000_000_000u64, "type": "VEC3",
                "sparse": {
                    "count": 1,
                    "indices": { "bufferView": 1, "componentType": 5121 },
                    "values": { "bufferView": 0 },
                },
            }),
        ),
    ];
    let mut files: Files = (cases.iter())
        .map(|(name, pointer, value)| {
            let mut bad = triangle();
            let (parent, key) = pointer.rsplit_once('/').unwrap();
            match bad.pointer_mut(parent).unwrap() {
                Value::Object(object) => drop(object.insert(key.into(), value.clone())),
                Value::Array(array) => array[key.parse::<usize>().unwrap()] = value.clone(),
                other => panic!("{other}"),
            }
            (format!("{name}.gltf"), bad.to_string().into_bytes())
        })
        .collect();
    let text = triangle().to_string();
    files.push(("half.gltf".into(), text[..text.len() / 2].into()));
    files.push(("deep.gltf".into(), "[".repeat(100_000).into()));
    let nan = text.replace("AAAAAAAAAAAAAAAAAACAPw", "AADAfwAAAAAAAAAAAACAPw");
    files.push(("nan.gltf".into(), nan.into()));
    let index = text.replace("AAEC", "AAEJ");
    files.push(("index.gltf".into(), index.into()));
    files
}

/// Legal, but a million of them.
#[test]
fn a_million_materials_neither_panic_nor_fill_the_memory() {
    let folder = Folder::new();
    let materials = vec!["{}"; 1_000_000].join(",");
    let text = triangle().to_string();
    let many = text.replacen('{', &format!("{{\"materials\":[{materials}],"), 1);
    folder.write("many.gltf", many);
    let script = "ulimit -v 2000000; exec \"$0\" info many.gltf --json --threads 1";
    let output = std::process::Command::new("bash")
        .args(["-c", script, env!("CARGO_BIN_EXE_karui")])
        .env("MALLOC_ARENA_MAX", "1")
        .current_dir(folder.path("."))
        .output();
    let ran: Ran = output.unwrap().into();
    assert!(matches!(ran.code, Some(0 | 2)), "{ran:?}");
}
