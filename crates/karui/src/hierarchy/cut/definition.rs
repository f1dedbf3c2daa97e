//! Tests against the definitions, which need to see what is inside.

use super::ACTIVE;
use crate::geom::{Camera, DVec3, Light, Vec3};
use crate::hierarchy::{Budget, Criteria, Hierarchy, HierarchyOptions, Keep, ViewAndLight};
use crate::mesh::{TriMesh, shapes};

fn meshes() -> Vec<TriMesh> {
    vec![
        shapes::icosphere(4),
        shapes::torus(1.0, 0.4, 40, 20),
        shapes::terrain(25, 30, 2),
    ]
}

fn view(mesh: &TriMesh, step: u32) -> ViewAndLight {
    let a = 0.8 * step as f32;
    let camera = Camera::looking_at(mesh.bounds(), Vec3::new(a.sin(), 0.4, a.cos()), 0.5);
    ViewAndLight {
        lights: Light::three_points(&camera).unwrap(),
        size: [300, 200],
        area: 30.0,
        camera,
        ..ViewAndLight::default()
    }
}

/// What is kept and everything that waits for it, transitively, is active; all
/// else is not.
#[test]
fn a_cut_is_what_is_kept_and_all_that_waits_for_it() {
    for mesh in meshes() {
        let hierarchy = Hierarchy::build(&mesh, &HierarchyOptions::default()).unwrap();
        let mut cut = hierarchy.coarsest();
        for step in 0..6 {
            let criteria = view(&mesh, step);
            let frame = criteria.frame(hierarchy.bounds()).unwrap();
            cut.refine(&criteria, Budget::UNLIMITED).unwrap();
            let mut active: Vec<bool> = hierarchy.node_bounds().map(|b| frame.keep(&b)).collect();
            for node in 0..active.len() {
                if active[node] {
                    hierarchy
                        .waiting(node as u32)
                        .for_each(|w| active[w as usize] = true);
                }
            }
            let found: Vec<bool> = cut.state.iter().map(|s| s & ACTIVE != 0).collect();
            assert_eq!(found, active);
        }
    }
}

/// The first collapse is the one that costs least of all, by the formulas as they
/// are written: the others follow from the same code.
#[test]
fn the_first_collapse_costs_least() {
    for mesh in meshes() {
        let hierarchy = Hierarchy::build(&mesh, &HierarchyOptions::default()).unwrap();
        let first = hierarchy.nodes[0].half_edge;
        assert_eq!(
            first & super::super::surface::REVERSED,
            0,
            "interiors are cheaper here"
        );
        let sides = hierarchy.surface.sides(first);
        let [removed, kept] = hierarchy.surface.moves(sides).left;
        let borders = border_vertices(&mesh);
        let mut least = f64::INFINITY;
        for &t in &mesh.triangles {
            for k in 0..3 {
                let (u, v) = (t[k], t[(k + 1) % 3]);
                if !borders[u as usize] {
                    least = least.min(plain_cost(&mesh, u, v));
                }
            }
        }
        let found = plain_cost(&mesh, removed, kept);
        assert!(found <= least * (1.0 + 1e-3) + 1e-18, "{found} {least}");
    }
}

fn border_vertices(mesh: &TriMesh) -> Vec<bool> {
    let mut of = vec![false; mesh.positions.len()];
    let halves: std::collections::BTreeSet<[u32; 2]> = mesh
        .triangles
        .iter()
        .flat_map(|t| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]])
        .collect();
    for &[a, b] in halves.iter().filter(|h| !halves.contains(&[h[1], h[0]])) {
        of[a as usize] = true;
        of[b as usize] = true;
    }
    of
}

/// `Q / sqrt(deg - 2)` times `2/k sum (1 - cos a)`.
fn plain_cost(mesh: &TriMesh, u: u32, v: u32) -> f64 {
    let at = |i: u32| mesh.positions[i as usize].as_dvec3();
    let normal = |t: [u32; 3]| {
        let [a, b, c] = t.map(at);
        (b - a).cross(c - a).normalize()
    };
    let around = mesh.triangles.iter().filter(|t| t.contains(&u));
    let degree = mesh.triangles.iter().filter(|t| t.contains(&v)).count();
    let (mut q, mut turns, mut k) = (0.0, 0.0, 0.0);
    for &t in around {
        let n: DVec3 = normal(t);
        q += n.dot(at(v) - at(t[0])).powi(2);
        if !t.contains(&v) {
            let angle = n
                .dot(normal(t.map(|i| if i == u { v } else { i })))
                .clamp(-1.0, 1.0)
                .acos();
            if angle >= std::f64::consts::FRAC_PI_2 {
                return f64::INFINITY;
            }
            turns += 1.0 - angle.cos();
            k += 1.0;
        }
    }
    q / (degree as f64 - 2.0).max(1.0).sqrt() * 2.0 / k * turns
}

/// What is said of how long an answer holds is true.
#[test]
fn answers_hold_for_as_long_as_they_say() {
    let mesh = shapes::torus(1.0, 0.4, 40, 20);
    let hierarchy = Hierarchy::build(&mesh, &HierarchyOptions::default()).unwrap();
    let mut held = [0; 2];
    for step in 0..400u32 {
        let mut before = view(&mesh, step / 40);
        let mut after = before.clone();
        let s = 0.004 * (1 + step % 40) as f32;
        let random = |k: u32| ((step * 7919 + k * 104_729) as f32 * 0.618).fract() - 0.5;
        let offset = Vec3::new(random(1), random(2), random(3)) * s;
        after.camera.eye += offset;
        if step % 3 == 0 {
            after.camera.target -= offset * 0.7;
        }
        if step % 5 == 0 {
            before.camera = before.camera.without_perspective();
            after.camera = after.camera.without_perspective();
        }
        if step % 4 == 0 {
            after.lights[0] = Light::Directional {
                direction: Vec3::new(0.1, -1.0 + s, s),
                color: Vec3::ONE,
                intensity: 1.0,
            };
            before.lights[0] = Light::Directional {
                direction: Vec3::new(0.1, -1.0, 0.0),
                color: Vec3::ONE,
                intensity: 1.0,
            };
        }
        let point = |at: Vec3| Light::Point {
            position: at,
            color: Vec3::ONE,
            intensity: 1.0,
        };
        before.lights[1] = point(Vec3::new(2.0, 1.0, 0.3));
        after.lights[1] = point(Vec3::new(2.0, 1.0, 0.3));
        if step % 4 < 2 {
            after.lights[1] = point(Vec3::new(2.0, 1.0, 0.3) - offset);
        }
        let [before, after] = [before, after].map(|c| c.frame(hierarchy.bounds()).unwrap());
        let way = after.vantage().unwrap();
        let way = way.way_from(&before.vantage().unwrap());
        if step % 5 != 0 {
            assert!(way.eye.is_finite());
        }
        let still = way.lights == 0.0;
        for bounds in hierarchy.node_bounds() {
            let (keep, holds) = before.keep_for(&bounds, still);
            assert_eq!(keep, before.keep(&bounds));
            if way.eye + way.lights < holds {
                held[usize::from(still)] += 1;
                assert_eq!(after.keep(&bounds), keep, "{step} {bounds:?}");
            }
        }
    }
    assert!(held.iter().all(|&h| h > 10_000), "{held:?}");
}
