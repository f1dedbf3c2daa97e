//! Meshes larger than memory as 3D Tiles: both tilings, killed, checked.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::{Folder, karui};
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::Duration;

const TILES: &str = "--memory-limit 20MiB --triangles 3000 --up y -q -o";

/// A folder with some land of 131,072 triangles.
fn land() -> Folder {
    let folder = Folder::new();
    folder.ok("scene terrain --size 257x257 -o land.ply -q");
    folder
}

/// Names and bytes of the files of a tileset.
fn files(folder: &Folder, tileset: &str) -> Vec<(PathBuf, Vec<u8>)> {
    let all = folder.files().into_iter();
    let below = all.filter_map(|(path, bytes)| {
        let root = folder.path(tileset);
        let path = path
            .strip_prefix(&root)
            .or_else(|_| path.strip_prefix(tileset));
        Some((path.ok()?.to_owned(), bytes))
    });
    let mut files: Vec<_> = below.collect();
    files.sort();
    files
}

fn whole(folder: &Folder, tileset: &str) -> serde_json::Value {
    let report = folder
        .ok(&format!("info {tileset}/tileset.json --json"))
        .json();
    assert_eq!(report[0]["errors"], serde_json::json!([]), "{report}");
    report[0].clone()
}

#[test]
fn both_tilings_are_without_error_and_the_same_for_any_threads() {
    let folder = land();
    for tiling in ["explicit", "implicit"] {
        let args = |threads: u32, out: &str| {
            format!("tiles land.ply --tiling {tiling} --threads {threads} {TILES} {out}")
        };
        folder.ok(&args(1, &format!("{tiling}1")));
        let report = whole(&folder, &format!("{tiling}1"));
        assert!(report["counts"]["tiles"].as_u64().unwrap() > 50, "{report}");
        assert!(!Path::new(&folder.path(&format!("{tiling}1.karui"))).exists());
        for threads in [2, 8] {
            let out = format!("{tiling}{threads}");
            folder.ok(&args(threads, &out));
            let one = files(&folder, &format!("{tiling}1"));
            assert!(!one.is_empty() && one == files(&folder, &out), "{out}");
        }
    }
}

#[test]
fn killed_runs_go_on_and_write_the_same() {
    let folder = land();
    folder.ok(&format!("tiles land.ply {TILES} whole"));
    let args = format!("tiles land.ply {TILES} killed");
    let mut kills = 0;
    for wait in (20..).step_by(90) {
        let mut command = karui();
        let command = command.current_dir(folder.path("")).args(args.split(' '));
        let mut child = command.stdout(Stdio::null()).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(wait));
        if child.try_wait().unwrap().is_some() || kills == 10 {
            child.wait().unwrap();
            break;
        }
        child.kill().unwrap();
        child.wait().unwrap();
        kills += 1;
        assert!(!folder.path("killed").exists());
    }
    if !folder.path("killed").exists() {
        folder.ok(&args);
    }
    println!("killed {kills} times");
    assert!(files(&folder, "whole") == files(&folder, "killed"));
}

#[test]
fn land_far_from_the_origin_stands_on_the_earth() {
    let folder = Folder::new();
    let mut land = karui::mesh::shapes::landscape(129, 129, 3);
    let far = karui::geom::Vec3::new(1e6, 0.0, -1e6);
    land.positions.iter_mut().for_each(|p| *p += far);
    folder.scene("far.ply", &karui::mesh::Scene::from_mesh(land));
    for (out, more) in [
        ("region", "--lat 46 --lon 7 --volume region"),
        ("implicit", "--lat 46 --lon 7 --tiling implicit"),
        ("sphere", "--volume sphere --quantize"),
    ] {
        folder.ok(&format!("tiles far.ply {more} {TILES} {out}"));
        whole(&folder, out);
    }
}

#[test]
fn what_does_not_fit_together_is_refused() {
    let folder = land();
    folder.fails(2, "tiles land.ply -o out --tiling implicit");
    folder.fails(2, &format!("tiles land.ply --stand-in 5 {TILES} out"));
    folder.fails(
        2,
        "tiles land.ply --triangles 3 --memory-limit 20MiB -o out",
    );
    folder.write("empty.ply", "ply\nformat binary_little_endian 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n");
    let ran = folder.run(&format!("tiles empty.ply {TILES} out"));
    assert!(
        ran.code == Some(2) && ran.err.contains("error: "),
        "{ran:?}"
    );
    assert!(!folder.path("out").exists());
}
