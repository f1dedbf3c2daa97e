//! `karui hierarchy clusters`, end to end.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::{Folder, Ran};
use karui::hierarchy::cluster::ClusterDag;
use karui::mesh::{Scene, shapes};
use serde_json::Value;

const SHEEN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/sheen_cloth.glb");

/// Some land, and its clusters.
fn land() -> Folder {
    let folder = Folder::new();
    folder.scene("land.ply", &Scene::from_mesh(shapes::landscape(90, 60, 1)));
    folder.ok("hierarchy clusters build land.ply -o land.kcl --max-triangles 64");
    folder
}

fn cut(folder: &Folder, args: &str) -> Ran {
    folder.ok(&format!("hierarchy clusters cut {args}"))
}

fn numbers(document: &Value, key: &str) -> Vec<u64> {
    let frames = document["frames"].as_array().unwrap().iter();
    frames.map(|f| f[key].as_u64().unwrap()).collect()
}

/// A path of one frame from `eye`, high up, straight ahead to `target`.
fn path(eye: [f32; 3], target: [f32; 3]) -> String {
    serde_json::json!({ "frames": [{ "camera": { "eye": eye, "target": target } }] }).to_string()
}

#[test]
fn built_files_are_as_they_are_told() {
    let folder = Folder::new();
    folder.scene("land.ply", &Scene::from_mesh(shapes::landscape(90, 60, 1)));
    let args = "hierarchy clusters build land.ply -o land.kcl --max-triangles 64 --group-size 12";
    let told = folder.ok(&format!("{args} --json")).json();
    let written = folder.read("land.kcl");
    let dag = ClusterDag::from_bytes(&written).unwrap();
    for (key, value) in [
        ("bytes", written.len()),
        ("clusters", dag.clusters().len()),
        ("groups", dag.groups().len()),
        ("levels", dag.levels()),
        ("stuck", dag.stuck()),
    ] {
        assert_eq!(told[key], value, "{key}");
    }
    assert_eq!(told["triangles"]["input"], 2 * 90 * 60);
    assert_eq!(told["triangles"]["roots"], dag.triangles_of_roots());
    assert!(dag.clusters().iter().all(|c| c.triangles <= 64));
    assert!(dag.groups().iter().all(|g| g.count > 0));
    let ran = folder.ok(args);
    assert_eq!(ran.out.lines().count(), 1, "{ran:?}");
    assert!(ran.out.contains("10,800"), "{ran:?}");
    assert_eq!(folder.names("."), ["land.kcl", "land.ply"]);
}

#[test]
fn threads_change_no_byte() {
    let folder = land();
    let files = [1, 2].map(|threads| {
        let name = format!("{threads}.kcl");
        let args = format!("land.ply -o {name} --max-triangles 64 --threads {threads}");
        folder.ok(&format!("hierarchy clusters build {args}"));
        let out = format!("out{threads}");
        let dag = format!("land.ply --dag {name} -o {out} --around 2 --size 64x48");
        cut(
            &folder,
            &format!("{dag} --meshes --pictures --threads {threads}"),
        );
        let frames = [
            "frame-000.glb",
            "frame-001.glb",
            "frame-000.png",
            "frame-001.png",
        ];
        let frames = frames.map(|f| folder.read(&format!("{out}/{f}")));
        (folder.read(&name), frames)
    });
    assert!(files[0] == files[1]);
    assert!(files[0].0 == folder.read("land.kcl"));
}

#[test]
fn frames_are_written_as_asked_for() {
    let folder = land();
    let ran = cut(
        &folder,
        "land.ply --dag land.kcl -o out --around 3 --size 96x64 --pictures --wireframe --meshes --json",
    );
    let told = ran.json();
    let names: Vec<String> = (0..3)
        .flat_map(|i| ["glb", "png"].map(|kind| format!("frame-00{i}.{kind}")))
        .chain(["frames.csv".to_owned()])
        .collect();
    assert_eq!(folder.names("out"), names);
    assert_eq!(told["files"].as_array().unwrap().len(), names.len());
    assert_eq!(told["triangles"], 10_800);
    let csv = String::from_utf8(folder.read("out/frames.csv")).unwrap();
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines[0], "frame,clusters,triangles,error,cut_ms,index_ms");
    assert_eq!(lines.len(), 4);
    for (i, triangles) in numbers(&told, "triangles").into_iter().enumerate() {
        let cells: Vec<&str> = lines[i + 1].split(',').collect();
        assert_eq!(
            [cells[0], cells[2]],
            [i, triangles as usize].map(|n| n.to_string())
        );
        let mesh = karui_io::read(folder.path(&format!("out/frame-00{i}.glb"))).unwrap();
        assert_eq!(mesh.triangle_count() as u64, triangles);
        let png = folder.read(&format!("out/frame-00{i}.png"));
        let picture = karui_io::decode_image(&png).unwrap();
        assert_eq!((picture.width(), picture.height()), (96, 64));
    }
}

#[test]
fn a_view_gets_what_it_asks_for() {
    let folder = land();
    let drawn = |args: &str| {
        let args = format!("land.ply --dag land.kcl -o out --around 2 --json {args}");
        numbers(&cut(&folder, &args).json(), "triangles")[0]
    };
    let plain = drawn("");
    assert!(drawn("--threshold 20") < plain);
    assert!(drawn("--size 64") < plain);
    assert!(drawn("--no-back-facing --no-frustum") >= plain);
    assert_eq!(drawn("--threshold 0 --no-back-facing --no-frustum"), 10_800);
    let lit = drawn("--threshold 20 --light-factor 0.05");
    assert!(lit > drawn("--threshold 20"));
    assert!(drawn("--threshold 20 --light-factor 0.05 --highlight 90") >= lit);
    assert!(drawn("--threshold 20 --light-factor 0.05 --highlight 0") <= lit);
    assert!((1..=1000).contains(&drawn("--triangles 1000")));
    // Without a file they are built first.
    let built = "land.ply -o out --around 2 --max-triangles 64 --json";
    assert_eq!(numbers(&cut(&folder, built).json(), "triangles")[0], plain);
}

#[test]
fn nothing_seen_is_a_frame_too() {
    let folder = land();
    folder.write("away.json", path([45.0, 500.0, 30.0], [45.0, 900.0, 31.0]));
    let args = "land.ply --dag land.kcl -o out --path away.json --size 32 --pictures --meshes";
    let told = cut(&folder, &format!("{args} --json")).json();
    assert_eq!(numbers(&told, "triangles"), [0]);
    assert_eq!(folder.names("out").len(), 3);
    let scene = karui_io::read(folder.path("out/frame-000.glb")).unwrap();
    assert_eq!(scene.triangle_count(), 0);
}

#[test]
fn materials_and_textures_stay() {
    let folder = Folder::new();
    std::fs::copy(SHEEN, folder.path("sheen.glb")).unwrap();
    let told = folder
        .ok("hierarchy clusters build sheen.glb -o sheen.kcl --json")
        .json();
    let args =
        "sheen.glb --dag sheen.kcl -o out --around 1 --size 64 --meshes --pictures --triangles";
    cut(&folder, &format!("{args} 2000"));
    let (before, after) = ["sheen.glb", "out/frame-000.glb"]
        .map(|name| karui_io::read(folder.path(name)).unwrap())
        .into();
    assert_eq!(after.materials, before.materials);
    assert_eq!(after.images.len(), before.images.len());
    assert!(after.triangle_count() < told["triangles"]["input"].as_u64().unwrap() as usize);
}

#[test]
fn broken_files_are_refused_by_name() {
    let folder = land();
    let whole = folder.read("land.kcl");
    let mut tampered = whole.clone();
    tampered[whole.len() / 2] ^= 1;
    for (name, content) in [
        ("cut.kcl", &whole[..whole.len() - 9]),
        ("short.kcl", &whole[..5]),
        ("empty.kcl", &[]),
        ("tampered.kcl", &tampered),
        (
            "text.kcl",
            b"no clusters at all, but a text that is long enough to be some",
        ),
    ] {
        folder.write(name, content);
        let ran = folder.fails(
            2,
            &format!("hierarchy clusters cut land.ply --dag {name} -o out"),
        );
        assert!(ran.err.contains(name), "{ran:?}");
        assert!(
            ran.err.contains("karui hierarchy clusters build"),
            "{ran:?}"
        );
    }
    let ran = folder.fails(2, "hierarchy clusters cut land.ply --dag none.kcl -o out");
    assert!(ran.err.contains("none.kcl"), "{ran:?}");
}

#[test]
fn clusters_of_another_mesh_are_refused() {
    let folder = land();
    // Other counts, and the same triangles in other places.
    for (name, mesh) in [
        ("other.ply", shapes::landscape(60, 60, 1)),
        ("moved.ply", shapes::landscape(90, 60, 2)),
    ] {
        folder.scene(name, &Scene::from_mesh(mesh));
        let ran = folder.fails(
            2,
            &format!("hierarchy clusters cut {name} --dag land.kcl -o out"),
        );
        for said in ["land.kcl", "another mesh", name] {
            assert!(ran.err.contains(said), "{ran:?}");
        }
    }
}

#[test]
fn bad_use_is_told_and_nothing_written() {
    let folder = land();
    folder.write(
        "typo.json",
        path([0.0; 3], [1.0; 3]).replace("target", "targte"),
    );
    folder.write("none.json", r#"{"frames":[]}"#);
    folder.write("still.json", path([1.0; 3], [1.0; 3]));
    folder.write("far.json", path([1.0; 3], [2.5; 3]).replace("2.5", "1e39"));
    for name in ["typo.json", "none.json", "far.json", "missing.json"] {
        let ran = folder.fails(
            2,
            &format!("hierarchy clusters cut land.ply -o out --path {name}"),
        );
        assert!(ran.err.contains(name), "{ran:?}");
    }
    let ran = folder.fails(
        2,
        "hierarchy clusters cut land.ply -o out --path still.json",
    );
    assert!(ran.err.contains("frame 0"), "{ran:?}");
    for wrong in [
        "build none.ply -o a.kcl",
        "build land.ply -o a.kcl --max-triangles 7",
        "build land.ply -o a.kcl --max-triangles 256",
        "build land.ply -o a.kcl --group-size 65",
        "cut none.ply -o out",
        "cut land.ply -o out --dag land.kcl --group-size 12",
        "cut land.ply -o out --path still.json --around 3",
        "cut land.ply -o out --threshold -1",
        "cut land.ply -o out --threshold nan",
        "cut land.ply -o out --light-factor 0",
        "cut land.ply -o out --light-factor 2",
        "cut land.ply -o out --light-factor 0.5 --highlight 181",
        "cut land.ply -o out --highlight 5",
        "cut land.ply -o out --triangles 100 --threshold 2",
        "cut land.ply -o out --wireframe",
        "bench",
        "bench none.ply",
    ] {
        folder.fails(2, &format!("hierarchy clusters {wrong}"));
    }
    folder.fails(3, "hierarchy clusters build land.ply -o nowhere/a.kcl");
    folder.fails(3, "hierarchy clusters cut land.ply -o land.kcl/out");
    folder.fails(3, "hierarchy clusters bench land.ply -o nowhere/a.md");
}

#[test]
fn the_bench_writes_its_section_and_keeps_the_rest() {
    let folder = land();
    folder.write("page.md", "# Figures\n");
    let args = "hierarchy clusters bench land.ply --sizes 5000,2 --frames 3";
    for _ in 0..2 {
        folder.ok(&format!("{args} -o page.md"));
    }
    let page = String::from_utf8(folder.read("page.md")).unwrap();
    assert!(page.starts_with("# Figures\n"), "{page}");
    assert_eq!(
        page.matches("begin: karui hierarchy clusters bench")
            .count(),
        1
    );
    assert!(
        page.contains("`land.ply`") && page.contains("`landscape 5,000`"),
        "{page}"
    );
    let rows = folder.ok(&format!("{args} --json")).json();
    let rows = rows.as_array().unwrap().clone();
    assert_eq!(rows.len(), 3);
    for row in &rows {
        let [all, seen] = [0, 1].map(|i| row["drawn"][i].as_u64().unwrap());
        assert!(
            seen <= all && all <= row["triangles"].as_u64().unwrap(),
            "{row}"
        );
        assert!(row["fill"].as_f64().unwrap() <= 1.0, "{row}");
    }
}

#[test]
fn a_scan_is_cut() {
    let default = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/models");
    let models = std::env::var("KARUI_MODELS").unwrap_or(default.to_owned());
    let bunny = format!("{models}/scans/bun_zipper.ply.gz");
    if !std::path::Path::new(&bunny).is_file() {
        println!("SKIPPED: no {bunny}");
        return;
    }
    let folder = Folder::new();
    folder.ok(&format!("hierarchy clusters build {bunny} -o bunny.kcl"));
    let drawn = |args: &str| {
        let args = format!("{bunny} --dag bunny.kcl -o out --around 4 --json {args}");
        numbers(&cut(&folder, &args).json(), "triangles")
    };
    let (all, coarse) = (
        drawn("--threshold 0 --no-frustum --no-back-facing"),
        drawn(""),
    );
    assert_eq!(all, [69_451; 4]);
    assert!(
        coarse.iter().all(|n| (100..40_000).contains(n)),
        "{coarse:?}"
    );
}

/// The user's interrupt ends a build with no word on what it would have been.
#[cfg(unix)]
#[test]
fn interrupted_builds_claim_nothing() {
    let folder = Folder::new();
    let large = Scene::from_mesh(shapes::landscape(700, 700, 1));
    folder.scene("large.ply", &large);
    let before = folder.files();
    let args = "hierarchy clusters build large.ply -o large.kcl --threads 1 --json";
    let child = common::karui()
        .args(args.split(' '))
        .current_dir(folder.path("."))
        .stderr(std::process::Stdio::piped())
        .stdout(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(std::time::Duration::from_millis(600));
    let id = child.id().to_string();
    let mut kill = std::process::Command::new("kill");
    let killed = kill.args(["-INT", &id]).status().unwrap();
    assert!(killed.success(), "it was over before it was interrupted");
    let ran: Ran = child.wait_with_output().unwrap().into();
    assert_eq!(ran.code, Some(130), "{ran:?}");
    assert!(ran.err.contains("error: cancelled"), "{ran:?}");
    assert_eq!(ran.out, "");
    assert_eq!(folder.files(), before);
}
