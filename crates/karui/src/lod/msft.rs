//! Chains as glTF's `MSFT_lod` says them: nodes that stand in for a node.
//!
//! A stand-in replaces a node together with everything below it, and only what
//! is said about the node itself (its animations, its use as a joint) keeps
//! its meaning. So wherever something may hang on a node, its mesh first moves
//! to a new child, and the stand-ins are for that child.

use super::{LodChain, SceneChain};
use crate::mesh::{LodLinks, NamedMesh, Node, NodeTie, Scene};

/// A scene that holds all levels of its meshes, and what it could not hold.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkedScene {
    /// The scene with meshes and nodes appended and [`Node::lods`] set.
    pub scene: Scene,
    /// Nodes that show their mesh in full detail only: those of which an
    /// extension may say something about the mesh ([`NodeTie::Mesh`]), and
    /// those with children and a mesh with morph targets, animations of which
    /// have to name the node with the mesh.
    pub left_out: Vec<u32>,
}

/// Appends all levels of `chain` to `scene` and links them by [`Node::lods`].
/// Links that are already there are replaced.
#[must_use]
pub fn to_msft_lod(scene: &Scene, chain: &SceneChain) -> LinkedScene {
    let mut linked = LinkedScene {
        scene: scene.clone(),
        left_out: Vec::new(),
    };
    let stands_in = scene.stand_ins();
    let levels = append_meshes(&mut linked.scene, chain);
    let shown = scene
        .nodes
        .iter()
        .enumerate()
        .filter(|(n, _)| !stands_in[*n]);
    for (n, node) in shown {
        let mesh = node.mesh.map(|m| m as usize);
        let of_mesh = mesh.and_then(|m| chain.chains.get(m)?.as_ref());
        let meshes = mesh.and_then(|m| levels.get(m)).filter(|l| !l.is_empty());
        if let (Some(of_mesh), Some(meshes)) = (of_mesh, meshes) {
            link(&mut linked, n, meshes, coverage(of_mesh, chain));
        }
    }
    linked
}

/// Adds a mesh a level; returns, for every former mesh, the indices of its
/// coarser levels.
fn append_meshes(scene: &mut Scene, chain: &SceneChain) -> Vec<Vec<u32>> {
    let count = scene.meshes.len();
    let mut indices = vec![Vec::new(); count];
    for (m, chain) in chain.chains.iter().enumerate().take(count) {
        for (i, level) in chain.iter().flat_map(|c| &c.levels).enumerate() {
            indices[m].push(scene.meshes.len() as u32);
            scene.meshes.push(NamedMesh {
                name: level_name(scene.meshes[m].name.as_deref(), i),
                mesh: level.mesh.clone(),
            });
        }
    }
    indices
}

fn level_name(name: Option<&str>, level: usize) -> Option<String> {
    name.map(|name| format!("{name}_lod{}", level + 1))
}

/// Least coverage of every level, the original first; the last is for any.
fn coverage(of_mesh: &LodChain, chain: &SceneChain) -> Vec<f32> {
    let share = |level: &super::LodLevel| {
        let share = chain.screen.coverage(of_mesh.radius, level.switch_distance);
        share as f32
    };
    of_mesh.levels.iter().map(share).chain([0.0]).collect()
}

fn link(linked: &mut LinkedScene, n: usize, meshes: &[u32], coverage: Vec<f32>) {
    let scene = &mut linked.scene;
    let Some(shown) = node_to_replace(scene, n) else {
        linked.left_out.push(n as u32);
        return;
    };
    let name = scene.nodes[n].name.clone();
    let original = scene.nodes[shown].clone();
    let first = scene.nodes.len() as u32;
    for (i, &mesh) in meshes.iter().enumerate() {
        scene.nodes.push(Node {
            name: level_name(name.as_deref(), i),
            mesh: Some(mesh),
            lods: None,
            tie: NodeTie::None,
            ..original.clone()
        });
    }
    scene.nodes[shown].lods = Some(LodLinks {
        nodes: (first..first + meshes.len() as u32).collect(),
        coverage,
    });
}

/// The node that stand-ins may replace: `n` itself, or a new child that takes
/// over its mesh; `None` if there can be none.
fn node_to_replace(scene: &mut Scene, n: usize) -> Option<usize> {
    let node = &scene.nodes[n];
    if node.tie == NodeTie::Mesh {
        return None;
    }
    let leaf = node.children.is_empty();
    let mesh = &scene.meshes.get(node.mesh? as usize)?.mesh;
    if !mesh.attributes.morphs.is_empty() {
        return leaf.then_some(n);
    }
    // A skinned mesh stands where its joints put it, whatever its node does.
    if leaf && (node.skin.is_some() || node.tie == NodeTie::None) {
        return Some(n);
    }
    let child = scene.nodes.len();
    let node = &mut scene.nodes[n];
    let moved = Node {
        name: node.name.as_ref().map(|name| format!("{name}_lod0")),
        mesh: node.mesh.take(),
        skin: node.skin.take(),
        placements: node.placements.take(),
        ..Node::default()
    };
    node.children.push(child as u32);
    node.lods = None;
    scene.nodes.push(moved);
    Some(child)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lod::{Levels, LodOptions, chain_scene};
    use crate::mesh::{MorphTarget, Placements, Transform, shapes};
    use glam::Vec3;
    use std::sync::Arc;

    fn node(mesh: Option<u32>, children: &[u32]) -> Node {
        Node {
            name: Some("n".into()),
            mesh,
            children: children.to_vec(),
            transform: Transform::Trs {
                translation: Vec3::X,
                rotation: glam::Quat::IDENTITY,
                scale: Vec3::splat(2.0),
            },
            ..Node::default()
        }
    }

    /// A root with a mesh and two children that share another mesh.
    fn family() -> Scene {
        let named = |mesh| NamedMesh {
            name: Some("m".into()),
            mesh,
        };
        Scene {
            meshes: vec![
                named(shapes::icosphere(3)),
                named(shapes::torus(1.0, 0.4, 24, 16)),
            ],
            nodes: vec![
                node(Some(0), &[1, 2]),
                node(Some(1), &[]),
                node(Some(1), &[]),
            ],
            roots: vec![0],
            ..Scene::default()
        }
    }

    fn linked(scene: &Scene) -> LinkedScene {
        let options = LodOptions {
            levels: Levels::Ratios(vec![0.5, 0.2]),
            samples: 1000,
            ..LodOptions::default()
        };
        let linked = to_msft_lod(scene, &chain_scene(scene, &options).unwrap());
        linked.scene.validate().unwrap();
        linked
    }

    fn linked_nodes(scene: &Scene) -> Vec<usize> {
        let nodes = scene.nodes.iter().enumerate();
        nodes
            .filter(|(_, n)| n.lods.is_some())
            .map(|(n, _)| n)
            .collect()
    }

    #[test]
    fn stand_ins_replace_nothing_but_the_mesh() {
        let before = family();
        let after = linked(&before).scene;
        // The root has children, so its mesh moved to a new child.
        assert_eq!(after.nodes[0].mesh, None);
        let moved = after.nodes[0].children[2] as usize;
        assert_eq!(linked_nodes(&after), [1, 2, moved]);
        assert_eq!(after.nodes[moved].transform, Transform::default());
        for n in linked_nodes(&after) {
            let shown = &after.nodes[n];
            let links = shown.lods.as_ref().unwrap();
            assert_eq!(links.nodes.len(), 2);
            let mut triangles = after.meshes[shown.mesh.unwrap() as usize]
                .mesh
                .triangles
                .len();
            for &l in &links.nodes {
                let stand_in = &after.nodes[l as usize];
                assert_eq!(stand_in.transform, shown.transform);
                assert!(["n_lod1", "n_lod2"].contains(&stand_in.name.as_deref().unwrap()));
                let coarser = after.meshes[stand_in.mesh.unwrap() as usize]
                    .mesh
                    .triangles
                    .len();
                assert!(coarser < triangles);
                triangles = coarser;
                let is_child = |n: &Node| n.children.contains(&l);
                assert!(!after.roots.contains(&l) && !after.nodes.iter().any(is_child));
            }
        }
        // What is drawn at the finest level is what was there before.
        let drawn = |scene: &Scene| {
            let instances = scene.instances().into_iter();
            let mut drawn: Vec<_> = instances
                .map(|(n, matrix)| (scene.nodes[n as usize].mesh, matrix.to_cols_array()))
                .collect();
            drawn.sort_by(|a, b| a.partial_cmp(b).unwrap());
            drawn
        };
        assert_eq!(drawn(&before), drawn(&after));
    }

    #[test]
    fn coverage_falls_to_zero() {
        let after = linked(&family()).scene;
        for n in linked_nodes(&after) {
            let coverage = &after.nodes[n].lods.as_ref().unwrap().coverage;
            assert_eq!(coverage.len(), 3);
            assert!(coverage.windows(2).all(|w| w[0] >= w[1]), "{coverage:?}");
            assert!(coverage[0] <= 1.0 && coverage[0] > 0.0);
            assert_eq!(coverage[2], 0.0);
        }
    }

    #[test]
    fn a_node_that_may_be_animated_keeps_what_is_said_about_it() {
        let mut scene = family();
        scene
            .nodes
            .iter_mut()
            .for_each(|node| node.tie = NodeTie::Placement);
        let after = linked(&scene).scene;
        for n in 0..3 {
            assert_eq!((after.nodes[n].mesh, &after.nodes[n].lods), (None, &None));
            assert_eq!(after.nodes[n].transform, scene.nodes[n].transform);
        }
        // A skinned mesh stays: its own node does not place it.
        scene.nodes[1].skin = Some(0);
        let after = linked(&scene).scene;
        assert!(after.nodes[1].lods.is_some());
        let stand_in = after.nodes[1].lods.as_ref().unwrap().nodes[0];
        assert_eq!(after.nodes[stand_in as usize].skin, Some(0));
    }

    #[test]
    fn a_node_with_an_extension_about_its_mesh_is_left_out() {
        let mut scene = family();
        scene.nodes[2].tie = NodeTie::Mesh;
        let after = linked(&scene);
        assert_eq!(after.left_out, [2]);
        assert_eq!(after.scene.nodes[2], scene.nodes[2]);
    }

    #[test]
    fn morphing_nodes_keep_their_mesh() {
        let mut scene = family();
        for named in &mut scene.meshes {
            let positions = vec![Vec3::Z; named.mesh.positions.len()];
            named.mesh.attributes.morphs = vec![MorphTarget {
                positions: Some(positions),
                ..MorphTarget::default()
            }];
        }
        let after = linked(&scene);
        assert_eq!(after.left_out, [0]);
        assert_eq!(linked_nodes(&after.scene), [1, 2]);
        assert_eq!(after.scene.nodes[0], scene.nodes[0]);
    }

    #[test]
    fn linking_twice_replaces_the_links() {
        let once = linked(&family()).scene;
        let twice = linked(&once).scene;
        assert_eq!(linked_nodes(&once).len(), 3);
        assert_eq!(twice.instances().len(), once.instances().len());
        let shown = |scene: &Scene| scene.nodes.iter().filter(|n| n.lods.is_some()).count();
        assert_eq!(shown(&twice), 3);
    }

    #[test]
    fn levels_are_those_of_the_most_stretched_placement() {
        let placements = Placements {
            scales: Some(vec![Vec3::ONE, Vec3::new(1.0, 3.0, 2.0)]),
            translations: vec![Vec3::ZERO, Vec3::X],
            ..Placements::default()
        };
        let mut scene = Scene::from_mesh(shapes::icosphere(4));
        scene.nodes[0].placements = Some(Arc::new(placements));
        let options = LodOptions {
            levels: Levels::Ratios(vec![0.2]),
            samples: 2000,
            ..LodOptions::default()
        };
        let chain = chain_scene(&scene, &options).unwrap();
        let of_mesh = chain.chains[0].as_ref().unwrap();
        assert_eq!((of_mesh.scale, of_mesh.instances), (3.0, 2));
        let linked = to_msft_lod(&scene, &chain);
        assert!(linked.left_out.is_empty());
        let stand_in = linked.scene.nodes[0].lods.as_ref().unwrap().nodes[0] as usize;
        let stand_in = &linked.scene.nodes[stand_in].placements;
        assert_eq!(stand_in, &scene.nodes[0].placements);
        // Where the mesh moves to a child, its placements move with it.
        let mut parent = scene.clone();
        parent.nodes[0].children = vec![1];
        parent.nodes.push(Node::default());
        let linked = to_msft_lod(&parent, &chain).scene;
        assert_eq!(linked.nodes[0].placements, None);
        assert_eq!(
            linked.instances(),
            parent
                .instances()
                .iter()
                .map(|i| (2, i.1))
                .collect::<Vec<_>>()
        );
    }
}
