//! A broken copy for every rule: each is refused with the right finding, at
//! the right place.

use super::base::{Tiles, a_box, cube, subtree, subtree_binary, subtree_json};
use karui_io::tiles::{self, Finding, Report};
use serde_json::{Value, json};

fn report(tiles: &Tiles) -> Report {
    tiles::check(tiles.root()).unwrap()
}

#[test]
fn the_tileset_itself_is_right() {
    let tiles = Tiles::new();
    let report = report(&tiles);
    assert_eq!(report.findings, tiles::Findings::default());
    let counts = report.counts;
    assert_eq!((counts.tiles, counts.contents, counts.depth), (10, 8, 4));
    assert_eq!((counts.tilesets, counts.subtrees, counts.files), (2, 1, 7));
    assert_eq!(counts.triangles, 7 * 12);
    assert!(report.is_valid());
}

/// Breaks a copy, and finds the rule broken among errors.
fn breaks(change: impl FnOnce(&Tiles), rule: &str, place: &str) {
    let tiles = Tiles::new();
    change(&tiles);
    let findings = report(&tiles).findings;
    let hit = |f: &&Finding| f.rule == rule && f.place.contains(place);
    let found = findings.errors.iter().find(hit);
    assert!(found.is_some(), "{rule} at {place}: {findings:#?}");
}

/// The same, by one value of the root file; `null` removes.
fn set(pointer: &str, value: Value, rule: &str) {
    set_in("tileset.json", pointer, value, rule);
}

fn set_in(file: &str, pointer: &str, value: Value, rule: &str) {
    let change = |tiles: &Tiles| tiles.edit(file, |json| put(json, pointer, value));
    let of_parent = [
        "required",
        "metadata-required",
        "schema-id",
        "content-or-contents",
    ];
    let of_parent = of_parent.contains(&rule) || pointer.ends_with("subtreeLevels");
    let place = if of_parent {
        pointer.rsplit_once('/').unwrap().0
    } else {
        pointer
    };
    breaks(change, rule, place);
}

fn put(json: &mut Value, pointer: &str, value: Value) {
    let (parent, key) = pointer.rsplit_once('/').unwrap();
    let parent = json.pointer_mut(parent).unwrap();
    match (parent, value) {
        (Value::Array(items), value) => items[key.parse::<usize>().unwrap()] = value,
        (parent, Value::Null) => drop(parent.as_object_mut().unwrap().remove(key)),
        (parent, value) => parent[key] = value,
    }
}

#[test]
fn required_properties() {
    for pointer in [
        "/asset",
        "/asset/version",
        "/geometricError",
        "/root",
        "/root/boundingVolume",
        "/root/geometricError",
        "/root/content/uri",
        "/root/children/2/implicitTiling/subtreeLevels",
        "/root/children/2/implicitTiling/subtrees/uri",
    ] {
        set(pointer, Value::Null, "required");
    }
}

#[test]
fn types() {
    for (pointer, value) in [
        ("/asset", json!(1.1)),
        ("/asset/version", json!(1.1)),
        ("/geometricError", json!("1")),
        ("/root", json!([])),
        ("/root/children", json!({})),
        ("/root/children/0", json!(7)),
        ("/root/transform", json!([1, 2])),
        ("/root/transform/3", json!("0")),
        ("/root/boundingVolume/box", json!([0, 0, 0])),
        ("/root/boundingVolume/box/3", json!(true)),
        ("/root/content", json!("root.glb")),
        ("/root/content/uri", json!(5)),
        ("/root/children/0/contents", json!({})),
        ("/extensionsUsed", json!("x")),
        ("/groups", json!({})),
    ] {
        set(pointer, value, "type");
    }
}

#[test]
fn the_tileset() {
    set("/asset/version", json!("2.0"), "version");
    set("/extensionsRequired", json!(["X"]), "extension-not-used");
    set(
        "/root/geometricError",
        json!(-1),
        "geometric-error-negative",
    );
    set(
        "/root/children/0/geometricError",
        json!(16.5),
        "geometric-error-grows",
    );
    set_in(
        "more/tileset.json",
        "/root/geometricError",
        json!(9),
        "geometric-error-grows",
    );
    set("/root/refine", json!("replace"), "refine");
    set("/root/children", json!([]), "children-empty");
    set("/root/children/0/contents", json!([]), "contents-empty");
    set(
        "/root/children/1/contents",
        json!([{ "uri": "root.glb" }]),
        "content-or-contents",
    );
    let no_refine =
        |tiles: &Tiles| tiles.edit("tileset.json", |j| put(j, "/root/refine", Value::Null));
    breaks(no_refine, "refine-of-root", "/root");
}

#[test]
fn volumes() {
    let volume = "/root/children/0/boundingVolume";
    set(volume, json!({}), "volume-shape");
    set(volume, json!({ "box": vec![0; 12] }), "box-degenerate");
    set(volume, json!({ "sphere": [0, 0, 0, -1] }), "sphere-radius");
    set(
        volume,
        json!({ "region": [0, 0, 4, 0, 0, 0] }),
        "region-range",
    );
    set(
        volume,
        json!({ "region": [0, 0.2, 0, 0.1, 0, 0] }),
        "region-order",
    );
    set(
        volume,
        json!({ "region": [0, 0, 0, 0.1, 5, 0] }),
        "region-order",
    );
    let shear = json!([1, 0, 0, 0.5, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
    set("/root/transform", shear, "transform-affine");
    let flat = json!([1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
    set("/root/transform", flat, "transform-invertible");
}

/// Volumes within volumes are advice, contents within volumes are the rule.
#[test]
fn what_sticks_out() {
    let child = "/root/children/0/boundingVolume/sphere/3";
    let tiles = Tiles::new();
    tiles.edit("tileset.json", |j| put(j, child, json!(9.0)));
    let findings = report(&tiles).findings;
    assert!(findings.errors.is_empty(), "{findings:?}");
    let rules: Vec<_> = findings.warnings.iter().map(|f| f.rule).collect();
    assert!(rules.contains(&"child-volume-outside"), "{findings:?}");

    let small = a_box([1.0, 1.0, 1.0], [2.5, 3.0, 3.0]);
    breaks(
        |t| {
            t.edit("tileset.json", |j| {
                put(j, "/root/children/0/boundingVolume", small.clone())
            })
        },
        "content-outside-tile",
        "/root/children/0/contents/0/uri",
    );
    breaks(
        |t| {
            t.edit("tileset.json", |j| {
                put(
                    j,
                    "/root/children/0/contents/0/boundingVolume",
                    small.clone(),
                )
            })
        },
        "content-outside-its-volume",
        "/root/children/0/contents/0/uri",
    );
    // The content of an external tileset against the tile that names it.
    breaks(
        |t| {
            let low = a_box([4.0, 0.0, 0.0], [8.0, 4.0, 1.0]);
            t.edit("tileset.json", |j| {
                put(j, "/root/children/1/boundingVolume", low)
            });
        },
        "content-outside-ancestor",
        "/root/children/0/content/uri",
    );
    // The turn from y up to z up.
    breaks(
        |t| {
            let mut scene = cube([1.0, 1.0, 1.0], [3.0, 3.0, 3.0]);
            for p in &mut scene.meshes[0].mesh.positions {
                p.z = -p.z;
            }
            t.model("near it.glb", &scene);
        },
        "content-outside-tile",
        "/root/children/0/contents/0/uri",
    );
    breaks(
        |t| t.model("cells/1-0-1.glb", &cube([0.0, 4.0, 0.0], [2.0, 6.0, 4.0])),
        "content-outside-tile",
        "tile 1/0/1/0 content 0",
    );
}

#[test]
fn files() {
    set("/root/content/uri", json!("none.glb"), "missing-file");
    set("/root/content/uri", json!("../root.glb"), "uri-outside");
    set("/root/content/uri", json!("%2e%2e/root.glb"), "uri-outside");
    set("/root/content/uri", json!("/etc/passwd"), "uri-outside");
    set_in(
        "more/tileset.json",
        "/root/content",
        json!({ "uri": "../tileset.json" }),
        "external-cycle",
    );
    set("/root/content/uri", json!("tileset.json"), "external-cycle");
    breaks(
        |t| t.write("root.glb", b"glTF\x02\0\0\0\x20\0\0\0"),
        "content-unreadable",
        "byte 8",
    );
    breaks(
        |t| t.write("more/tileset.json", b"{\"root\":"),
        "tileset-unreadable",
        "/root/children/1",
    );
    breaks(
        |t| t.write("root.glb", b"b3dm\x01\0\0\0"),
        "tile-header",
        "",
    );
    let b3dm = |t: &Tiles| {
        t.edit("tileset.json", |j| {
            put(j, "/root/content/uri", json!("root.b3dm"))
        });
        t.write("root.b3dm", b"b3dm\x01\0\0\0\x40\0\0\0");
    };
    breaks(b3dm, "tile-length", "");
    let remote = Tiles::new();
    remote.edit("tileset.json", |j| {
        put(j, "/root/content/uri", json!("https://h/x.glb"))
    });
    let findings = report(&remote).findings;
    assert_eq!(findings.warnings[0].rule, "uri-remote");
}

#[test]
fn metadata() {
    set("/metadata/class", json!("none"), "metadata-class");
    set("/metadata/properties/other", json!(1), "metadata-property");
    set("/metadata/properties/name", json!(1), "metadata-value");
    set(
        "/root/children/0/metadata/properties/n",
        Value::Null,
        "metadata-required",
    );
    set("/root/content/group", json!(1), "content-group");
    set("/schema/id", Value::Null, "schema-id");
    set("/schemaUri", json!("schema.json"), "schema-or-uri");
    let n = "/schema/classes/tile/properties/n";
    set(&format!("{n}/type"), json!("VEC5"), "property-type");
    set(n, json!({ "type": "SCALAR" }), "property-component-type");
    set(
        n,
        json!({ "type": "ENUM", "enumType": "e" }),
        "property-enum-type",
    );
    breaks(
        |t| t.edit("tileset.json", |j| put(j, "/schema", Value::Null)),
        "metadata-schema",
        "/groups/0",
    );
}

#[test]
fn implicit_tiling() {
    let tile = "/root/children/2";
    let tiling = format!("{tile}/implicitTiling");
    let child = json!([{ "boundingVolume": { "sphere": [2, 6, 2, 1] }, "geometricError": 0 }]);
    set(&format!("{tile}/children"), child, "implicit-children");
    set(
        &format!("{tile}/boundingVolume"),
        json!({ "sphere": [2, 6, 2, 2] }),
        "implicit-volume",
    );
    set(
        &format!("{tile}/content/uri"),
        json!("cells/{level}-{x}.glb"),
        "template",
    );
    set(
        &format!("{tiling}/subtrees/uri"),
        json!("trees/0/0.0.subtree"),
        "template",
    );
    set(
        &format!("{tiling}/subdivisionScheme"),
        json!("BINARY"),
        "subdivision-scheme",
    );
    set(
        &format!("{tiling}/subtreeLevels"),
        json!(0),
        "implicit-levels",
    );
    set(
        &format!("{tiling}/availableLevels"),
        json!(0.5),
        "implicit-levels",
    );
    set(
        &format!("{tiling}/subtreeLevels"),
        json!(4_000_000_000u32),
        "implicit-levels",
    );
    let metadata = json!({ "class": "tile", "properties": { "n": 1 } });
    set(&format!("{tile}/metadata"), metadata, "implicit-metadata");
    let short = |t: &Tiles| {
        t.edit("tileset.json", |j| {
            put(j, &format!("{tiling}/availableLevels"), json!(1))
        })
    };
    breaks(short, "available-levels", "tile 0/0/0/0");
    let away = |t: &Tiles| std::fs::remove_file(t.path("trees/0/0.0.subtree")).unwrap();
    breaks(away, "missing-subtree", "tile 0/0/0/0");
}

/// A subtree broken in its JSON.
fn tree(pointer: &str, value: Value, rule: &str) {
    let change = |tiles: &Tiles| {
        let mut json = subtree_json();
        put(&mut json, pointer, value);
        tiles.write("trees/0/0.0.subtree", &subtree(&json, &subtree_binary()));
    };
    breaks(change, rule, "");
}

#[test]
fn subtrees() {
    tree("/tileAvailability", Value::Null, "required");
    tree(
        "/tileAvailability/constant",
        json!(2),
        "availability-constant",
    );
    tree("/tileAvailability", json!({}), "availability");
    tree(
        "/tileAvailability",
        json!({ "constant": 0 }),
        "subtree-root",
    );
    tree("/contentAvailability/0/bitstream", json!(7), "availability");
    tree(
        "/contentAvailability/0/availableCount",
        json!(3),
        "available-count",
    );
    tree(
        "/contentAvailability",
        json!([]),
        "content-availability-count",
    );
    tree("/bufferViews/0/byteLength", json!(2), "bitstream-length");
    tree(
        "/bufferViews/0/byteOffset",
        json!(24),
        "subtree-buffer-view",
    );
    tree("/bufferViews/0/buffer", json!(1), "subtree-buffer");
    tree("/buffers/0/uri", json!("none.bin"), "missing-buffer");
    tree(
        "/childSubtreeAvailability",
        json!({ "constant": 1 }),
        "available-levels",
    );
    tree("/propertyTables/0/class", json!("none"), "metadata-class");
    tree("/propertyTables/0/count", json!(4), "table-count");
    tree(
        "/propertyTables/0/properties",
        json!({}),
        "metadata-required",
    );
    tree("/bufferViews/1/byteLength", json!(8), "table-rows");
    tree("/tileMetadata", json!(3), "property-table");
    tree("/contentMetadata", json!([0]), "table-count");
}

/// A subtree broken in its bits.
#[test]
fn bits_of_subtrees() {
    let with = |tiles: &Tiles, tile_bits: u8, content_bits: u8| {
        let mut json = subtree_json();
        json["bufferViews"][1]["byteLength"] = json!(2 * tile_bits.count_ones());
        json["propertyTables"][0]["count"] = json!(tile_bits.count_ones());
        json["bufferViews"]
            .as_array_mut()
            .unwrap()
            .push(json!({ "buffer": 0, "byteOffset": 1, "byteLength": 1 }));
        json["tileAvailability"] = json!({ "bitstream": 2 });
        json["contentAvailability"] = json!([{ "bitstream": 0 }]);
        let mut binary = subtree_binary();
        (binary[0], binary[1]) = (content_bits, tile_bits);
        tiles.write("trees/0/0.0.subtree", &subtree(&json, &binary));
    };
    let good = Tiles::new();
    with(&good, 0b0_0111, 0b0_0110);
    assert_eq!(report(&good).findings, tiles::Findings::default());
    breaks(
        |t| with(t, 0b0_0110, 0b0_0110),
        "tile-without-parent",
        "tile 1/1/0/0",
    );
    breaks(
        |t| with(t, 0b0_0111, 0b0_1110),
        "content-without-tile",
        "content 0",
    );
    breaks(
        |t| with(t, 0b10_0111, 0b0_0110),
        "bitstream-padding",
        "/tileAvailability/bitstream",
    );
    let below = |t: &Tiles| {
        let mut json = subtree_json();
        json["childSubtreeAvailability"] = json!({ "constant": 1 });
        t.write("trees/0/0.0.subtree", &subtree(&json, &subtree_binary()));
        t.edit("tileset.json", |j| {
            put(
                j,
                "/root/children/2/implicitTiling/availableLevels",
                json!(3),
            )
        });
    };
    breaks(below, "missing-subtree", "tile 2/3/3/0");
    let file = |change: fn(&mut Vec<u8>)| {
        move |t: &Tiles| {
            let mut bytes = t.read("trees/0/0.0.subtree");
            change(&mut bytes);
            t.write("trees/0/0.0.subtree", &bytes);
        }
    };
    breaks(file(|b| b[0] = b'S'), "subtree-unreadable", "byte 0");
    breaks(file(|b| b[4] = 2), "subtree-unreadable", "byte 4");
    breaks(file(|b| b.truncate(60)), "subtree-unreadable", "byte 8");
    breaks(file(|b| b.extend([0; 8])), "subtree-length", "");
    breaks(file(|b| b.truncate(20)), "subtree-unreadable", "byte 0");
    breaks(file(|b| b[24] = b'['), "subtree-unreadable", "byte 24");
}

/// A glTF content with features, broken in one value.
fn features(pointer: &str, value: Value, rule: &str) {
    let mut gltf = featured();
    let tiles = Tiles::new();
    tiles.edit("tileset.json", |j| {
        put(j, "/root/content/uri", json!("root.gltf"))
    });
    tiles.write("root.gltf", gltf.to_string().as_bytes());
    assert_eq!(report(&tiles).findings, tiles::Findings::default());
    put(&mut gltf, pointer, value);
    let change = |t: &Tiles| {
        t.edit("tileset.json", |j| {
            put(j, "/root/content/uri", json!("root.gltf"))
        });
        t.write("root.gltf", gltf.to_string().as_bytes());
    };
    breaks(change, rule, "");
}

/// A triangle of three features with names.
fn featured() -> Value {
    let mut bytes = Vec::new();
    for p in [[1.2f32, 1.2, -1.2], [2.0, 1.2, -1.2], [2.0, 2.0, -2.0]] {
        bytes.extend(p.map(f32::to_le_bytes).as_flattened());
    }
    for id in [0.0f32, 1.0, 2.0] {
        bytes.extend(id.to_le_bytes());
    }
    bytes.extend(b"abc\0");
    for offset in 0..4u32 {
        bytes.extend(offset.to_le_bytes());
    }
    let text: String = bytes.iter().map(|b| format!("%{b:02X}")).collect();
    json!({
        "asset": { "version": "2.0" },
        "extensionsUsed": ["EXT_mesh_features", "EXT_structural_metadata"],
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{
            "attributes": { "POSITION": 0, "_FEATURE_ID_0": 1 },
            "extensions": { "EXT_mesh_features": { "featureIds": [
                { "featureCount": 3, "attribute": 0, "propertyTable": 0 }
            ] } }
        }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [1.2, 1.2, -2.0], "max": [2.0, 2.0, -1.2] },
            { "bufferView": 1, "componentType": 5126, "count": 3, "type": "SCALAR" }
        ],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": 36 },
            { "buffer": 0, "byteOffset": 36, "byteLength": 12 },
            { "buffer": 0, "byteOffset": 48, "byteLength": 3 },
            { "buffer": 0, "byteOffset": 52, "byteLength": 16 }
        ],
        "buffers": [{ "byteLength": 68, "uri": format!("data:application/octet-stream,{text}") }],
        "extensions": { "EXT_structural_metadata": {
            "schema": { "id": "s", "classes": { "thing": { "properties": { "name": { "type": "STRING" } } } } },
            "propertyTables": [{
                "class": "thing", "count": 3,
                "properties": { "name": { "values": 2, "stringOffsets": 3 } }
            }]
        } }
    })
}

#[test]
fn features_of_contents() {
    let set = "/meshes/0/primitives/0/extensions/EXT_mesh_features/featureIds/0";
    features(&format!("{set}/featureCount"), json!(2), "feature-count");
    features(&format!("{set}/featureCount"), Value::Null, "feature-count");
    features(&format!("{set}/propertyTable"), json!(1), "property-table");
    features(&format!("{set}/attribute"), json!(1), "feature-attribute");
    let metadata = "/extensions/EXT_structural_metadata";
    features(
        &format!("{metadata}/propertyTables/0/count"),
        json!(2),
        "feature-id-rows",
    );
    features(
        &format!("{metadata}/propertyTables/0/count"),
        json!(4),
        "table-rows",
    );
    features(
        &format!("{metadata}/propertyTables/0/class"),
        json!("x"),
        "metadata-class",
    );
    features(&format!("{metadata}/schema"), Value::Null, "schema-or-uri");
    features("/bufferViews/2/byteLength", json!(2), "table-rows");
    features("/bufferViews/3/byteOffset", json!(48), "table-offsets");
}
