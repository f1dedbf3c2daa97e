//! Texture coordinates and colours of adaptive meshes against those of uniform refinement.

use karui::geom::{Aabb, Camera, Vec2, Vec3, Vec4};
use karui::progress::Silent;
use karui::subdiv::adaptive::{Adaptive, AdaptiveMesh, AdaptiveOptions, View};
use karui::subdiv::{
    Cage, ControlMesh, Crease, FaceVarying, FaceVaryingRule, SubdivOptions, SurfaceOptions,
    subdivide,
};
use proptest::prelude::*;

const RULES: [FaceVaryingRule; 6] = [
    FaceVaryingRule::None,
    FaceVaryingRule::CornersOnly,
    FaceVaryingRule::CornersPlus1,
    FaceVaryingRule::CornersPlus2,
    FaceVaryingRule::Boundaries,
    FaceVaryingRule::All,
];

/// A prism over a pentagon, open at one side, with a colour for every vertex. Corners choose
/// by `choices` one of two values of their vertex.
fn prism(choices: &[bool]) -> ControlMesh {
    let faces: [&[u32]; 7] = [
        &[4, 3, 2, 1, 0],
        &[5, 6, 7, 8, 9],
        &[0, 1, 6, 5],
        &[1, 2, 7],
        &[1, 7, 6],
        &[2, 3, 8, 7],
        &[4, 0, 5, 9],
    ];
    let mut cage = Cage {
        vertices: 10,
        offsets: vec![0],
        ..Cage::default()
    };
    for face in faces {
        cage.indices.extend_from_slice(face);
        cage.offsets.push(cage.indices.len() as u32);
    }
    let ring = |i: u32| {
        let angle = (i % 5) as f32 * 1.256;
        Vec3::new(angle.cos(), (i / 5) as f32 + 0.2 * angle.sin(), angle.sin())
    };
    let value = |i: u32| Vec2::new((i % 5) as f32, (i / 5) as f32 + 0.1 * (i % 3) as f32);
    let choice = |(c, &v): (usize, &u32)| v + 10 * u32::from(choices[c % choices.len()]);
    let color = |i: u32| Vec4::new((i % 2) as f32, (i % 3) as f32 / 2.0, 0.3, 0.1 * i as f32);
    ControlMesh {
        positions: (0..10).map(ring).collect(),
        colors: Some((0..10).map(color).collect()),
        uvs: Some(FaceVarying {
            values: (0..20).map(value).collect(),
            indices: cage.indices.iter().enumerate().map(choice).collect(),
        }),
        face_materials: (0..7).map(|f| Some(f % 3)).collect(),
        cage,
        ..ControlMesh::default()
    }
}

fn refined(control: &ControlMesh, options: &SubdivOptions, how: &AdaptiveOptions) -> AdaptiveMesh {
    let bounds = Aabb::of(control.positions.iter().copied());
    let view = View {
        camera: Camera::looking_at(bounds, Vec3::new(1.0, 0.4, 0.6), 0.6),
        size: [300, 200],
        lights: Vec::new(),
    };
    let mut adaptive = Adaptive::of_control(control, options).expect("a good cage");
    adaptive.refine(&view, how).expect("a good view")
}

/// Everything at the vertices of faces.
fn vertices(mesh: &karui::mesh::PolyMesh) -> Vec<[f32; 9]> {
    let (uvs, colors) = (&mesh.attributes.uvs[0], &mesh.attributes.colors[0]);
    let mut used = mesh.indices.clone();
    used.sort_unstable();
    used.dedup();
    let numbers = |v: usize| {
        let ([x, y, z], [s, t]) = (mesh.positions[v].to_array(), uvs[v].to_array());
        let [r, g, b, a] = colors[v].to_array();
        [x, y, z, s, t, r, g, b, a]
    };
    used.into_iter().map(|v| numbers(v as usize)).collect()
}

/// The vertex that is farthest from all others, and how far.
fn farthest(from: &[[f32; 9]], to: &[[f32; 9]]) -> ([f32; 9], f32) {
    let off = |a: &[f32; 9], b: &[f32; 9]| {
        let off = a.iter().zip(b).map(|(a, b)| (a - b).abs());
        off.fold(0.0, f32::max)
    };
    let nearest = |a: &[f32; 9]| to.iter().map(|b| off(a, b)).fold(f32::INFINITY, f32::min);
    let all = from.iter().map(|a| (*a, nearest(a)));
    all.max_by(|a, b| a.1.total_cmp(&b.1)).expect("some vertex")
}

fn check_uniform(control: &ControlMesh, rule: FaceVaryingRule, (levels, limit): (u32, bool)) {
    let options = SubdivOptions {
        levels,
        face_varying: rule,
        ..SubdivOptions::default()
    };
    let surface = SurfaceOptions {
        on_limit: limit,
        normals: false,
    };
    let expected = subdivide(control, &options, surface, &Silent);
    let expected = expected.expect("a good cage").mesh;
    let how = AdaptiveOptions {
        limit,
        ..AdaptiveOptions::uniform(2 * levels)
    };
    let found = refined(control, &options, &how).mesh;
    assert_eq!(found.face_count(), expected.face_count());
    let (found, expected) = (vertices(&found), vertices(&expected));
    for (from, to) in [(&found, &expected), (&expected, &found)] {
        let (vertex, off) = farthest(from, to);
        assert!(off < 1e-5, "{rule:?} {levels} {limit}: {vertex:?} by {off}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn values_are_those_of_uniform_refinement(
        choices in proptest::collection::vec(proptest::bool::weighted(0.3), 1..29),
        rule in 0..RULES.len(),
        levels in 1u32..4,
        limit: bool,
    ) {
        check_uniform(&prism(&choices), RULES[rule], (levels, limit));
    }
}

/// Twice the area of all faces in texture space, mirrored or not.
fn area(mesh: &karui::mesh::PolyMesh) -> f64 {
    let uv = |v: u32| mesh.attributes.uvs[0][v as usize].as_dvec2();
    let face = |w: &[u32]| {
        let face = &mesh.indices[w[0] as usize..w[1] as usize];
        let next = face.iter().skip(1).chain(&face[..1]);
        let sum = face.iter().zip(next).map(|(&a, &b)| uv(a).perp_dot(uv(b)));
        sum.sum::<f64>().abs()
    };
    mesh.offsets.windows(2).map(face).sum()
}

#[test]
fn no_face_crosses_a_seam() {
    // A cube, each side of which has a square of its own.
    let cage = Cage {
        vertices: 8,
        offsets: (0..=6).map(|f| 4 * f).collect(),
        indices: vec![
            0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5,
        ],
        ..Cage::default()
    };
    let axis = |v: u32, a: u32| (v >> a & 1) as f32;
    let square = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
    let value = |c: u32| square[c as usize % 4] + Vec2::X * (2 * (c / 4)) as f32;
    let control = ControlMesh {
        positions: (0..8)
            .map(|v| Vec3::new(axis(v, 0), axis(v, 1), axis(v, 2)))
            .collect(),
        uvs: Some(FaceVarying {
            values: (0..24).map(value).collect(),
            indices: (0..24).collect(),
        }),
        cage,
        ..ControlMesh::default()
    };
    for depth in 0..6 {
        let options = SubdivOptions {
            face_varying: FaceVaryingRule::All,
            ..SubdivOptions::default()
        };
        let whole = refined(&control, &options, &AdaptiveOptions::uniform(depth));
        let seen = refined(&control, &options, &AdaptiveOptions::within(0.5));
        for mesh in [whole.mesh, seen.mesh] {
            assert!(
                (area(&mesh) - 12.0).abs() < 1e-5,
                "{depth}: {}",
                area(&mesh)
            );
            mesh.clone().triangulate().validate().expect("a good mesh");
        }
    }
}

#[test]
fn limits_are_those_of_fine_meshes() {
    let control = prism(&[false, true, false, false, false]);
    let fine = SubdivOptions {
        levels: 6,
        ..SubdivOptions::default()
    };
    let fine = subdivide(&control, &fine, SurfaceOptions::default(), &Silent).expect("a good cage");
    let coarse = refined(
        &control,
        &SubdivOptions::default(),
        &AdaptiveOptions::uniform(2),
    )
    .mesh;
    let all = |mesh: &karui::mesh::PolyMesh, v: usize| {
        let (uv, color) = (mesh.attributes.uvs[0][v], mesh.attributes.colors[0][v]);
        (mesh.positions[v], uv, color)
    };
    for v in 0..coarse.positions.len() {
        let (position, uv, color) = all(&coarse, v);
        let near = (0..fine.mesh.positions.len()).map(|w| {
            let other = all(&fine.mesh, w);
            let apart = position.distance(other.0) + uv.distance(other.1);
            apart + color.distance(other.2)
        });
        let nearest = near.fold(f32::INFINITY, f32::min);
        assert!(nearest < 5e-3, "vertex {v}: {nearest}");
    }
}

#[test]
fn creases_and_materials_go_along() {
    let mut control = prism(&[false]);
    control.cage.creases.push(Crease {
        vertices: [1, 6],
        sharpness: 10.0,
    });
    check_uniform(&control, FaceVaryingRule::CornersPlus1, (2, false));
    let mesh = refined(
        &control,
        &SubdivOptions::default(),
        &AdaptiveOptions::default(),
    );
    let material = |&f: &u32| control.face_materials[f as usize];
    let expected: Vec<Option<u32>> = mesh.parents.iter().map(material).collect();
    assert_eq!(mesh.mesh.face_materials, expected);
}

#[test]
fn memory_used_again_holds_no_values_of_another() {
    let mut control = prism(&[true, false]);
    let options = SubdivOptions::default();
    let mut mesh = refined(&control, &options, &AdaptiveOptions::default());
    (control.uvs, control.colors) = (None, None);
    control.face_materials.clear();
    let view = View {
        camera: Camera::looking_at(Aabb::of(control.positions.iter().copied()), Vec3::X, 0.6),
        size: [100, 100],
        lights: Vec::new(),
    };
    let mut plain = Adaptive::of_control(&control, &options).expect("a good cage");
    let how = AdaptiveOptions::default();
    plain
        .refine_into(&view, &how, &mut mesh)
        .expect("a good view");
    assert_eq!(mesh, plain.refine(&view, &how).expect("a good view"));
    mesh.to_tri_mesh().validate().expect("a good mesh");
}
