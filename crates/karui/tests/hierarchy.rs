//! The half-edge hierarchy and its cuts.

use karui::geom::{Aabb, Camera, Light, Vec3};
use karui::hierarchy::{
    Bounds, Budget, Criteria, Cut, Gliding, Hierarchy, HierarchyOptions, Keep, Silhouette,
    ViewAndLight,
};
use karui::mesh::{Halfedge, PositionIds, RepairOptions, TriMesh, repair, shapes};
use karui::{Error, Result};
use proptest::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

fn deep() -> HierarchyOptions<'static> {
    HierarchyOptions {
        alpha: f64::INFINITY,
        ..HierarchyOptions::default()
    }
}

/// A walk around, close up and away, with a light that moves as well.
fn criteria(bounds: Aabb, step: u32) -> ViewAndLight {
    let (a, s) = (0.37 * step as f32, step as f32);
    let direction = Vec3::new(a.sin(), (0.11 * s).cos(), a.cos());
    let mut camera = Camera::looking_at(bounds, direction, 0.7);
    let nearer = [1.0, 0.6, 0.25, 3.0, 0.0][step as usize % 5];
    camera.eye = camera.target + (camera.eye - camera.target) * (nearer + 1e-3);
    let at = bounds.center() + Vec3::new(a.cos(), 1.0, a.sin()) * bounds.diagonal() as f32;
    ViewAndLight {
        camera,
        size: [160, 120],
        lights: vec![
            Light::Point {
                position: at,
                color: Vec3::ONE,
                intensity: 1.0,
            },
            Light::Directional {
                direction: -at,
                color: Vec3::ONE,
                intensity: 1.0,
            },
        ],
        area: [4.0, 60.0, 600.0][step as usize % 3],
        ..ViewAndLight::default()
    }
}

/// Edges with one triangle, by position.
fn border(mesh: &TriMesh, triangles: impl Iterator<Item = [u32; 3]>) -> BTreeSet<[u32; 2]> {
    let ids = PositionIds::of_mesh(mesh);
    let mut edges = BTreeSet::new();
    for t in triangles {
        let p = t.map(|v| ids.of_vertex[v as usize]);
        for [a, b] in [[p[0], p[1]], [p[1], p[2]], [p[2], p[0]]] {
            if !edges.remove(&[b, a]) {
                edges.insert([a, b]);
            }
        }
    }
    edges
}

fn drawn(cut: &Cut<'_>) -> Vec<[u32; 3]> {
    cut.triangles().into_iter().map(|t| t.1).collect()
}

/// Euler characteristic of a cut of a manifold mesh, seams closed.
fn euler(mesh: &TriMesh, cut: &Cut<'_>) -> i64 {
    let ids = PositionIds::of_mesh(mesh);
    let topology = Halfedge::new(&ids.triangles(&drawn(cut)), ids.count).expect("manifold");
    topology.validate().expect("sound");
    topology.euler_characteristic()
}

#[test]
fn cuts_of_the_zoo_hold_together_and_come_back() {
    for (name, mesh) in shapes::zoo() {
        let hierarchy = Hierarchy::build(&mesh, &deep()).unwrap_or_else(|e| panic!("{name}: {e}"));
        hierarchy
            .validate()
            .unwrap_or_else(|e| panic!("{name}: {e}"));
        let mut cut = hierarchy.coarsest();
        let mut first = None;
        for step in [0, 1, 2, 3, 4, 5, 6, 0] {
            let criteria = criteria(mesh.bounds(), step);
            cut.refine(&criteria, Budget::UNLIMITED).expect(name);
            cut.validate().unwrap_or_else(|e| panic!("{name}: {e}"));
            let mut fresh = hierarchy.finest();
            fresh.refine(&criteria, Budget::UNLIMITED).expect(name);
            assert_eq!(cut.triangles(), fresh.triangles(), "{name} {step}");
            first.get_or_insert_with(|| cut.triangles());
        }
        assert_eq!(first, Some(cut.triangles()), "{name}");
    }
}

#[test]
fn every_cut_has_the_topology_of_the_input() {
    let manifold = [
        shapes::icosphere(4),
        shapes::torus(1.0, 0.3, 40, 20),
        shapes::terrain(30, 20, 3),
        shapes::cube(6),
        shapes::textured_sphere(30, 40),
        shapes::loaded_sphere(20, 30),
    ];
    for mesh in &manifold {
        let hierarchy = Hierarchy::build(mesh, &deep()).unwrap();
        assert!(hierarchy.node_count() > 0);
        let mut cut = hierarchy.finest();
        let expected = euler(mesh, &cut);
        for step in 0..20 {
            cut.refine(&criteria(mesh.bounds(), step), Budget::UNLIMITED)
                .unwrap();
            assert_eq!(euler(mesh, &cut), expected, "{step}");
        }
        assert_eq!(euler(mesh, &hierarchy.coarsest()), expected);
    }
}

#[test]
fn the_finest_cut_is_the_mesh_and_the_coarsest_keeps_one_in_alpha() {
    let mesh = shapes::icosphere(5);
    let hierarchy = Hierarchy::build(&mesh, &HierarchyOptions::default()).unwrap();
    assert_eq!(drawn(&hierarchy.finest()), mesh.triangles);
    let vertices = mesh.positions.len();
    assert_eq!(hierarchy.node_count(), vertices - vertices.div_ceil(10));
    let coarsest = hierarchy.coarsest().to_mesh(&mesh).unwrap();
    assert_eq!(coarsest.positions.len(), vertices.div_ceil(10));
    assert_eq!(coarsest.triangles.len(), hierarchy.counts().coarsest);
    assert!(hierarchy.node_bytes() <= 60 * hierarchy.node_count());
}

#[test]
fn seams_and_borders_stay_where_they_are() {
    for mesh in [
        shapes::textured_sphere(30, 40),
        shapes::cube(8),
        shapes::loaded_sphere(20, 30),
    ] {
        let hierarchy = Hierarchy::build(&mesh, &deep()).unwrap();
        let mut cut = hierarchy.coarsest();
        for step in 0..12 {
            cut.refine(&criteria(mesh.bounds(), step), Budget::UNLIMITED)
                .unwrap();
            assert_eq!(border(&mesh, drawn(&cut).into_iter()), BTreeSet::new());
            // A cube has sharp edges, so each side has its own normals.
            cut.to_mesh(&mesh).unwrap().validate().unwrap();
        }
    }
    // A cube's sides are flat, so only its corners need to stay.
    let cube = shapes::cube(8);
    let hierarchy = Hierarchy::build(&cube, &deep()).unwrap();
    let coarsest = hierarchy.coarsest().to_mesh(&cube).unwrap();
    assert_eq!(coarsest.triangles.len(), 12);
    assert_eq!(coarsest.positions.len(), 24);
}

#[test]
fn materials_keep_their_triangles() {
    let mut mesh = shapes::grid(16, 16);
    let half = mesh.triangles.len() as u32 / 2;
    let range = |first, material| karui::mesh::MaterialRange {
        first,
        count: half,
        material: Some(material),
        source: None,
    };
    mesh.ranges = vec![range(0, 3), range(half, 5)];
    let area = |mesh: &TriMesh, range: usize| -> f64 {
        mesh.ranges[range]
            .triangles()
            .map(|t| karui::geom::area(mesh.corners(t)))
            .sum()
    };
    let options = HierarchyOptions {
        alpha: 36.0,
        ..deep()
    };
    let hierarchy = Hierarchy::build(&mesh, &options).unwrap();
    let coarse = hierarchy.coarsest().to_mesh(&mesh).unwrap();
    assert!(coarse.triangles.len() <= 12, "{}", coarse.triangles.len());
    for r in 0..2 {
        assert!((area(&coarse, r) - area(&mesh, r)).abs() < 1e-5);
    }
}

#[test]
fn what_is_not_manifold_is_split_and_opens_no_crack() {
    for (name, mesh) in [
        ("book", shapes::book(5)),
        ("bow_tie", shapes::bow_tie()),
        ("cubes_sharing_edge", shapes::cubes_sharing_edge()),
        ("flipped_face", shapes::flipped_face()),
        ("duplicate_faces", shapes::duplicate_faces()),
    ] {
        let hierarchy = Hierarchy::build(&mesh, &deep()).expect(name);
        let counts = hierarchy.counts();
        let said = counts.split_edges + counts.split_vertices + counts.dropped;
        assert!(said > 0, "{name}: {counts:?}");
        let coarsest = hierarchy.coarsest().to_mesh(&mesh).expect(name);
        let places = |mesh: &TriMesh| {
            mesh.positions
                .iter()
                .map(|p| p.to_array().map(f32::to_bits))
                .collect::<BTreeSet<_>>()
        };
        let left = places(&coarsest);
        let repaired = repair(&mesh, &RepairOptions::default()).expect(name);
        let ids = PositionIds::of_mesh(&repaired.mesh);
        let mut fans = vec![BTreeSet::new(); ids.count];
        for (at, fan) in ids.of_vertex.iter().zip(&repaired.ids.of_vertex) {
            fans[*at as usize].insert(fan);
        }
        for (v, &at) in ids.of_vertex.iter().enumerate() {
            let place = repaired.mesh.positions[v].to_array().map(f32::to_bits);
            assert!(
                fans[at as usize].len() < 2 || left.contains(&place),
                "{name}"
            );
        }
    }
}

#[test]
fn weights_and_locks_keep_detail() {
    let mesh = shapes::icosphere(4);
    let weights: Vec<f32> = mesh
        .positions
        .iter()
        .map(|p| if p.x > 0.0 { 100.0 } else { 1.0 })
        .collect();
    let locks: Vec<bool> = mesh.positions.iter().map(|p| p.y > 0.7).collect();
    let options = HierarchyOptions {
        alpha: 4.0,
        weights: Some(&weights),
        locks: Some(&locks),
        ..HierarchyOptions::default()
    };
    let hierarchy = Hierarchy::build(&mesh, &options).unwrap();
    let coarse = hierarchy.coarsest().to_mesh(&mesh).unwrap();
    let count =
        |mesh: &TriMesh, p: fn(&Vec3) -> bool| mesh.positions.iter().filter(|x| p(x)).count();
    assert_eq!(count(&coarse, |p| p.y > 0.7), count(&mesh, |p| p.y > 0.7));
    let (heavy, light) = (count(&coarse, |p| p.x > 0.0), count(&coarse, |p| p.x < 0.0));
    assert!(heavy > 3 * light / 2, "{heavy} {light}");
}

#[test]
fn the_same_for_any_number_of_threads() {
    let mesh = shapes::terrain(120, 90, 5);
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let hierarchy = Hierarchy::build(&mesh, &deep()).unwrap();
            let mut cut = hierarchy.coarsest();
            let criteria = ViewAndLight {
                area: 1.0,
                ..criteria(mesh.bounds(), 1)
            };
            cut.refine(&criteria, Budget::UNLIMITED).unwrap();
            let triangles = cut.indices().to_vec();
            (hierarchy, triangles)
        })
    };
    let one = run(1);
    assert_eq!(one, run(2));
    assert_eq!(one, run(8));
}

#[test]
fn a_budget_is_kept_and_leads_to_one_mesh() {
    let mesh = shapes::icosphere(5);
    let hierarchy = Hierarchy::build(&mesh, &HierarchyOptions::default()).unwrap();
    let mut cut = hierarchy.coarsest();
    for step in 0..10 {
        let criteria = ViewAndLight {
            area: 0.5,
            ..criteria(mesh.bounds(), step)
        };
        let free = hierarchy
            .coarsest()
            .refine(&criteria, Budget::UNLIMITED)
            .unwrap();
        let most = free.triangles.min(6000);
        let change = cut.refine(&criteria, Budget::triangles(most)).unwrap();
        cut.validate().unwrap();
        assert!(change.complete && change.triangles <= most);
        assert_eq!(change.floor > 0.0, free.triangles > most);
        let mut from_above = hierarchy.finest();
        from_above
            .refine(&criteria, Budget::triangles(most))
            .unwrap();
        assert_eq!(cut.triangles(), from_above.triangles(), "{step}");
        // Without one, all is as if there had never been one.
        let mut after = cut.clone();
        after.refine(&criteria, Budget::UNLIMITED).unwrap();
        assert_eq!(after.indices().len(), free.triangles);
    }
}

#[test]
fn no_time_changes_little_and_the_rest_follows() {
    let mesh = shapes::icosphere(5);
    let hierarchy = Hierarchy::build(&mesh, &HierarchyOptions::default()).unwrap();
    let criteria = ViewAndLight {
        area: 0.5,
        ..criteria(mesh.bounds(), 0)
    };
    let mut cut = hierarchy.coarsest();
    let change = cut.refine(&criteria, Budget::time(Duration::ZERO)).unwrap();
    assert!(!change.complete && change.splits == 0);
    let mut free = hierarchy.coarsest();
    free.refine(&criteria, Budget::UNLIMITED).unwrap();
    let change = cut
        .refine(&criteria, Budget::time(Duration::from_secs(100)))
        .unwrap();
    assert!(change.complete);
    assert_eq!(cut.triangles(), free.triangles());
}

#[test]
fn ranges_tell_all_that_is_new() {
    let mesh = shapes::torus(1.0, 0.4, 80, 40);
    let hierarchy = Hierarchy::build(&mesh, &HierarchyOptions::default()).unwrap();
    let mut cut = hierarchy.coarsest();
    let mut uploaded = cut.indices().to_vec();
    for step in 0..15 {
        let before = drawn(&cut);
        let change = cut
            .refine(&criteria(mesh.bounds(), step), Budget::UNLIMITED)
            .unwrap();
        uploaded.resize(change.triangles, [0; 3]);
        for range in &change.ranges {
            let range = range.start as usize..range.end as usize;
            uploaded[range.clone()].copy_from_slice(&cut.indices()[range]);
        }
        assert_eq!(uploaded, cut.indices());
        let used = |t: &[[u32; 3]]| t.as_flattened().iter().copied().collect::<BTreeSet<u32>>();
        let (old, new) = (used(&before), used(cut.indices()));
        let appeared: BTreeSet<u32> = cut.appeared().iter().map(|a| a[0]).collect();
        assert_eq!(appeared, new.difference(&old).copied().collect());
        assert!(cut.appeared().iter().all(|a| old.contains(&a[1])));
    }
    let again = cut
        .refine(&criteria(mesh.bounds(), 14), Budget::UNLIMITED)
        .unwrap();
    assert_eq!((again.splits, again.collapses, again.tests), (0, 0, 0));
    assert_eq!(again.ranges, []);
}

/// Where a threshold is met, what is there stays.
#[test]
fn hysteresis_keeps_what_is_there() {
    let mesh = shapes::icosphere(5);
    let hierarchy = Hierarchy::build(&mesh, &HierarchyOptions::default()).unwrap();
    let at = |hysteresis, nearer: f32| {
        let mut criteria = ViewAndLight {
            hysteresis,
            lights: Vec::new(),
            ..criteria(mesh.bounds(), 0)
        };
        criteria.camera.eye *= nearer;
        criteria
    };
    let changes = |hysteresis| -> usize {
        let mut cut = hierarchy.coarsest();
        let to_and_fro = (0..20).map(|i| 1.0 + 0.02 * (i % 2) as f32);
        let done = to_and_fro.map(|nearer| {
            let change = cut
                .refine(&at(hysteresis, nearer), Budget::UNLIMITED)
                .unwrap();
            cut.validate().unwrap();
            change.splits + change.collapses
        });
        done.skip(2).sum()
    };
    assert!(changes(1.0) > 100);
    assert_eq!(changes(1.5), 0);
    // What is to be kept is there all the same.
    let mut cut = hierarchy.coarsest();
    let mut free = hierarchy.coarsest();
    for nearer in [3.0, 1.0, 0.7, 2.0] {
        let with = cut.refine(&at(1.5, nearer), Budget::UNLIMITED).unwrap();
        let without = free.refine(&at(1.0, nearer), Budget::UNLIMITED).unwrap();
        assert!(with.triangles >= without.triangles);
    }
}

#[test]
fn what_comes_back_glides_to_its_place() {
    let mesh = shapes::icosphere(4);
    let hierarchy = Hierarchy::build(&mesh, &HierarchyOptions::default()).unwrap();
    let mut cut = hierarchy.coarsest();
    let mut gliding = Gliding::over(4);
    let weights = |g: &Gliding| g.glides().map(|g| g.weight).collect::<Vec<_>>();
    let here = Lens(Vec3::X, 0.5);
    gliding.refine(&mut cut, &here, Budget::UNLIMITED).unwrap();
    let came = cut.appeared().len();
    assert!(came > 0);
    assert_eq!(weights(&gliding), vec![0.0; came]);
    for quarter in [0.25, 0.5, 0.75] {
        gliding.refine(&mut cut, &here, Budget::UNLIMITED).unwrap();
        assert_eq!(weights(&gliding), vec![quarter; came]);
    }
    gliding.refine(&mut cut, &here, Budget::UNLIMITED).unwrap();
    assert_eq!(gliding.glides().count(), 0);
}

#[test]
fn what_goes_glides_to_where_it_will_be_part_of_another() {
    let mesh = shapes::icosphere(4);
    let hierarchy = Hierarchy::build(&mesh, &HierarchyOptions::default()).unwrap();
    let mut cut = hierarchy.coarsest();
    let mut gliding = Gliding::over(4);
    // Weight of every vertex that is drawn.
    let drawn = |cut: &Cut<'_>, gliding: &Gliding| {
        let used = cut.indices().as_flattened().iter();
        let mut drawn: BTreeMap<u32, f32> = used.map(|&v| (v, 1.0)).collect();
        drawn.extend(gliding.glides().map(|g| (g.vertex, g.weight)));
        drawn
    };
    let lens = |i: usize| Lens([Vec3::X, Vec3::Y, Vec3::X, Vec3::Z][i / 3 % 4], 0.6);
    let mut before = drawn(&cut, &gliding);
    let mut went = 0;
    for frame in 0..200 {
        // Not long enough at one place for all to arrive, but in the end.
        let lens = lens(frame.min(50));
        let change = gliding.refine(&mut cut, &lens, Budget::UNLIMITED).unwrap();
        assert_eq!(hierarchy.validate(), Ok(()));
        let now = drawn(&cut, &gliding);
        for (vertex, weight) in &before {
            match now.get(vertex) {
                Some(w) => assert!((w - weight).abs() <= 0.25, "{vertex}: {weight} to {w}"),
                None => assert_eq!(*weight, 0.0, "{vertex} went at once"),
            }
            went += usize::from(!now.contains_key(vertex));
        }
        let come = now.iter().filter(|n| !before.contains_key(n.0));
        assert!(come.clone().all(|n| *n.1 == 0.0));
        assert_eq!(cut.to_mesh(&mesh).unwrap().validate(), Ok(()));
        assert_eq!(change.triangles, cut.indices().len());
        before = now;
    }
    assert!(went > 100, "{went}");
    let mut fresh = hierarchy.coarsest();
    let change = fresh.refine(&lens(50), Budget::UNLIMITED).unwrap();
    assert!(change.complete && gliding.glides().count() == 0);
    assert_eq!(cut.triangles(), fresh.triangles());
}

#[test]
fn bad_cameras_lights_and_options_are_errors_and_change_nothing() {
    let mesh = shapes::icosphere(3);
    let hierarchy = Hierarchy::build(&mesh, &deep()).unwrap();
    let mut cut = hierarchy.coarsest();
    let before = cut.triangles();
    let good = criteria(mesh.bounds(), 0);
    let damages: [fn(&mut ViewAndLight); 13] = [
        |c| c.hysteresis = 0.5,
        |c| c.camera.eye.x = f32::NAN,
        |c| c.camera.eye = c.camera.target,
        |c| c.camera.target.y = f32::INFINITY,
        |c| c.camera.projection = karui::geom::Projection::Perspective { fov_y: 0.0 },
        |c| c.camera.projection = karui::geom::Projection::Orthographic { height: f32::NAN },
        |c| c.camera.near = Some(f32::NAN),
        |c| c.size = [0, 4],
        |c| c.area = -1.0,
        |c| c.flatness = f64::NAN,
        |c| c.highlight = 181.0,
        |c| c.silhouette = Silhouette::Kept { area: f64::NAN },
        |c| {
            c.lights[0] = Light::Point {
                position: Vec3::NAN,
                color: Vec3::ONE,
                intensity: 1.0,
            }
        },
    ];
    for (i, damage) in damages.into_iter().enumerate() {
        let mut bad = good.clone();
        damage(&mut bad);
        let found = cut.refine(&bad, Budget::UNLIMITED);
        assert!(
            matches!(found, Err(Error::BadOption { .. })),
            "{i}: {found:?}"
        );
        assert_eq!(cut.triangles(), before);
    }
    let bad = |options: HierarchyOptions<'_>| Hierarchy::build(&mesh, &options).unwrap_err();
    bad(HierarchyOptions {
        alpha: 0.5,
        ..deep()
    });
    bad(HierarchyOptions {
        weights: Some(&[1.0]),
        ..deep()
    });
    bad(HierarchyOptions {
        weights: Some(&vec![-1.0; mesh.positions.len()]),
        ..deep()
    });
    bad(HierarchyOptions {
        locks: Some(&[true]),
        ..deep()
    });
    assert!(cut.to_mesh(&shapes::cube(1)).is_err());
}

#[test]
fn no_lights_a_thousand_and_an_eye_inside() {
    let mesh = shapes::icosphere(4);
    let hierarchy = Hierarchy::build(&mesh, &deep()).unwrap();
    let mut cut = hierarchy.coarsest();
    let light = |i: u32| Light::Point {
        position: Vec3::new((i as f32).sin(), (i as f32).cos(), 0.01 * i as f32) * 3.0,
        color: Vec3::ONE,
        intensity: 1.0,
    };
    for lights in [vec![], (0..1000).map(light).collect()] {
        let mut criteria = ViewAndLight {
            lights,
            ..criteria(mesh.bounds(), 0)
        };
        cut.refine(&criteria, Budget::UNLIMITED).unwrap();
        cut.validate().unwrap();
        criteria.camera.eye = Vec3::new(0.1, 0.0, 0.0);
        cut.refine(&criteria, Budget::UNLIMITED).unwrap();
        cut.validate().unwrap();
    }
}

/// Criteria of a user: a sphere in which all is kept.
struct Lens(Vec3, f64);

impl Criteria for Lens {
    type Frame = Lens;

    fn frame(&self, _: Aabb) -> Result<Self::Frame> {
        Ok(Lens(self.0, self.1))
    }
}

impl Keep for Lens {
    fn keep(&self, bounds: &Bounds) -> bool {
        bounds.center.distance(self.0.as_dvec3()) <= self.1 + bounds.radius
    }

    fn area(&self, bounds: &Bounds) -> f64 {
        bounds.radius
    }
}

#[test]
fn a_lens_shows_the_mesh_as_it_is() {
    let mesh = shapes::icosphere(5);
    let hierarchy = Hierarchy::build(&mesh, &HierarchyOptions::default()).unwrap();
    let mut cut = hierarchy.coarsest();
    for at in [Vec3::X, Vec3::Y, -Vec3::Z] {
        cut.refine(&Lens(at, 0.3), Budget::UNLIMITED).unwrap();
        cut.validate().unwrap();
        let drawn: BTreeSet<[u32; 3]> = drawn(&cut).into_iter().collect();
        let within = |t: &&[u32; 3]| {
            t.iter()
                .all(|&v| mesh.positions[v as usize].distance(at) < 0.3)
        };
        assert!(
            mesh.triangles
                .iter()
                .filter(within)
                .all(|t| drawn.contains(t))
        );
        assert!(drawn.len() < mesh.triangles.len() / 2);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn random_walks_over_random_land(seed in any::<u64>(), columns in 4u32..24, rows in 4u32..24, steps in prop::collection::vec(0u32..40, 1..8)) {
        let mesh = shapes::terrain(columns, rows, seed);
        let hierarchy = Hierarchy::build(&mesh, &deep()).unwrap();
        hierarchy.validate().unwrap();
        let mut cut = hierarchy.coarsest();
        let expected = euler(&mesh, &cut);
        for step in steps {
            cut.refine(&criteria(mesh.bounds(), step), Budget::UNLIMITED).unwrap();
            cut.validate().unwrap();
            prop_assert_eq!(euler(&mesh, &cut), expected);
            let mut fresh = hierarchy.finest();
            fresh.refine(&criteria(mesh.bounds(), step), Budget::UNLIMITED).unwrap();
            prop_assert_eq!(cut.triangles(), fresh.triangles());
        }
    }
}
