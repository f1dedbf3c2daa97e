//! Vertex clustering, held to what it promises on the mesh zoo and on generated
//! meshes.

#![allow(clippy::unwrap_used, reason = "a failed unwrap fails the test")]

use glam::Vec3;
use karui::mesh::{AttributeValues, TriMesh, diagnose, shapes};
use karui::metrics::{SurfaceDistanceOptions, surface_distance};
use karui::simplify::{ClusterOptions, Clustered, Stop, Stopped, cluster};
use karui::spatial::Bvh;
use karui::{Error, Progress};
use proptest::prelude::*;

fn to(mesh: &TriMesh, stop: Stop) -> Clustered {
    let options = ClusterOptions {
        stop,
        ..ClusterOptions::default()
    };
    cluster(mesh, &options).unwrap()
}

/// What every result owes its input.
fn assert_sound(name: &str, mesh: &TriMesh, target: usize, coarse: &Clustered) {
    coarse
        .mesh
        .validate()
        .unwrap_or_else(|e| panic!("{name}: {e}"));
    let left = coarse.mesh.triangles.len();
    assert!(left <= mesh.triangles.len(), "{name}");
    match coarse.stopped {
        Stopped::Target => assert!(left <= target, "{name}: {left} of {target}"),
        Stopped::Exhausted => assert!(left > target, "{name}: {left} of {target}"),
        other => panic!("{name}: {other:?}"),
    }
    if coarse.cell > 0.0 {
        assert_eq!(diagnose(&coarse.mesh).unwrap().degenerate, 0, "{name}");
    }
    assert!(coarse.error.is_finite() && coarse.error >= 0.0, "{name}");
}

#[test]
fn the_zoo_comes_down_to_any_count() {
    for (name, mesh) in shapes::zoo() {
        for ratio in [1.0, 0.5, 0.1, 0.0] {
            let target = (ratio * mesh.triangles.len() as f64).round() as usize;
            let coarse = to(&mesh, Stop::ratio(ratio));
            assert_sound(name, &mesh, target, &coarse);
            let empty = coarse.mesh.triangles.is_empty();
            assert_eq!(empty, mesh.triangles.is_empty(), "{name} {ratio}");
        }
    }
}

#[test]
fn all_that_was_asked_for_is_used() {
    for (name, mesh) in [
        ("sphere", shapes::icosphere(6)),
        ("terrain", shapes::terrain(150, 150, 3)),
        ("torus", shapes::torus(1.0, 0.3, 200, 100)),
    ] {
        for target in [200, 2000, mesh.triangles.len() / 2] {
            let coarse = to(&mesh, Stop::triangles(target));
            assert_sound(name, &mesh, target, &coarse);
            let left = coarse.mesh.triangles.len();
            assert!(left * 100 >= target * 90, "{name}: {left} of {target}");
        }
    }
}

#[test]
fn no_surface_leaves_its_cell() {
    // A vertex and what it stands for share a cell, so every point of a
    // triangle left lies within a cell's diagonal of the input.
    for (name, mesh) in [
        ("terrain", shapes::terrain(100, 100, 1)),
        ("touching", shapes::touching_parts()),
        ("torus", shapes::torus(1.0, 0.3, 128, 64)),
    ] {
        let coarse = to(&mesh, Stop::ratio(0.2));
        let index = Bvh::build(&mesh).unwrap();
        for p in &coarse.mesh.positions {
            let off = index.closest(p.as_dvec3()).distance_squared.sqrt();
            assert!(
                off <= 3f64.sqrt() * coarse.cell,
                "{name}: {off} {}",
                coarse.cell
            );
        }
    }
}

#[test]
fn a_sphere_stays_close_to_one() {
    let sphere = shapes::icosphere(6);
    let coarse = to(&sphere, Stop::triangles(4000));
    let options = SurfaceDistanceOptions::default();
    let distance = surface_distance(&sphere, &coarse.mesh, &options).unwrap();
    // A chord of length l lies up to l^2 / 8 below the unit sphere, and edges
    // are as long as one to two cells' sides.
    let sag = (2.0 * coarse.cell).powi(2) / 8.0;
    assert!(distance.rms() < sag, "{} {sag}", distance.rms());
    assert!(diagnose(&coarse.mesh).unwrap().closed);
}

#[test]
fn a_flat_grid_stays_flat() {
    let coarse = to(&shapes::grid(64, 64), Stop::ratio(0.1));
    assert!(coarse.mesh.positions.iter().all(|p| p.y.abs() < 1e-6));
    assert!(coarse.error < 1e-4, "{}", coarse.error);
    // UVs are linear over the grid: u is x, and v runs against z or with it.
    let uvs = &coarse.mesh.attributes.uvs[0];
    for (p, uv) in coarse.mesh.positions.iter().zip(uvs) {
        assert!(
            (uv.x - p.x).abs() < 1e-5 && (uv.y - p.z).abs() < 1e-5,
            "{p} {uv}"
        );
    }
}

#[test]
fn open_borders_are_held() {
    for ratio in [0.3, 0.1, 0.03] {
        let coarse = to(&shapes::terrain(100, 100, 2), Stop::ratio(ratio));
        let bounds = coarse.mesh.bounds();
        for axis in [0, 2] {
            assert!(
                bounds.min[axis].abs() < 0.1 * coarse.cell as f32,
                "{ratio} {bounds:?}"
            );
            assert!(
                (bounds.max[axis] - 1.0).abs() < 0.1 * coarse.cell as f32,
                "{ratio} {bounds:?}"
            );
        }
    }
}

#[test]
fn charts_do_not_mix() {
    // A seam: u jumps from 1 to 0 there, so a triangle with corners from both
    // of its sides would span nearly all of the texture.
    let sphere = shapes::textured_sphere(60, 90);
    for ratio in [0.5, 0.1, 0.03] {
        let coarse = to(&sphere, Stop::ratio(ratio)).mesh;
        let (uvs, normals) = (
            &coarse.attributes.uvs[0],
            coarse.attributes.normals.as_ref(),
        );
        for triangle in &coarse.triangles {
            let u = triangle.map(|v| uvs[v as usize].x);
            let near_pole = triangle
                .iter()
                .any(|&v| coarse.positions[v as usize].y.abs() > 0.8);
            let spread =
                u.iter().fold(0f32, |a, b| a.max(*b)) - u.iter().fold(1f32, |a, b| a.min(*b));
            assert!(near_pole || spread < 0.4, "{ratio}: {u:?}");
        }
        for (p, n) in coarse.positions.iter().zip(normals.unwrap()) {
            assert!(n.dot(p.normalize()) > 0.9 && (n.length() - 1.0).abs() < 1e-5);
        }
    }
}

#[test]
fn everything_a_mesh_carries_comes_along() {
    let sphere = shapes::loaded_sphere(48, 64);
    let coarse = to(&sphere, Stop::ratio(0.2)).mesh;
    assert_eq!(coarse.ranges.len(), 2);
    let AttributeValues::U32(numbers) = &coarse.face_attributes[0].values else {
        panic!("numbers are U32");
    };
    let before = sphere.range_of_triangles();
    for (range, &number) in coarse.range_of_triangles().iter().zip(numbers) {
        assert_eq!(*range, before[number as usize]);
    }
    for skin in &coarse.attributes.skins[0] {
        assert!((skin.weights.iter().sum::<f32>() - 1.0).abs() < 1e-5);
    }
    let morph = coarse.attributes.morphs[0].positions.as_ref().unwrap();
    for (p, m) in coarse.positions.iter().zip(morph) {
        assert!(m.distance(*p * 0.1) < 0.05);
    }
}

#[test]
fn locked_vertices_do_not_move() {
    let terrain = shapes::terrain(60, 60, 5);
    let locks: Vec<bool> = (0..terrain.positions.len()).map(|v| v % 97 == 0).collect();
    let options = ClusterOptions {
        stop: Stop::ratio(0.2),
        locks: Some(&locks),
        ..ClusterOptions::default()
    };
    let coarse = cluster(&terrain, &options).unwrap();
    let places: Vec<[u32; 3]> = coarse
        .mesh
        .positions
        .iter()
        .map(|p| p.to_array().map(f32::to_bits))
        .collect();
    let kept = |v: usize| places.contains(&terrain.positions[v].to_array().map(f32::to_bits));
    let held = locks.iter().filter(|l| **l).count();
    let found = (0..locks.len()).filter(|&v| locks[v] && kept(v)).count();
    assert!(found * 10 >= held * 9, "{found} of {held}");

    let all = vec![true; terrain.positions.len()];
    let options = ClusterOptions {
        locks: Some(&all),
        ..options
    };
    let coarse = cluster(&terrain, &options).unwrap();
    assert_eq!(coarse.stopped, Stopped::Exhausted);
    assert!(coarse.mesh == terrain);
}

#[test]
fn the_error_bound_holds_and_is_named() {
    let torus = shapes::torus(1.0, 0.3, 200, 100);
    let mut before = usize::MAX;
    for bound in [0.001, 0.004, 0.016] {
        let coarse = to(&torus, Stop::ratio(0.001).or_error(bound));
        assert_eq!(coarse.stopped, Stopped::ErrorBound);
        assert!(
            coarse.error <= bound && coarse.error > 0.2 * bound,
            "{}",
            coarse.error
        );
        let options = SurfaceDistanceOptions::default();
        let rms = surface_distance(&torus, &coarse.mesh, &options)
            .unwrap()
            .rms();
        assert!(rms <= bound, "{rms} {bound}");
        assert!(coarse.mesh.triangles.len() < before);
        before = coarse.mesh.triangles.len();
    }
    let coarse = to(&torus, Stop::ratio(0.5).or_error(1.0));
    assert_eq!(coarse.stopped, Stopped::Target);
}

#[test]
fn what_topology_forbids_is_no_obstacle() {
    // A thousand loose cubes: no edge collapse can go below four triangles a
    // part.
    let mut mesh = TriMesh::default();
    for i in 0..1000 {
        let cube = shapes::closed_cube(2);
        let first = mesh.positions.len() as u32;
        let place = Vec3::new((i % 10) as f32, (i / 10 % 10) as f32, (i / 100) as f32) * 1.5;
        mesh.positions
            .extend(cube.positions.iter().map(|p| *p + place));
        mesh.triangles
            .extend(cube.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    let coarse = to(&mesh, Stop::triangles(1000));
    assert_sound("cubes", &mesh, 1000, &coarse);
    assert!(
        coarse.mesh.triangles.len() > 100,
        "{}",
        coarse.mesh.triangles.len()
    );
}

#[test]
fn threads_change_nothing() {
    for mesh in [
        shapes::loaded_sphere(100, 120),
        shapes::terrain(200, 200, 9),
    ] {
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let pool = pool.build().unwrap();
            let coarse = pool.install(|| to(&mesh, Stop::ratio(0.1)));
            (coarse.mesh, coarse.error.to_bits(), coarse.joined)
        };
        let one = run(1);
        assert!(one == run(2) && one == run(8));
    }
}

#[test]
fn nonsense_is_refused() {
    let sphere = shapes::icosphere(2);
    let refused = |options: ClusterOptions<'_>| cluster(&sphere, &options).unwrap_err();
    let bad = refused(ClusterOptions {
        stop: Stop::ratio(2.0),
        ..ClusterOptions::default()
    });
    assert!(matches!(bad, Error::BadOption { .. }));
    let short = refused(ClusterOptions {
        locks: Some(&[true]),
        ..ClusterOptions::default()
    });
    assert!(matches!(short, Error::LengthMismatch { .. }));

    struct Impatient;
    impl Progress for Impatient {
        fn report(&self, _: &'static str, _: f32) {}
        fn cancelled(&self) -> bool {
            true
        }
    }
    let cancelled = refused(ClusterOptions {
        progress: &Impatient,
        ..ClusterOptions::default()
    });
    assert_eq!(cancelled, Error::Cancelled);
}

proptest! {
    #[test]
    fn any_soup_stays_valid(
        places in prop::collection::vec((0u8..12, 0u8..12, 0u8..12), 3..80),
        corners in prop::collection::vec((0usize..80, 0usize..80, 0usize..80), 1..160),
        scale in prop::sample::select(vec![1.0f32, 1e-30, 1e18, 1e37]),
        offset in prop::sample::select(vec![0.0f32, 0.0, 3e7]),
        target in 0usize..80,
    ) {
        let place = |&(x, y, z): &(u8, u8, u8)| {
            Vec3::new(f32::from(x), f32::from(y), f32::from(z)) * 0.25 * scale + offset
        };
        let n = places.len();
        let triangles = corners.iter().map(|&(a, b, c)| [a, b, c].map(|v| (v % n) as u32));
        let mesh = TriMesh::new(places.iter().map(place).collect(), triangles.collect());
        let coarse = to(&mesh, Stop::triangles(target));
        prop_assert!(coarse.mesh.validate().is_ok());
        prop_assert!(coarse.mesh.triangles.len() <= mesh.triangles.len());
        if coarse.stopped == Stopped::Target {
            prop_assert!(coarse.mesh.triangles.len() <= target);
        }
        prop_assert!(coarse.error.is_finite());
    }
}
