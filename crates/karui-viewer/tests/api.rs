//! What a page can ask for.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[allow(dead_code, reason = "each test file uses a part of it")]
mod common;

use common::Running;
use karui::Scene;
use karui::lod::{Levels, LodOptions, chain_scene};
use karui::mesh::shapes;
use karui_io::Format;
use karui_viewer::ViewerOptions;
use serde_json::json;
use std::path::PathBuf;
use std::time::Duration;

fn torus() -> Scene {
    Scene::from_mesh(shapes::torus(2.0, 0.7, 96, 48))
}

/// A folder with `torus.ply` in it.
fn folder() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("torus.ply");
    karui_io::write(&path, &torus()).unwrap();
    (folder, path)
}

fn read(glb: &[u8]) -> Scene {
    karui_io::read_bytes(Format::Glb, glb, "answer.glb")
        .unwrap()
        .scene
}

#[test]
fn files_are_told_and_sent() {
    let (_folder, path) = folder();
    let viewer = Running::of(&[path]);
    let state = viewer.get("api/state").json();
    assert_eq!(
        state["files"],
        json!([{ "id": 0, "name": "torus.ply", "kind": "model", "version": 0 }])
    );
    let told = viewer.get("api/files/0").json();
    assert_eq!(told["triangles"], 96 * 48 * 2);
    assert_eq!(told["levels"].as_array().unwrap().len(), 1);
    let sent = viewer.get("api/files/0/level/0.glb");
    assert_eq!(
        read(&sent.body).meshes[0].mesh.positions,
        torus().meshes[0].mesh.positions
    );
    assert_eq!(told["levels"][0]["bytes"], sent.body.len());
    for missing in [
        "api/files/1",
        "api/files/0/level/1.glb",
        "api/files/0/level/x",
        "api/jobs/0",
    ] {
        assert_eq!(viewer.get(missing).status, 404, "{missing}");
    }
}

#[test]
fn levels_are_those_of_the_library() {
    let (_folder, path) = folder();
    let viewer = Running::of(&[path]);
    let asked = json!({ "levels": 3 }).to_string();
    let begun = viewer.send("POST", "api/files/0/lod", asked.as_bytes());
    assert_eq!(begun.status, 202, "{begun:?}");
    let report = viewer.ended(begun.json()["job"].as_u64().unwrap());
    assert_eq!(report["state"], "done", "{report}");
    let options = LodOptions {
        levels: Levels::Halving {
            min_triangles: 32,
            max_levels: 3,
        },
        ..LodOptions::default()
    };
    let scene = torus();
    let chain = chain_scene(&scene, &options).unwrap();
    let told = viewer.get("api/files/0").json();
    assert_eq!(
        told["levels"].as_array().unwrap().len(),
        chain.level_count()
    );
    for level in 0..chain.level_count() {
        let sum = chain.summary(&scene, level);
        let row = &told["levels"][level];
        assert_eq!(row["triangles"], sum.triangles);
        assert_eq!(row["error"]["max"].as_f64(), Some(sum.max));
        assert_eq!(row["switch_distance"].as_f64(), Some(sum.switch_distance));
        let sent = read(&viewer.get(&format!("api/files/0/level/{level}.glb")).body);
        let expected = chain.scene_at(&scene, level);
        assert_eq!(
            sent.meshes[0].mesh.positions,
            expected.meshes[0].mesh.positions
        );
        assert_eq!(
            sent.meshes[0].mesh.triangles,
            expected.meshes[0].mesh.triangles
        );
    }
    assert_eq!(told["version"], 1);
    assert_eq!(viewer.get("api/state").json()["files"][0]["version"], 1);
    let all = read(&viewer.get("api/files/0/lods.glb").body);
    assert_eq!(all.stand_ins().iter().filter(|s| **s).count(), 3);
}

#[test]
fn levels_that_a_file_brings_along_are_shown() {
    let scene = torus();
    let options = LodOptions {
        levels: Levels::Ratios(vec![0.4, 0.05]),
        ..LodOptions::default()
    };
    let chain = chain_scene(&scene, &options).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lods.glb");
    karui_io::write(&path, &karui::lod::to_msft_lod(&scene, &chain).scene).unwrap();
    let viewer = Running::of(&[path]);
    let told = viewer.get("api/files/0").json();
    assert_eq!(told["triangles"], scene.triangle_count());
    for level in 0..3 {
        let known = chain.summary(&scene, level);
        let row = &told["levels"][level];
        assert_eq!(row["triangles"], known.triangles);
        let max = row["error"]["max"].as_f64().unwrap();
        assert!((max - known.max).abs() <= 0.1 * known.max, "{row}");
        let sent = viewer.get(&format!("api/files/0/level/{level}.glb"));
        assert_eq!(read(&sent.body).triangle_count(), known.triangles);
    }
    let refused = viewer.get("api/files/0/heat/error.glb?level=1");
    assert_eq!(refused.status, 422);
    let job = viewer.send("POST", "api/files/0/lod", b"{}").json()["job"].clone();
    assert_eq!(viewer.ended(job.as_u64().unwrap())["state"], "done");
    let told = viewer.get("api/files/0").json();
    assert_eq!(told["levels"][1]["triangles"], scene.triangle_count() / 2);
}

#[test]
fn work_can_be_cancelled_and_leaves_levels_as_they_were() {
    let (_folder, path) = folder();
    let viewer = Running::of(&[path]);
    let asked = json!({ "levels": 8, "quality": "exact", "flip": 0.01 }).to_string();
    let job = viewer
        .send("POST", "api/files/0/lod", asked.as_bytes())
        .json()["job"]
        .clone();
    let job = job.as_u64().unwrap();
    assert_eq!(
        viewer
            .send("DELETE", &format!("api/jobs/{job}"), &[])
            .status,
        200
    );
    assert_eq!(viewer.ended(job)["state"], "cancelled");
    let told = viewer.get("api/files/0").json();
    assert_eq!(told["levels"].as_array().unwrap().len(), 1);
}

/// A folder with a surface that takes a while to measure.
fn large() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("large.ply");
    let mesh = shapes::torus(2.0, 0.7, 1200, 600);
    karui_io::write(&path, &Scene::from_mesh(mesh)).unwrap();
    (folder, path)
}

const EYE: &str = "eye=0,3,9&target=0,0,0&up=0,1,0&fov=0.7&width=1600&height=1200";

#[test]
fn maps_can_be_cancelled() {
    let (_folder, path) = large();
    let viewer = Running::of(&[path]);
    for map in ["heat/mesh.glb?level=0", &format!("flip.png?level=0&{EYE}")] {
        let begun = viewer.send("POST", "api/jobs", &[]);
        assert_eq!(begun.status, 201, "{begun:?}");
        let job = begun.json()["job"].as_u64().unwrap();
        let answer = std::thread::scope(|scope| {
            let asked = scope.spawn(|| viewer.get(&format!("api/files/0/{map}&job={job}")));
            while viewer.get(&format!("api/jobs/{job}")).json()["stage"] == "waiting" {
                std::thread::sleep(Duration::from_millis(2));
            }
            viewer.send("DELETE", &format!("api/jobs/{job}"), &[]);
            asked.join().unwrap()
        });
        assert_eq!(
            (answer.status, answer.error().contains("cancelled")),
            (409, true),
            "{map}"
        );
        assert_eq!(viewer.ended(job)["state"], "cancelled", "{map}");
    }
    assert_eq!(viewer.get("api/files/0/heat/mesh.glb?job=99").status, 404);
}

#[test]
fn maps_that_nobody_waits_for_end() {
    let (_folder, path) = large();
    let viewer = Running::of(&[path]);
    let job = viewer.send("POST", "api/jobs", &[]).json()["job"]
        .as_u64()
        .unwrap();
    let asked = viewer.begin("GET", &format!("api/files/0/heat/mesh.glb?job={job}"));
    let report = || viewer.get(&format!("api/jobs/{job}")).json();
    while report()["stage"] == "waiting" {
        std::thread::sleep(Duration::from_millis(2));
    }
    drop(asked);
    assert_eq!(viewer.ended(job)["state"], "cancelled");
    // Nothing was kept of it, and nothing is in the way of the next one.
    let job = viewer.send("POST", "api/jobs", &[]).json()["job"]
        .as_u64()
        .unwrap();
    let glb = viewer.get(&format!("api/files/0/heat/curvature.glb?job={job}"));
    assert_eq!(read(&glb.body).triangle_count(), 1200 * 600 * 2);
    assert_eq!(viewer.ended(job)["state"], "done");
}

#[test]
fn nonsense_is_refused_in_words() {
    let (_folder, path) = folder();
    let viewer = Running::of(&[path]);
    let lod = |body: &str| viewer.send("POST", "api/files/0/lod", body.as_bytes());
    for body in [
        "",
        "{",
        "3",
        r#"{"levels":-1}"#,
        r#"{"taste":1}"#,
        r#"{"quality":"best"}"#,
    ] {
        let answer = lod(body);
        assert!((400..500).contains(&answer.status), "{body}: {answer:?}");
        assert!(!answer.error().is_empty());
    }
    assert_eq!(lod(r#"{"saliency":"taste"}"#).status, 422);
    assert_eq!(lod(&" ".repeat(100_000)).status, 413);
    let job = lod(r#"{"ratios":[2.0]}"#).json()["job"].as_u64().unwrap();
    let report = viewer.ended(job);
    assert_eq!(report["state"], "failed");
    assert!(report["error"].as_str().unwrap().contains('2'), "{report}");
}

#[test]
fn dropped_files_stay_in_memory() {
    let viewer = Running::with(
        &[],
        &ViewerOptions {
            upload_bytes: 4 << 20,
            ..Default::default()
        },
    );
    let (_folder, path) = folder();
    let bytes = std::fs::read(path).unwrap();
    let drop =
        |name: &str, bytes: &[u8]| viewer.send("POST", &format!("api/files?name={name}"), bytes);
    let taken = drop("..%2F..%2Ftorus.ply", &bytes);
    assert_eq!((taken.status, taken.json()["id"].as_u64()), (201, Some(0)));
    assert_eq!(viewer.get("api/files/0").json()["name"], "torus.ply");
    let broken = drop("broken.ply", &bytes[..bytes.len() / 2]);
    assert_eq!(broken.status, 422);
    assert!(
        broken.error().contains("broken.ply") && broken.error().contains("ends early"),
        "{}",
        broken.error()
    );
    for (name, bytes) in [
        ("a.fbx", &b"Kaydara"[..]),
        ("a.obj", b"v 0 0 0"),
        ("a.glb", b""),
        ("a.ply.gz", b"x"),
    ] {
        let refused = drop(name, bytes);
        assert_eq!(refused.status, 422, "{name}");
        assert!(refused.error().contains(name), "{}", refused.error());
    }
    let large = drop("large.stl", &vec![0; (4 << 20) + 1]);
    assert_eq!(large.status, 413);
    assert!(large.error().contains("4194304"), "{}", large.error());
    assert_eq!(
        viewer.get("api/state").json()["files"]
            .as_array()
            .unwrap()
            .len(),
        1
    );
}

#[test]
fn heat_is_what_the_library_finds() {
    let (_folder, path) = folder();
    let viewer = Running::of(&[path]);
    let job = viewer
        .send("POST", "api/files/0/lod", br#"{"ratios":[0.1]}"#)
        .json()["job"]
        .clone();
    assert_eq!(viewer.ended(job.as_u64().unwrap())["state"], "done");
    let coarse = read(&viewer.get("api/files/0/level/1.glb").body);
    let distances =
        karui::metrics::vertex_distances(&coarse.meshes[0].mesh, &torus().meshes[0].mesh);
    let largest = distances.unwrap().into_iter().fold(0.0, f32::max);
    let legend = viewer.get("api/files/0/heat/error.json?level=1").json();
    assert_eq!(legend["max"].as_f64().map(|m| m as f32), Some(largest));
    let painted = read(&viewer.get("api/files/0/heat/error.glb?level=1").body);
    let colors = &painted.meshes[0].mesh.attributes.colors[0];
    let yellow = karui::render::heat_color(1.0);
    assert!(
        colors.iter().any(|c| c.distance(yellow) < 1e-3),
        "the farthest vertex is yellow"
    );
    for kind in ["curvature", "mesh"] {
        let glb = viewer.get(&format!("api/files/0/heat/{kind}.glb"));
        let mesh = read(&glb.body).meshes.remove(0).mesh;
        assert_eq!(mesh.attributes.colors[0].len(), mesh.positions.len());
    }
    assert_eq!(viewer.get("api/files/0/heat/taste.glb").status, 422);
    assert_eq!(viewer.get("api/files/0/heat/mesh.glb?level=7").status, 404);
}

#[test]
fn flip_is_nothing_for_the_original_and_grows() {
    let (_folder, path) = folder();
    let viewer = Running::of(&[path]);
    let job = viewer
        .send("POST", "api/files/0/lod", br#"{"ratios":[0.3,0.02]}"#)
        .json()["job"]
        .clone();
    assert_eq!(viewer.ended(job.as_u64().unwrap())["state"], "done");
    let eye = "eye=0,3,9&target=0,0,0&up=0,1,0&fov=0.7&width=120&height=90";
    let mean = |level: usize| {
        let answer = viewer.get(&format!("api/files/0/flip.png?level={level}&{eye}"));
        assert_eq!(answer.status, 200, "{answer:?}");
        let picture = karui_io::decode_image(&answer.body).unwrap();
        assert_eq!((picture.width(), picture.height()), (120, 90));
        let line = answer
            .head
            .lines()
            .find_map(|l| l.strip_prefix("x-karui-flip: "))
            .unwrap();
        line.parse::<f64>().unwrap()
    };
    let means = [0, 1, 2].map(mean);
    assert_eq!(means[0], 0.0);
    assert!(means[0] < means[1] && means[1] < means[2], "{means:?}");
    let refused = |query: &str| viewer.get(&format!("api/files/0/flip.png?{query}")).status;
    assert_eq!(refused(&format!("level=9&{eye}")), 404);
    assert_eq!(
        refused(&format!(
            "level=1&{}",
            eye.replace("width=120", "width=99999")
        )),
        422
    );
    assert_eq!(
        refused(&format!("level=1&{}", eye.replace("0,3,9", "0,3"))),
        422
    );
    assert_eq!(
        refused(&format!("level=1&{}", eye.replace("0,3,9", "0,0,0"))),
        422
    );
    assert_eq!(refused("level=1"), 400);
}

#[test]
fn tilesets_are_sent_from_their_folder_only() {
    let (folder, secret) = folder();
    let city = folder.path().join("city");
    std::fs::create_dir(&city).unwrap();
    std::fs::write(city.join("tileset.json"), "{}").unwrap();
    std::fs::write(city.join("a b.glb"), "glTF").unwrap();
    let viewer = Running::of(&[city.join("tileset.json"), secret]);
    let told = viewer.get("api/files/0").json();
    assert_eq!(
        (told["kind"].as_str(), told["root"].as_str()),
        (Some("tileset"), Some("tileset.json"))
    );
    assert_eq!(viewer.get("api/files/0/tiles/tileset.json").body, b"{}");
    assert_eq!(viewer.get("api/files/0/tiles/a%20b.glb").body, b"glTF");
    for path in [
        "../torus.ply",
        "..%2Ftorus.ply",
        "%2Fetc%2Fpasswd",
        "none",
        "",
    ] {
        assert_eq!(
            viewer.get(&format!("api/files/0/tiles/{path}")).status,
            404,
            "{path}"
        );
    }
    assert_eq!(viewer.get("api/files/1/tiles/torus.ply").status, 404);
    assert_eq!(viewer.get("api/files/0/level/0.glb").status, 404);
}
