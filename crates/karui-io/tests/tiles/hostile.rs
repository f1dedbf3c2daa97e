//! Files that mean harm: an error or a report, never a panic, a hang or an
//! overflow.

use super::base::{Tiles, a_box, subtree, subtree_json};
use karui_io::tiles::{self, CheckOptions};
use proptest::prelude::*;
use serde_json::{Value, json};

/// Most findings there can be.
const MOST: usize = 1000;

#[test]
fn a_hundred_thousand_levels() {
    let levels = 100_000;
    let volume = r#""boundingVolume":{"sphere":[0,0,0,1]},"geometricError":0"#;
    let text = format!(
        r#"{{"asset":{{"version":"1.1"}},"geometricError":0,"root":{}{{{volume}}}{}}}"#,
        format!(r#"{{{volume},"refine":"ADD","children":["#).repeat(levels),
        "]}".repeat(levels),
    );
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tileset.json");
    std::fs::write(&path, &text).unwrap();
    let tileset = tiles::read(&path).unwrap();
    assert_eq!(tileset.tiles.len(), levels + 1);
    let written = tileset.to_json();
    assert_eq!(
        tiles::read_bytes(&written, "again").unwrap(),
        tileset.clone()
    );
    let report = tiles::check(&path).unwrap();
    assert!(report.is_valid());
    assert_eq!(report.counts.depth as usize, levels + 1);
}

/// Every tile breaks rules, and the deepest have the longest pointers.
#[test]
fn findings_are_bounded() {
    let levels = 50_000;
    let text = format!(
        r#"{{"root":{}{{}}{}}}"#,
        r#"{"children":["#.repeat(levels),
        "]}".repeat(levels)
    );
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tileset.json");
    std::fs::write(&path, &text).unwrap();
    let report = tiles::check(&path).unwrap();
    assert_eq!(report.findings.errors.len(), MOST);
    assert!(report.findings.further_errors > 50_000);
    assert!(report.findings.errors.iter().all(|f| f.place.len() < 1000));
}

#[test]
fn a_wide_tileset() {
    let child = json!({ "boundingVolume": { "sphere": [0, 0, 0, 1] }, "geometricError": 0 });
    let tileset = json!({
        "asset": { "version": "1.1" },
        "geometricError": 1,
        "root": {
            "boundingVolume": { "sphere": [0, 0, 0, 1] },
            "geometricError": 1, "refine": "ADD",
            "children": vec![child; 200_000],
        }
    });
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tileset.json");
    std::fs::write(&path, tileset.to_string()).unwrap();
    assert_eq!(tiles::check(&path).unwrap().counts.tiles, 200_001);
}

/// Each tileset names the next one twice: 2^n tiles in n small files.
#[test]
fn tilesets_that_multiply() {
    let folder = tempfile::tempdir().unwrap();
    for i in 0..64 {
        let next = json!({
            "boundingVolume": { "sphere": [0, 0, 0, 1] }, "geometricError": 0,
            "content": { "uri": format!("{}.json", i + 1) }
        });
        let tileset = json!({
            "asset": { "version": "1.1" }, "geometricError": 0,
            "root": {
                "boundingVolume": { "sphere": [0, 0, 0, 1] }, "geometricError": 0,
                "refine": "ADD", "children": [next, next]
            }
        });
        std::fs::write(folder.path().join(format!("{i}.json")), tileset.to_string()).unwrap();
    }
    let options = CheckOptions {
        max_tiles: 20_000,
        ..CheckOptions::default()
    };
    let report = tiles::check_with(folder.path().join("0.json"), &options).unwrap();
    assert_eq!(report.counts.tiles, 20_000);
    assert!(
        report
            .findings
            .errors
            .iter()
            .any(|f| f.rule == "too-many-tiles")
    );
}

/// A subtree of a few bytes that claims all of its millions of tiles.
#[test]
fn subtrees_that_claim_everything() {
    let tiles = Tiles::new();
    let mut json = subtree_json();
    for key in ["propertyTables", "tileMetadata"] {
        json.as_object_mut().unwrap().remove(key);
    }
    json["contentAvailability"] = json!([{ "constant": 0 }]);
    tiles.write("trees/0/0.0.subtree", &subtree(&json, &[0; 24]));
    tiles.edit("tileset.json", |j| {
        let tiling = &mut j["root"]["children"][2]["implicitTiling"];
        tiling["subtreeLevels"] = json!(15);
        tiling["availableLevels"] = json!(31);
    });
    let options = CheckOptions {
        max_tiles: 100_000,
        ..CheckOptions::default()
    };
    let report = tiles::check_with(tiles.root(), &options).unwrap();
    assert_eq!(report.counts.tiles, 100_000);
    assert_eq!(report.findings.errors.len(), 1, "{:?}", report.findings);
}

#[test]
fn numbers_at_the_edge() {
    for volume in [
        a_box([1e300, 0.0, 0.0], [1.1e300, 1.0, 1.0]),
        json!({ "sphere": [1e308, 1e308, 1e308, 1e308] }),
        json!({ "sphere": [0, 0, 0, 1e-320] }),
        json!({ "box": [0, 0, 0, 1e-200, 0, 0, 1e-200, 0, 0, 1e-200, 0, 0] }),
        json!({ "region": [0, 0, 0, 0, -1e308, 1e308] }),
        json!({ "region": [0, 0, 0, 0, -7e6, -7e6] }),
    ] {
        let tiles = Tiles::new();
        tiles.edit("tileset.json", |j| j["root"]["boundingVolume"] = volume);
        tiles::check(tiles.root()).unwrap();
    }
    for number in ["NaN", "Infinity", "1e999", "-1e999"] {
        let tiles = Tiles::new();
        let text = String::from_utf8(tiles.read("tileset.json")).unwrap();
        let text = text.replacen("16.0", number, 1);
        assert!(tiles::read_bytes(text.as_bytes(), "t").is_err(), "{number}");
    }
}

#[test]
fn every_truncation_of_every_file() {
    for name in [
        "tileset.json",
        "more/tileset.json",
        "trees/0/0.0.subtree",
        "root.glb",
    ] {
        let tiles = Tiles::new();
        let whole = tiles.read(name);
        let step = (whole.len() / 60).max(1);
        for end in (0..whole.len()).step_by(step) {
            tiles.write(name, &whole[..end]);
            if let Ok(report) = tiles::check(tiles.root()) {
                assert!(
                    !report.is_valid() || !report.findings.warnings.is_empty(),
                    "{name} {end}"
                );
            }
        }
    }
}

#[test]
fn what_is_no_tileset() {
    let folder = tempfile::tempdir().unwrap();
    for text in [
        &b""[..],
        b"[]",
        b"7",
        b"{",
        b"\xff\xfe",
        b"subt",
        b"\xef\xbb\xbf{}",
    ] {
        let path = folder.path().join("t.json");
        std::fs::write(&path, text).unwrap();
        assert!(tiles::check(&path).is_err());
        assert!(tiles::read(&path).is_err());
    }
    assert!(tiles::check(folder.path()).is_err());
    assert!(tiles::check(folder.path().join("none.json")).is_err());
}

/// Any value in place of any other.
fn values() -> impl Strategy<Value = Value> {
    prop_oneof![
        Just(Value::Null),
        Just(json!([])),
        Just(json!({})),
        Just(json!("")),
        Just(json!("{level}{x}{y}{z}")),
        Just(json!("tileset.json")),
        Just(json!([-1, 1e308, 0.5, "x"])),
        any::<f64>().prop_map(|x| json!(x)),
        any::<u32>().prop_map(|x| json!(x)),
        Just(json!(u64::MAX)),
        Just(json!(1)),
    ]
}

/// Pointers to all values of a document.
fn pointers(json: &Value, at: String, found: &mut Vec<String>) {
    match json {
        Value::Array(items) => {
            for (i, item) in items.iter().enumerate() {
                pointers(item, format!("{at}/{i}"), found);
            }
        }
        Value::Object(members) => {
            for (key, member) in members {
                pointers(member, format!("{at}/{key}"), found);
            }
        }
        _ => {}
    }
    found.push(at);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Values of the JSON changed at random.
    #[test]
    fn changed_values(which in any::<prop::sample::Index>(), value in values(), file in 0..3usize) {
        let tiles = Tiles::new();
        let name = ["tileset.json", "more/tileset.json", "trees/0/0.0.subtree"][file];
        let change = |json: &mut Value| {
            let mut found = Vec::new();
            pointers(json, String::new(), &mut found);
            *json.pointer_mut(&found[which.index(found.len())]).unwrap() = value;
        };
        if file == 2 {
            let mut json = subtree_json();
            change(&mut json);
            tiles.write(name, &subtree(&json, &[0xff; 24]));
        } else {
            tiles.edit(name, change);
        }
        let options = CheckOptions { max_tiles: 10_000, ..CheckOptions::default() };
        let _ = tiles::check_with(tiles.root(), &options);
    }

    /// Bytes changed at random.
    #[test]
    fn changed_bytes(at in any::<prop::sample::Index>(), byte in any::<u8>(), file in 0..4usize) {
        let tiles = Tiles::new();
        let name = ["tileset.json", "more/tileset.json", "trees/0/0.0.subtree", "root.glb"][file];
        let mut bytes = tiles.read(name);
        let i = at.index(bytes.len());
        bytes[i] = byte;
        tiles.write(name, &bytes);
        let options = CheckOptions { max_tiles: 10_000, ..CheckOptions::default() };
        let _ = tiles::check_with(tiles.root(), &options);
    }
}
