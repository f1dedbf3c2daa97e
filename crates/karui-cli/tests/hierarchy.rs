//! `karui hierarchy`, end to end.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::Folder;
use karui::mesh::{Scene, shapes};

fn folder() -> Folder {
    let folder = Folder::new();
    folder.scene("ball.ply", &Scene::from_mesh(shapes::icosphere(5)));
    folder.scene("land.glb", &Scene::from_mesh(shapes::terrain(40, 30, 3)));
    folder
}

#[test]
fn built_once_and_refined_along_a_path() {
    let folder = folder();
    let built = folder
        .ok("hierarchy build ball.ply -o ball.kheh --json")
        .json();
    assert_eq!(built["triangles"]["finest"], 20_480);
    assert!(built["bytes_per_node"].as_f64().unwrap() <= 60.0);
    let written = std::fs::metadata(folder.path("ball.kheh")).unwrap().len();
    assert_eq!(built["bytes"], written);
    let path = r#"{"frames":[
        {"camera":{"eye":[0,0,3],"target":[0,0,0],"fov":40}},
        {"camera":{"eye":[0,0,60],"target":[0,0,0],"fov":40},
         "lights":[{"type":"point","position":[4,4,4]},{"type":"directional","direction":[0,-1,0]}]},
        {"camera":{"eye":[0,0,3],"target":[0,0,0],"fov":40}}]}"#;
    std::fs::write(folder.path("path.json"), path).unwrap();
    let args = "--path path.json --size 320x200 --area 2 --pictures --meshes --json";
    let ran = folder.ok(&format!(
        "hierarchy refine ball.ply --hierarchy ball.kheh -o a {args}"
    ));
    let frames = ran.json()["frames"].as_array().unwrap().clone();
    assert_eq!(frames.len(), 3);
    assert!(frames[0]["triangles"].as_u64() > frames[1]["triangles"].as_u64());
    assert_eq!(frames[0]["triangles"], frames[2]["triangles"]);
    let csv = std::fs::read_to_string(folder.path("a/frames.csv")).unwrap();
    assert_eq!(csv.lines().count(), 4);
    for (i, frame) in frames.iter().enumerate() {
        let scene = karui_io::read(folder.path(&format!("a/frame-{i:03}.glb"))).unwrap();
        assert_eq!(
            scene.triangle_count() as u64,
            frame["triangles"].as_u64().unwrap()
        );
        let png = std::fs::read(folder.path(&format!("a/frame-{i:03}.png"))).unwrap();
        let picture = karui_io::decode_image(&png).unwrap();
        assert_eq!((picture.width(), picture.height()), (320, 200));
    }
    // The same without the file, on one thread.
    folder.ok(&format!(
        "hierarchy refine ball.ply -o b {args} --threads 1"
    ));
    for name in ["frame-000.glb", "frame-001.png", "frame-002.glb"] {
        let [a, b] =
            ["a", "b"].map(|d| std::fs::read(folder.path(&format!("{d}/{name}"))).unwrap());
        assert!(a == b, "{name}");
    }
}

#[test]
fn a_budget_bounds_every_frame() {
    let folder = folder();
    let ran =
        folder.ok("hierarchy refine land.glb -o out --around 5 --triangles 900 --area 1 --json");
    for frame in ran.json()["frames"].as_array().unwrap() {
        assert!(frame["triangles"].as_u64().unwrap() <= 900, "{frame}");
    }
    assert!(folder.path("out/frames.csv").exists());
}

#[test]
fn benches_print_their_tables() {
    let folder = folder();
    for args in [
        "ball.ply --frames 20 --sizes 2000",
        "land.glb --check 12",
        "ball.ply --paper --areas 60",
    ] {
        let ran = folder.ok(&format!("hierarchy bench {args}"));
        assert!(ran.out.contains("Machine: "), "{ran:?}");
        assert!(
            ran.out.lines().filter(|l| l.starts_with('|')).count() > 2,
            "{ran:?}"
        );
    }
}

/// What `karui view` records: a frame for each camera that was asked for.
#[test]
fn recorded_paths_are_walked() {
    let folder = folder();
    let frame = |x: f32| {
        format!(
            r#"{{"camera":{{"eye":[{x},0.5,3],"target":[0,0,0],"fov":40}},
                "lights":[{{"type":"point","position":[1,2,3],"intensity":1}}]}}"#
        )
    };
    let path = |frames: Vec<String>| format!(r#"{{"frames":[{}]}}"#, frames.join(","));
    let eyes = (0..9u8).map(|i| frame(0.1 * f32::from(i))).collect();
    std::fs::write(folder.path("path.json"), path(eyes)).unwrap();
    std::fs::write(folder.path("one.json"), path(vec![frame(0.0)])).unwrap();
    let ran = folder.ok("hierarchy bench ball.ply --path path.json");
    assert!(ran.out.contains("along `path.json`"), "{ran:?}");
    for wrong in [
        "one.json",
        "none.json",
        "path.json --sizes 2000",
        "path.json --frames 20",
    ] {
        folder.fails(2, &format!("hierarchy bench ball.ply --path {wrong}"));
    }
}

#[test]
fn what_is_wrong_is_named_and_nothing_is_written() {
    let folder = folder();
    folder.ok("hierarchy build ball.ply -o ball.kheh");
    let bytes = std::fs::read(folder.path("ball.kheh")).unwrap();
    std::fs::write(folder.path("short.kheh"), &bytes[..bytes.len() / 2]).unwrap();
    let mut altered = bytes.clone();
    altered[500] ^= 1;
    std::fs::write(folder.path("altered.kheh"), altered).unwrap();
    std::fs::write(folder.path("none.json"), r#"{"frames":[]}"#).unwrap();
    let nan = r#"{"frames":[{"camera":{"eye":[0,0,0],"target":[0,0,0]}}]}"#;
    std::fs::write(folder.path("nowhere.json"), nan).unwrap();
    std::fs::write(folder.path("empty.ply"), "").unwrap();
    for (args, said) in [
        (
            "refine ball.ply --hierarchy short.kheh -o out",
            "short.kheh",
        ),
        (
            "refine ball.ply --hierarchy altered.kheh -o out",
            "altered.kheh",
        ),
        ("refine ball.ply --hierarchy ball.ply -o out", "ball.ply"),
        (
            "refine ball.ply --hierarchy missing.kheh -o out",
            "missing.kheh",
        ),
        (
            "refine land.glb --hierarchy ball.kheh -o out",
            "another mesh",
        ),
        ("refine ball.ply --path none.json -o out", "none.json"),
        (
            "refine ball.ply --path nowhere.json -o out",
            "camera.target",
        ),
        ("refine ball.ply --path ball.ply -o out", "ball.ply"),
        ("refine ball.ply --area=-1 -o out", "--area"),
        ("refine ball.ply --highlight 200 -o out", "--highlight"),
        ("build empty.ply -o out", "empty.ply"),
        ("build ball.ply --alpha 0.5 -o out", "--alpha"),
    ] {
        let ran = folder.run(&format!("hierarchy {args}"));
        assert_eq!(ran.code, Some(2), "{args}: {ran:?}");
        assert!(ran.err.contains(said), "{args}: {ran:?}");
        assert!(!folder.path("out").exists(), "{args}");
    }
    let ran = folder.run("hierarchy build ball.ply -o no/such/folder.kheh");
    assert_eq!(ran.code, Some(3), "{ran:?}");
}
