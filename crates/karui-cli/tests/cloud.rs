//! Plans in the bucket that `KARUI_CLOUD` names, e.g. `s3://bucket/prefix`; the environment says
//! who asks and where, e.g. a server on loopback.
#![cfg(feature = "cloud")]
#![allow(clippy::print_stdout, reason = "a test that is skipped says so")]
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::Folder;
use karui::outofcore::Store as _;
use karui_io::Cloud;
use std::{collections::BTreeMap, fs, path::Path};

const SIMPLIFY: &str = "--ratio 0.1 --memory-limit 20MiB -q";
const TILES: &str = "--memory-limit 20MiB --triangles 3000 -q -o";

/// A place of its own in the bucket; none, with a reason, without a bucket.
fn place(test: &str) -> Option<String> {
    let Ok(url) = std::env::var("KARUI_CLOUD") else {
        println!("SKIPPED: KARUI_CLOUD names no bucket");
        return None;
    };
    let url = format!("{url}/{test}-{}", std::process::id());
    assert!(Cloud::open(&url).unwrap().list().unwrap().is_empty());
    Some(url)
}

/// A folder with land of 131,072 triangles, and a tenth of it that was made without a cloud.
fn land() -> Folder {
    let folder = Folder::new();
    folder.ok("scene terrain --size 257x257 -o land.ply -q");
    folder.ok(&format!("simplify land.ply {SIMPLIFY} -o whole.ply"));
    folder
}

fn clear(url: &str) {
    let cloud = Cloud::open(url).unwrap();
    for name in cloud.list_below().unwrap() {
        cloud.remove(&name).unwrap();
    }
}

#[test]
fn simplified_by_way_of_a_bucket_a_model_has_the_same_bytes() {
    let Some(url) = place("simplify") else { return };
    let folder = land();
    folder.ok(&format!(
        "simplify land.ply {SIMPLIFY} --work {url} -o cloud.ply"
    ));
    assert!(folder.read("whole.ply") == folder.read("cloud.ply"));
    assert!(Cloud::open(&url).unwrap().list().unwrap().is_empty());
    let shown = folder.fails(2, &format!("plan show {url}"));
    assert!(shown.err.contains("holds no plan"), "{shown:?}");
}

#[test]
fn rows_run_by_programs_of_their_own_and_damage_is_mended() {
    let Some(url) = place("rows") else { return };
    let folder = land();
    let new = format!("plan new land.ply {url} --ratio 0.1 --memory-limit 20MiB --json");
    let mut step = folder.ok(&new).json();
    while step["done"] == false {
        let manifest = step["manifest"].as_str().unwrap().to_owned();
        assert!(manifest.starts_with(&url), "{manifest}");
        for row in 0..step["rows"].as_u64().unwrap() {
            folder.ok(&format!("task run {manifest} --row {row}"));
        }
        step = folder.ok(&format!("plan next {url} --json")).json();
    }
    folder.ok(&format!("plan write {url} -o rows.ply"));
    assert!(folder.read("whole.ply") == folder.read("rows.ply"));

    let cloud = Cloud::open(&url).unwrap();
    let names = cloud.list().unwrap();
    let last = names.iter().rfind(|n| n.ends_with(".block")).unwrap();
    let mut bytes = cloud.get(last).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    cloud.put(last, &bytes).unwrap();
    let ran = folder.run(&format!("plan verify {url}"));
    assert_eq!(ran.code, Some(1), "{ran:?}");
    assert_eq!(ran.out, format!("{last}\n"));
    folder.ok(&format!("plan resume {url} -o mended.ply -q"));
    assert!(folder.read("whole.ply") == folder.read("mended.ply"));
    clear(&url);
}

#[test]
fn a_bucket_that_does_not_exist_is_told_with_its_url() {
    if place("none").is_none() {
        return;
    }
    let folder = land();
    let url = "s3://karui-has-no-such-bucket/work";
    let ran = folder.run(&format!(
        "simplify land.ply {SIMPLIFY} --work {url} -o no.ply"
    ));
    assert_eq!(ran.code, Some(3), "{ran:?}");
    assert!(ran.err.contains(&format!("{url}/plan.json")), "{ran:?}");
    assert!(ran.err.contains("hint: create the bucket first"), "{ran:?}");
    assert!(!folder.path("no.ply").exists());
    let url = "s3://karui-has-no-such-bucket/tiles";
    let ran = folder.run(&format!("tiles land.ply {TILES} {url}"));
    assert_eq!(ran.code, Some(3), "{ran:?}");
    assert!(ran.err.contains("hint: create the bucket first"), "{ran:?}");
    assert!(!folder.path("tiles.karui").exists(), "told before any work");
}

/// Names and bytes of all files in a folder.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut all = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(at) = folders.pop() {
        for entry in fs::read_dir(at).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let name = path.strip_prefix(folder).unwrap().to_str().unwrap();
            all.insert(name.to_owned(), fs::read(&path).unwrap());
        }
    }
    all
}

/// The same of all objects at a URL.
fn objects(url: &str) -> BTreeMap<String, Vec<u8>> {
    let cloud = Cloud::open(url).unwrap();
    let names = cloud.list_below().unwrap().into_iter();
    names
        .map(|name| (name.clone(), cloud.get(&name).unwrap()))
        .collect()
}

#[test]
fn tiles_in_a_bucket_are_those_of_a_folder() {
    let Some(url) = place("tiles") else { return };
    let folder = land();
    for tiling in ["explicit", "implicit"] {
        let tiles = format!("tiles land.ply --tiling {tiling} --tiles-per-file 20 {TILES}");
        folder.ok(&format!("{tiles} {tiling}"));
        folder.ok(&format!("{tiles} {url}/{tiling}"));
        let expected = files(&folder.path(tiling));
        assert!(expected.len() > 50, "{}", expected.len());
        assert!(expected == objects(&format!("{url}/{tiling}")), "{tiling}");
        assert!(!folder.path(&format!("{tiling}.karui")).exists());
    }
    clear(&url);
}

#[test]
fn a_tileset_in_a_bucket_is_replaced_if_asked_and_never_half_there() {
    let Some(url) = place("replaced") else { return };
    let folder = land();
    let cloud = Cloud::open(&url).unwrap();
    // An upload that was killed has left this.
    cloud.put("content/7/9999.glb", b"half a tileset").unwrap();
    let tiles = format!("tiles land.ply {TILES} {url}");
    folder.ok(&tiles);
    let first = objects(&url);
    assert!(!first.contains_key("content/7/9999.glb"));
    let ran = folder.fails(2, &tiles);
    assert!(ran.err.contains("overwriting was not asked for"), "{ran:?}");
    assert!(first == objects(&url));
    folder.ok(&format!(
        "tiles land.ply --overwrite --lat 1 --lon 2 {TILES} {url}"
    ));
    let second = objects(&url);
    assert!(first["tileset.json"] != second["tileset.json"]);
    folder.ok(&format!("tiles land.ply --overwrite {TILES} {url}"));
    assert!(first == objects(&url));
    cloud.put("tileset.json", b"{}").unwrap();
    let ran = folder.fails(2, &format!("{tiles} --overwrite"));
    assert!(ran.err.contains("something else"), "{ran:?}");
    clear(&url);
}
