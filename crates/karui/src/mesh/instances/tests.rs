use super::*;
use crate::mesh::{NamedMesh, Transform, TriMesh, shapes};
use glam::Quat;
use proptest::prelude::*;
use std::sync::Arc;

fn translated(by: Vec3) -> Transform {
    Transform::Trs {
        translation: by,
        rotation: Quat::IDENTITY,
        scale: Vec3::ONE,
    }
}

fn placed(mesh: TriMesh, placements: Placements) -> Scene {
    let mut scene = Scene::from_mesh(mesh);
    scene.nodes[0].placements = Some(Arc::new(placements));
    scene
}

fn at(translations: Vec<Vec3>) -> Placements {
    Placements {
        translations,
        ..Placements::default()
    }
}

/// The same scene with a node for every placement.
fn spelled_out(scene: &Scene) -> Scene {
    let mut out = Scene {
        nodes: Vec::new(),
        roots: Vec::new(),
        ..scene.clone()
    };
    scene.for_each_instance(|instance| {
        out.roots.push(out.nodes.len() as u32);
        out.nodes.push(Node {
            mesh: Some(instance.mesh),
            transform: Transform::Matrix(instance.world_from_mesh.as_mat4()),
            ..Node::default()
        });
    });
    out
}

#[test]
fn a_placement_stands_between_node_and_mesh_and_not_over_children() {
    let mut scene = placed(shapes::triangle(), at(vec![Vec3::X, Vec3::Z]));
    scene.nodes[0].transform = Transform::Trs {
        translation: Vec3::Y,
        rotation: Quat::IDENTITY,
        scale: Vec3::splat(2.0),
    };
    scene.nodes[0].children = vec![1];
    scene.nodes.push(Node {
        mesh: Some(0),
        ..Node::default()
    });
    let found: Vec<_> = scene.iter_instances().collect();
    let place = |i: usize| {
        found[i]
            .world_from_mesh
            .transform_point3(DVec3::ZERO)
            .as_vec3()
    };
    assert_eq!(found.len(), 3);
    assert_eq!(
        (found[0].placement, place(0)),
        (Some(0), Vec3::new(2.0, 1.0, 0.0))
    );
    assert_eq!(
        (found[1].placement, place(1)),
        (Some(1), Vec3::new(0.0, 1.0, 2.0))
    );
    assert_eq!(
        (found[2].node, found[2].placement, place(2)),
        (1, None, Vec3::Y)
    );
    assert_eq!(scene.instance_count(), 3);
    assert_eq!(scene.unfolded(), [9, 3]);
}

#[test]
fn nothing_is_lost_below_large_translations() {
    let mut scene = Scene::from_mesh(shapes::triangle());
    scene.nodes[0].transform = translated(Vec3::new(1e9, 0.0, 0.0));
    scene.nodes[0].mesh = None;
    scene.nodes[0].children = vec![1];
    scene.nodes.push(Node {
        transform: translated(Vec3::new(0.125, 0.0, 0.0)),
        children: vec![2],
        ..Node::default()
    });
    scene.nodes.push(Node {
        transform: translated(Vec3::new(-1e9, 0.0, 0.0)),
        mesh: Some(0),
        placements: Some(Arc::new(at(vec![Vec3::new(0.25, 0.0, 0.0)]))),
        ..Node::default()
    });
    let found = scene.iter_instances().next().unwrap().world_from_mesh;
    assert_eq!(found.w_axis.x, 0.375);
}

#[test]
fn a_million_placements_cost_themselves_only() {
    let count = 1_000_000;
    let place = |i: usize| Vec3::new((i % 1000) as f32, 0.0, (i / 1000) as f32);
    let scene = placed(shapes::icosphere(3), at((0..count).map(place).collect()));
    scene.validate().unwrap();
    assert_eq!(scene.placement_memory(), 12 * count);
    let copy = scene.clone();
    assert_eq!(copy.placement_memory(), 12 * count);
    let shared = copy.nodes[0].placements.as_ref().unwrap();
    assert!(Arc::ptr_eq(
        shared,
        scene.nodes[0].placements.as_ref().unwrap()
    ));
    let bounds = scene.bounds();
    assert!(
        (bounds.min - Vec3::new(-1.0, -1.0, -1.0)).length() < 0.02,
        "{bounds:?}"
    );
    assert!((bounds.max - Vec3::new(1000.0, 1.0, 1000.0)).length() < 0.02);
    let error = scene.into_single_mesh().unwrap_err();
    let found = count * shapes::icosphere(3).positions.len();
    let limit = UNFOLDED;
    assert_eq!(
        error,
        Error::Unfolds {
            what: "vertices",
            found,
            limit
        }
    );
}

#[test]
fn deep_trees_and_cycles_end() {
    let mut scene = Scene::from_mesh(shapes::triangle());
    let depth = 100_000;
    scene.nodes = (0..depth)
        .map(|n| Node {
            mesh: (n + 1 == depth).then_some(0),
            children: if n + 1 < depth { vec![n + 1] } else { vec![] },
            transform: translated(Vec3::X),
            ..Node::default()
        })
        .collect();
    scene.validate().unwrap();
    assert_eq!(scene.bounds().min.x, depth as f32);
    let links = crate::mesh::LodLinks {
        nodes: vec![1],
        coverage: vec![],
    };
    scene.nodes[0].lods = Some(links);
    assert_eq!(
        scene.stand_ins().iter().filter(|&&s| s).count(),
        depth as usize - 1
    );
    scene.nodes[depth as usize - 1].children = vec![0];
    assert!(matches!(scene.validate(), Err(Error::BadReference { .. })));
    // Even unchecked, each node is met once.
    assert_eq!(scene.instance_count(), 1);
    scene.roots = vec![0, 0, 7, 4_000_000_000];
    assert_eq!(scene.instances().len(), 1);
}

#[test]
fn bad_placements_are_found() {
    let mut scene = placed(shapes::triangle(), at(vec![Vec3::NAN]));
    assert!(matches!(scene.validate(), Err(Error::NotFinite { .. })));
    scene.nodes[0].placements = Some(Arc::new(Placements {
        scales: Some(vec![]),
        ..at(vec![Vec3::X])
    }));
    assert!(matches!(
        scene.validate(),
        Err(Error::LengthMismatch { .. })
    ));
    scene.nodes[0].placements = Some(Arc::default());
    scene.validate().unwrap();
    assert!(scene.bounds().is_empty());
    assert!(scene.into_single_mesh().unwrap().triangles.is_empty());
}

#[test]
fn mirrored_placements_still_face_outwards() {
    let scene = placed(
        shapes::icosphere(1),
        Placements {
            scales: Some(vec![Vec3::new(-1.0, 1.0, 1.0), Vec3::new(-2.0, -1.0, -1.0)]),
            ..at(vec![Vec3::ZERO, Vec3::X * 5.0])
        },
    );
    let mesh = scene.into_single_mesh().unwrap();
    let centre = |t: usize| if t < 80 { DVec3::ZERO } else { DVec3::X * 5.0 };
    for t in 0..mesh.triangles.len() {
        let [a, b, c] = mesh.corners(t);
        let outwards = (a + b + c) / 3.0 - centre(t);
        assert!(
            crate::geom::normal_times_two_areas([a, b, c]).dot(outwards) > 0.0,
            "{t}"
        );
    }
}

fn any_placements() -> impl Strategy<Value = Placements> {
    let vector = || prop::array::uniform3(-3f32..3.0).prop_map(Vec3::from_array);
    let turn = vector().prop_map(Quat::from_scaled_axis);
    prop::collection::vec((vector(), turn, vector()), 1..9).prop_map(|all| Placements {
        translations: all.iter().map(|p| p.0).collect(),
        rotations: Some(all.iter().map(|p| p.1).collect()),
        scales: Some(all.iter().map(|p| p.2).collect()),
        attributes: Vec::new(),
    })
}

proptest! {
    /// Everything sees placements as it sees as many nodes.
    #[test]
    fn placements_are_nodes(placements in any_placements()) {
        let mut scene = placed(shapes::cube(1), placements);
        scene.nodes[0].transform = translated(Vec3::new(1.0, 2.0, -3.0));
        scene.meshes.push(NamedMesh::default());
        let nodes = spelled_out(&scene);
        prop_assert_eq!(scene.instance_count(), nodes.instance_count());
        let (a, b) = (scene.bounds(), nodes.bounds());
        prop_assert!((a.min - b.min).length() < 1e-4 && (a.max - b.max).length() < 1e-4);
        let mesh = scene.clone().into_single_mesh().unwrap();
        prop_assert_eq!(&mesh, &nodes.into_single_mesh().unwrap());
        // The box is the same as that around each vertex.
        let all = Aabb::of(mesh.positions.iter().copied());
        prop_assert!((a.min - all.min).length() < 1e-4 && (a.max - all.max).length() < 1e-4);
    }
}

#[test]
fn placements_are_drawn_as_nodes_are_and_not_without_end() {
    use crate::geom::{Camera, Light};
    use crate::render::{RenderOptions, Renderer, render};
    let turn = |i: usize| Quat::from_rotation_y(0.7 * i as f32);
    let scale = |i: usize| {
        Vec3::new(
            1.0,
            0.5 + 0.1 * i as f32,
            if i.is_multiple_of(2) { 1.0 } else { -1.0 },
        )
    };
    let place = |i: usize| Vec3::new(2.0 * i as f32, 0.3 * i as f32, -1.5 * i as f32);
    let mut scene = placed(
        shapes::torus(0.8, 0.3, 24, 12),
        Placements {
            rotations: Some((0..7).map(turn).collect()),
            scales: Some((0..7).map(scale).collect()),
            ..at((0..7).map(place).collect())
        },
    );
    let nodes = spelled_out(&scene);
    let camera = Camera::looking_at(scene.bounds(), Vec3::new(0.3, 0.5, 1.0), 0.7);
    let options = RenderOptions {
        width: 160,
        height: 120,
        ..RenderOptions::default()
    };
    let light = [Light::Directional {
        direction: Vec3::new(0.2, -1.0, -0.4),
        color: Vec3::ONE,
        intensity: 1.0,
    }];
    let draw = |scene| render(scene, &[], &camera, &light, &options).unwrap();
    let (a, b) = (draw(&scene), draw(&nodes));
    assert!(a.color == b.color && a.depth == b.depth);
    assert!(a.depth.iter().any(|d| d.is_finite()));
    // More than a picture has memory for.
    scene.nodes[0].placements = Some(Arc::new(at(vec![Vec3::ZERO; 1_000_000])));
    let error = Renderer::new(&scene, &[]).unwrap_err();
    assert!(matches!(error, Error::Unfolds { .. }), "{error}");
}
