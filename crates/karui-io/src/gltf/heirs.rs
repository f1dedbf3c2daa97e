//! What belongs to a mesh but is written on the node that shows it: morph
//! weights. Levels of detail add stand-ins, which then inherit.

use karui::Scene;
use serde_json::Value;

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
    fn stand_ins_have_the_same_weights() {
        let mut json = json!({"nodes": [{}, {}, {"weights": [0.5]}, {}]});
        hand_on_weights(&mut json, &scene(), |_| 1);
        assert_eq!(json["nodes"][3]["weights"], json!([0.5]));
        let mut json = json!({"nodes": [{}, {}, {"weights": [0.5]}, {}]});
        hand_on_weights(&mut json, &scene(), |n| n);
        assert!(json["nodes"][3].get("weights").is_none());
    }
}
