//! Surface distance against closed forms.

use glam::{DVec3, Vec3};
use karui::metrics::{
    Samples, Surface, SurfaceDistance, SurfaceDistanceOptions, directed_distance, surface_distance,
    surface_distance_between, vertex_distances,
};
use karui::{Error, Progress, TriMesh};
use std::sync::atomic::{AtomicU32, Ordering};

/// A square of `size`, `n` x `n` cells, at height `z`.
fn plane(n: u32, size: f32, z: f32) -> TriMesh {
    let step = size / n as f32;
    let at = |i: u32| Vec3::new((i % (n + 1)) as f32 * step, (i / (n + 1)) as f32 * step, z);
    let mut triangles = Vec::new();
    for i in (0..n * (n + 1)).filter(|i| i % (n + 1) != n) {
        triangles.push([i, i + 1, i + n + 1]);
        triangles.push([i + 1, i + n + 2, i + n + 1]);
    }
    TriMesh::new((0..(n + 1) * (n + 1)).map(at).collect(), triangles)
}

/// A cube of `n` x `n` cells a side blown up to a sphere.
fn sphere(n: u32, radius: f32) -> TriMesh {
    let mut mesh = TriMesh::default();
    for side in 0..6 {
        let face = plane(n, 2.0, 0.0);
        let first = mesh.positions.len() as u32;
        let turned = |p: Vec3| {
            let q = Vec3::new(p.x - 1.0, p.y - 1.0, 1.0);
            let r = [q, Vec3::new(q.z, q.x, q.y), Vec3::new(q.y, q.z, q.x)][side % 3];
            if side < 3 { r } else { -r }
        };
        let on_sphere = |&p: &Vec3| turned(p).normalize() * radius;
        mesh.positions.extend(face.positions.iter().map(on_sphere));
        mesh.triangles
            .extend(face.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    mesh
}

fn count(n: u64) -> SurfaceDistanceOptions<'static> {
    SurfaceDistanceOptions {
        samples: Samples::Count(n),
        ..Default::default()
    }
}

fn assert_close(found: f64, expected: f64, tolerance: f64) {
    assert!(
        (found - expected).abs() <= tolerance,
        "{found} is not {expected}"
    );
}

#[test]
fn parallel_planes_are_as_far_as_they_are_apart() {
    let d = surface_distance(&plane(9, 2.0, 1.0), &plane(4, 2.0, 1.25), &count(20_000)).unwrap();
    for side in [d.a_to_b, d.b_to_a] {
        assert_close(side.max, 0.25, 1e-7);
        assert_close(side.mean, 0.25, 1e-7);
        assert_close(side.rms, 0.25, 1e-7);
    }
    assert_eq!(d.a_to_b.samples, 100 + 40_000);
    assert_eq!(d.b_to_a.samples, 25 + 40_000);
    assert_close(d.diagonal, 8f64.sqrt(), 1e-6);
}

#[test]
fn concentric_spheres_are_as_far_as_their_radii() {
    let d = surface_distance(&sphere(40, 1.0), &sphere(40, 1.5), &count(50_000)).unwrap();
    // Chords of 40 cells a quarter turn lie at most 1e-3 inside.
    for side in [d.a_to_b, d.b_to_a] {
        assert_close(side.mean, 0.5, 1e-3);
        assert_close(side.rms, 0.5, 1e-3);
        assert_close(side.max, 0.5, 2e-3);
    }
}

#[test]
fn a_surface_is_on_itself() {
    let mesh = sphere(20, 1.0);
    let d = surface_distance(&mesh, &mesh, &count(50_000)).unwrap();
    assert!(d.max() < 1e-14, "{}", d.max());
}

#[test]
fn tilted_plane_has_the_moments_of_a_ramp() {
    // Distance grows evenly from 0 to h: mean h / 2, rms h / sqrt(3).
    let mut ramp = plane(1, 1.0, 0.0);
    ramp.positions.iter_mut().for_each(|p| p.z = p.x * 0.1);
    let options = SurfaceDistanceOptions {
        vertices: false,
        edges: false,
        ..count(100_000)
    };
    let d = surface_distance(&ramp, &plane(3, 1.0, 0.0), &options).unwrap();
    assert_close(d.a_to_b.mean, 0.05, 1e-5);
    assert_close(d.a_to_b.rms, 0.1 / 3f64.sqrt(), 1e-5);
    assert!(d.a_to_b.max < 0.1);
    let d = surface_distance(&ramp, &plane(3, 1.0, 0.0), &count(100)).unwrap();
    assert_close(d.a_to_b.max, 0.1, 1e-8);
    let [from, to] = d.a_to_b.farthest;
    assert_eq!((from.x, to.x, to.z), (1.0, 1.0, 0.0));
}

#[test]
fn worse_direction_counts() {
    // A half-plane of a plane: one way 0, the other way the missing half.
    let mut half = plane(2, 1.0, 0.0);
    half.positions.iter_mut().for_each(|p| p.x *= 0.5);
    let d = surface_distance(&half, &plane(2, 1.0, 0.0), &count(10_000)).unwrap();
    assert!(d.a_to_b.max < 1e-15);
    assert_close(d.max(), 0.5, 1e-12);
    assert_eq!((d.mean(), d.rms()), (d.b_to_a.mean, d.b_to_a.rms));
}

#[test]
fn mask_leaves_only_what_it_shows() {
    // A plane bent up beyond x = 1, masked there.
    let mut bent = plane(20, 2.0, 0.0);
    bent.positions
        .iter_mut()
        .for_each(|p| p.z = (p.x - 1.0).max(0.0));
    let flat = plane(20, 2.0, 0.0);
    let mask: Vec<f32> = bent
        .positions
        .iter()
        .map(|p| f32::from(u8::from(p.x < 1.0)))
        .collect();
    let options = SurfaceDistanceOptions {
        weights: Some(&mask),
        ..count(20_000)
    };
    let d = surface_distance(&bent, &flat, &options).unwrap();
    assert!(d.max() < 1e-7, "{}", d.max());
    assert!(d.a_to_b.samples > 15_000 && d.a_to_b.samples < 25_000);
    assert!(d.b_to_a.samples > 15_000 && d.b_to_a.samples < 25_000);
}

#[test]
fn weights_weigh() {
    // Distance x, weight x: mean 2/3, rms sqrt(1/2).
    let mut ramp = plane(1, 1.0, 0.0);
    ramp.positions.iter_mut().for_each(|p| p.z = p.x);
    let weights: Vec<f32> = ramp.positions.iter().map(|p| p.x).collect();
    let mut flat = plane(1, 8.0, 0.0);
    flat.positions
        .iter_mut()
        .for_each(|p| *p -= Vec3::new(4.0, 4.0, 0.0));
    let options = SurfaceDistanceOptions {
        weights: Some(&weights),
        vertices: false,
        edges: false,
        ..count(100_000)
    };
    let d = surface_distance(&ramp, &flat, &options).unwrap();
    assert_close(d.a_to_b.mean, 2.0 / 3.0, 1e-4);
    assert_close(d.a_to_b.rms, 0.5f64.sqrt(), 1e-4);
}

fn bits(d: &SurfaceDistance) -> Vec<u64> {
    let of = |d: karui::metrics::Distance| [d.max.to_bits(), d.mean.to_bits(), d.rms.to_bits()];
    [of(d.a_to_b), of(d.b_to_a)].concat()
}

#[test]
fn threads_and_seeds() {
    let (a, b) = (sphere(30, 1.0), sphere(11, 1.0));
    let run = |threads: usize, seed: u64| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        let options = SurfaceDistanceOptions {
            seed,
            ..count(30_000)
        };
        bits(&pool.install(|| surface_distance(&a, &b, &options).unwrap()))
    };
    let one = run(1, 5);
    assert_eq!(one, run(2, 5));
    assert_eq!(one, run(8, 5));
    assert_ne!(one, run(1, 6));
}

#[test]
fn density_is_samples_a_unit_of_area() {
    let options = SurfaceDistanceOptions {
        samples: Samples::Density(100.0),
        vertices: false,
        edges: false,
        ..Default::default()
    };
    let d = surface_distance(&plane(3, 4.0, 0.0), &plane(1, 2.0, 0.0), &options).unwrap();
    assert_eq!((d.a_to_b.samples, d.b_to_a.samples), (1600, 400));
}

#[test]
fn one_surface_for_many_levels() {
    let original = sphere(20, 1.0);
    let surface = Surface::new(&original).unwrap();
    for n in [3, 7] {
        let level = sphere(n, 1.0);
        let once = surface_distance(&original, &level, &count(500)).unwrap();
        let level = Surface::new(&level).unwrap();
        let again = surface_distance_between(&surface, &level, &count(500));
        assert_eq!(again, Ok(once));
        let back = directed_distance(&level, &surface, &count(500));
        assert_eq!(back, Ok(once.b_to_a));
    }
}

#[test]
fn map_of_a_bump_is_its_height() {
    let mut bump = plane(8, 1.0, 0.0);
    let height = |p: &Vec3| (p.x * 5.0).sin().abs() * 0.1;
    bump.positions.iter_mut().for_each(|p| p.z = height(p));
    let stray = DVec3::new(0.5, 0.5, -3.0);
    bump.positions.push(stray.as_vec3());
    let map = vertex_distances(&bump, &plane(3, 1.0, 0.0)).unwrap();
    for (p, d) in bump.positions.iter().zip(&map) {
        assert_close(f64::from(*d), f64::from(p.z.abs()), 1e-9);
    }
    let nan = TriMesh::new(vec![Vec3::NAN], vec![]);
    let error = vertex_distances(&nan, &bump);
    assert!(matches!(error, Err(Error::NotFinite { index: 0, .. })));
}

#[test]
fn bad_requests_are_errors() {
    let mesh = plane(1, 1.0, 0.0);
    let run = |options: &SurfaceDistanceOptions| surface_distance(&mesh, &mesh, options).err();
    let weights = |w: &[f32]| {
        run(&SurfaceDistanceOptions {
            weights: Some(w),
            ..count(9)
        })
    };
    let density = |d| {
        run(&SurfaceDistanceOptions {
            samples: Samples::Density(d),
            ..count(9)
        })
    };
    let bad = |e| matches!(e, Some(Error::BadOption { .. }));
    let mismatch = matches!(
        weights(&[1.0]),
        Some(Error::LengthMismatch {
            expected: 4,
            found: 1,
            ..
        })
    );
    assert!(mismatch);
    assert!(bad(weights(&[1.0, f32::NAN, 1.0, 1.0])));
    assert!(bad(weights(&[1.0, -1.0, 1.0, 1.0])));
    assert_eq!(
        weights(&[0.0; 4]),
        Some(Error::Empty {
            what: "weight mask"
        })
    );
    assert!(bad(density(-1.0)) && bad(density(f64::NAN)) && bad(density(1e300)));
    assert!(bad(run(&count(u64::MAX))));
    let none = SurfaceDistanceOptions {
        vertices: false,
        ..count(0)
    };
    assert_eq!(
        run(&none),
        Some(Error::Empty {
            what: "set of samples"
        })
    );
    let empty = surface_distance(&TriMesh::default(), &mesh, &count(9));
    assert_eq!(empty.err(), Some(Error::Empty { what: "mesh" }));
}

#[test]
fn a_point_has_a_distance_too() {
    let point = TriMesh::new(vec![Vec3::new(0.5, 0.5, 2.0)], vec![[0, 0, 0]]);
    let d = surface_distance(&point, &plane(1, 1.0, 0.0), &count(100)).unwrap();
    assert_eq!((d.a_to_b.samples, d.a_to_b.max), (1, 2.0));
    assert_eq!((d.diagonal, d.b_to_a.samples), (0.0, 204));
}

/// Stops at the third report.
struct Impatient(AtomicU32);

impl Progress for Impatient {
    fn report(&self, _: &'static str, fraction: f32) {
        assert!((0.0..=1.0).contains(&fraction));
        self.0.fetch_add(1, Ordering::Relaxed);
    }

    fn cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed) >= 3
    }
}

#[test]
fn cancelling_ends_the_work() {
    let mesh = plane(2, 1.0, 0.0);
    let progress = Impatient(AtomicU32::new(0));
    let options = SurfaceDistanceOptions {
        progress: &progress,
        ..count(u64::MAX >> 12)
    };
    assert_eq!(
        surface_distance(&mesh, &mesh, &options),
        Err(Error::Cancelled)
    );
}
