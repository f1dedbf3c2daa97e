//! Attributes of real models after simplification: UVs stay in their charts,
//! skin weights sum to 1, normals are unit, materials keep their triangles.
#![allow(clippy::unwrap_used, reason = "a failed unwrap fails the test")]
#![allow(clippy::print_stdout, reason = "a test that is skipped says so")]

mod common;

use common::models;
use glam::{Vec2, Vec3};
use karui::TriMesh;
use karui::mesh::{Components, PositionIds};
use karui::metrics::{Samples, SurfaceDistanceOptions, surface_distance};
use karui::simplify::{Quality, SimplifyOptions, Stop, simplify};
use std::collections::BTreeMap;

const TEXTURED: [&str; 6] = [
    "gltf/CesiumMan.glb",
    "gltf/Fox.glb",
    "gltf/FlightHelmet/FlightHelmet.gltf",
    "gltf/AnisotropyBarnLamp/AnisotropyBarnLamp.gltf",
    "gltf/PalmTree/PalmTree.gltf",
    "hard/sponza.obj.gz",
];

#[test]
fn attributes_of_textured_models_hold() {
    let Some(folder) = models() else { return };
    for file in TEXTURED {
        let scene = karui_io::read(folder.join(file)).unwrap();
        for named in scene.meshes.iter().filter(|m| !m.mesh.triangles.is_empty()) {
            let options = SimplifyOptions {
                stop: Stop::ratio(0.25),
                ..SimplifyOptions::default()
            };
            let coarse = simplify(&named.mesh, &options).unwrap().mesh;
            coarse.validate().unwrap();
            check_vertices(file, &named.mesh, &coarse);
            check_ranges(file, &named.mesh, &coarse);
            check_charts(file, &named.mesh, &coarse);
        }
    }
}

fn check_vertices(file: &str, mesh: &TriMesh, coarse: &TriMesh) {
    let unit = |normals: &[Vec3]| normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-3);
    if mesh.attributes.normals.as_deref().is_some_and(unit) {
        assert!(
            coarse.attributes.normals.as_deref().is_some_and(unit),
            "{file}"
        );
    }
    let skins = &coarse.attributes.skins;
    for v in 0..skins.first().map_or(0, Vec::len) {
        let sum: f32 = skins.iter().flat_map(|set| set[v].weights).sum();
        assert!(
            (sum - 1.0).abs() < 1e-3,
            "{file}: weights of {v} sum to {sum}"
        );
    }
}

fn check_ranges(file: &str, mesh: &TriMesh, coarse: &TriMesh) {
    let material = |m: &TriMesh| m.ranges.iter().map(|r| r.material).collect::<Vec<_>>();
    assert_eq!(material(mesh), material(coarse), "{file}");
    for (before, after) in mesh.ranges.iter().zip(&coarse.ranges) {
        assert!(
            before.count == 0 || after.count > 0,
            "{file}: a material is gone"
        );
        assert!(after.count <= before.count, "{file}");
    }
}

/// Boxes of a chart in texture space and in space.
type Chart = [(Vec3, Vec3); 2];

/// Charts: triangles that hang together by position and UV.
fn charts(mesh: &TriMesh, uvs: &[Vec2]) -> Vec<Chart> {
    let mut known = BTreeMap::new();
    let mut ids = PositionIds::of_mesh(mesh);
    let keys: Vec<_> = ids.of_vertex.iter().zip(uvs).collect();
    let bits = |uv: &Vec2| (uv.x.to_bits(), uv.y.to_bits());
    let of_vertex = keys.iter().map(|(p, uv)| {
        let next = known.len() as u32;
        *known.entry((**p, bits(uv))).or_insert(next)
    });
    ids.of_vertex = of_vertex.collect();
    ids.count = known.len();
    let flat = |uv: Vec2| uv.extend(0.0);
    let components = Components::of(mesh, &ids).unwrap();
    let (first, triangles) = components.groups();
    let boxes = first.windows(2).map(|group| {
        let triangles = &triangles[group[0] as usize..group[1] as usize];
        let corners = || triangles.iter().flat_map(|&t| mesh.triangles[t as usize]);
        [
            span(corners().map(|v| flat(uvs[v as usize]))),
            span(corners().map(|v| mesh.positions[v as usize])),
        ]
    });
    boxes.collect()
}

fn span(points: impl Iterator<Item = Vec3>) -> (Vec3, Vec3) {
    points.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), p| {
        (lo.min(p), hi.max(p))
    })
}

fn check_charts(file: &str, mesh: &TriMesh, coarse: &TriMesh) {
    let (Some(before), Some(after)) = (mesh.attributes.uvs.first(), coarse.attributes.uvs.first())
    else {
        return;
    };
    let charts = charts(mesh, before);
    let slack = [1e-4, 0.05 * mesh.bounds().diagonal() as f32];
    for triangle in &coarse.triangles {
        let uv = triangle.map(|v| after[v as usize].extend(0.0));
        let place = triangle.map(|v| coarse.positions[v as usize]);
        let inside = |points: &[Vec3; 3], (lo, hi): (Vec3, Vec3), slack: f32| {
            points
                .iter()
                .all(|p| p.cmpge(lo - slack).all() && p.cmple(hi + slack).all())
        };
        let fits = |c: &Chart| inside(&uv, c[0], slack[0]) && inside(&place, c[1], slack[1]);
        assert!(charts.iter().any(fits), "{file}: {uv:?} lies in no chart");
    }
}

/// Where this scan is tangled inside, knots that nothing dissolves must not
/// take the triangles of what is seen.
#[test]
fn coarse_dragon_keeps_its_shape() {
    let Some(folder) = models() else { return };
    let scene = karui_io::read(folder.join("scans/dragon_vrip.ply.gz")).unwrap();
    let mesh = &scene.meshes[0].mesh;
    let sampled = SurfaceDistanceOptions {
        samples: Samples::Count(20_000),
        vertices: false,
        ..SurfaceDistanceOptions::default()
    };
    for quality in [Quality::Fast, Quality::Balanced] {
        let options = SimplifyOptions {
            stop: Stop::triangles(1000),
            quality,
            ..SimplifyOptions::default()
        };
        let coarse = simplify(mesh, &options).unwrap().mesh;
        let error = surface_distance(mesh, &coarse, &sampled).unwrap().rms();
        let (low, high) = span(mesh.positions.iter().copied());
        let share = error / f64::from(low.distance(high));
        assert!(share < 0.006, "{quality:?}: {share}");
    }
}
