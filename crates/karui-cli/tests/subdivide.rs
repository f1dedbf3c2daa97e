//! `karui subdivide`, end to end.
#![allow(clippy::unwrap_used, reason = "it is a test")]

mod common;

use common::Folder;
use karui::geom::Vec2;
use std::path::{Path, PathBuf};

const CUBE: &str = "\
v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1
f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6
";

fn cube() -> Folder {
    let folder = Folder::new();
    folder.write("cube.obj", CUBE);
    let tags = "t crease 2/1/0 2 3 10\nt crease 2/1/0 3 7 10\nt crease 2/1/0 7 6 10\n";
    let last = "t crease 2/1/0 6 2 10\nt corner 1/1/0 0 1.5\nt hole 1/0/0 4\n";
    folder.write("tagged.obj", format!("{CUBE}{tags}{last}"));
    folder
}

#[test]
fn every_scheme_and_format() {
    let folder = cube();
    for (args, faces, triangles) in [
        ("--levels 3", 384, 768),
        ("--scheme sqrt2 --levels 3", 48, 96),
        ("--scheme bilinear --levels 1", 24, 48),
        ("--limit --normals", 96, 192),
    ] {
        for extension in ["obj", "ply", "off", "glb", "gltf"] {
            let ran = folder.ok(&format!(
                "subdivide cube.obj -o out.{extension} --json {args}"
            ));
            assert_eq!(ran.json()["faces"]["after"], faces, "{args}");
            let mesh = karui_io::read(folder.path(&format!("out.{extension}"))).unwrap();
            assert_eq!(mesh.triangle_count(), triangles, "{args} {extension}");
        }
    }
    folder.ok("convert cube.obj cube.ply");
    for scheme in ["loop", "sqrt3"] {
        let ran = folder.ok(&format!(
            "subdivide cube.ply -o out.glb --scheme {scheme} --json"
        ));
        let times = if scheme == "loop" { 16 } else { 9 };
        assert_eq!(ran.json()["triangles"], 12 * times);
        let ran = folder.fails(
            2,
            &format!("subdivide cube.obj -o no.glb --scheme {scheme}"),
        );
        assert!(
            ran.err.contains("hint: --scheme catmull-clark"),
            "{}",
            ran.err
        );
    }
}

#[test]
fn tags_of_the_file_count_and_options_take_their_place() {
    let folder = cube();
    let ran = folder.ok("subdivide tagged.obj -o out.ply --levels 3 --json");
    assert_eq!(ran.json()["faces"]["after"], 5 * 64, "a hole is left out");
    let mesh = karui_io::read(folder.path("out.ply"))
        .unwrap()
        .into_single_mesh()
        .unwrap();
    let highest = mesh.positions.iter().map(|p| p.y).fold(f32::MIN, f32::max);
    assert_eq!(highest, 1.0, "the top stays flat within its crease");
    let open = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
    folder.write("open.obj", format!("{open}t interpolateboundary 1/0/0 2\n"));
    let corner = |args: &str| {
        folder.ok(&format!("subdivide open.obj -o open.ply --levels 3 {args}"));
        let mesh = karui_io::read(folder.path("open.ply")).unwrap();
        mesh.into_single_mesh().unwrap().positions[0].x
    };
    assert!(corner("") > 0.1, "the file wants round corners");
    assert_eq!(corner("--boundary corner"), 0.0);
}

#[test]
fn texture_coordinates_and_materials_go_along() {
    let folder = Folder::new();
    let uvs = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
    let faces: String = CUBE
        .lines()
        .filter(|l| l.starts_with('f'))
        .enumerate()
        .map(|(i, line)| {
            let corners: Vec<_> = line[2..]
                .split(' ')
                .zip(1..)
                .map(|(v, t)| format!("{v}/{t}"))
                .collect();
            format!("usemtl m{}\nf {}\n", i % 2, corners.join(" "))
        })
        .collect();
    let vertices: String = CUBE
        .lines()
        .filter(|l| l.starts_with('v'))
        .map(|l| format!("{l}\n"))
        .collect();
    folder.write("box.mtl", "newmtl m0\nKd 1 0 0\nnewmtl m1\nKd 0 0 1\n");
    folder.write("box.obj", format!("mtllib box.mtl\n{vertices}{uvs}{faces}"));
    folder.ok("subdivide box.obj -o out.glb --levels 2 --uvs boundaries");
    let scene = karui_io::read(folder.path("out.glb")).unwrap();
    assert_eq!(scene.materials.len(), 2);
    let mesh = &scene.meshes[0].mesh;
    assert_eq!(mesh.triangles.len(), 192);
    let uvs = &mesh.attributes.uvs[0];
    assert!(
        uvs.iter()
            .all(|uv| uv.min_element() > -1e-6 && uv.max_element() < 1.0 + 1e-6)
    );
    let counts: Vec<u32> = mesh.ranges.iter().map(|r| r.count).collect();
    assert_eq!(counts.iter().sum::<u32>(), 192);
    assert_eq!(mesh.ranges.len(), 2);
    folder.ok("subdivide box.obj -o seen.glb --adaptive --pixels 0.5 --uvs boundaries");
    let scene = karui_io::read(folder.path("seen.glb")).unwrap();
    let mesh = &scene.meshes[0].mesh;
    let inside = |uv: &Vec2| uv.min_element() > -1e-6 && uv.max_element() < 1.0 + 1e-6;
    assert_eq!((scene.materials.len(), mesh.ranges.len()), (2, 2));
    assert!(mesh.attributes.uvs[0].iter().all(inside));
    for args in ["--scheme sqrt2 --levels 3", "--scheme sqrt2 --levels 1"] {
        let ran = folder.ok(&format!("subdivide box.obj -o out.glb {args}"));
        assert!(ran.err.contains("left out"), "{}", ran.err);
        let mesh = &karui_io::read(folder.path("out.glb")).unwrap().meshes[0].mesh;
        assert!(mesh.attributes.uvs.is_empty());
    }
    folder.ok("convert box.obj box.ply");
    let ran = folder.fails(2, "subdivide box.ply -o out.glb --scheme sqrt3 --limit");
    assert!(ran.err.contains("leave out --limit"), "{}", ran.err);
}

#[test]
fn weights_of_the_file_count() {
    let folder = cube();
    let heavy = CUBE.replace("v 1 1 1", "v 1 1 1 4");
    folder.write("heavy.obj", heavy);
    let top = |input: &str| {
        folder.ok(&format!("subdivide {input} -o out.ply --limit"));
        let scene = karui_io::read(folder.path("out.ply")).unwrap();
        let sums = scene.meshes[0].mesh.positions.iter();
        sums.map(|p| p.element_sum()).fold(0.0, f32::max)
    };
    assert!(
        top("heavy.obj") > top("cube.obj") + 0.1,
        "it is drawn to the corner"
    );
    let ran = folder.fails(2, "subdivide heavy.obj -o no.ply --adaptive");
    assert!(ran.err.contains("weights"), "{}", ran.err);
    folder.write("none.obj", CUBE.replace("v 1 1 1", "v 1 1 1 0"));
    let ran = folder.fails(2, "subdivide none.obj -o no.ply");
    assert!(ran.err.contains("weight"), "{}", ran.err);
}

#[test]
fn threads_make_no_difference() {
    let folder = cube();
    let bytes = |threads: u32| {
        folder.ok(&format!(
            "subdivide tagged.obj -o t.glb --levels 4 --limit --normals --threads {threads}"
        ));
        folder.read("t.glb")
    };
    let one = bytes(1);
    assert!(one == bytes(2) && one == bytes(8));
}

#[test]
fn what_cannot_be_done_is_said() {
    let folder = cube();
    let ran = folder.fails(2, "subdivide cube.obj -o out.glb --levels 40");
    assert!(ran.err.contains("7.25e24 faces"), "{}", ran.err);
    assert!(ran.err.contains("hint: take fewer --levels"), "{}", ran.err);
    folder.fails(
        2,
        "subdivide cube.obj -o out.glb --levels 5 --max-faces 1000",
    );
    folder.write("two.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n");
    let ran = folder.fails(2, "subdivide two.obj -o out.glb");
    assert!(ran.err.contains("line 3"), "{}", ran.err);
    folder.write("tag.obj", format!("{CUBE}t crease 2/1/0 0 99 1\n"));
    let ran = folder.fails(2, "subdivide tag.obj -o out.glb");
    assert!(ran.err.contains("vertex 99"), "{}", ran.err);
    folder.write("tag.obj", format!("{CUBE}t crease 2/1 0 1 1\n"));
    let ran = folder.fails(2, "subdivide tag.obj -o out.glb");
    assert!(ran.err.contains("line 15"), "{}", ran.err);
    folder.write("none.obj", "v 0 0 0\n");
    folder.fails(2, "subdivide none.obj -o out.glb");
    folder.fails(2, "subdivide cube.obj -o out.xyz");
}

fn model(name: &str) -> Option<PathBuf> {
    let models = std::env::var("KARUI_MODELS")
        .unwrap_or_else(|_| concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/models").into());
    let path = Path::new(&models).join("subdivision").join(name);
    path.exists().then(|| path.canonicalize().unwrap())
}

#[test]
fn control_meshes_of_the_world() {
    let folder = Folder::new();
    let mut found = 0;
    for name in [
        "hand.off",
        "head.off",
        "fish_control_mesh.obj",
        "penguin_control_mesh.obj",
        "spot_control_mesh.obj",
        "suzanne.ply",
        "mannequin-devil.off",
        "quadknot.obj",
        "rabbit.obj",
        "opensubdiv/catmark_helmet.obj",
    ] {
        let Some(path) = model(name) else {
            println!("SKIPPED: {name} is not in KARUI_MODELS");
            continue;
        };
        found += 1;
        let path = path.display();
        let ran = folder.ok(&format!(
            "subdivide {path} -o out.glb --levels 2 --limit --normals --json"
        ));
        let report = ran.json();
        let faces = |when: &str| report["faces"][when].as_u64().unwrap();
        assert!(faces("after") >= 12 * faces("before"), "{name}: {report}");
        let mesh = karui_io::read(folder.path("out.glb"))
            .unwrap()
            .into_single_mesh()
            .unwrap();
        mesh.validate().unwrap();
        let normals = mesh.attributes.normals.as_ref().unwrap();
        let bad = normals
            .iter()
            .filter(|n| (n.length() - 1.0).abs() > 1e-3)
            .count();
        assert!(
            bad * 100 <= normals.len(),
            "{name}: {bad} normals of no length"
        );
    }
    println!("{found} models");
}
