//! `karui scene`: made-up scenes, and what other commands make of them.
#![allow(clippy::unwrap_used, reason = "it is a test")]

mod common;

use common::Folder;
use std::path::PathBuf;

#[test]
fn a_forest_is_made_to_measure() {
    let folder = Folder::new();
    let ran = folder.ok("scene forest --count 500 --seed 3 -o a.glb --json");
    let made = ran.json();
    // The ground is one more.
    assert_eq!(made["instances"], 501);
    // Yaw and scale: translations, rotations, scales of 12, 16 and 12 bytes.
    assert_eq!(made["placement_bytes"], 500 * 40);
    let info = &folder.ok("info a.glb --json").json()[0];
    assert_eq!(
        (&info["instances"], &info["placements"]),
        (&501.into(), &500.into())
    );
    assert_eq!(info["drawn_triangles"], made["drawn_triangles"]);
    let text = folder.ok("info a.glb").out;
    assert!(
        text.contains("500 of the instances are placements"),
        "{text}"
    );
    folder.ok("validate a.glb");
}

#[test]
fn the_same_arguments_give_the_same_bytes() {
    let folder = Folder::new();
    for what in ["forest --red 0.2", "city"] {
        let bytes = |name: &str, seed: u32, threads: u32| {
            let args = format!("scene {what} --seed {seed} --threads {threads} -o {name}");
            folder.ok(&args);
            std::fs::read(folder.path(name)).unwrap()
        };
        let first = bytes("a.glb", 1, 1);
        assert!(first == bytes("b.glb", 1, 8), "{what}");
        assert!(first != bytes("c.glb", 2, 1), "{what}");
    }
}

#[test]
fn one_line_at_the_end_and_none_if_quiet() {
    let folder = Folder::new();
    let ran = folder.ok("scene city --count 300 -o a.gltf");
    assert_eq!(ran.out.lines().count(), 1, "{ran:?}");
    assert!(ran.out.contains("a city of 300 objects"), "{ran:?}");
    assert!(
        folder
            .ok("scene kato1998 mixed -o b.glb --quiet")
            .out
            .is_empty()
    );
    let single = folder.ok("scene kato1998 single -o c.glb --json").json();
    assert_eq!(
        (&single["instances"], &single["drawn_triangles"]),
        (&32.into(), &3360.into())
    );
}

#[test]
fn a_forest_renders_and_has_levels() {
    let folder = Folder::new();
    folder.ok("scene forest --count 200 --kinds conifer -o a.glb");
    folder.ok("render a.glb -o a.png --size 320x200");
    folder.ok("lod a.glb -o lods --ratio 0.5");
    folder.ok("convert a.glb a.ply");
    let info = &folder.ok("info a.ply --json").json()[0];
    // 128 x 128 cells of ground.
    assert_eq!(info["triangles"], 200 * 105 + 2 * 128 * 128);
}

#[test]
fn a_million_places_do_not_become_a_million_copies() {
    let folder = Folder::new();
    let made = folder
        .ok("scene forest --count 1000000 --no-ground -o a.glb --json")
        .json();
    assert_eq!(made["instances"], 1_000_000);
    assert!(made["bytes"].as_u64().unwrap() < 45_000_000, "{made}");
    assert_eq!(
        folder.ok("info a.glb --json").json()[0]["instances"],
        1_000_000
    );
    for name in ["a.obj", "a.stl", "a.off"] {
        let ran = folder.fails(2, &format!("convert a.glb {name}"));
        assert!(ran.err.contains("all instances together"), "{ran:?}");
    }
}

#[test]
fn nonsense_is_refused() {
    let folder = Folder::new();
    folder.fails(2, "scene forest -o a.obj");
    folder.fails(2, "scene forest --red 2 -o a.glb");
    folder.fails(2, "scene forest --count -5 -o a.glb");
    folder.fails(2, "scene city --block 0 -o a.glb");
    folder.fails(2, "scene city --parts nowhere -o a.glb");
    std::fs::create_dir(folder.path("empty")).unwrap();
    folder.fails(2, "scene city --parts empty -o a.glb");
    folder.fails(3, "scene forest -o missing/a.glb");
}

/// The KayKit parts, if the models are there.
#[test]
fn a_city_of_given_parts() {
    let default = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/models");
    let models = std::env::var_os("KARUI_MODELS").map_or(default, PathBuf::from);
    let parts = models.join("scenes/kaykit-city");
    if !parts.is_dir() {
        println!("SKIPPED: no models at {}", models.display());
        return;
    }
    let folder = Folder::new();
    let args = format!(
        "scene city --count 2000 --parts {} -o a.glb --json",
        parts.display()
    );
    let made = folder.ok(&args).json();
    assert_eq!(made["instances"], 2000);
    let info = &folder.ok("info a.glb --json").json()[0];
    // One texture for all.
    assert_eq!(
        (&info["images"], &info["materials"]),
        (&1.into(), &1.into())
    );
}
