//! Cluster DAGs: every cut is the surface without cracks, errors are upper
//! estimates, the result is the same everywhere, and bytes are not trusted.
#![allow(clippy::unwrap_used, reason = "a failed unwrap fails the test")]

use karui::geom::{Camera, Light, Vec3};
use karui::hierarchy::cluster::{ClusterDag, ClusterDagOptions, Cut, Detail, View};
use karui::hierarchy::{Silhouette, ViewAndLight};
use karui::mesh::{MaterialRange, PositionIds, TriMesh, shapes};
use karui::metrics::{Samples, SurfaceDistanceOptions, surface_distance};
use karui::simplify::{Border, Quality, SimplifyOptions, Stop, Topology, simplify};
use karui::{Error, Progress};
use proptest::prelude::*;
use std::collections::BTreeSet;

/// Small clusters, so that small shapes have several levels.
fn small() -> ClusterDagOptions<'static> {
    ClusterDagOptions {
        max_triangles: 16,
        max_vertices: 32,
        group_size: 8,
        ..ClusterDagOptions::default()
    }
}

fn built(mesh: &TriMesh) -> ClusterDag {
    let dag = ClusterDag::build(mesh, &small()).unwrap();
    dag.validate_for(mesh).unwrap();
    dag
}

/// Edges, by position, that have not two triangles, or twice the same, and how
/// many they have.
fn odd_edges(mesh: &TriMesh, triangles: &[[u32; 3]]) -> Vec<((u32, u32), usize)> {
    let linked = PositionIds::of_mesh(mesh).triangles(triangles);
    let is_whole = |[a, b, c]: &&[u32; 3]| a != b && b != c && c != a;
    let whole = linked.iter().filter(is_whole);
    let sides = whole.flat_map(|&[a, b, c]| [(a, b, c), (b, c, a), (c, a, b)]);
    let mut edges: Vec<_> = sides.map(|(a, b, c)| ((a.min(b), a.max(b)), c)).collect();
    edges.sort_unstable();
    let same = edges.chunk_by(|x, y| x.0 == y.0);
    let odd = same.filter(|same| same.len() != 2 || same[0] == same[1]);
    odd.map(|same| (same[0].0, same.len())).collect()
}

/// Edges of the cut with one triangle on one side alone run between vertices
/// where the mesh is not closed; if borders are locked, along such edges of it.
/// (Two triangles of different groups may come to lie back to back: an edge of
/// four is none with a crack.)
fn assert_no_cracks(name: &str, mesh: &TriMesh, cut: &Cut<'_>, locked: bool) {
    let input = odd_edges(mesh, &mesh.triangles).into_iter();
    let input: BTreeSet<(u32, u32)> = input.map(|e| e.0).collect();
    let ends: BTreeSet<u32> = input.iter().flat_map(|&(a, b)| [a, b]).collect();
    let edges = odd_edges(mesh, &cut.triangles()).into_iter();
    for (edge, _) in edges.filter(|e| e.1 % 2 == 1) {
        let known = match locked {
            true => input.contains(&edge),
            false => ends.contains(&edge.0) && ends.contains(&edge.1),
        };
        assert!(known, "{name}: {edge:?} is a crack");
    }
}

fn camera(mesh: &TriMesh, place: [f32; 3], target: [f32; 3]) -> Camera {
    let bounds = mesh.bounds();
    let size = bounds.diagonal() as f32;
    Camera {
        eye: bounds.center() + Vec3::from(place) * size,
        target: bounds.center() + Vec3::from(target) * size,
        ..Camera::looking_at(bounds, Vec3::Z, 0.8)
    }
}

#[test]
fn the_zoo_is_built_and_cut() {
    for (name, mesh) in shapes::zoo() {
        let dag = built(&mesh);
        let whole = dag.cut(&View {
            threshold: 0.0,
            ..View::new(Camera::looking_at(mesh.bounds(), Vec3::ONE, 0.8))
        });
        assert_eq!(
            whole.unwrap().triangle_count(),
            mesh.triangles.len(),
            "{name}"
        );
        for group in dag.groups() {
            assert_no_cracks(name, &mesh, &dag.cut_at(group.bounds.error), false);
        }
        let coarsest = dag.cut_at(f32::INFINITY);
        assert_eq!(coarsest.clusters(), dag.roots(), "{name}");
    }
}

#[test]
fn empty_meshes_have_empty_cuts() {
    let mesh = shapes::empty();
    let dag = built(&mesh);
    assert_eq!((dag.levels(), dag.roots().len()), (0, 0));
    let camera = Camera::looking_at(mesh.bounds(), Vec3::Z, 0.8);
    let cut = dag.cut(&View::new(camera)).unwrap();
    assert_eq!(cut.triangle_count(), 0);
    assert_eq!(cut.to_mesh(&mesh).unwrap(), mesh);
    assert_eq!(ClusterDag::from_bytes(&dag.to_bytes()).unwrap(), dag);
}

#[test]
fn the_root_is_small_and_levels_halve() {
    for (name, mesh) in [
        ("sphere", shapes::icosphere(6)),
        ("terrain", shapes::terrain(200, 200, 3)),
        ("textured", shapes::textured_sphere(150, 200)),
        ("torus", shapes::torus(1.0, 0.3, 250, 120)),
    ] {
        let dag = ClusterDag::build(&mesh, &ClusterDagOptions::default()).unwrap();
        dag.validate_for(&mesh).unwrap();
        let share = dag.triangles_of_roots() as f64 / mesh.triangles.len() as f64;
        assert!(share < 0.01, "{name}: {share}");
        let fine = dag.clusters().iter().filter(|c| c.level == 0).count();
        let fill = mesh.triangles.len() as f64 / fine as f64;
        assert!(fill > 110.0, "{name}: {fill}");
        assert!(dag.clusters().len() < fine * 22 / 10, "{name}");
        assert_eq!(dag.stuck(), 0, "{name}");
    }
}

#[test]
fn errors_are_upper_estimates() {
    let options = SurfaceDistanceOptions {
        samples: Samples::Count(40_000),
        ..SurfaceDistanceOptions::default()
    };
    for (name, mesh) in [
        ("sphere", shapes::icosphere(5)),
        ("terrain", shapes::terrain(100, 100, 3)),
        ("cube", shapes::closed_cube(40)),
        ("textured", shapes::textured_sphere(60, 90)),
        ("torus", shapes::torus(1.0, 0.3, 120, 60)),
        ("tree", shapes::tree(300, 3)),
    ] {
        let dag = ClusterDag::build(&mesh, &ClusterDagOptions::default()).unwrap();
        for share in [2, 5, 20, 100] {
            let cut = dag.cut_to(mesh.triangles.len() / share);
            let coarse = cut.to_mesh(&mesh).unwrap();
            let measured = surface_distance(&mesh, &coarse, &options).unwrap().max();
            let told = f64::from(cut.error());
            assert!(
                measured <= told + 1e-6,
                "{name} 1/{share}: {measured} > {told}"
            );
        }
    }
}

#[test]
fn threads_do_not_change_the_result() {
    for mesh in [shapes::landscape(120, 90, 5), shapes::loaded_sphere(60, 80)] {
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let pool = pool.build().unwrap();
            pool.install(|| ClusterDag::build(&mesh, &ClusterDagOptions::default()).unwrap())
        };
        let one = with(1);
        assert_eq!(one, with(2));
        assert_eq!(one, with(8));
        assert_eq!(one.to_bytes(), with(3).to_bytes());
    }
}

#[test]
fn attributes_come_along_and_seams_stay_closed() {
    let mesh = shapes::loaded_sphere(60, 80);
    let dag = built(&mesh);
    let uv = |m: &TriMesh, v: u32| m.attributes.uvs[0][v as usize];
    for error in [0.0, 0.01, 0.05, 0.2] {
        let cut = dag.cut_at(error);
        assert_no_cracks("sphere", &mesh, &cut, false);
        let coarse = cut.to_mesh(&mesh).unwrap();
        coarse.validate().unwrap();
        assert_eq!(coarse.triangles.len(), cut.triangle_count());
        for triangle in &coarse.triangles {
            let [a, b, c] = triangle.map(|v| uv(&coarse, v).x);
            let width = a.max(b).max(c) - a.min(b).min(c);
            assert!(width < 0.7, "a triangle runs across the seam: {width}");
        }
    }
}

#[test]
fn every_quality_and_topology_will_do() {
    let mesh = shapes::loaded_sphere(30, 40);
    for quality in [Quality::Fast, Quality::Balanced, Quality::Exact] {
        for topology in [Topology::Simplify, Topology::Preserve] {
            let options = ClusterDagOptions {
                quality,
                topology,
                ..small()
            };
            let dag = ClusterDag::build(&mesh, &options).unwrap();
            dag.validate_for(&mesh).unwrap();
            assert!(dag.triangles_of_roots() * 20 < mesh.triangles.len());
        }
    }
}

#[test]
fn flat_shading_does_not_stop_it() {
    let smooth = shapes::icosphere(5);
    let corners: Vec<u32> = smooth.triangles.iter().flatten().copied().collect();
    let mut mesh = smooth.clone();
    mesh.gather_vertices(&corners);
    let flat = |t: u32| [3 * t, 3 * t + 1, 3 * t + 2];
    mesh.triangles = (0..smooth.triangles.len() as u32).map(flat).collect();
    let face = |m: &TriMesh, t: usize| {
        karui::geom::normal_times_two_areas(m.corners(t))
            .as_vec3()
            .normalize()
    };
    let normals = (0..mesh.triangles.len()).flat_map(|t| [face(&mesh, t); 3]);
    mesh.attributes.normals = Some(normals.collect());
    let dag = ClusterDag::build(&mesh, &ClusterDagOptions::default()).unwrap();
    dag.validate_for(&mesh).unwrap();
    assert!(dag.triangles_of_roots() * 50 < mesh.triangles.len());
    let coarse = dag.cut_to(2000).to_mesh(&mesh).unwrap();
    let normals = coarse.attributes.normals.as_ref().unwrap();
    for (t, corners) in coarse.triangles.iter().enumerate() {
        for &v in corners {
            assert!(normals[v as usize].dot(face(&coarse, t)) > 0.9);
        }
    }
}

#[test]
fn materials_keep_their_triangles() {
    let mut mesh = shapes::terrain(40, 40, 2);
    let count = mesh.triangles.len() as u32;
    let range = |first, count, material| MaterialRange {
        first,
        count,
        material: Some(material),
        source: None,
    };
    mesh.ranges = vec![
        range(0, count / 4, 5),
        range(count / 4, 0, 6),
        range(count / 4, count - count / 4, 7),
    ];
    let dag = built(&mesh);
    for error in [0.0, 0.01, 0.05] {
        let coarse = dag.cut_at(error).to_mesh(&mesh).unwrap();
        coarse.validate().unwrap();
        let materials: Vec<_> = coarse.ranges.iter().map(|r| r.material).collect();
        assert_eq!(materials, [Some(5), Some(6), Some(7)]);
        assert!(coarse.ranges[0].count > 0 && coarse.ranges[2].count > 0);
    }
}

#[test]
fn locked_borders_stay_as_they_are() {
    let mesh = shapes::terrain(40, 30, 2);
    let options = ClusterDagOptions {
        border: Border::Lock,
        ..small()
    };
    let dag = ClusterDag::build(&mesh, &options).unwrap();
    dag.validate_for(&mesh).unwrap();
    for group in dag.groups() {
        assert_no_cracks("terrain", &mesh, &dag.cut_at(group.bounds.error), true);
    }
}

#[test]
fn small_parts_are_simplified_together() {
    let ball = shapes::icosphere(2);
    let mut mesh = TriMesh::default();
    for i in 0..200u32 {
        let first = mesh.positions.len() as u32;
        let at = Vec3::new((i % 20) as f32, (i / 20) as f32, 0.0) * 3.0;
        mesh.positions
            .extend(ball.positions.iter().map(|&p| p + at));
        mesh.triangles
            .extend(ball.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    let dag = ClusterDag::build(&mesh, &ClusterDagOptions::default()).unwrap();
    dag.validate_for(&mesh).unwrap();
    assert!(dag.triangles_of_roots() * 100 < mesh.triangles.len());
    let tiny = dag.cut_at(
        dag.roots()
            .iter()
            .map(|&c| dag.own(c).error)
            .fold(0.0, f32::max),
    );
    let options = SurfaceDistanceOptions {
        samples: Samples::Count(20_000),
        ..SurfaceDistanceOptions::default()
    };
    let coarse = tiny.to_mesh(&mesh).unwrap();
    let measured = surface_distance(&mesh, &coarse, &options).unwrap().max();
    assert!(measured <= f64::from(tiny.error()));
}

#[test]
fn every_cluster_decides_alone() {
    let mesh = shapes::terrain(60, 60, 4);
    let dag = built(&mesh);
    let view = View::new(camera(&mesh, [0.2, 0.3, 0.1], [0.0, 0.0, 0.0]));
    for threshold in [0.3, 1.0, 4.0, 20.0, 100.0] {
        let cut = dag.cut(&View { threshold, ..view }).unwrap();
        // The same by the bounds alone, one cluster after another.
        let enough = |b: karui::hierarchy::cluster::Bounds| {
            let center = b.sphere.center.as_dvec3();
            let clear = center.distance(view.camera.eye.as_dvec3()) - f64::from(b.sphere.radius);
            let pixels = 0.5 * f64::from(view.height) / karui::geom::tan(0.4);
            let near = 1e-6 * view.camera.eye.as_dvec3().length();
            f64::from(b.error) * pixels <= f64::from(threshold) * clear.max(near)
        };
        let alone = (0..dag.clusters().len() as u32)
            .filter(|&c| enough(dag.own(c)) && !enough(dag.parent(c)));
        assert_eq!(cut.clusters(), alone.collect::<Vec<_>>());
        assert_no_cracks("terrain", &mesh, &cut, false);
    }
}

#[test]
fn light_asks_for_more_where_it_changes() {
    let mesh = shapes::icosphere(6);
    let dag = built(&mesh);
    let plain = View {
        threshold: 8.0,
        ..View::new(camera(&mesh, [0.0, 0.0, 2.0], [0.0; 3]))
    };
    let lights = [
        Light::Directional {
            direction: Vec3::new(-1.0, -0.2, -0.3),
            color: Vec3::ONE,
            intensity: 1.0,
        },
        Light::Point {
            position: Vec3::new(0.0, 3.0, 1.0),
            color: Vec3::ONE,
            intensity: 1.0,
        },
    ];
    let criteria = ViewAndLight {
        camera: plain.camera,
        lights: lights.to_vec(),
        area: f64::INFINITY,
        silhouette: Silhouette::Ignored,
        highlight: 20.0,
        ..ViewAndLight::default()
    };
    let lit = |factor| {
        let detail = Some(Detail {
            criteria: &criteria,
            factor,
        });
        let cut = dag.cut(&View { detail, ..plain }).unwrap();
        assert_no_cracks("sphere", &mesh, &cut, true);
        cut.triangle_count()
    };
    let without = dag.cut(&plain).unwrap().triangle_count();
    assert_eq!(lit(1.0), without);
    let (some, more) = (lit(0.5), lit(0.1));
    assert!(without < some && some < more, "{without} {some} {more}");
    let everywhere = dag
        .cut(&View {
            threshold: 0.8,
            ..plain
        })
        .unwrap();
    assert!(more < everywhere.triangle_count());
}

#[test]
fn what_is_culled_is_not_seen() {
    let mesh = shapes::icosphere(6);
    let dag = built(&mesh);
    let view = View::new(camera(&mesh, [0.0, 0.0, 1.0], [0.2, 0.1, 0.0]));
    let all = dag.cut(&view).unwrap();
    let culled = View {
        frustum: true,
        backfaces: true,
        aspect: 1.0,
        ..view
    };
    let seen = dag.cut(&culled).unwrap();
    assert!(seen.triangle_count() * 10 < all.triangle_count() * 7);
    let clip = view.camera.clip_from_world(1.0, mesh.bounds()).unwrap();
    let eye = view.camera.eye.as_dvec3();
    for c in all
        .clusters()
        .iter()
        .filter(|c| !seen.clusters().contains(c))
    {
        for t in dag.triangles_of(*c) {
            let corners = t.map(|v| mesh.positions[v as usize].as_dvec3());
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            let away = normal.dot(corners[0] - eye) >= 0.0;
            let outside = corners.iter().all(|&p| {
                let p = clip.project_point3(p);
                p.x.abs() > 1.0 || p.y.abs() > 1.0
            });
            assert!(away || outside);
        }
    }
}

#[test]
fn size_and_place_do_not_matter() {
    let unit = shapes::icosphere(4);
    let share = |mesh: &TriMesh| {
        let dag = built(mesh);
        let camera = Camera::looking_at(mesh.bounds(), Vec3::Z, 0.8);
        let cut = dag.cut(&View {
            threshold: 5.0,
            ..View::new(camera)
        });
        (dag.triangles_of_roots(), cut.unwrap().triangle_count())
    };
    let (roots, seen) = share(&unit);
    for (size, at) in [(1e-12, 0.0), (1e20, 0.0), (1.0, 1000.0)] {
        let mut mesh = unit.clone();
        let moved = |p: &mut Vec3| *p = *p * size + Vec3::splat(at);
        mesh.positions.iter_mut().for_each(moved);
        let (other_roots, other_seen) = share(&mesh);
        assert!(other_roots.abs_diff(roots) <= 16, "{size} {at}");
        assert!(
            other_seen.abs_diff(seen) * 5 <= seen,
            "{size} {at}: {other_seen} {seen}"
        );
    }
}

#[test]
fn views_that_are_none_are_refused() {
    let mesh = shapes::icosphere(3);
    let dag = built(&mesh);
    let good = View::new(Camera::looking_at(mesh.bounds(), Vec3::Z, 0.8));
    let mut nan = good;
    nan.camera.eye = Vec3::NAN;
    let mut blind = good;
    blind.camera.target = blind.camera.eye;
    let negative = View {
        threshold: -1.0,
        ..good
    };
    for view in [nan, blind, negative] {
        let refused = dag.cut(&view);
        assert!(matches!(refused, Err(Error::BadOption { .. })));
    }
}

#[test]
fn options_and_other_meshes_are_checked() {
    let mesh = shapes::icosphere(3);
    let build = |options| ClusterDag::build(&mesh, &options);
    for options in [
        ClusterDagOptions {
            max_triangles: 256,
            ..small()
        },
        ClusterDagOptions {
            max_vertices: 7,
            ..small()
        },
        ClusterDagOptions {
            group_size: 1,
            ..small()
        },
    ] {
        assert!(matches!(build(options), Err(Error::BadOption { .. })));
    }
    let other = shapes::icosphere(2);
    let dag = built(&mesh);
    assert!(matches!(
        dag.validate_for(&other),
        Err(Error::OtherMesh { .. })
    ));
    assert!(matches!(
        dag.cut_at(0.1).to_mesh(&other),
        Err(Error::OtherMesh { .. })
    ));
    let mut moved = mesh.clone();
    moved.triangles.swap(0, 1);
    moved.triangles[0].swap(0, 1);
    assert!(matches!(
        dag.validate_for(&moved),
        Err(Error::Broken { .. })
    ));
}

#[test]
fn work_can_be_cancelled() {
    struct Stop;
    impl Progress for Stop {
        fn report(&self, _: &'static str, _: f32) {}
        fn cancelled(&self) -> bool {
            true
        }
    }
    let options = ClusterDagOptions {
        progress: &Stop,
        ..small()
    };
    let cancelled = ClusterDag::build(&shapes::icosphere(3), &options);
    assert_eq!(cancelled, Err(Error::Cancelled));
}

#[test]
fn bytes_give_the_graph_again() {
    for (name, mesh) in shapes::zoo() {
        let dag = built(&mesh);
        let bytes = dag.to_bytes();
        assert_eq!(ClusterDag::from_bytes(&bytes).unwrap(), dag, "{name}");
    }
}

#[test]
fn hostile_bytes_are_errors() {
    let dag = built(&shapes::icosphere(3));
    let bytes = dag.to_bytes();
    for len in 0..bytes.len() {
        let refused = ClusterDag::from_bytes(&bytes[..len]);
        assert!(matches!(refused, Err(Error::BadClusters { .. })), "{len}");
    }
    for at in 0..bytes.len() {
        let mut wrong = bytes.clone();
        wrong[at] ^= 0x41;
        assert!(ClusterDag::from_bytes(&wrong).is_err(), "{at}");
    }
    let mut longer = bytes;
    longer.push(0);
    assert!(ClusterDag::from_bytes(&longer).is_err());
}

/// The checksum is no secret: whoever tampers can renew it.
fn resealed(mut bytes: Vec<u8>) -> Vec<u8> {
    let end = bytes.len() - 8;
    let mix = |sum: u64, word: u64| {
        let mixed = (sum ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        mixed ^ mixed >> 29
    };
    let (words, rest) = bytes[..end].as_chunks::<8>();
    let words = words.iter().map(|w| u64::from_le_bytes(*w));
    let rest = rest.iter().map(|&b| u64::from(b) | 0x100);
    let sum = words.chain(rest).fold(end as u64, mix);
    bytes[end..].copy_from_slice(&sum.to_le_bytes());
    bytes
}

/// Whatever is read holds together and can be used.
fn use_if_read(bytes: &[u8]) {
    if let Ok(dag) = ClusterDag::from_bytes(bytes) {
        dag.validate().unwrap();
        let camera = Camera::looking_at(karui::geom::Aabb::EMPTY, Vec3::Z, 0.8);
        let cut = dag.cut(&View::new(camera)).unwrap();
        assert_eq!(cut.triangles().len(), cut.triangle_count());
        let again = dag.to_bytes();
        assert_eq!(ClusterDag::from_bytes(&again).unwrap(), dag);
    }
}

#[test]
fn tampered_bytes_with_a_good_checksum_do_no_harm() {
    let bytes = built(&shapes::icosphere(2)).to_bytes();
    for at in 12..bytes.len() - 8 {
        for flip in [0x01, 0x80, 0xff] {
            let mut wrong = bytes.clone();
            wrong[at] ^= flip;
            use_if_read(&resealed(wrong));
        }
    }
}

#[test]
fn a_uniform_cut_is_not_much_worse_than_plain_simplification() {
    let mesh = shapes::terrain(150, 150, 3);
    let dag = ClusterDag::build(&mesh, &ClusterDagOptions::default()).unwrap();
    let options = SurfaceDistanceOptions {
        samples: Samples::Count(100_000),
        ..SurfaceDistanceOptions::default()
    };
    for share in [4, 20] {
        let cut = dag.cut_to(mesh.triangles.len() / share);
        let plain = simplify(
            &mesh,
            &SimplifyOptions {
                stop: Stop::triangles(cut.triangle_count()),
                ..SimplifyOptions::default()
            },
        );
        let rms = |m: &TriMesh| surface_distance(&mesh, m, &options).unwrap().rms();
        let ratio = rms(&cut.to_mesh(&mesh).unwrap()) / rms(&plain.unwrap().mesh);
        assert!(ratio < 2.5, "1/{share}: {ratio}");
    }
}

fn some_mesh() -> impl Strategy<Value = TriMesh> {
    let corner = || 0u32..40;
    let soup = prop::collection::vec([corner(), corner(), corner()], 0..150);
    let place = prop::collection::vec([-3i8..4, -3i8..4, -3i8..4], 40);
    (place, soup).prop_map(|(places, triangles)| {
        let place = |p: &[i8; 3]| Vec3::from(p.map(f32::from));
        TriMesh::new(places.iter().map(place).collect(), triangles)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_soup_is_built_and_read_again(mesh in some_mesh()) {
        let dag = built(&mesh);
        prop_assert_eq!(&ClusterDag::from_bytes(&dag.to_bytes()).unwrap(), &dag);
        for error in [0.0, 0.5, 2.0] {
            assert_no_cracks("soup", &mesh, &dag.cut_at(error), false);
        }
    }

    #[test]
    fn no_camera_sees_a_crack(
        place in prop::array::uniform3(-1.5f32..1.5),
        target in prop::array::uniform3(-0.5f32..0.5),
        threshold in 0.1f32..200.0,
        which in 0usize..4,
        flat in any::<bool>(),
        factor in 0.05f32..1.0,
        sun in prop::array::uniform3(-1f32..1.0),
    ) {
        let mesh = [
            shapes::icosphere(4),
            shapes::terrain(40, 40, 2),
            shapes::textured_sphere(40, 50),
            shapes::closed_cube(12),
        ][which].clone();
        let dag = built(&mesh);
        let mut camera = camera(&mesh, place, target);
        prop_assume!(camera.eye != camera.target);
        if flat {
            camera = camera.without_perspective();
        }
        let lights = [
            Light::Directional { direction: Vec3::from(sun), color: Vec3::ONE, intensity: 1.0 },
            Light::Point { position: Vec3::from(sun) * 2.0, color: Vec3::ONE, intensity: 1.0 },
        ];
        let criteria = ViewAndLight { camera, lights: lights.to_vec(), ..ViewAndLight::default() };
        let of_lights = ViewAndLight { area: f64::INFINITY, ..criteria.clone() };
        let detail = |criteria| Some(Detail { criteria, factor });
        for detail in [None, detail(&criteria), detail(&of_lights)] {
            let cut = dag.cut(&View { threshold, detail, ..View::new(camera) }).unwrap();
            assert_no_cracks("view", &mesh, &cut, false);
        }
    }

    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..200), flips in prop::collection::vec((12usize..4000, any::<u8>()), 1..6)) {
        use_if_read(&bytes);
        let mut wrong = built(&shapes::cube(4)).to_bytes();
        for (at, with) in flips {
            let end = wrong.len() - 8;
            wrong[12 + at % (end - 12)] = with;
        }
        use_if_read(&resealed(wrong));
    }
}
