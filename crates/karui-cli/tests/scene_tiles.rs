//! `karui tiles`, end to end.
#![allow(clippy::unwrap_used, reason = "it is a test")]

mod common;

use common::Folder;
use std::path::Path;
use std::process::Command;

fn with(scene: &str) -> Folder {
    let folder = Folder::new();
    folder.ok(&format!("scene {scene} -o scene.glb --quiet"));
    folder
}

/// Quick ones.
const SMALL: &str = "--triangles 3000 --pixels 32";

#[test]
fn a_scene_becomes_a_tileset_without_findings() {
    for scene in ["city --count 80", "forest --count 40"] {
        let folder = with(scene);
        let made = folder.ok(&format!("tiles scene.glb -o out --json {SMALL}"));
        let made = made.json();
        let report = folder.ok("info --json out/tileset.json").json();
        assert_eq!(report[0]["errors"], serde_json::json!([]), "{scene}");
        assert_eq!(report[0]["warnings"], serde_json::json!([]), "{scene}");
        assert_eq!(report[0]["counts"]["tiles"], made["written"]["tiles"]);
        assert!(made["made"]["tiles"]["objects"].as_u64().unwrap() > 1);
        let stand_ins = ["boxes", "cards", "merged"].map(|k| &made["made"]["tiles"][k]);
        assert!(stand_ins.iter().any(|n| n.as_u64() > Some(0)), "{made}");
    }
}

#[test]
fn a_scene_stands_where_it_is_put() {
    let folder = with("forest --count 10");
    folder.ok(&format!(
        "tiles scene.glb -o out --lat 35.6586 --lon 139.7454 --height 40 {SMALL} -q"
    ));
    let tileset = folder.json("out/tileset.json");
    let matrix = tileset["root"]["transform"].as_array().unwrap();
    let at: Vec<f64> = matrix[12..15].iter().map(|x| x.as_f64().unwrap()).collect();
    // By the closed form, WGS 84.
    let (lat, lon) = (35.6586f64.to_radians(), 139.7454f64.to_radians());
    let (a, e2) = (6_378_137.0f64, 6.694_379_990_141_3e-3);
    let n = a / (1.0 - e2 * lat.sin().powi(2)).sqrt();
    let expected = [
        (n + 40.0) * lat.cos() * lon.cos(),
        (n + 40.0) * lat.cos() * lon.sin(),
        (n * (1.0 - e2) + 40.0) * lat.sin(),
    ];
    // The transform leads to the middle of the root, some metres from the origin.
    let away: f64 = at.iter().zip(expected).map(|(a, b)| (a - b).powi(2)).sum();
    assert!(away.sqrt() < 60.0, "{at:?} {expected:?}");
    folder.fails(2, "tiles scene.glb -o other --lat 35.6");
    folder.fails(2, "tiles scene.glb -o other --volume region");
    folder.fails(2, "tiles scene.glb -o other --lat 91 --lon 0");
    assert!(!folder.path("other").exists());
}

#[test]
fn the_same_bytes_for_any_number_of_threads() {
    let folder = with("city --count 60");
    folder.ok(&format!("tiles scene.glb -o one --threads 1 {SMALL} -q"));
    folder.ok(&format!("tiles scene.glb -o many --threads 8 {SMALL} -q"));
    let files = |of: &str| {
        let all = folder.files().into_iter();
        let within = all.filter_map(|(path, bytes)| {
            let mark = format!("/{of}/");
            let path = path.to_string_lossy().into_owned();
            path.split_once(&mark)
                .map(|(_, rest)| (rest.to_owned(), bytes))
        });
        within.collect::<std::collections::BTreeMap<_, _>>()
    };
    assert!(!files("one").is_empty());
    assert!(files("one") == files("many"));
}

#[test]
fn nothing_is_replaced_or_left_half_written() {
    let folder = with("forest --count 5");
    std::fs::create_dir(folder.path("mine")).unwrap();
    folder.write("mine/note.txt", "mine");
    folder.fails(2, &format!("tiles scene.glb -o mine {SMALL}"));
    assert_eq!(folder.names("mine"), ["note.txt"]);
    folder.ok(&format!("tiles scene.glb -o out {SMALL} -q"));
    folder.fails(2, &format!("tiles scene.glb -o out {SMALL}"));
    folder.ok(&format!("tiles scene.glb -o out --overwrite {SMALL} -q"));
    folder.write("broken.glb", "glTF");
    folder.fails(2, "tiles broken.glb -o never");
    folder.fails(2, "tiles missing.glb -o never");
    folder.fails(2, "tiles scene.glb -o never --triangles 0");
    folder.fails(2, "tiles scene.glb -o never --tolerance 2");
    assert!(!folder.path("never").exists());
}

/// Where Node, the two clients and a Chromium are.
#[test]
fn real_clients_load_every_tile() {
    let Some(modules) = std::env::var_os("KARUI_NODE_MODULES") else {
        println!(
            "SKIPPED: KARUI_NODE_MODULES names no folder with cesium, three, 3d-tiles-renderer and playwright-core"
        );
        return;
    };
    let folder = with("city --count 120");
    folder.ok(&format!("tiles scene.glb -o out {SMALL} -q"));
    let tool = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tools/view_tiles.mjs");
    let ran = Command::new("node")
        .arg(tool)
        .arg(folder.path("out/tileset.json"))
        .env("NODE_PATH", modules)
        .output();
    let Ok(ran) = ran else {
        println!("SKIPPED: no Node here");
        return;
    };
    let said = String::from_utf8_lossy(&ran.stdout).into_owned();
    match ran.status.code() {
        Some(0) => assert!(said.contains("all tiles loaded in both clients"), "{said}"),
        Some(code @ (2 | 3)) => println!("SKIPPED: the clients cannot run here ({code})"),
        code => panic!("{code:?}: {said}"),
    }
}
