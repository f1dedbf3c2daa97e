//! `karui saliency` and `--saliency`, end to end.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::Folder;
use karui::mesh::{AttributeValues, Scene, shapes};
use karui::{TriMesh, geom::Vec3};

/// A torus with one bump outside.
fn bumped() -> TriMesh {
    let mut mesh = shapes::torus(1.0, 0.45, 192, 96);
    for p in &mut mesh.positions {
        let way = (*p - Vec3::new(1.45, 0.0, 0.0)).length();
        *p *= 1.0 + 0.06 * (-way * way / 0.004).exp();
    }
    mesh
}

fn values(mesh: &TriMesh) -> Vec<f32> {
    let mut custom = mesh.attributes.custom.iter();
    let named = custom.find(|a| a.name.eq_ignore_ascii_case("saliency"));
    match &named.unwrap().values {
        AttributeValues::F32(values) => values.clone(),
        other => panic!("{other:?}"),
    }
}

fn near_bump(mesh: &TriMesh, v: usize) -> bool {
    (mesh.positions[v] - Vec3::new(1.45, 0.0, 0.0)).length() < 0.25
}

#[test]
fn the_bump_is_what_matters() {
    let folder = Folder::new();
    folder.scene("bump.ply", &Scene::from_mesh(bumped()));
    for kind in ["curvature", "mesh", "image", "hybrid"] {
        let ran = folder.ok(&format!(
            "saliency bump.ply -o {kind}.ply --kind {kind} --colors"
        ));
        assert!(ran.out.lines().count() > 10, "{ran:?}");
        let scene = karui_io::read(folder.path(&format!("{kind}.ply"))).unwrap();
        let mesh = &scene.meshes[0].mesh;
        let found = values(mesh);
        assert!(found.iter().all(|v| (0.0..=1.0).contains(v)));
        if kind == "image" {
            continue; // Pictures see outlines, not only bumps.
        }
        let most = (0..found.len()).max_by(|a, b| found[*a].total_cmp(&found[*b]));
        assert!(near_bump(mesh, most.unwrap()), "{kind}");
        assert_eq!(mesh.attributes.colors[0].len(), found.len());
    }
}

#[test]
fn what_matters_keeps_its_triangles() {
    let folder = Folder::new();
    folder.scene("bump.ply", &Scene::from_mesh(bumped()));
    folder.ok("simplify bump.ply -o plain.ply --triangles 2000");
    folder.ok(
        "simplify bump.ply -o steered.ply --triangles 2000 --saliency mesh --saliency-weight 100",
    );
    let near = |name: &str| {
        let scene = karui_io::read(folder.path(name)).unwrap();
        let mesh = scene.meshes[0].mesh.clone();
        (0..mesh.positions.len())
            .filter(|v| near_bump(&mesh, *v))
            .count()
    };
    let (plain, steered) = (near("plain.ply"), near("steered.ply"));
    assert!(steered > plain, "{steered} vertices, {plain} without");
}

#[test]
fn a_higher_power_leaves_less_to_what_is_half_salient() {
    let folder = Folder::new();
    folder.scene("bump.ply", &Scene::from_mesh(bumped()));
    let near = |power: u32| {
        folder.ok(&format!(
            "simplify bump.ply -o {power}.ply --triangles 2000 --saliency hybrid --saliency-power {power}"
        ));
        let scene = karui_io::read(folder.path(&format!("{power}.ply"))).unwrap();
        let mesh = &scene.meshes[0].mesh;
        (0..mesh.positions.len())
            .filter(|v| near_bump(mesh, *v))
            .count()
    };
    let (line, eighth) = (near(1), near(8));
    assert!(eighth > line, "{eighth} vertices, {line} along a line");
}

#[test]
fn a_picture_shows_front_and_back() {
    let folder = Folder::new();
    folder.scene("bump.ply", &Scene::from_mesh(bumped()));
    folder.ok("saliency bump.ply -o a.ply --picture a.png");
    let picture = karui_io::decode_image(&folder.read("a.png")).unwrap();
    assert_eq!((picture.width(), picture.height()), (2 * 768, 768 + 32));
    let yellow = |p: &[u8; 4]| p[0] > 200 && p[1] > 180 && p[2] < 110;
    let inside = |p: &&[u8; 4]| p[3] == 255 && yellow(p);
    assert!(picture.pixels().iter().filter(inside).count() > 100);
    folder.fails(2, "saliency bump.ply -o b.ply --picture b.jpg");
    folder.fails(3, "saliency bump.ply -o b.ply --picture nowhere/b.png");
    assert!(!folder.path("b.ply").exists());
}

#[test]
fn attributes_made_can_be_given_back() {
    let folder = Folder::new();
    folder.scene("bump.ply", &Scene::from_mesh(bumped()));
    folder.ok("saliency bump.ply -o marked.ply");
    folder.ok("simplify marked.ply -o coarse.ply --ratio 0.1 --weights saliency");
    assert!(!folder.read("coarse.ply").is_empty());
}

#[test]
fn presets_are_known_by_name() {
    let folder = Folder::new();
    folder.scene("bump.ply", &Scene::from_mesh(bumped()));
    folder.scene("tiny.ply", &Scene::from_mesh(shapes::cube(2)));
    for (preset, model) in [
        ("lee2005", "bump"),
        ("itti1998", "tiny"),
        ("thesis2014", "tiny"),
    ] {
        let out = format!("{preset}.ply");
        let ran = folder.ok(&format!(
            "saliency {model}.ply -o {out} --preset {preset} --json"
        ));
        assert!(ran.out.contains(preset), "{ran:?}");
        let scene = karui_io::read(folder.path(&out)).unwrap();
        let found = values(&scene.meshes[0].mesh);
        assert!(found.iter().all(|v| (0.0..=1.0).contains(v)), "{preset}");
        assert!(found.iter().any(|v| *v > 0.0), "{preset}");
    }
    let lee = karui_io::read(folder.path("lee2005.ply")).unwrap();
    let mesh = &lee.meshes[0].mesh;
    let found = values(mesh);
    let most = (0..found.len()).max_by(|a, b| found[*a].total_cmp(&found[*b]));
    assert!(near_bump(mesh, most.unwrap()));
}

#[test]
fn a_preset_steers_simplification() {
    let folder = Folder::new();
    folder.scene("bump.ply", &Scene::from_mesh(bumped()));
    folder.ok("simplify bump.ply -o plain.ply --triangles 2000");
    folder.ok("simplify bump.ply -o lee.ply --triangles 2000 --saliency-preset lee2005");
    folder.ok("lod bump.ply -o lods.glb --saliency-preset lee2005");
    folder.ok(
        "simplify bump.ply -o own.ply --triangles 2000 --saliency-preset lee2005 --cost averaged",
    );
    assert_ne!(folder.read("own.ply"), folder.read("lee.ply"));
    assert_ne!(folder.read("plain.ply"), folder.read("lee.ply"));
    for wrong in [
        "saliency bump.ply -o a.ply --preset lee2005 --kind mesh",
        "saliency bump.ply -o a.ply --preset taste",
        "simplify bump.ply -o a.ply --ratio 0.5 --saliency-preset lee2005 --saliency mesh",
        "simplify bump.ply -o a.ply --ratio 0.5 --saliency-preset lee2005 --saliency-weight 5",
        "lod bump.ply -o a.glb --saliency-preset lee2005 --weights w",
    ] {
        folder.fails(2, wrong);
    }
    assert!(!folder.path("a.ply").exists() && !folder.path("a.glb").exists());
}

#[test]
fn bad_use_is_told_and_nothing_written() {
    let folder = Folder::new();
    folder.scene("bump.ply", &Scene::from_mesh(shapes::cube(1)));
    folder.fails(2, "simplify bump.ply -o a.ply --ratio 0.5 --saliency taste");
    folder.fails(
        2,
        "simplify bump.ply -o a.ply --ratio 0.5 --saliency mesh --weights w",
    );
    let ran = folder.fails(
        2,
        "simplify bump.ply -o a.ply --ratio 0.5 --saliency mesh --saliency-weight 0.5",
    );
    assert!(ran.err.contains("1 or more"), "{ran:?}");
    folder.fails(2, "saliency bump.ply -o a.docx");
    let ran = folder.fails(2, "saliency bump.ply -o a.ply --smoothing 2");
    assert!(ran.err.contains("1e-5 to 1"), "{ran:?}");
    folder.fails(2, "saliency none.ply -o a.ply");
    assert!(!folder.path("a.ply").exists());
}
