//! `karui scene terrain` and `karui scene fused`: meshes written as they are made.
#![allow(clippy::unwrap_used, reason = "it is a test")]
#![allow(clippy::print_stdout, reason = "a test that is skipped says so")]

mod common;

use common::Folder;
use karui::TriMesh;
use karui::geom::{Vec3, normal_times_two_areas};
use karui::mesh::{diagnose, shapes};
use std::path::PathBuf;

fn mesh(folder: &Folder, name: &str) -> TriMesh {
    let scene = karui_io::read(folder.path(name)).unwrap();
    scene.into_single_mesh().unwrap()
}

#[test]
fn land_is_the_landscape_of_the_library() {
    let folder = Folder::new();
    let made = folder
        .ok("scene terrain --size 61x33 --seed 5 -o a.ply --json")
        .json();
    assert_eq!(
        (&made["vertices"], &made["triangles"]),
        (&2013.into(), &3840.into())
    );
    let (land, same) = (mesh(&folder, "a.ply"), shapes::landscape(60, 32, 5));
    assert_eq!(land.positions, same.positions);
    for t in 0..land.triangles.len() {
        assert!(normal_times_two_areas(land.corners(t)).y > 0.0);
    }
    let report = diagnose(&land).unwrap();
    assert_eq!((report.components, report.nonmanifold_edges), (1, 0));
}

#[test]
fn half_of_it_is_flat_if_asked() {
    let folder = Folder::new();
    folder.ok("scene terrain --size 65x9 --half-flat -o a.ply");
    let (land, whole) = (mesh(&folder, "a.ply"), shapes::landscape(64, 8, 1));
    for (p, q) in land.positions.iter().zip(&whole.positions) {
        if p.x >= 32.0 {
            assert_eq!(p.y, 0.0);
        } else if p.x <= 28.0 {
            assert_eq!(p, q);
        }
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let folder = Folder::new();
    folder.ok("scene terrain --size 700x400 --threads 1 -o a.ply");
    let one = std::fs::read(folder.path("a.ply")).unwrap();
    for threads in [2, 8] {
        folder.ok(&format!(
            "scene terrain --size 700x400 --threads {threads} -o b.ply"
        ));
        assert!(one == std::fs::read(folder.path("b.ply")).unwrap());
    }
    folder.ok("scene terrain --size 700x400 --seed 2 -o b.ply");
    assert!(one != std::fs::read(folder.path("b.ply")).unwrap());
}

#[test]
fn copies_stand_apart_and_are_turned() {
    let folder = Folder::new();
    let options = karui_io::WriteOptions::default();
    let mut one = shapes::textured_sphere(6, 9);
    for p in &mut one.positions {
        *p = *p * Vec3::new(1.0, 2.0, 3.0) + Vec3::new(5.0, 0.0, 0.0);
    }
    let scene = karui::Scene::from_mesh(one.clone());
    karui_io::write_with(folder.path("one.ply"), &scene, &options).unwrap();
    karui_io::write_with(folder.path("one.off"), &scene, &options).unwrap();
    folder.ok("scene fused one.ply --count 5 -o a.ply");
    let fused = mesh(&folder, "a.ply");
    let (n, t) = (one.positions.len(), one.triangles.len());
    assert_eq!(
        (fused.positions.len(), fused.triangles.len()),
        (5 * n, 5 * t)
    );
    assert_eq!(fused.positions[..n], one.positions);
    for copy in 0..5 {
        let shifted: Vec<_> = one
            .triangles
            .iter()
            .map(|t| t.map(|v| v + (copy * n) as u32))
            .collect();
        assert_eq!(fused.triangles[copy * t..(copy + 1) * t], shifted);
    }
    // No two boxes overlap, and each copy keeps its size, turned or not.
    let boxes: Vec<_> = fused
        .positions
        .chunks(n)
        .map(|c| karui::geom::Aabb::of(c.iter().copied()))
        .collect();
    for (i, a) in boxes.iter().enumerate() {
        assert!((a.diagonal() - boxes[0].diagonal()).abs() < 1e-4);
        for b in &boxes[..i] {
            let apart = (a.min - b.max).max(b.min - a.max);
            assert!(apart.x > 0.0 || apart.z > 0.0);
        }
    }
    // What cannot be read in slices is read whole.
    assert_eq!(
        folder
            .ok("scene fused one.off --count 5 -o b.ply --json")
            .json()["triangles"],
        5 * t
    );
}

#[test]
fn what_cannot_be_made_leaves_nothing_behind() {
    let folder = Folder::new();
    for args in [
        "scene terrain --size 1x5 -o a.ply",
        "scene terrain --size 70000x70000 -o a.ply",
        "scene terrain --size 5 -o a.ply",
        "scene terrain -o a.obj",
        "scene terrain -o a.ply.gz",
        "scene terrain --heights none.png -o a.ply",
        "scene terrain --heights a.png --seed 3 -o a.ply",
        "scene terrain --spacing 2 -o a.ply",
        "scene fused none.ply -o a.ply",
        "scene fused none.ply --count 0 -o a.ply",
    ] {
        folder.fails(2, args);
    }
    folder.fails(3, "scene terrain --size 5x5 -o none/a.ply");
    assert_eq!(std::fs::read_dir(folder.path(".")).unwrap().count(), 0);
}

#[test]
fn the_earth_from_a_height_map() {
    let default = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/models");
    let models = std::env::var_os("KARUI_MODELS").map_or(default, PathBuf::from);
    let map = models.join("terrain/etopo5_u16_plus11000_north_up.png");
    if !map.is_file() {
        println!("SKIPPED: no {}", map.display());
        return;
    }
    let folder = Folder::new();
    let args = "--zero 11000 --spacing 9266 -o a.ply --json";
    let ran = folder.ok(&format!("scene terrain --heights {} {args}", map.display()));
    let made = ran.json();
    assert_eq!(made["triangles"], 18_658_080);
    let source = karui_io::slices::open(folder.path("a.ply")).unwrap();
    let (mut lowest, mut highest) = (f32::INFINITY, f32::NEG_INFINITY);
    for row in 0..2161 {
        let slice = source.read_vertices(row * 4320..(row + 1) * 4320).unwrap();
        for p in slice.positions {
            lowest = lowest.min(p.y);
            highest = highest.max(p.y);
        }
    }
    // The deepest and the highest five minutes of the earth, metres.
    assert!((-10_900.0..-10_000.0).contains(&lowest), "{lowest}");
    assert!((7_000.0..8_850.0).contains(&highest), "{highest}");
}
