//! Changes of topology while simplifying: on meshes whose handles, holes and
//! parts are known by construction.

#![allow(clippy::unwrap_used, reason = "a failed unwrap fails the test")]

use glam::{Vec2, Vec3};
use karui::TriMesh;
use karui::mesh::{TopologyReport, diagnose, shapes};
use karui::simplify::{
    Border, Quality, Simplified, SimplifyOptions, Stop, Topology, simplify, simplify_chain,
};
use proptest::prelude::*;

fn options(ratio: f64, topology: Topology) -> SimplifyOptions<'static> {
    SimplifyOptions {
        quality: Quality::Fast,
        stop: Stop::ratio(ratio),
        topology,
        ..SimplifyOptions::default()
    }
}

fn to(mesh: &TriMesh, ratio: f64, topology: Topology) -> Simplified {
    simplify(mesh, &options(ratio, topology)).unwrap()
}

/// A plate of `n` by `n` cells and little height with a tunnel through each of
/// these cells, no two of which touch: a surface of as many handles.
fn plate(n: u32, tunnels: &[[u32; 2]]) -> TriMesh {
    let at = |x: u32, y: u32, top: bool| x + (n + 1) * (y + (n + 1) * u32::from(top));
    let mut positions = Vec::new();
    for top in [false, true] {
        for (y, x) in (0..=n).flat_map(|y| (0..=n).map(move |x| (y, x))) {
            // Not flat, or everything would cost nothing.
            let wave = (0.17 * x as f32).sin() + (0.13 * y as f32).cos();
            let z = 3.0 * wave + if top { 1.0 } else { 0.0 };
            positions.push(Vec3::new(x as f32, y as f32, z));
        }
    }
    let mut triangles = Vec::new();
    let mut quad = |a, b, c, d| triangles.extend([[a, b, c], [a, c, d]]);
    for (y, x) in (0..n).flat_map(|y| (0..n).map(move |x| (y, x))) {
        let ring = [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)];
        let [a, b, c, d] = ring.map(|(x, y)| at(x, y, true));
        let [e, f, g, h] = ring.map(|(x, y)| at(x, y, false));
        if !tunnels.contains(&[x, y]) {
            quad(a, b, c, d);
            quad(e, h, g, f);
            continue;
        }
        for [(low, high), (low_next, high_next)] in [
            [(e, a), (f, b)],
            [(f, b), (g, c)],
            [(g, c), (h, d)],
            [(h, d), (e, a)],
        ] {
            quad(low_next, low, high, high_next);
        }
    }
    for i in 0..n {
        for [(x, y), (u, v)] in [
            [(i, 0), (i + 1, 0)],
            [(n, i), (n, i + 1)],
            [(i + 1, n), (i, n)],
            [(0, i + 1), (0, i)],
        ] {
            quad(
                at(x, y, false),
                at(u, v, false),
                at(u, v, true),
                at(x, y, true),
            );
        }
    }
    TriMesh::new(positions, triangles)
}

/// Handles of a closed surface of one part.
fn genus(report: &TopologyReport) -> i64 {
    report.components as i64 - report.euler_characteristic / 2
}

/// A sphere and crumbs of it around it, of this size.
fn crumbs(count: u32, size: f32) -> TriMesh {
    let mut all = shapes::icosphere(5);
    let crumb = shapes::icosphere(1);
    for i in 0..count {
        let angle = i as f32 * 2.4;
        let height = (i as f32 + 0.5) / count as f32 * 2.0 - 1.0;
        let (sin, cos) = angle.sin_cos();
        let around = (1.0 - height * height).sqrt();
        let center = Vec3::new(cos * around, sin * around, height) * 1.1;
        let first = all.positions.len() as u32;
        let place = |p: &Vec3| *p * size + center;
        all.positions.extend(crumb.positions.iter().map(place));
        let triangles = crumb.triangles.iter().map(|t| t.map(|v| v + first));
        all.triangles.extend(triangles);
    }
    all
}

/// A sphere without each of these triangles.
fn leaky(holes: &[usize]) -> TriMesh {
    let mut sphere = shapes::icosphere(5);
    sphere.retain_triangles(|t| !holes.contains(&t));
    sphere
}

#[test]
fn the_generated_meshes_are_what_they_are_said_to_be() {
    let report = diagnose(&plate(12, &[[2, 2], [5, 2], [8, 7]])).unwrap();
    assert!(report.closed && report.manifold && report.oriented && report.volume > Some(0.0));
    assert_eq!(genus(&report), 3);
    assert_eq!(diagnose(&crumbs(7, 0.01)).unwrap().components, 8);
    assert_eq!(diagnose(&leaky(&[40, 900])).unwrap().boundary_loops, 2);
}

#[test]
fn handles_keep_their_triangles_only_if_asked_to() {
    let tunnels: Vec<[u32; 2]> = (0..100)
        .map(|i| [3 + 6 * (i % 10), 3 + 6 * (i / 10)])
        .collect();
    let mesh = plate(64, &tunnels);
    let kept = to(&mesh, 0.01, Topology::Preserve);
    assert_eq!(genus(&diagnose(&kept.mesh).unwrap()), 100);
    let free = to(&mesh, 0.01, Topology::Simplify);
    let report = diagnose(&free.mesh).unwrap();
    assert!(report.closed && report.manifold && report.oriented);
    assert_eq!(genus(&report), 100 - free.topology.handles as i64);
    assert!(free.topology.handles > 80, "{:?}", free.topology);
    assert!(free.mesh.triangles.len() <= mesh.triangles.len() / 100);
    assert!(kept.mesh.triangles.len() > 2 * free.mesh.triangles.len());
}

#[test]
fn an_arm_of_three_sides_stays_on() {
    // Two balls joined by a neck of triangular section.
    let mut mesh = shapes::icosphere(4);
    let ball = mesh.clone();
    let n = ball.positions.len() as u32;
    mesh.positions.extend(
        ball.positions
            .iter()
            .map(|p| Vec3::new(4.0 - p.x, p.y, p.z)),
    );
    mesh.triangles.extend(
        ball.triangles
            .iter()
            .map(|t| [t[0] + n, t[2] + n, t[1] + n]),
    );
    // The triangle furthest to the right, and its image.
    let center = |t: &[u32; 3]| t.iter().map(|&v| ball.positions[v as usize].x).sum::<f32>();
    let right = (0..ball.triangles.len())
        .max_by(|&a, &b| center(&ball.triangles[a]).total_cmp(&center(&ball.triangles[b])))
        .unwrap();
    let [a, b, c] = mesh.triangles[right];
    mesh.retain_triangles(|t| t != right && t != right + ball.triangles.len());
    for (p, q) in [(a, b), (b, c), (c, a)] {
        mesh.triangles.extend([[p, q, q + n], [p, q + n, p + n]]);
    }
    let before = diagnose(&mesh).unwrap();
    assert!(
        before.closed && before.oriented && before.components == 1,
        "{before:?}"
    );
    for triangles in [200, 60, 24] {
        let coarse = simplify(
            &mesh,
            &SimplifyOptions {
                stop: Stop::triangles(triangles),
                ..options(0.0, Topology::Simplify)
            },
        )
        .unwrap();
        let after = diagnose(&coarse.mesh).unwrap();
        assert!(after.closed && after.components == 1, "{triangles}");
        assert_eq!(coarse.topology.handles, 0);
    }
}

#[test]
fn crumbs_vanish_below_the_error_and_never_all() {
    let mesh = crumbs(60, 0.01);
    let kept = to(&mesh, 0.01, Topology::Preserve);
    assert_eq!(diagnose(&kept.mesh).unwrap().components, 61);
    let free = to(&mesh, 0.01, Topology::Simplify);
    assert_eq!(free.topology.parts, 60);
    assert!(free.error > 0.005);
    // Large ones are still there, as long as they are worth their triangles.
    let large = to(&crumbs(4, 0.3), 0.02, Topology::Simplify);
    assert_eq!(diagnose(&large.mesh).unwrap().components, 5);
    // However low the target, something is left.
    let last = to(&mesh, 0.0, Topology::Simplify);
    assert_eq!(diagnose(&last.mesh).unwrap().components, 1);
    assert!(diagnose(&last.mesh).unwrap().closed);
}

#[test]
fn nothing_goes_above_the_error_bound() {
    let mesh = crumbs(60, 0.01);
    let bounded = SimplifyOptions {
        stop: Stop::error(0.004),
        ..options(0.0, Topology::Simplify)
    };
    let coarse = simplify(&mesh, &bounded).unwrap();
    assert_eq!(coarse.topology.parts, 0);
}

#[test]
fn locked_parts_stay() {
    let mesh = crumbs(60, 0.01);
    let mut locks = vec![false; mesh.positions.len()];
    *locks.last_mut().unwrap() = true;
    let options = SimplifyOptions {
        locks: Some(&locks),
        ..options(0.01, Topology::Simplify)
    };
    let coarse = simplify(&mesh, &options).unwrap();
    assert_eq!(diagnose(&coarse.mesh).unwrap().components, 2);
    assert!(
        coarse
            .mesh
            .positions
            .contains(mesh.positions.last().unwrap())
    );
}

/// Prices and what they are compared with are both weighted.
#[test]
fn weights_of_all_alike_change_nothing_and_a_heavy_part_stays() {
    let mesh = crumbs(60, 0.02);
    let weighted = |weights: &[f32]| {
        let options = SimplifyOptions {
            weights: Some(weights),
            ..options(0.02, Topology::Simplify)
        };
        simplify(&mesh, &options).unwrap()
    };
    let plain = to(&mesh, 0.02, Topology::Simplify).topology;
    assert!(plain.parts > 0, "{plain:?}");
    let mut weights = vec![64.0; mesh.positions.len()];
    assert_eq!(weighted(&weights).topology, plain);
    let crumb = shapes::icosphere(1).positions.len();
    let heavy = weights.len() - crumb..weights.len();
    weights[heavy.clone()].fill(1e9);
    let coarse = weighted(&weights).mesh;
    let center = mesh.positions[heavy].iter().sum::<Vec3>() / crumb as f32;
    let near = |p: &Vec3| p.distance(center) < 0.03;
    assert!(coarse.positions.iter().any(near));
}

#[test]
fn holes_close_unless_borders_are_locked() {
    let holes: Vec<usize> = (0..60).map(|i| 50 + 300 * i).collect();
    let mesh = leaky(&holes);
    let free = to(&mesh, 0.01, Topology::Simplify);
    let report = diagnose(&free.mesh).unwrap();
    assert_eq!(free.topology.holes + report.boundary_loops, 60);
    assert!(free.topology.holes > 50, "{:?}", free.topology);
    assert!(report.manifold && report.oriented);
    let locked = SimplifyOptions {
        border: Border::Lock,
        ..options(0.01, Topology::Simplify)
    };
    let locked = simplify(&mesh, &locked).unwrap();
    assert_eq!(diagnose(&locked.mesh).unwrap().boundary_loops, 60);
}

#[test]
fn wedges_and_materials_survive() {
    let mut mesh = plate(48, &[[5, 5], [15, 25], [30, 40], [40, 12], [22, 8]]);
    let uv = |p: &Vec3| Vec2::new(p.x, p.y) / 48.0;
    mesh.attributes.uvs = vec![mesh.positions.iter().map(uv).collect()];
    let levels = simplify_chain(
        &mesh,
        &[Stop::ratio(0.1), Stop::ratio(0.03), Stop::ratio(0.005)],
        &options(0.0, Topology::Simplify),
    )
    .unwrap();
    // How far a texture may have slipped, cells.
    for (level, slip) in levels.iter().zip([1.0, 2.0, 8.0]) {
        level.mesh.validate().unwrap();
        let places = level.mesh.positions.iter();
        for (p, uv) in places.zip(&level.mesh.attributes.uvs[0]) {
            let slipped = (*uv * 48.0 - Vec2::new(p.x, p.y)).length();
            assert!(slipped < slip, "{slipped} of {slip}");
        }
    }
    let last = levels.last().unwrap();
    assert!(last.topology.handles > 0);
    assert!(diagnose(&last.mesh).unwrap().closed);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn manifold_stays_manifold_and_threads_do_not_matter(
        cells in prop::collection::btree_set((0u32..7, 0u32..7), 0..12),
        count in 0u32..20,
        share in 0.005f64..0.05,
    ) {
        let tunnels: Vec<[u32; 2]> = cells.iter().map(|&(x, y)| [2 + 3 * x, 2 + 3 * y]).collect();
        let mut mesh = plate(24, &tunnels);
        let crumbs = crumbs(count, 0.05);
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(crumbs.positions.iter().map(|p| *p * 6.0 + Vec3::Z * 40.0));
        mesh.triangles.extend(crumbs.triangles.iter().map(|t| t.map(|v| v + first)));
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| to(&mesh, share, Topology::Simplify))
        };
        let (one, four) = (with(1), with(4));
        prop_assert_eq!(&one.mesh, &four.mesh);
        let report = diagnose(&one.mesh).unwrap();
        prop_assert!(report.closed && report.manifold && report.oriented, "{:?}", report);
        prop_assert_eq!(report.components + one.topology.parts, 2 + count as usize);
        let lost = tunnels.len() as i64 - genus(&report);
        prop_assert!(lost >= one.topology.handles as i64);
    }
}
