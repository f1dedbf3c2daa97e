//! `karui render`, end to end.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::{Folder, karui};
use karui::render::Picture;
use std::path::Path;

fn picture(folder: &Folder, name: &str) -> Picture {
    karui_io::decode_image(&folder.read(name)).unwrap()
}

/// Pixels that are not of this colour.
fn drawn(picture: &Picture, background: [u8; 3]) -> usize {
    let is_drawn = |p: &&[u8; 4]| p[..3] != background;
    picture.pixels().iter().filter(is_drawn).count()
}

/// The model of the README, whose texture is a PNG or JPEG inside.
fn cloth() -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let path = root.join("../../assets/sheen_cloth.glb");
    path.display().to_string()
}

#[test]
fn a_model_is_drawn_with_its_textures() {
    let folder = Folder::new();
    let model = cloth();
    let ran = folder.ok(&format!(
        "render {model} -o a.png --size 120x90 --background 102030"
    ));
    assert!(ran.out.starts_with("a.png: 120 x 90 pixels"), "{ran:?}");
    assert_eq!(ran.err, "");
    folder.ok(&format!(
        "render {model} -o clay.png --size 120x90 --paint clay -q"
    ));
    let shown = picture(&folder, "a.png");
    assert_eq!((shown.width(), shown.height()), (120, 90));
    let some = drawn(&shown, [0x10, 0x20, 0x30]);
    assert!((500..10_000).contains(&some), "{some} pixels");
    assert_eq!(shown.get(0, 0), Some([0x10, 0x20, 0x30, 255]));
    // The cloth is blue, clay is grey.
    let blueness = |p: &Picture| -> i64 {
        let middle = |[r, _, b, _]: [u8; 4]| i64::from(b) - i64::from(r);
        (30..60).map(|y| middle(p.get(60, y).unwrap())).sum()
    };
    assert!(blueness(&shown) > 30 * 30, "{}", blueness(&shown));
    assert!(blueness(&picture(&folder, "clay.png")).abs() < 30 * 12);
}

#[test]
fn the_same_bytes_for_any_number_of_threads() {
    let folder = Folder::new();
    let model = cloth();
    let run = |name: &str, threads: &str| {
        let args = ["render", &model, "-o", name, "--size", "200", "--wireframe"];
        let mut command = karui();
        command.current_dir(folder.path(".")).args(args);
        let status = command.env("RAYON_NUM_THREADS", threads).output().unwrap();
        assert!(status.status.success(), "{status:?}");
        folder.read(name)
    };
    let first = run("a.png", "1");
    assert!(first == run("b.png", "1"));
    assert!(first == run("c.png", "2"));
}

#[test]
fn several_models_make_a_sheet() {
    let folder = Folder::new();
    folder.family("family.glb");
    folder.ok("simplify family.glb -o coarse.glb --ratio 0.1");
    let ran = folder.ok("render family.glb coarse.glb -o sheet.png --size 200x100 --json");
    let document = ran.json();
    assert_eq!(document["width"], 400);
    assert_eq!(document["height"], 116, "100 pixels and a line of text");
    assert_eq!(document["files"][0], "sheet.png");
    assert_eq!(document["models"].as_array().unwrap().len(), 2);
    let sheet = picture(&folder, "sheet.png");
    assert_eq!((sheet.width(), sheet.height()), (400, 116));
    let ran = folder.ok("render family.glb coarse.glb -o said.png --size 400x100 --errors --json");
    let models = ran.json()["models"].clone();
    assert_eq!(models[0]["rms_of_diagonal"], serde_json::Value::Null);
    assert!(models[1]["rms_of_diagonal"].as_f64() > Some(0.0));
    assert_ne!(folder.read("said.png"), folder.read("sheet.png"));
    // The first tile is the picture of that model alone.
    folder.ok("render family.glb -o one.png --size 200x100");
    let one = picture(&folder, "one.png");
    for y in 0..100 {
        for x in 0..200 {
            assert_eq!(sheet.get(x, y), one.get(x, y), "{x} {y}");
        }
    }
    // The second is seen by the same camera.
    let silhouettes_differ = (0..100 * 200).filter(|i| {
        let (x, y) = (i % 200, i / 200);
        let background = sheet.get(0, 0);
        (sheet.get(x, y) == background) != (sheet.get(x + 200, y) == background)
    });
    assert!(silhouettes_differ.count() < 300);
}

#[test]
fn a_turntable_is_written_whole() {
    let folder = Folder::new();
    folder.terrain("land.ply");
    let ran = folder.ok("render land.ply -o turn.png --turntable 4 --size 64");
    assert!(
        ran.out
            .starts_with("4 pictures, turn-000.png to turn-003.png"),
        "{ran:?}"
    );
    let expected = [
        "land.ply",
        "turn-000.png",
        "turn-001.png",
        "turn-002.png",
        "turn-003.png",
    ];
    assert_eq!(folder.names("."), expected);
    // A quarter turn from azimuth 30 is azimuth 120.
    folder.ok("render land.ply -o side.png --azimuth 120 --size 64");
    assert!(folder.read("turn-001.png") != folder.read("turn-000.png"));
    let (side, frame) = (
        picture(&folder, "side.png"),
        picture(&folder, "turn-001.png"),
    );
    let differ = side
        .pixels()
        .iter()
        .zip(frame.pixels())
        .filter(|(a, b)| a != b);
    assert!(differ.count() < 64 * 64 / 50, "rounding alone may differ");
}

#[test]
fn up_is_up_and_front_is_in_front() {
    let folder = Folder::new();
    // A tall thin triangle that points up, and right as seen from +z.
    folder.write("up.obj", "v 0 0 0\nv 1 0 0\nv 1 2 0\nf 1 2 3\n");
    let common = "--size 80 --direction 0,0,1 --background ffffff --samples 1 --orthographic";
    folder.ok(&format!("render up.obj -o a.png {common}"));
    let shown = picture(&folder, "a.png");
    let drawn = |x, y| shown.get(x, y) != Some([255; 4]);
    let row = |y| (0..80).filter(|&x| drawn(x, y)).count();
    let top = (0..80).find(|&y| row(y) > 0).unwrap();
    let bottom = (0..80).rfind(|&y| row(y) > 0).unwrap();
    assert!(row(top + 1) < row(bottom - 1) / 4, "it narrows upwards");
    assert!(
        (40..80).any(|x| drawn(x, top + 1)),
        "its tip is on the right"
    );
    // Height by diagonal: 2 of the square root of 5, in 80 pixels.
    let height = f64::from(bottom - top + 1);
    let expected = 80.0 * 2.0 / 5f64.sqrt();
    // Without perspective as at the target with it: a little less than the sphere.
    assert!(
        (0.9..1.01).contains(&(height / expected)),
        "{height} {expected}"
    );
}

#[test]
fn narrow_pictures_show_all() {
    let folder = Folder::new();
    folder.family("family.glb");
    for more in ["", "--orthographic"] {
        folder.ok(&format!(
            "render family.glb -o a.png --size 60x240 --azimuth 0 {more}"
        ));
        let shown = picture(&folder, "a.png");
        let background = shown.get(0, 0);
        for y in 0..240 {
            assert_eq!(shown.get(0, y), background, "{more}");
            assert_eq!(shown.get(59, y), background, "{more}");
        }
        assert!((0..60).any(|x| shown.get(x, 120) != background));
    }
}

#[test]
fn a_missing_texture_is_done_without() {
    let folder = Folder::new();
    folder.write(
        "a.mtl",
        "newmtl m\nKd 1 0 0\nmap_Kd none.png\nnewmtl n\nmap_Kd bad.png\n",
    );
    folder.write("bad.png", b"\x89PNG\r\n\x1a\n");
    let faces = "usemtl m\nf 1/1 2/2 3/3\nusemtl n\nf 1/1 2/2 4/3\n";
    let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 -1 0\nvt 0 0\nvt 1 0\nvt 0 1\n";
    folder.write("a.obj", format!("mtllib a.mtl\n{vertices}{faces}"));
    let ran = folder.ok("render a.obj -o a.png --size 50");
    assert!(ran.err.contains("none.png"), "{ran:?}");
    assert!(ran.err.contains("bad.png: the file ends early"), "{ran:?}");
    assert_eq!(ran.err.matches("none.png").count(), 1, "said once: {ran:?}");
    let reds = |p: &&[u8; 4]| p[0] > 100 && p[1] < 80;
    let shown = picture(&folder, "a.png");
    assert!(shown.pixels().iter().filter(reds).count() > 50);
    let quiet = folder.ok("render a.obj -o a.png --size 50 -q");
    assert_eq!((quiet.out.as_str(), quiet.err.as_str()), ("", ""));
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let folder = Folder::new();
    folder.terrain("land.ply");
    folder.write("broken.ply", "ply\nformat ascii 1.0\nelement vertex 3\n");
    folder.write("points.obj", "v 0 0 0\nv 1 0 0\n");
    for args in [
        "render broken.ply -o a.png",
        "render land.ply broken.ply -o a.png",
        "render points.obj -o a.png",
        "render none.ply -o a.png",
        "render land.ply -o a.jpg",
        "render land.ply -o a",
        "render land.ply -o a.png --size 0",
        "render land.ply -o a.png --size 99999",
        "render land.ply -o a.png --size 10x0",
        "render land.ply land.ply -o a.png --size 9000x10",
        "render land.ply -o a.png --samples 3",
        "render land.ply -o a.png --fov 180",
        "render land.ply -o a.png --fov nan",
        "render land.ply -o a.png --azimuth nan",
        "render land.ply -o a.png --direction 0,0,0",
        "render land.ply -o a.png --direction 1,2",
        "render land.ply -o a.png --direction 1,0,0 --elevation 3",
        "render land.ply -o a.png --background white",
        "render land.ply -o a.png --turntable 0",
    ] {
        folder.fails(2, args);
    }
    let ran = folder.fails(2, "render land.ply -o a.png --size 99999");
    assert!(
        ran.err.contains("99999 pixels; a side has 1 to 16384"),
        "{ran:?}"
    );
    folder.fails(3, "render land.ply -o none/a.png");
}
