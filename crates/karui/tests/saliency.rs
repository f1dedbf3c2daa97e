//! Curvature and mesh saliency.

#![allow(clippy::unwrap_used, reason = "a failed unwrap fails the test")]

use glam::Vec3;
use karui::Error;
use karui::mesh::PositionIds;
use karui::mesh::{TriMesh, shapes};
use karui::saliency::{Curvature, CurvatureOptions, Estimator, curvature, curvature_sizes};
use karui::saliency::{MeshSaliencyOptions, Suppression, curvature_with, mesh_saliency};
use rayon::prelude::*;

fn scaled(mut mesh: TriMesh, by: f32) -> TriMesh {
    mesh.positions.iter_mut().for_each(|p| *p *= by);
    mesh
}

fn assert_near(found: f64, expected: f64, tolerance: f64, what: &str) {
    let off = (found - expected).abs();
    assert!(off <= tolerance, "{what}: {found}, expected {expected}");
}

/// Away from the poles, which lie on the y axis.
fn is_midway(p: Vec3) -> bool {
    p.normalize().y.abs() < 0.7
}

#[test]
fn spheres_bend_by_one_over_their_radius() {
    for radius in [0.01, 1.0, 250.0] {
        let of = |mesh: TriMesh| scaled(mesh, radius);
        let spheres = [
            shapes::uv_sphere(96, 192),
            shapes::textured_sphere(128, 128),
        ];
        for mesh in spheres.map(of).iter().chain([&of(shapes::icosphere(5))]) {
            let all = curvature(mesh).unwrap();
            for (c, p) in all.iter().zip(&mesh.positions).filter(|c| is_midway(*c.1)) {
                let r = f64::from(radius);
                assert_near(c.k1 * r, 1.0, 0.02, "k1");
                assert_near(c.k2 * r, 1.0, 0.02, "k2");
                assert!(c.directions.iter().all(|d| d.dot(*p).abs() < 0.02 * radius));
            }
        }
    }
}

/// Open, around the y axis, of quads split by diagonals.
fn cylinder(radius: f32, segments: u32, rows: u32) -> TriMesh {
    let mut mesh = shapes::grid(segments, rows);
    for p in &mut mesh.positions {
        let (sin, cos) = (p.x * std::f32::consts::TAU).sin_cos();
        *p = Vec3::new(radius * cos, 6.0 * radius * p.z, radius * sin);
    }
    mesh
}

#[test]
fn a_cylinder_bends_one_way() {
    let mesh = cylinder(2.0, 64, 64);
    let inner = |p: &Vec3| p.y > 0.5 && p.y < 11.5 && p.z.abs() > 0.2;
    let all = curvature(&mesh).unwrap();
    let mut signs = 0.0;
    for (c, p) in all.iter().zip(&mesh.positions).filter(|c| inner(c.1)) {
        let (large, small) = if c.mean() > 0.0 {
            (c.k1, c.k2)
        } else {
            (c.k2, c.k1)
        };
        assert_near(large.abs(), 0.5, 0.01, "around");
        assert_near(small, 0.0, 0.01, "along");
        let along = c.directions[usize::from(c.mean() > 0.0)];
        assert!(along.y.abs() > 0.99, "{along} at {p}");
        signs += c.mean().signum();
    }
    assert!(f64::abs(signs) > 1000.0, "{signs}");
}

/// k1 and k2 by Taubin's own formula and by the corrected one.
fn both(mesh: &TriMesh) -> [Vec<[f64; 2]>; 2] {
    [Estimator::Taubin1995, Estimator::Corrected].map(|estimator| {
        let all = curvature_with(mesh, &CurvatureOptions { estimator }).unwrap();
        all.iter().map(|c| [c.k1, c.k2]).collect()
    })
}

#[test]
fn taubin_s_own_form_is_right_on_average_and_off_where_directions_are_not_even() {
    let sphere = shapes::uv_sphere(96, 192);
    let [plain, corrected] = both(&sphere);
    for (v, p) in sphere.positions.iter().enumerate() {
        if is_midway(*p) && p.x.abs() > 0.1 {
            let [k1, k2] = plain[v];
            assert_near((k1 + k2) / 2.0, 1.0, 0.02, "mean");
            // Quads split by diagonals have no even directions.
            assert!(k1 > 1.3 && k2 < 0.7, "{k1} {k2}");
            assert_near(corrected[v][0], 1.0, 0.02, "k1");
            assert_near(corrected[v][1], 1.0, 0.02, "k2");
        }
    }
    // Stars of nearly even directions.
    let [plain, corrected] = both(&shapes::icosphere(5));
    for (p, c) in plain.iter().zip(&corrected) {
        for k in 0..2 {
            assert_near(p[k], 1.0, 0.35, "plain");
            assert_near(c[k], 1.0, 0.001, "corrected");
        }
    }
    let tube = cylinder(2.0, 64, 64);
    let [plain, corrected] = both(&tube);
    for (v, p) in tube.positions.iter().enumerate() {
        if p.y > 0.5 && p.y < 11.5 && p.z.abs() > 0.2 {
            let size = |[a, b]: [f64; 2]| a.abs().max(b.abs());
            assert_near(size(corrected[v]), 0.5, 0.01, "corrected around");
            let mean = f64::abs(plain[v][0] + plain[v][1]) / 2.0;
            assert_near(mean, 0.25, 0.005, "plain mean");
        }
    }
    for k in both(&shapes::grid(9, 7)).iter().flatten().flatten() {
        assert_eq!(k.abs(), 0.0);
    }
}

#[test]
fn sizes_of_curvature_are_shares_of_what_is_no_spike() {
    let of = |mean: f64| Curvature {
        k1: mean,
        k2: mean,
        directions: [Vec3::X, Vec3::Y],
    };
    let mut found: Vec<Curvature> = (0..200).map(|i| of(-f64::from(i) / 100.0)).collect();
    found.push(of(1e6));
    let sizes = curvature_sizes(&found);
    assert_eq!((sizes[0], sizes[200], sizes[199]), (0.0, 1.0, 1.0));
    assert!((sizes[99] - 0.5).abs() < 1e-6, "{}", sizes[99]);
    assert_eq!(curvature_sizes(&[of(0.0); 3]), [0.0; 3]);
    assert!(curvature_sizes(&[]).is_empty());
}

#[test]
fn a_plane_does_not_bend_and_its_border_neither() {
    for c in curvature(&shapes::grid(9, 7)).unwrap() {
        assert_eq!((c.k1.abs(), c.k2.abs()), (0.0, 0.0));
    }
}

#[test]
fn a_torus_has_its_closed_form() {
    let (major, minor) = (2.0, 0.7);
    let mesh = shapes::torus(2.0, 0.7, 192, 96);
    for (c, p) in curvature(&mesh).unwrap().iter().zip(&mesh.positions) {
        let out = f64::from(p.x).hypot(f64::from(p.z));
        let around = (out - major) / minor / out;
        assert_near(c.k1, 1.0 / minor, 0.03, "k1");
        assert_near(c.k2, around, 0.03, "k2");
    }
}

/// By position, so that another numbering of vertices does not matter.
fn by_place(mesh: &TriMesh, values: &[Curvature]) -> Vec<([u32; 3], u64)> {
    let bits = |p: Vec3| (p + Vec3::ZERO).to_array().map(f32::to_bits);
    let pairs = mesh.positions.iter().zip(values);
    let mut all: Vec<_> = pairs.map(|(p, c)| (bits(*p), c.mean().to_bits())).collect();
    all.sort_unstable();
    all.dedup();
    all
}

#[test]
fn seams_do_not_matter() {
    let mesh = shapes::torus(2.0, 0.7, 24, 12);
    let mut soup = TriMesh::default();
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        let place = |v: &u32| mesh.positions[*v as usize];
        soup.positions.extend(triangle.iter().map(place));
        soup.triangles.push([0, 1, 2].map(|k| 3 * t as u32 + k));
    }
    let (one, other) = (curvature(&mesh).unwrap(), curvature(&soup).unwrap());
    assert_eq!(by_place(&mesh, &one), by_place(&soup, &other));
}

#[test]
fn curvature_of_anything_is_finite() {
    let mut zoo = shapes::zoo();
    zoo.push(("point", TriMesh::new(vec![Vec3::ONE], vec![])));
    zoo.push(("no area", TriMesh::new(vec![Vec3::ONE; 3], vec![[0, 1, 2]])));
    for (name, mesh) in zoo {
        for by in [1e-30, 1.0, 1e30] {
            let mesh = scaled(mesh.clone(), by);
            for c in curvature(&mesh).unwrap() {
                let all_finite = c.k1.is_finite() && c.k2.is_finite();
                assert!(all_finite && c.k1 >= c.k2, "{name}: {c:?}");
                assert!(
                    c.directions.iter().all(|d| d.is_normalized()),
                    "{name}: {c:?}"
                );
            }
        }
    }
}

#[test]
fn wrong_meshes_are_errors() {
    let mut mesh = shapes::triangle();
    mesh.positions[1].y = f32::NAN;
    assert!(matches!(
        curvature(&mesh),
        Err(Error::NotFinite { index: 1, .. })
    ));
    let mesh = TriMesh::new(vec![Vec3::ONE], vec![[0, 0, 1]]);
    assert!(matches!(
        curvature(&mesh),
        Err(Error::IndexOutOfRange { .. })
    ));
}

/// The definition, summed over all pairs of vertices without seams.
fn plain(mesh: &TriMesh, power: i32) -> Vec<f64> {
    let diagonal = mesh.bounds().diagonal();
    let bends: Vec<f64> = curvature(mesh)
        .unwrap()
        .iter()
        .map(Curvature::mean)
        .collect();
    let places: Vec<_> = mesh.positions.iter().map(|p| p.as_dvec3()).collect();
    let smooth = |width: f64| -> Vec<f64> {
        let at = |v: &glam::DVec3| {
            let (mut sum, mut weights) = (0.0, 0.0);
            for (x, bend) in places.iter().zip(&bends) {
                let squared = x.distance_squared(*v);
                if squared < 4.0 * width * width {
                    let weight = (-squared / (2.0 * width * width)).exp();
                    sum += weight * bend;
                    weights += weight;
                }
            }
            sum / weights
        };
        places.par_iter().map(at).collect()
    };
    let mut total = vec![0.0; places.len()];
    for scale in [2.0, 3.0, 4.0, 5.0, 6.0] {
        let width = scale * 0.003 * diagonal;
        let pairs = smooth(width).into_iter().zip(smooth(2.0 * width));
        let raw: Vec<f64> = pairs.map(|(a, b)| f64::abs(a - b)).collect();
        let top = raw.iter().copied().fold(0.0, f64::max);
        let mut above = vec![true; raw.len()];
        for &[a, b, c] in &mesh.triangles {
            for (p, q) in [(a, b), (b, c), (c, a), (b, a), (c, b), (a, c)] {
                above[p as usize] &= raw[p as usize] > raw[q as usize];
            }
        }
        let peaks = raw
            .iter()
            .zip(&above)
            .filter(|(r, above)| **above && **r < top);
        let peaks: Vec<f64> = peaks.map(|(r, _)| r / top).collect();
        let mean = peaks.iter().sum::<f64>() / (peaks.len().max(1) as f64);
        let shares = total.iter_mut().zip(&raw);
        shares.for_each(|(t, r)| *t += r / top * (1.0 - mean).powi(power));
    }
    let top = total.iter().copied().fold(0.0, f64::max);
    total.iter().map(|t| t / top).collect()
}

/// Pushed out along the way from the origin by `height`.
fn dented(mut mesh: TriMesh, height: impl Fn(Vec3) -> f32) -> TriMesh {
    mesh.positions
        .iter_mut()
        .for_each(|p| *p *= 1.0 + height(p.normalize()));
    mesh
}

fn bump(p: Vec3, top: Vec3) -> f32 {
    0.03 * (-p.distance_squared(top) / 0.003).exp()
}

fn wavy(p: Vec3) -> f32 {
    let wave = (9.0 * p.x).sin() * (7.0 * p.y + 1.0).sin() + (31.0 * p.z + p.x).sin() * 0.1;
    0.02 * wave + bump(p, Vec3::X)
}

#[test]
fn sums_are_within_one_percent_of_the_plain_ones() {
    let part = |mut mesh: TriMesh, by: f32| {
        mesh.positions
            .iter_mut()
            .for_each(|p| *p = *p * 0.5 + Vec3::Y * by);
        mesh
    };
    let meshes = [
        ("coarse", dented(shapes::icosphere(4), wavy)),
        ("middle", dented(shapes::uv_sphere(90, 120), wavy)),
        ("torus", dented(shapes::torus(2.0, 0.4, 200, 50), wavy)),
        ("rough", part(shapes::landscape(70, 70, 3), 0.2)),
        ("dense patch", height_patch(108)),
        ("denser patch", height_patch(128)),
    ];
    for (name, mesh) in meshes {
        for (suppression, power) in [(Suppression::Off, 0), (Suppression::Squared, 2)] {
            let options = MeshSaliencyOptions {
                suppression,
                ..MeshSaliencyOptions::default()
            };
            let found = mesh_saliency(&mesh, &options).unwrap();
            let off = farthest(&found, &plain(&mesh, power));
            println!(
                "{name}, {suppression:?}: {} vertices, off by {off:.5}",
                found.len()
            );
            assert!(off < 0.01, "{name}: {off}");
        }
    }
}

fn farthest(found: &[f32], expected: &[f64]) -> f64 {
    let pairs = found.iter().zip(expected);
    pairs
        .map(|(a, b)| (f64::from(*a) - b).abs())
        .fold(0.0, f64::max)
}

/// Long and thin, so that many vertices lie within the narrowest Gaussian.
fn height_patch(n: u32) -> TriMesh {
    let mut mesh = shapes::height_grid(6 * n, n / 6, |x, z| {
        0.004 * (x * 60.0).sin() * (z * 5.0).cos() + 0.01 * (-(x - 0.6).powi(2) * 900.0).exp()
    });
    mesh.positions.iter_mut().for_each(|p| p.z *= 0.03);
    mesh
}

#[test]
fn even_surfaces_have_none() {
    let spheres = [shapes::icosphere(4), shapes::icosphere(6)];
    for mesh in spheres.iter().chain([&shapes::grid(40, 40)]) {
        let found = mesh_saliency(mesh, &MeshSaliencyOptions::default()).unwrap();
        let top = found.iter().copied().fold(0.0, f32::max);
        assert!(top < 1e-6, "{top} of {}", found.len());
    }
}

fn top(mesh: &TriMesh, found: &[f32]) -> Vec3 {
    let best = (0..found.len()).max_by(|&a, &b| found[a].total_cmp(&found[b]));
    mesh.positions[best.unwrap()]
}

#[test]
fn one_bump_is_the_peak() {
    let at = Vec3::new(0.48, 0.6, 0.64);
    let mesh = dented(shapes::icosphere(6), |p| bump(p, at));
    for options in [
        MeshSaliencyOptions::lee2005(),
        MeshSaliencyOptions::thesis2014(),
    ] {
        let found = mesh_saliency(&mesh, &options).unwrap();
        assert!(top(&mesh, &found).normalize().distance(at) < 0.05);
        assert!(found.iter().all(|s| (0.0..=1.0).contains(s)));
        assert!(found.contains(&1.0));
    }
}

#[test]
fn many_equal_bumps_score_lower_than_one() {
    let tops = shapes::icosphere(1).positions;
    let one = dented(shapes::icosphere(6), |p| bump(p, tops[0]));
    let many = dented(shapes::icosphere(6), |p| {
        tops.iter().map(|t| bump(p, *t)).sum()
    });
    let of = |mesh: &TriMesh, suppression| {
        let options = MeshSaliencyOptions {
            suppression,
            stretch: false,
            ..MeshSaliencyOptions::default()
        };
        let found = mesh_saliency(mesh, &options).unwrap();
        found.iter().copied().fold(0.0, f32::max)
    };
    for suppression in [Suppression::Squared, Suppression::Linear] {
        let (single, several) = (of(&one, suppression), of(&many, suppression));
        assert!(several < 0.95 * single, "{several}, one {single}");
    }
    let (single, several) = (of(&one, Suppression::Off), of(&many, Suppression::Off));
    assert!(
        (several / single - 1.0).abs() < 0.2,
        "{several}, one {single}"
    );
}

#[test]
fn saliency_of_anything_is_between_0_and_1() {
    let mut zoo = shapes::zoo();
    zoo.push(("point", TriMesh::new(vec![Vec3::ONE], vec![])));
    zoo.push(("no area", TriMesh::new(vec![Vec3::ONE; 3], vec![[0, 1, 2]])));
    for (name, mesh) in zoo {
        for by in [1e-30, 1.0, 1e30] {
            let mesh = scaled(mesh.clone(), by);
            let found = mesh_saliency(&mesh, &MeshSaliencyOptions::default()).unwrap();
            assert_eq!(found.len(), mesh.positions.len());
            assert!(
                found.iter().all(|s| (0.0..=1.0).contains(s)),
                "{name} x {by}"
            );
            let ids = PositionIds::of_mesh(&mesh);
            for (v, &id) in ids.of_vertex.iter().enumerate() {
                assert_eq!(found[v], found[ids.first_vertices()[id as usize] as usize]);
            }
        }
    }
}

#[test]
fn wrong_options_and_positions_are_errors() {
    let mut mesh = shapes::icosphere(1);
    for (epsilon, scales) in [
        (f64::NAN, 2.0),
        (0.0, 2.0),
        (0.003, 0.0),
        (1e-9, 2.0),
        (0.003, f64::NAN),
    ] {
        let options = MeshSaliencyOptions {
            epsilon,
            scales: vec![scales],
            ..MeshSaliencyOptions::default()
        };
        assert!(matches!(
            mesh_saliency(&mesh, &options),
            Err(Error::BadOption { .. })
        ));
    }
    mesh.positions[5].x = f32::INFINITY;
    let found = mesh_saliency(&mesh, &MeshSaliencyOptions::default());
    assert!(matches!(found, Err(Error::NotFinite { index: 5, .. })));
}

#[test]
fn threads_do_not_matter() {
    let mesh = dented(shapes::icosphere(6), wavy);
    let of = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let run = || mesh_saliency(&mesh, &MeshSaliencyOptions::default());
        pool.unwrap().install(run).unwrap()
    };
    let one = of(1);
    assert!([2, 8].iter().all(|&threads| of(threads) == one));
}
