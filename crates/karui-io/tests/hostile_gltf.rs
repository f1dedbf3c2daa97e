//! Damaged and malicious glTF: every file gives a typed error, never a
//! panic.
#![allow(clippy::unwrap_used, reason = "it is a test")]

use karui_io::{Error, ErrorKind, Format, Place, read_bytes};
use serde_json::{Value, json};

fn refused(format: Format, bytes: &[u8]) -> Error {
    read_bytes(format, bytes, "hostile").unwrap_err()
}

/// The error for a document, with its message.
fn error_of(json: &Value) -> (ErrorKind, String) {
    let error = refused(Format::Gltf, &serde_json::to_vec(json).unwrap());
    let message = error.to_string();
    (*error.kind, message)
}

/// A document that is read without error: one triangle in a data URI.
fn triangle() -> Value {
    let positions = [0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let mut bytes: Vec<u8> = positions.iter().flat_map(|f| f.to_le_bytes()).collect();
    bytes.extend([0u16, 1, 2, 0].iter().flat_map(|i| i.to_le_bytes()));
    json!({
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
             "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}],
        "bufferViews": [
            {"buffer": 0, "byteLength": 36},
            {"buffer": 0, "byteOffset": 36, "byteLength": 6}],
        "buffers": [{"byteLength": 44, "uri": data_uri(&bytes)}]
    })
}

fn data_uri(bytes: &[u8]) -> String {
    let hex = |b: &u8| format!("%{b:02x}");
    let text: String = bytes.iter().map(hex).collect();
    format!("data:application/octet-stream,{text}")
}

/// The triangle with something replaced or added.
fn with(pointer: &str, value: Value) -> Value {
    let mut json = triangle();
    let (parent, key) = pointer.rsplit_once('/').unwrap();
    let parent = json.pointer_mut(parent).unwrap();
    match parent {
        Value::Array(items) => {
            let index: usize = key.parse().unwrap();
            if index == items.len() {
                items.push(value);
            } else {
                items[index] = value;
            }
        }
        parent => parent[key] = value,
    }
    json
}

fn glb(json: &Value, bin: &[u8]) -> Vec<u8> {
    let mut text = serde_json::to_vec(json).unwrap();
    text.resize(text.len().next_multiple_of(4), b' ');
    let length = 12 + 8 + text.len() + 8 + bin.len();
    let mut glb = b"glTF".to_vec();
    glb.extend(2u32.to_le_bytes());
    glb.extend((length as u32).to_le_bytes());
    glb.extend((text.len() as u32).to_le_bytes());
    glb.extend(b"JSON");
    glb.extend(text);
    glb.extend((bin.len() as u32).to_le_bytes());
    glb.extend(b"BIN\0");
    glb.extend(bin);
    glb
}

/// The triangle as GLB.
fn triangle_glb() -> Vec<u8> {
    let mut json = triangle();
    json["buffers"][0].as_object_mut().unwrap().remove("uri");
    let mut bin = vec![0; 36];
    bin[12..16].copy_from_slice(&1f32.to_le_bytes());
    bin[28..32].copy_from_slice(&1f32.to_le_bytes());
    bin.extend([0, 0, 1, 0, 2, 0, 0, 0]);
    glb(&json, &bin)
}

#[test]
fn the_untouched_triangle_is_read() {
    for (format, bytes) in [
        (Format::Gltf, serde_json::to_vec(&triangle()).unwrap()),
        (Format::Glb, triangle_glb()),
    ] {
        let scene = read_bytes(format, &bytes, "fine").unwrap().scene;
        assert_eq!(scene.meshes[0].mesh.triangles, [[0, 1, 2]]);
        assert_eq!(scene.meshes[0].mesh.positions[1].x, 1.0);
    }
}

#[test]
fn every_truncation_of_a_glb() {
    let glb = triangle_glb();
    for end in 0..glb.len() {
        refused(Format::Glb, &glb[..end]);
        if end >= 24 {
            // The same with a header that agrees with the length.
            let mut short = glb[..end].to_vec();
            short[8..12].copy_from_slice(&(end as u32).to_le_bytes());
            refused(Format::Glb, &short);
        }
    }
}

#[test]
fn lying_glb_headers() {
    let damaged = |offset: usize, word: u32| {
        let mut glb = triangle_glb();
        glb[offset..offset + 4].copy_from_slice(&word.to_le_bytes());
        refused(Format::Glb, &glb)
    };
    let json_length = u32::from_le_bytes(triangle_glb()[12..16].try_into().unwrap()) as usize;
    let bin_header = 20 + json_length;
    assert!(
        matches!(*damaged(4, 1).kind, ErrorKind::Unsupported(_)),
        "version 1"
    );
    assert!(
        matches!(*damaged(4, 3).kind, ErrorKind::Unsupported(_)),
        "version 3"
    );
    for offset in [8, 12, bin_header] {
        let error = damaged(offset, u32::MAX);
        assert!(
            matches!(*error.kind, ErrorKind::Truncated { .. }),
            "{error}"
        );
    }
    for (offset, word) in [(8, 0), (8, 19), (12, 0), (16, 0x004e_4942), (bin_header, 0)] {
        damaged(offset, word);
    }
    // Another first chunk, no BIN chunk.
    damaged(bin_header + 4, 0x1234_5678);
    let mut magic = triangle_glb();
    magic[0] = b'h';
    refused(Format::Glb, &magic);
}

#[test]
fn every_truncation_of_the_json() {
    let text = serde_json::to_vec(&triangle()).unwrap();
    for end in 0..text.len() {
        let error = refused(Format::Gltf, &text[..end]);
        assert!(matches!(error.place, Place::Line(_)), "{error}");
    }
}

#[test]
fn not_a_document() {
    for text in [
        "null",
        "[]",
        "3",
        "\"x\"",
        "{}",
        r#"{"asset": {}}"#,
        "{\"asset\": 1}",
        "\u{0}",
    ] {
        refused(Format::Gltf, text.as_bytes());
    }
    let (kind, _) = error_of(&with("/asset/version", json!("1.0")));
    assert!(matches!(kind, ErrorKind::Unsupported(_)));
    let (kind, _) = error_of(&with("/asset/minVersion", json!("3.0")));
    assert!(matches!(kind, ErrorKind::Unsupported(_)));
}

#[test]
fn deep_nesting() {
    for open in ["[", "{\"a\":"] {
        let deep = open.repeat(1_000_000);
        let text = format!(r#"{{"asset":{{"version":"2.0"}},"extras":{deep}"#);
        refused(Format::Gltf, text.as_bytes());
    }
}

#[test]
fn a_million_elements() {
    for (key, element) in [
        ("materials", "{}"),
        ("materials", r#"{"name":"m","pbrMetallicRoughness":{}}"#),
        ("textures", "{}"),
        ("images", r#"{"uri":"x"}"#),
        ("animations", "{}"),
        ("buffers", r#"{"byteLength":1}"#),
    ] {
        let list = vec![element; 1_000_000].join(",");
        let text = format!(r#"{{"asset":{{"version":"2.0"}},"{key}":[{list}]}}"#);
        let error = refused(Format::Gltf, text.as_bytes());
        assert!(
            matches!(
                *error.kind,
                ErrorKind::TooLarge {
                    found: 1_000_000,
                    ..
                }
            ),
            "{error}"
        );
    }
}

#[test]
fn references_that_lead_nowhere() {
    let cases = [
        ("/scene", json!(1), "/scene"),
        ("/scenes/0/nodes", json!([1]), "/scenes/0/nodes/0"),
        ("/nodes/0/mesh", json!(1), "/nodes/0/mesh"),
        ("/nodes/0/skin", json!(0), "/nodes/0/skin"),
        ("/nodes/0/children", json!([7]), "/nodes/0/children/0"),
        (
            "/nodes/0/extensions",
            json!({"MSFT_lod": {"ids": [4]}}),
            "/nodes/0/extensions/MSFT_lod/ids/0",
        ),
        (
            "/meshes/0/primitives/0/attributes",
            json!({"POSITION": 9}),
            "/meshes/0/primitives/0/attributes/POSITION",
        ),
        (
            "/meshes/0/primitives/0/indices",
            json!(2),
            "/meshes/0/primitives/0/indices",
        ),
        (
            "/meshes/0/primitives/0/material",
            json!(0),
            "/meshes/0/primitives/0/material",
        ),
        (
            "/meshes/0/primitives/0/targets",
            json!([{"POSITION": 5}]),
            "/meshes/0/primitives/0/targets/0/POSITION",
        ),
        (
            "/accessors/0/bufferView",
            json!(2),
            "/accessors/0/bufferView",
        ),
        ("/bufferViews/0/buffer", json!(1), "/bufferViews/0/buffer"),
        ("/textures", json!([{"source": 0}]), "/textures/0/source"),
        ("/textures", json!([{"sampler": 0}]), "/textures/0/sampler"),
        (
            "/images",
            json!([{"bufferView": 2}]),
            "/images/0/bufferView",
        ),
        (
            "/materials",
            json!([{"normalTexture": {"index": 0}}]),
            "/materials/0/normalTexture/index",
        ),
        (
            "/skins",
            json!([{"joints": [0], "inverseBindMatrices": 2}]),
            "/skins/0/inverseBindMatrices",
        ),
        (
            "/animations",
            json!([{"samplers": [{"input": 0, "output": 2}], "channels": []}]),
            "/animations/0/samplers/0/output",
        ),
    ];
    for (pointer, value, place) in cases {
        let (kind, message) = error_of(&with(pointer, value));
        assert!(
            matches!(kind, ErrorKind::IndexOutOfRange { .. }),
            "{message}"
        );
        assert!(
            message.contains(&format!("{place}:")),
            "{message} at {place}"
        );
    }
}

#[test]
fn numbers_that_are_none() {
    let cases = [
        ("/nodes/0/mesh", json!(-1)),
        ("/nodes/0/mesh", json!(0.5)),
        ("/nodes/0/mesh", json!("0")),
        ("/nodes/0/mesh", json!(1e30)),
        ("/nodes/0/mesh", json!(u64::MAX)),
        ("/nodes/0/translation", json!([1, 2])),
        ("/nodes/0/translation", json!([1, 2, "x"])),
        ("/nodes/0/matrix", json!([1])),
        ("/nodes/0/scale", json!([1, 1, 1e300])),
        ("/accessors/0/count", json!(null)),
        ("/accessors/0/componentType", json!(5124)),
        ("/accessors/0/type", json!("VEC5")),
        ("/bufferViews/0/byteLength", json!(-36)),
        ("/buffers/0/byteLength", json!({})),
        ("/nodes", json!({"0": {}})),
        ("/meshes/0/primitives", json!(3)),
        ("/scenes/0/nodes", json!([[0]])),
    ];
    for (pointer, value) in cases {
        error_of(&with(pointer, value));
    }
}

#[test]
fn zero_and_huge_counts() {
    let (_, message) = error_of(&with("/accessors/0/count", json!(0)));
    assert!(message.contains("/accessors/0"), "{message}");
    for count in [4u64, 1 << 31, 1 << 32, 1 << 61, u64::MAX] {
        let (kind, message) = error_of(&with("/accessors/0/count", json!(count)));
        assert!(
            matches!(kind, ErrorKind::Truncated { .. } | ErrorKind::Syntax { .. }),
            "{message}"
        );
    }
    // Offsets and lengths whose sums overflow.
    for key in ["byteOffset", "byteLength"] {
        error_of(&with(&format!("/bufferViews/0/{key}"), json!(u64::MAX)));
    }
    error_of(&with("/accessors/0/byteOffset", json!(u64::MAX)));
    error_of(&with("/buffers/0/byteLength", json!(1u64 << 40)));
}

#[test]
fn strides_that_lie() {
    for stride in [0u64, 1, 3, 253, 1 << 40] {
        error_of(&with("/bufferViews/0/byteStride", json!(stride)));
    }
    for stride in [4, 8, 16, 252] {
        error_of(&with("/bufferViews/0/byteStride", json!(stride)));
    }
}

#[test]
fn accessors_without_data() {
    let sparse = |count: u64, indices: u64| {
        json!({"componentType": 5126, "count": count, "type": "VEC3", "sparse": {
            "count": indices,
            "indices": {"bufferView": 1, "componentType": 5123},
            "values": {"bufferView": 0}}})
    };
    // Bombs: zeros that no data back.
    for count in [1u64 << 25, 1 << 31, 1 << 62] {
        let (kind, message) = error_of(&with("/accessors/0", sparse(count, 1)));
        assert!(matches!(kind, ErrorKind::TooLarge { .. }), "{message}");
        let zeros = json!({"componentType": 5126, "count": count, "type": "MAT4"});
        let (kind, message) = error_of(&with("/accessors/0", zeros));
        assert!(matches!(kind, ErrorKind::TooLarge { .. }), "{message}");
    }
    // A list longer than its data, an index beyond the accessor.
    error_of(&with("/accessors/0", sparse(1000, 500)));
    error_of(&with("/accessors/0", sparse(3, 4)));
    let (kind, message) = error_of(&with("/accessors/0", sparse(2, 2)));
    assert!(
        matches!(
            kind,
            ErrorKind::IndexOutOfRange { .. } | ErrorKind::Syntax { .. }
        ),
        "{message}"
    );
    let mut json = with("/accessors/0", sparse(3, 1));
    json["accessors"][0]["sparse"]["indices"]["componentType"] = json!(5126);
    error_of(&json);
    json["accessors"][0]["sparse"] = json!({"count": 1});
    error_of(&json);
}

#[test]
fn one_array_used_a_million_times() {
    // 250 kB of zeros behind each of 20,000 accessors of different names.
    let mut json = triangle();
    json["accessors"][0] = json!({"componentType": 5126, "count": 20_000, "type": "VEC3"});
    let primitive = json["meshes"][0]["primitives"][0].clone();
    json["meshes"] = Value::Array(vec![json!({"primitives": [primitive]}); 20_000]);
    let (kind, message) = error_of(&json);
    assert!(matches!(kind, ErrorKind::TooLarge { .. }), "{message}");
}

#[test]
fn trees_that_are_none() {
    let nodes = |nodes: Value| {
        let mut json = triangle();
        json["nodes"] = nodes;
        error_of(&json).1
    };
    let own = nodes(json!([{"children": [0]}]));
    assert!(own.contains("is its own ancestor"), "{own}");
    let ring: Vec<Value> = (0..1000)
        .map(|n| json!({"children": [(n + 1) % 1000]}))
        .collect();
    let ring = nodes(Value::Array(ring));
    assert!(ring.contains("is its own ancestor"), "{ring}");
    let shared = nodes(json!([{"children": [2]}, {"children": [2]}, {}]));
    assert!(shared.contains("has another parent"), "{shared}");
    let twice = nodes(json!([{"children": [1, 1]}, {}]));
    assert!(twice.contains("is listed twice"), "{twice}");
    let lod = nodes(json!([{"extensions": {"MSFT_lod": {"ids": [0]}}}]));
    assert!(lod.contains("is the node itself"), "{lod}");
}

#[test]
fn uris_that_lead_outside() {
    for uri in [
        "../secret.bin",
        "a/../../secret.bin",
        "%2e%2e/secret.bin",
        "..%2fsecret.bin",
        "/etc/passwd",
        "file:///etc/passwd",
        "http://localhost/x.bin",
        "C:\\secret.bin",
        "\\\\server\\share",
        "..\\secret.bin",
    ] {
        for pointer in ["/buffers/0/uri", "/images"] {
            let value = match pointer {
                "/images" => json!([{"uri": uri}]),
                _ => json!(uri),
            };
            let (kind, message) = error_of(&with(pointer, value));
            assert!(matches!(kind, ErrorKind::UnsafePath(_)), "{uri}: {message}");
        }
    }
}

#[test]
fn buffers_that_are_missing_or_broken() {
    let (kind, message) = error_of(&with("/buffers/0/uri", json!("none.bin")));
    assert!(matches!(kind, ErrorKind::Syntax { .. }), "{message}");
    assert!(message.contains("none.bin"), "{message}");
    for uri in [
        "data:;base64,A",
        "data:;base64,!!!!",
        "data:nothing",
        "data:,short",
        "%ff",
    ] {
        error_of(&with("/buffers/0/uri", json!(uri)));
    }
    error_of(&with("/buffers/0", json!({"byteLength": 44})));
    error_of(&with("/buffers", json!([])));
}

#[test]
fn positions_that_are_not_finite() {
    for bits in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut glb = triangle_glb();
        let x = glb.len() - 44;
        glb[x..x + 4].copy_from_slice(&bits.to_le_bytes());
        let error = refused(Format::Glb, &glb);
        assert!(
            matches!(*error.kind, ErrorKind::NotFinite { .. }),
            "{error}"
        );
    }
}

#[test]
fn vertex_indices_that_are_wrong() {
    let mut glb = triangle_glb();
    let first = glb.len() - 8;
    glb[first..first + 2].copy_from_slice(&3u16.to_le_bytes());
    let error = refused(Format::Glb, &glb);
    assert!(
        matches!(
            *error.kind,
            ErrorKind::IndexOutOfRange {
                index: 3,
                count: 3,
                ..
            }
        ),
        "{error}"
    );
    glb[first..first + 2].copy_from_slice(&u16::MAX.to_le_bytes());
    refused(Format::Glb, &glb);
    for component in [5120, 5122, 5126] {
        error_of(&with("/accessors/1/componentType", json!(component)));
    }
    error_of(&with("/accessors/1/type", json!("VEC2")));
}

#[test]
fn attributes_that_do_not_fit() {
    for name in [
        "NORMAL",
        "TANGENT",
        "TEXCOORD_0",
        "COLOR_0",
        "JOINTS_0",
        "WEIGHTS_0",
    ] {
        let attributes = json!({"POSITION": 0, name: 1});
        error_of(&with("/meshes/0/primitives/0/attributes", attributes));
    }
    // Fewer normals than positions.
    let mut json = with(
        "/accessors/2",
        json!({"bufferView": 0, "componentType": 5126,
        "count": 2, "type": "VEC3"}),
    );
    json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(2);
    let (_, message) = error_of(&json);
    assert!(message.contains("NORMAL"), "{message}");
    error_of(&with(
        "/meshes/0/primitives/0/targets",
        json!([{"POSITION": 1}]),
    ));
    error_of(&with("/meshes/0/primitives/0/targets", json!([7])));
}

#[test]
fn draco_streams_that_are_none() {
    let draco = |extension: Value| {
        let extension = json!({"KHR_draco_mesh_compression": extension});
        error_of(&with("/meshes/0/primitives/0/extensions", extension)).1
    };
    draco(json!({"bufferView": 0, "attributes": {"POSITION": 0}}));
    draco(json!({"bufferView": 5, "attributes": {"POSITION": 0}}));
    draco(json!({"attributes": {"POSITION": 0}}));
    draco(json!({"bufferView": 0}));
    draco(json!(null));
}

#[test]
fn meshopt_streams_that_are_none() {
    let meshopt = |changes: &[(&str, Value)]| {
        let mut extension = json!({"buffer": 0, "byteLength": 36, "byteStride": 12,
            "count": 3, "mode": "ATTRIBUTES"});
        for (key, value) in changes {
            extension[*key] = value.clone();
        }
        let extension = json!({"EXT_meshopt_compression": extension});
        error_of(&with("/bufferViews/0/extensions", extension)).1
    };
    meshopt(&[]);
    meshopt(&[("mode", json!("TRIANGLES")), ("byteStride", json!(2))]);
    meshopt(&[("mode", json!("INDICES")), ("byteStride", json!(4))]);
    meshopt(&[("mode", json!("FUTURE"))]);
    meshopt(&[("byteStride", json!(0))]);
    meshopt(&[("byteStride", json!(6))]);
    meshopt(&[("byteStride", json!(260))]);
    meshopt(&[("byteLength", json!(1000))]);
    meshopt(&[("filter", json!("OCTAHEDRAL"))]);
    for count in [1u64 << 31, u64::MAX] {
        let message = meshopt(&[("count", json!(count))]);
        assert!(message.contains("limit"), "{message}");
    }
}

#[test]
fn random_damage_is_never_a_panic() {
    // A fixed sequence, so that a failure can be repeated.
    let mut state = 1u64;
    let mut random = move |below: usize| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 33) as usize % below
    };
    let originals = [triangle_glb(), serde_json::to_vec(&triangle()).unwrap()];
    for round in 0..20_000 {
        let original = &originals[round % 2];
        let mut bytes = original.clone();
        for _ in 0..1 + random(4) {
            let at = random(bytes.len());
            bytes[at] = match random(3) {
                0 => random(256) as u8,
                1 => b'0' + random(10) as u8,
                _ => bytes[random(original.len())],
            };
        }
        let format = [Format::Glb, Format::Gltf][round % 2];
        if let Ok(loaded) = read_bytes(format, &bytes, "damaged") {
            loaded.scene.validate().unwrap();
        }
    }
}
