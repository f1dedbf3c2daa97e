//! What belongs to a mesh but is written on the node that shows it: instances
//! and morph weights. Levels of detail may have moved the mesh to a new child
//! and added stand-ins; these then inherit.

use super::json;
use karui::Scene;
use serde_json::Value;

/// Extensions of a node that say how its mesh is repeated.
const INSTANCING: [&str; 2] = ["EXT_mesh_gpu_instancing", "EXT_instance_features"];

/// For every node of the file `json` with instances: its index, and the nodes
/// that show its mesh or a level of it now.
pub(super) fn instanced(scene: &Scene, json: &Value) -> Vec<(usize, Vec<usize>)> {
    let raw = json.get("nodes").and_then(Value::as_array);
    let raw = raw.map_or(&[][..], Vec::as_slice);
    let heirs = |(n, node): (usize, &Value)| {
        json::extension(node, INSTANCING[0])?;
        let shown = shown_by(scene, n, node, raw.len())?;
        let lods = scene.nodes[shown].lods.iter().flat_map(|l| &l.nodes);
        let lods = lods.map(|&l| l as usize).filter(|&l| l >= raw.len());
        Some((n, std::iter::once(shown).chain(lods).collect()))
    };
    raw.iter().enumerate().filter_map(heirs).collect()
}

/// The node that shows what node `n` of the file showed: itself or a child
/// that is new (there were `count` nodes) and has its mesh.
fn shown_by(scene: &Scene, n: usize, raw: &Value, count: usize) -> Option<usize> {
    let node = scene.nodes.get(n)?;
    if node.mesh.is_some() {
        return Some(n);
    }
    let mesh = raw.get("mesh")?.as_u64()?;
    let mut children = node.children.iter().map(|&c| c as usize);
    children.find(|&c| c >= count && scene.nodes[c].mesh.map(u64::from) == Some(mesh))
}

/// Hands instances on to the nodes that [`instanced`] found.
pub(super) fn hand_on_instances(json: &mut Value, instanced: &[(usize, Vec<usize>)]) {
    let Some(nodes) = json.get_mut("nodes").and_then(Value::as_array_mut) else {
        return;
    };
    for (n, heirs) in instanced {
        for name in INSTANCING {
            let Some(extension) = json::extension(&nodes[*n], name).cloned() else {
                continue;
            };
            if !heirs.contains(n) {
                json::remove_extension(&mut nodes[*n], name);
            }
            for &heir in heirs {
                json::set_extension(&mut nodes[heir], name, extension.clone());
            }
        }
    }
}

/// Gives stand-ins the morph weights of the node they stand in for. `morphs`
/// tells the number of morph targets of a node's mesh.
pub(super) fn hand_on_weights(json: &mut Value, scene: &Scene, morphs: impl Fn(usize) -> usize) {
    let Some(nodes) = json.get_mut("nodes").and_then(Value::as_array_mut) else {
        return;
    };
    for (n, node) in scene.nodes.iter().enumerate() {
        let Some(weights) = nodes[n].get("weights").cloned() else {
            continue;
        };
        for &lod in node.lods.iter().flat_map(|l| &l.nodes) {
            let lod = lod as usize;
            if nodes[lod].get("weights").is_none() && morphs(lod) == morphs(n) {
                nodes[lod]["weights"] = weights.clone();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use karui::mesh::{LodLinks, Node};
    use serde_json::json;

    fn scene() -> Scene {
        let node = |mesh, children: &[u32], lods: &[u32]| Node {
            mesh,
            children: children.to_vec(),
            lods: (!lods.is_empty()).then(|| LodLinks {
                nodes: lods.to_vec(),
                coverage: Vec::new(),
            }),
            ..Node::default()
        };
        // Node 0 of two was given a child 2 with its mesh and a stand-in 3.
        let nodes = vec![
            node(None, &[1, 2], &[]),
            node(Some(0), &[], &[]),
            node(Some(0), &[], &[3]),
            node(Some(1), &[], &[]),
        ];
        Scene {
            nodes,
            ..Scene::default()
        }
    }

    #[test]
    fn instances_follow_the_mesh() {
        let extensions = json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 4}},
            "OTHER": {}});
        let before = json!({"nodes": [{"mesh": 0, "extensions": extensions}, {"mesh": 0}]});
        let found = instanced(&scene(), &before);
        assert_eq!(found, [(0, vec![2, 3])]);
        let mut after = json!({"nodes": [before["nodes"][0], {}, {}, {}]});
        hand_on_instances(&mut after, &found);
        assert_eq!(after["nodes"][0]["extensions"], json!({"OTHER": {}}));
        for heir in [2, 3] {
            let heir = &after["nodes"][heir]["extensions"]["EXT_mesh_gpu_instancing"];
            assert_eq!(heir["attributes"]["TRANSLATION"], 4);
        }
        assert!(after["nodes"][1].get("extensions").is_none());
    }

    #[test]
    fn stand_ins_have_the_same_weights() {
        let mut json = json!({"nodes": [{}, {}, {"weights": [0.5]}, {}]});
        hand_on_weights(&mut json, &scene(), |_| 1);
        assert_eq!(json["nodes"][3]["weights"], json!([0.5]));
        let mut json = json!({"nodes": [{}, {}, {"weights": [0.5]}, {}]});
        hand_on_weights(&mut json, &scene(), |n| n);
        assert!(json["nodes"][3].get("weights").is_none());
    }
}
