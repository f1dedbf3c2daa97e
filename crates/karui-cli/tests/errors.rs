//! Every way to fail: exit code, message, hint, and nothing left behind.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::{Folder, Ran, karui};
use std::time::Duration;

#[test]
fn bad_usage() {
    let folder = Folder::new();
    folder.terrain("land.ply");
    for args in [
        "",
        "frobnicate",
        "lod",
        "lod land.ply",
        "lod land.ply -o out --ratio 0.5 --triangles 10",
        "lod land.ply -o out --ratio a",
        "lod land.ply -o out --ratio 1.5",
        "lod land.ply -o out --error 0",
        "lod land.ply -o out --pixels -3",
        "lod land.ply -o out --fov 180",
        "lod land.ply -o out --height 0",
        "lod land.ply -o out.obj",
        "simplify land.ply -o out.ply",
        "simplify land.ply -o out.fbx --ratio 0.5",
        "simplify land.ply -o out --ratio 0.5",
        "simplify land.ply -o out.ply --ratio -1",
        "simplify land.ply -o out.ply --error nan",
        "simplify land.ply -o out.ply --ratio 0.5 --weights nosuch",
        "simplify land.ply -o out.ply --ratio 0.5 --normal-weight -1",
        "convert land.ply",
        "convert land.ply land.xyz",
        "measure land.ply",
        "measure land.ply land.ply --map map.txt",
        "validate",
        "validate land.ply --require beautiful",
        "info land.ply --threads 0",
        "completions tcsh9",
        "bench models --models nosuch",
        "bench simplify --models nosuch",
        "bench simplify land.ply --quality nosuch",
    ] {
        let before = folder.files();
        let ran = folder.run(args);
        assert_eq!(ran.code, Some(2), "karui {args}: {ran:?}");
        assert!(!ran.err.is_empty(), "karui {args}: {ran:?}");
        assert_eq!(folder.files(), before, "karui {args}");
    }
}

#[test]
fn hints_follow_errors() {
    let folder = Folder::new();
    folder.terrain("land.ply");
    folder.write("short.txt", "1 2 3");
    folder.write("words.txt", "1\n2 three");
    let hinted = |ran: Ran, words: &[&str]| {
        let error = ran.err.find("error: ").unwrap();
        let hint = ran.err.find("hint: ").unwrap_or_else(|| panic!("{ran:?}"));
        assert!(error < hint, "{ran:?}");
        for word in words {
            assert!(ran.err.contains(word), "{word} in {ran:?}");
        }
    };
    hinted(
        folder.fails(2, "info nosuch.ply"),
        &["nosuch.ply", "spelling"],
    );
    hinted(
        folder.fails(2, "lod land.ply -o x.stl"),
        &["STL", "--format"],
    );
    let simplify = "simplify land.ply -o x.ply --ratio 0.5 --weights";
    hinted(folder.fails(2, &format!("{simplify} nosuch")), &["nosuch"]);
    hinted(
        folder.fails(2, &format!("{simplify} short.txt")),
        &["3 numbers", "1271 vertices"],
    );
    hinted(
        folder.fails(2, &format!("{simplify} words.txt")),
        &["line 2", "three"],
    );
}

#[test]
fn a_model_without_triangles() {
    let folder = Folder::new();
    folder.write("points.obj", "v 0 0 0\nv 1 0 0\n");
    folder.terrain("land.ply");
    folder.fails(2, "lod points.obj -o out");
    folder.fails(2, "simplify points.obj -o out.ply --ratio 0.5");
    folder.fails(2, "measure land.ply points.obj");
    folder.fails(2, "measure points.obj land.ply --map map.ply");
}

#[test]
fn what_cannot_be_written() {
    let folder = Folder::new();
    folder.terrain("land.ply");
    folder.write("file", "in the way");
    std::fs::create_dir(folder.path("folder.glb")).unwrap();
    std::fs::create_dir(folder.path("folder.ply")).unwrap();
    for args in [
        "lod land.ply -o file/out --ratio 0.5",
        "lod land.ply -o file/out.glb --ratio 0.5",
        "lod land.ply -o nosuch/out.glb --ratio 0.5",
        "simplify land.ply -o nosuch/out.ply --ratio 0.5",
        "simplify land.ply -o folder.ply --ratio 0.5",
        "convert land.ply file/out.obj",
        "convert land.ply folder.glb",
        "measure land.ply land.ply --samples 10 --map file/map.ply",
        "man -o file/pages",
        "bench models --models . -o file/measured.md",
        "bench simplify land.ply -o file/measured.md",
    ] {
        let ran = folder.fails(3, args);
        assert!(ran.err.contains("error: cannot write"), "{ran:?}");
        assert!(ran.err.contains("hint: "), "{ran:?}");
    }
    // A folder stands where a level is to go: none of the others appears.
    std::fs::create_dir_all(folder.path("out/land_lod1.glb")).unwrap();
    folder.fails(3, "lod land.ply -o out --ratio 0.5");
}

/// A limit on the size of files stands in for a full disk.
#[cfg(unix)]
#[test]
fn no_space_left_behind() {
    let folder = Folder::new();
    folder.terrain("land.ply");
    let before = folder.files();
    for args in [
        "lod land.ply -o out --ratio 0.5",
        "lod land.ply -o out.glb --ratio 0.5",
        "simplify land.ply -o out.ply --ratio 0.9",
        "convert land.ply out.gltf",
        "man -o pages",
    ] {
        let script = format!("trap '' XFSZ; ulimit -f 2; exec \"$0\" {args}");
        let ran: Ran = std::process::Command::new("sh")
            .args(["-c", &script, env!("CARGO_BIN_EXE_karui")])
            .current_dir(folder.path("."))
            .output()
            .unwrap()
            .into();
        assert_eq!(ran.code, Some(3), "{args}: {ran:?}");
        assert!(ran.err.contains("error: cannot write"), "{args}: {ran:?}");
        assert_eq!(folder.files(), before, "{args}");
    }
}

#[cfg(unix)]
#[test]
fn devices_are_not_overwritten() {
    let folder = Folder::new();
    folder.terrain("land.ply");
    std::os::unix::fs::symlink("/dev/full", folder.path("full.ply")).unwrap();
    let ran = folder.run("convert land.ply full.ply");
    assert_eq!(ran.code, Some(3), "{ran:?}");
}

/// The user's interrupt ends long work with nothing left behind.
#[cfg(unix)]
#[test]
fn interrupted() {
    let folder = Folder::new();
    let large = karui::Scene::from_mesh(karui::mesh::shapes::icosphere(7));
    folder.scene("large.ply", &large);
    let before = folder.files();
    let child = karui()
        .args([
            "lod",
            "large.ply",
            "-o",
            "out",
            "--error",
            "1e-6,2e-6,3e-6,1e-5,1e-4,1e-3",
        ])
        .current_dir(folder.path("."))
        .stderr(std::process::Stdio::piped())
        .stdout(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_millis(600));
    let id = child.id().to_string();
    let killed = std::process::Command::new("kill")
        .args(["-INT", &id])
        .status()
        .unwrap();
    assert!(killed.success(), "it was over before it was interrupted");
    let ran: Ran = child.wait_with_output().unwrap().into();
    assert_eq!(ran.code, Some(130), "{ran:?}");
    assert!(ran.err.contains("error: cancelled"), "{ran:?}");
    assert_eq!(folder.files(), before);
}
