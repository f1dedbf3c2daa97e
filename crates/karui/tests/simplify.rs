//! Simplification, held to what it promises on the mesh zoo and on generated
//! meshes.

#![allow(clippy::unwrap_used, reason = "a failed unwrap fails the test")]

use glam::{Vec2, Vec3};
use karui::geom::Aabb;
use karui::mesh::{Attributes, diagnose, shapes};
use karui::metrics::{SurfaceDistanceOptions, flipped, surface_distance};
use karui::simplify::{
    AttributeWeights, Border, Cost, Placement, Quality, Simplified, SimplifyOptions, Stop, Stopped,
    simplify, simplify_chain,
};
use karui::spatial::Bvh;
use karui::{Error, Progress, TriMesh};
use proptest::prelude::*;

fn to(mesh: &TriMesh, stop: Stop) -> Simplified {
    let options = SimplifyOptions {
        stop,
        ..SimplifyOptions::default()
    };
    simplify(mesh, &options).unwrap()
}

/// What every result owes its input.
fn assert_sound(name: &str, mesh: &TriMesh, coarse: &Simplified) {
    coarse.mesh.validate().unwrap();
    assert!(
        coarse.mesh.triangles.len() <= mesh.triangles.len(),
        "{name}"
    );
    if coarse.mesh.triangles.is_empty() {
        return;
    }
    let (before, after) = (diagnose(mesh).unwrap(), diagnose(&coarse.mesh).unwrap());
    assert!(
        after.nonmanifold_edges <= before.nonmanifold_edges,
        "{name}"
    );
    assert_eq!(after.degenerate, 0, "{name}");
    assert!(!before.closed || after.closed, "{name}: a hole was torn");
    if coarse.topology.handles > 0 {
        // What closes a handle faces as nothing did.
        return;
    }
    let index = Bvh::build(mesh).unwrap();
    let new_flips = flipped(&coarse.mesh, &index).unwrap();
    assert!(
        new_flips <= flipped(mesh, &index).unwrap(),
        "{name}: {new_flips} flips"
    );
}

#[test]
fn the_zoo_survives_every_mode() {
    for (name, mesh) in shapes::zoo() {
        for ratio in [0.5, 0.1, 0.0] {
            for placement in [Placement::Optimal, Placement::HalfEdge] {
                for cost in [Cost::Memoryless, Cost::Accumulated, Cost::Averaged] {
                    let options = SimplifyOptions {
                        stop: Stop::ratio(ratio),
                        placement,
                        cost,
                        ..SimplifyOptions::default()
                    };
                    assert_sound(name, &mesh, &simplify(&mesh, &options).unwrap());
                }
            }
        }
    }
}

/// Half of every cost changes no order; halves of sums do, from the second collapse at a
/// point on.
#[test]
fn averaged_quadrics_start_like_sums_and_go_their_own_way() {
    let bump = |p: Vec3| p * (1.0 + 0.1 * (5.0 * p.x).sin() * (7.0 * p.y).cos());
    let mut mesh = shapes::icosphere(3);
    mesh.positions.iter_mut().for_each(|p| *p = bump(*p));
    let reached = |cost, triangles| {
        let options = SimplifyOptions {
            stop: Stop::triangles(triangles),
            cost,
            ..SimplifyOptions::default()
        };
        simplify(&mesh, &options).unwrap().mesh
    };
    let first = mesh.triangles.len() - 2;
    let of = |triangles| [Cost::Accumulated, Cost::Averaged].map(|cost| reached(cost, triangles));
    let [summed, averaged] = of(first);
    assert_eq!(summed, averaged);
    let [summed, averaged] = of(200);
    assert_ne!(summed, averaged);
    assert_eq!(averaged.triangles.len(), 200);
}

#[test]
fn the_zoo_survives_every_quality() {
    for (name, mut mesh) in shapes::zoo() {
        mesh.attributes = Attributes::default();
        for quality in [Quality::Fast, Quality::Balanced, Quality::Exact] {
            for placement in [Placement::Optimal, Placement::HalfEdge] {
                for border in [Border::Preserve, Border::Lock, Border::Free] {
                    let options = SimplifyOptions {
                        quality,
                        placement,
                        border,
                        stop: Stop::ratio(0.2),
                        ..SimplifyOptions::default()
                    };
                    let coarse = simplify(&mesh, &options).unwrap();
                    if quality == Quality::Fast {
                        coarse.mesh.validate().unwrap();
                    } else {
                        assert_sound(name, &mesh, &coarse);
                    }
                }
            }
        }
    }
}

/// Rolling hills of some 50,000 triangles: several blocks.
fn hills() -> TriMesh {
    shapes::height_grid(160, 160, |x, y| {
        (9.0 * x).sin() * (7.0 * y).cos() * 0.1 + (31.0 * x * y).sin() * 0.01
    })
}

#[test]
fn rounds_come_as_close_as_one_collapse_at_a_time() {
    let mesh = hills();
    let rms = |quality| {
        let options = SimplifyOptions {
            quality,
            stop: Stop::ratio(0.1),
            ..SimplifyOptions::default()
        };
        let coarse = simplify(&mesh, &options).unwrap();
        assert_eq!(coarse.stopped, Stopped::Target);
        let (got, wanted) = (coarse.mesh.triangles.len(), mesh.triangles.len() / 10);
        assert!(got <= wanted && got + 3 > wanted, "{got}");
        let options = SurfaceDistanceOptions::default();
        let distance = surface_distance(&mesh, &coarse.mesh, &options).unwrap();
        distance.rms()
    };
    let exact = rms(Quality::Exact);
    let (balanced, fast) = (rms(Quality::Balanced), rms(Quality::Fast));
    assert!(balanced < 1.05 * exact, "{balanced:e} {exact:e}");
    assert!(fast < 1.1 * exact, "{fast:e} {exact:e}");
}

#[test]
fn an_open_border_moves_no_further_than_the_surface() {
    let mesh = hills();
    for quality in [Quality::Fast, Quality::Balanced] {
        let options = SimplifyOptions {
            quality,
            stop: Stop::ratio(0.1),
            ..SimplifyOptions::default()
        };
        let coarse = simplify(&mesh, &options).unwrap().mesh;
        let options = SurfaceDistanceOptions::default();
        let reached = surface_distance(&mesh, &coarse, &options).unwrap().max();
        let bounds = [mesh.bounds(), coarse.bounds()];
        assert!(f64::from((bounds[0].min - bounds[1].min).length()) <= reached);
        assert!(f64::from((bounds[0].max - bounds[1].max).length()) <= reached);
        let found = diagnose(&coarse).unwrap();
        assert!(found.boundary_edges > 3 && found.nonmanifold_edges == 0);
    }
}

#[test]
fn blocks_come_out_the_same_for_any_number_of_threads() {
    let mesh = hills();
    let in_pool = |threads| {
        let pool = rayon::ThreadPoolBuilder::new();
        let pool = pool.num_threads(threads).build().unwrap();
        pool.install(|| to(&mesh, Stop::ratio(0.2)).mesh)
    };
    let one = in_pool(1);
    assert!(one == in_pool(2));
    assert!(one == in_pool(8));
}

#[test]
fn where_a_model_lies_and_how_large_it_is_does_not_matter() {
    let mesh = shapes::torus(1.0, 0.4, 96, 48);
    let coarse = to(&mesh, Stop::ratio(0.1)).mesh;
    for scale in [1e-12f32, 1e12] {
        let mut other = mesh.clone();
        other.positions.iter_mut().for_each(|p| *p *= scale);
        let other = to(&other, Stop::ratio(0.1));
        assert_eq!(other.stopped, Stopped::Target);
        assert_eq!(other.mesh.triangles.len(), coarse.triangles.len());
        let size = f64::from(scale);
        let ratio = other.error / size / to(&mesh, Stop::ratio(0.1)).error;
        assert!((0.5..2.0).contains(&ratio), "{scale}: {ratio}");
    }
}

#[test]
fn a_sphere_meets_its_target_and_stays_a_sphere() {
    let sphere = shapes::icosphere(5);
    let coarse = to(&sphere, Stop::triangles(1000));
    assert_eq!(coarse.mesh.triangles.len(), 1000);
    assert_eq!(coarse.stopped, Stopped::Target);
    assert_sound("sphere", &sphere, &coarse);
    // Inscribed equilateral triangles of edge l would lie l^2 / 8 below the
    // unit sphere on average; the best placement is well under half of that.
    let edge_squared = 4.0 * std::f64::consts::PI / 1000.0 * 4.0 / 3f64.sqrt();
    let options = SurfaceDistanceOptions::default();
    let distance = surface_distance(&sphere, &coarse.mesh, &options).unwrap();
    assert!(
        distance.rms() < 0.5 * edge_squared / 8.0,
        "{}",
        distance.rms()
    );
    assert!(
        coarse.error < 0.01 && coarse.error > 1e-4,
        "{}",
        coarse.error
    );
}

#[test]
fn a_flat_grid_goes_down_to_two_triangles() {
    let coarse = to(&shapes::grid(12, 9), Stop::relative_error(1e-6));
    assert_eq!(coarse.mesh.triangles.len(), 2);
    assert!(coarse.error < 1e-6);
}

#[test]
fn a_cube_with_hard_edges_goes_down_to_twelve_triangles() {
    let cube = shapes::cube(6);
    let coarse = to(&cube, Stop::relative_error(1e-6));
    assert_eq!(coarse.mesh.triangles.len(), 12);
    let normals = coarse.mesh.attributes.normals.as_ref().unwrap();
    for (t, triangle) in coarse.mesh.triangles.iter().enumerate() {
        let [a, b, c] = coarse.mesh.corners(t);
        let own = (b - a).cross(c - a).normalize().as_vec3();
        assert!(
            triangle
                .iter()
                .all(|&v| normals[v as usize].dot(own) > 0.999)
        );
    }
}

#[test]
fn broken_normals_do_not_hold_a_mesh_up() {
    // A torus whose normals lean to alternate sides, quad by quad.
    let mut torus = shapes::torus(2.0, 0.5, 48, 24);
    let corners: Vec<u32> = torus.triangles.iter().flatten().copied().collect();
    torus.gather_vertices(&corners);
    torus.triangles = (0..corners.len() as u32 / 3)
        .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
        .collect();
    let tilted = |(i, p): (usize, &Vec3)| {
        let ring = Vec3::new(p.x, p.y, 0.0).normalize_or_zero() * 2.0;
        let side = if (i / 6) % 2 == 0 { 0.15 } else { -0.15 };
        ((*p - ring).normalize() + Vec3::Z * side).normalize()
    };
    let normals: Vec<Vec3> = torus.positions.iter().enumerate().map(tilted).collect();
    torus.attributes.normals = Some(normals);
    let coarse = to(&torus, Stop::ratio(0.2));
    assert_eq!(coarse.stopped, Stopped::Target);
    let normals = coarse.mesh.attributes.normals.as_ref().unwrap();
    for (t, triangle) in coarse.mesh.triangles.iter().enumerate() {
        let [a, b, c] = coarse.mesh.corners(t);
        let own = (b - a).cross(c - a).normalize().as_vec3();
        for &v in triangle {
            assert!((normals[v as usize].length() - 1.0).abs() < 1e-4);
            assert!(normals[v as usize].dot(own) > 0.0);
        }
    }
}

#[test]
fn the_error_bound_holds_and_is_named() {
    let torus = shapes::torus(1.0, 0.3, 64, 32);
    let coarse = to(&torus, Stop::error(0.01));
    assert_eq!(coarse.stopped, Stopped::ErrorBound);
    assert!(coarse.error <= 0.01);
    assert!(coarse.mesh.triangles.len() < torus.triangles.len() / 4);
    let distance =
        surface_distance(&torus, &coarse.mesh, &SurfaceDistanceOptions::default()).unwrap();
    assert!(distance.max() < 0.02, "{}", distance.max());
}

#[test]
fn a_locked_border_is_not_touched() {
    let grid = shapes::height_grid(20, 20, |x, y| (6.0 * x).sin() * (5.0 * y).cos() * 0.1);
    let options = SimplifyOptions {
        stop: Stop::ratio(0.05),
        border: Border::Lock,
        ..SimplifyOptions::default()
    };
    let coarse = simplify(&grid, &options).unwrap();
    let before = diagnose(&grid).unwrap().boundary_edges;
    assert_eq!(diagnose(&coarse.mesh).unwrap().boundary_edges, before);
    for p in border_places(&grid) {
        assert!(coarse.mesh.positions.contains(&p));
    }
}

fn border_places(grid: &TriMesh) -> Vec<Vec3> {
    let bounds = grid.bounds();
    let on_edge = |p: &&Vec3| {
        [
            p.x == bounds.min.x,
            p.x == bounds.max.x,
            p.y == bounds.min.y,
            p.y == bounds.max.y,
        ]
        .contains(&true)
    };
    grid.positions.iter().filter(on_edge).copied().collect()
}

#[test]
fn locked_vertices_stay_and_are_named() {
    let sphere = shapes::icosphere(3);
    let locks = vec![true; sphere.positions.len()];
    let options = SimplifyOptions {
        stop: Stop::ratio(0.5),
        locks: Some(&locks),
        ..SimplifyOptions::default()
    };
    let coarse = simplify(&sphere, &options).unwrap();
    assert!(coarse.mesh == sphere);
    assert_eq!(coarse.stopped, Stopped::Locked);
    assert!(coarse.blocked.locked > 0);
}

#[test]
fn weights_keep_detail_where_they_are_large() {
    let sphere = shapes::icosphere(4);
    let north = |p: &Vec3| if p.z > 0.0 { 50.0 } else { 1.0 };
    let weights: Vec<f32> = sphere.positions.iter().map(north).collect();
    let options = SimplifyOptions {
        stop: Stop::ratio(0.2),
        weights: Some(&weights),
        ..SimplifyOptions::default()
    };
    let coarse = simplify(&sphere, &options).unwrap().mesh;
    let upper = coarse.positions.iter().filter(|p| p.z > 0.1).count();
    let lower = coarse.positions.iter().filter(|p| p.z < -0.1).count();
    assert!(upper > 2 * lower, "{upper} above, {lower} below");
}

#[test]
fn half_edge_placement_keeps_a_subset_of_the_vertices() {
    let mesh = shapes::loaded_sphere(16, 24);
    let options = SimplifyOptions {
        stop: Stop::ratio(0.3),
        placement: Placement::HalfEdge,
        ..SimplifyOptions::default()
    };
    let coarse = simplify(&mesh, &options).unwrap().mesh;
    let vertex =
        |m: &TriMesh, v: usize| (m.positions[v].to_array(), m.attributes.uvs[0][v].to_array());
    let known: Vec<_> = (0..mesh.positions.len())
        .map(|v| vertex(&mesh, v))
        .collect();
    assert!((0..coarse.positions.len()).all(|v| known.contains(&vertex(&coarse, v))));
}

#[test]
fn seams_hold_and_uvs_stay_on_their_side() {
    let mesh = shapes::textured_sphere(32, 48);
    let coarse = to(&mesh, Stop::ratio(0.15));
    assert_eq!(coarse.stopped, Stopped::Target);
    assert_sound("textured sphere", &mesh, &coarse);
    let uvs = &coarse.mesh.attributes.uvs[0];
    for triangle in &coarse.mesh.triangles {
        let u = triangle.map(|v| uvs[v as usize].x);
        let span = u.iter().copied().fold(0.0, f32::max) - u.iter().copied().fold(1.0, f32::min);
        assert!(span < 0.5, "a triangle spans the seam: {u:?}");
    }
    let in_chart =
        |uv: &Vec2| uv.cmpge(Vec2::splat(-1e-5)).all() && uv.cmple(Vec2::splat(1.00001)).all();
    assert!(uvs.iter().all(in_chart));
}

#[test]
fn attributes_follow_the_surface() {
    let mesh = shapes::loaded_sphere(32, 48);
    let coarse = to(&mesh, Stop::ratio(0.2)).mesh;
    let Attributes { normals, skins, .. } = &coarse.attributes;
    for (p, n) in coarse.positions.iter().zip(normals.as_ref().unwrap()) {
        assert!((n.length() - 1.0).abs() < 1e-4);
        assert!(n.dot(p.normalize()) > 0.95, "normal {n} at {p}");
    }
    for skin in &skins[0] {
        assert!((skin.weights.iter().sum::<f32>() - 1.0).abs() < 1e-4);
    }
}

#[test]
fn material_ranges_keep_their_triangles() {
    let mut grid = shapes::grid(16, 16);
    let half = grid.triangles.len() as u32 / 2;
    let range = |first, material| karui::mesh::MaterialRange {
        first,
        count: half,
        material: Some(material),
        source: None,
    };
    grid.ranges = vec![range(0, 3), range(half, 4)];
    let coarse = to(&grid, Stop::relative_error(1e-6)).mesh;
    assert_eq!(coarse.triangles.len(), 4);
    for range in 0..2 {
        let (before, after) = (box_of(&grid, range), box_of(&coarse, range));
        assert!(
            (before.min - after.min).length() < 1e-5,
            "{range}: {before:?} {after:?}"
        );
        assert!(
            (before.max - after.max).length() < 1e-5,
            "{range}: {before:?} {after:?}"
        );
    }
}

fn box_of(mesh: &TriMesh, range: usize) -> Aabb {
    let corners = mesh.ranges[range]
        .triangles()
        .flat_map(|t| mesh.triangles[t]);
    Aabb::of(corners.map(|v| mesh.positions[v as usize]))
}

#[test]
fn pairs_join_parts_that_edges_cannot() {
    let mut two = shapes::cube(4);
    let mut other = two.clone();
    let gap = two.bounds().size().x * 1.01;
    other.positions.iter_mut().for_each(|p| p.x += gap);
    append(&mut two, &other);
    two.attributes = Attributes::default();
    let pairs = Some(f64::from(gap) * 0.05);
    let stop = Stop::triangles(12);
    let apart = to(&two, stop);
    let options = SimplifyOptions {
        stop,
        pairs,
        ..SimplifyOptions::default()
    };
    let joined = simplify(&two, &options).unwrap();
    joined.mesh.validate().unwrap();
    let components = |m: &TriMesh| diagnose(m).unwrap().components;
    assert_eq!(components(&apart.mesh), 2);
    assert_eq!(components(&joined.mesh), 1);
}

fn append(mesh: &mut TriMesh, other: &TriMesh) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(&other.positions);
    let moved = other.triangles.iter().map(|t| t.map(|v| v + first));
    mesh.triangles.extend(moved);
}

#[test]
fn same_bytes_for_any_number_of_threads() {
    let mesh = shapes::loaded_sphere(24, 32);
    let in_pool = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| to(&mesh, Stop::ratio(0.2)).mesh)
    };
    let one = in_pool(1);
    assert!(one == in_pool(2));
    assert!(one == in_pool(8));
}

#[test]
fn a_chain_goes_on_from_level_to_level() {
    let mesh = shapes::loaded_sphere(24, 32);
    let stops = [Stop::ratio(0.5), Stop::ratio(0.2), Stop::ratio(0.2)];
    for quality in [Quality::Fast, Quality::Balanced, Quality::Exact] {
        let options = SimplifyOptions {
            quality,
            ..SimplifyOptions::default()
        };
        let chain = simplify_chain(&mesh, &stops, &options).unwrap();
        let direct = |stop| {
            let options = SimplifyOptions { stop, ..options };
            simplify(&mesh, &options).unwrap().mesh
        };
        assert!(chain[1].mesh == chain[2].mesh);
        assert!(chain[0].mesh == direct(stops[0]));
        assert!(chain[0].error <= chain[1].error);
        // Rounds begin anew at every stop, single collapses do not.
        if quality == Quality::Exact {
            assert!(chain[1].mesh == direct(stops[1]));
        }
        let wanted = mesh.triangles.len() / 5;
        let got = chain[1].mesh.triangles.len();
        assert!(got <= wanted && got + 3 > wanted, "{quality:?} {got}");
    }
}

#[test]
fn bad_options_are_refused() {
    let mesh = shapes::icosphere(1);
    let refused = |options: SimplifyOptions<'_>| simplify(&mesh, &options).unwrap_err();
    let stop = |stop| SimplifyOptions {
        stop,
        ..SimplifyOptions::default()
    };
    for bad in [Stop::ratio(1.5), Stop::ratio(f64::NAN), Stop::error(-1.0)] {
        assert!(matches!(refused(stop(bad)), Error::BadOption { .. }));
    }
    let weights = [1.0];
    let short = SimplifyOptions {
        weights: Some(&weights),
        ..SimplifyOptions::default()
    };
    assert!(matches!(refused(short), Error::LengthMismatch { .. }));
    let nan = vec![f32::NAN; mesh.positions.len()];
    let nan = SimplifyOptions {
        weights: Some(&nan),
        ..SimplifyOptions::default()
    };
    assert!(matches!(refused(nan), Error::BadOption { .. }));
    let negative = AttributeWeights {
        uv: -1.0,
        ..AttributeWeights::default()
    };
    let negative = SimplifyOptions {
        attributes: negative,
        ..SimplifyOptions::default()
    };
    assert!(matches!(refused(negative), Error::BadOption { .. }));
}

struct Stopper;

impl Progress for Stopper {
    fn report(&self, _: &'static str, _: f32) {}

    fn cancelled(&self) -> bool {
        true
    }
}

#[test]
fn it_can_be_cancelled() {
    let mesh = shapes::icosphere(2);
    let options = SimplifyOptions {
        progress: &Stopper,
        ..SimplifyOptions::default()
    };
    assert_eq!(simplify(&mesh, &options).unwrap_err(), Error::Cancelled);
}

fn soup() -> impl Strategy<Value = TriMesh> {
    let places = prop::collection::vec((-4i8..4, -4i8..4, -2i8..2), 3..40);
    let faces = prop::collection::vec((any::<u16>(), any::<u16>(), any::<u16>()), 0..120);
    (places, faces).prop_map(|(places, faces)| {
        let n = places.len() as u32;
        let place = |(x, y, z)| Vec3::new(f32::from(x), f32::from(y), f32::from(z));
        let face = |(a, b, c): (u16, u16, u16)| [a, b, c].map(|i| u32::from(i) % n);
        TriMesh::new(
            places.into_iter().map(place).collect(),
            faces.into_iter().map(face).collect(),
        )
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn random_soup_comes_out_valid(mesh in soup(), ratio in 0.0..1.0f64, join in any::<bool>()) {
        let options = SimplifyOptions {
            stop: Stop::ratio(ratio),
            pairs: join.then_some(1.5),
            ..SimplifyOptions::default()
        };
        let coarse = simplify(&mesh, &options).unwrap();
        coarse.mesh.validate().unwrap();
        prop_assert!(coarse.mesh.triangles.len() <= mesh.triangles.len());
    }

    #[test]
    fn height_fields_keep_their_border_and_side(seed in any::<u64>(), ratio in 0.02..0.9f64) {
        let terrain = shapes::terrain(17, 13, seed);
        let coarse = to(&terrain, Stop::ratio(ratio));
        assert_sound("terrain", &terrain, &coarse);
        let (before, after) = (terrain.bounds(), coarse.mesh.bounds());
        prop_assert!((before.diagonal() / after.diagonal() - 1.0).abs() < 0.05);
    }
}
