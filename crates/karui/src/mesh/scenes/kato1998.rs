//! The scenes of the experiments of Kato, Kanoh and Nishihara 1998, chapter 4.
//! The paper gives numbers of trees and triangles but not where they stand.

use super::build::{Painter, add_mesh, add_root};
use super::forest::link_lod;
use super::trees::{
    BARK, TreeKind, crown, crown_lod, materials, tree_lod, tree_model, trunk, trunk_lod,
};
use crate::mesh::{Node, Scene, Transform, TriMesh, random::Random};
use glam::{Quat, Vec3};

/// Trees that are red where colours are mixed, 5 of 32.
const RED_TREES: [u32; 5] = [3, 9, 17, 22, 28];

/// Figures 9 to 11: 32 trees B of 105 triangles, 3360 in all, each with its
/// simplified form of 12; with `mixed`, 5 of them are red. They stand in eight
/// rows of four, about 8 m apart, the first row in front at z = 0, the last at
/// z = -56; seen from z = 20 or farther all are in view.
#[must_use]
pub fn kato1998_32_trees(mixed: bool) -> Scene {
    let mut scene = Scene {
        materials: materials(),
        ..Scene::default()
    };
    let kind = TreeKind::Conifer;
    let meshes = [("green", false), ("red", true)].map(|(name, red)| {
        let mesh = add_mesh(&mut scene, name, tree_model(kind, red, 1));
        let simple = format!("{name} simplified");
        [mesh, add_mesh(&mut scene, &simple, tree_lod(kind, red))]
    });
    let mut random = Random(1998);
    for i in 0..32 {
        let red = mixed && RED_TREES.contains(&i);
        let at = Vec3::new((i % 4) as f32 * 8.0 - 12.0, 0.0, (i / 4) as f32 * -8.0);
        let transform = standing(at, 2.0, &mut random);
        let meshes = meshes[usize::from(red)];
        add_pair(&mut scene, &format!("tree {i}"), meshes, transform);
    }
    scene
}

/// Figure 12, the wide scene: 24 trees A near the eye, each of two objects,
/// trunk (20 triangles) and leaves (700), and 400 trees B (105) far behind,
/// all with their simplified forms (6, 12 and 12). The eye is meant at
/// (0, 2, 20), looking along -z; trees A stand from z = 0 to -24, trees B from
/// z = -60 to -220.
#[must_use]
pub fn kato1998_wide(seed: u64) -> Scene {
    let mut scene = Scene {
        materials: materials(),
        ..Scene::default()
    };
    let mut random = Random(seed);
    let broad = TreeKind::Broad.leaves(false);
    let parts = [
        (
            "trunk",
            BARK,
            trunk as fn(&mut Painter, TreeKind),
            trunk_lod as fn(&mut Painter, TreeKind),
        ),
        ("leaves", broad, |p, kind| crown(p, kind, 1), crown_lod),
    ];
    let parts = parts.map(|(name, material, full, simple)| {
        let [full, simple] = [full, simple].map(|draw| one_colour(draw, material));
        let mesh = add_mesh(&mut scene, name, full);
        (
            name,
            [
                mesh,
                add_mesh(&mut scene, &format!("{name} simplified"), simple),
            ],
        )
    });
    for i in 0..24 {
        let at = Vec3::new((i % 8) as f32 * 7.0 - 24.5, 0.0, (i / 8) as f32 * -8.0);
        let transform = standing(at, 1.5, &mut random);
        for (name, meshes) in parts {
            add_pair(&mut scene, &format!("{name} {i}"), meshes, transform);
        }
    }
    let mesh = add_mesh(
        &mut scene,
        "tree B",
        tree_model(TreeKind::Conifer, false, 1),
    );
    let simple = tree_lod(TreeKind::Conifer, false);
    let simple = add_mesh(&mut scene, "tree B simplified", simple);
    for i in 0..400 {
        let at = Vec3::new(
            (i % 40) as f32 * 6.0 - 117.0,
            0.0,
            (i / 40) as f32 * -16.0 - 60.0,
        );
        let transform = standing(at, 2.0, &mut random);
        add_pair(
            &mut scene,
            &format!("tree B {i}"),
            [mesh, simple],
            transform,
        );
    }
    scene
}

fn one_colour(draw: fn(&mut Painter, TreeKind), material: u32) -> TriMesh {
    let mut part = Painter::default();
    draw(&mut part, TreeKind::Broad);
    part.paint(material);
    part.finish()
}

/// At most `off` metres beside `at` on each axis, turned anyhow.
fn standing(at: Vec3, off: f32, random: &mut Random) -> Transform {
    let beside = Vec3::new(random.between(-off, off), 0.0, random.between(-off, off));
    Transform::Trs {
        translation: at + beside,
        rotation: Quat::from_rotation_y(random.between(0.0, std::f32::consts::TAU)),
        scale: Vec3::ONE,
    }
}

/// A root and the simplified node that stands in for it.
fn add_pair(scene: &mut Scene, name: &str, [mesh, simple]: [u32; 2], transform: Transform) {
    let node = Node {
        name: Some(name.into()),
        mesh: Some(mesh),
        transform,
        ..Node::default()
    };
    let node = add_root(scene, node);
    link_lod(scene, node, &format!("{name} simplified"), simple);
}
