//! Which nodes the parts of a file that Karui does not model speak of.

use super::instancing::{FEATURES, INSTANCING};
use karui::mesh::{Node, NodeTie};
use serde_json::Value;

/// Extensions of nodes that Karui models.
const MODELLED: [&str; 3] = ["MSFT_lod", INSTANCING, FEATURES];
/// Extensions of nodes that are not about the mesh.
const PLACED: [&str; 1] = ["KHR_lights_punctual"];

/// Sets [`Node::tie`] of all nodes.
pub(super) fn mark(json: &Value, nodes: &mut [Node]) {
    for n in moved(json) {
        if let Some(node) = nodes.get_mut(n) {
            node.tie = NodeTie::Placement;
        }
    }
    for (node, raw) in nodes.iter_mut().zip(list(json, "nodes")) {
        if raw.get("camera").is_some() {
            node.tie = NodeTie::Placement;
        }
        let extensions = raw.get("extensions").and_then(Value::as_object);
        let names = extensions.into_iter().flat_map(|e| e.keys());
        for name in names.filter(|name| !MODELLED.contains(&name.as_str())) {
            let placed = PLACED.contains(&name.as_str()) && node.tie != NodeTie::Mesh;
            node.tie = if placed {
                NodeTie::Placement
            } else {
                NodeTie::Mesh
            };
        }
    }
}

/// Nodes that animations move and joints of skins.
fn moved(json: &Value) -> Vec<usize> {
    let channels = list(json, "animations").flat_map(|a| list(a, "channels"));
    let animated = channels.filter_map(|c| animated(c.get("target")?));
    let joints = list(json, "skins").flat_map(|s| list(s, "joints"));
    animated.chain(joints.filter_map(index)).collect()
}

/// The node of an animation's target, which `KHR_animation_pointer` may name.
fn animated(target: &Value) -> Option<usize> {
    if let Some(node) = target.get("node") {
        return index(node);
    }
    let pointer = target.pointer("/extensions/KHR_animation_pointer/pointer")?;
    let node = pointer.as_str()?.strip_prefix("/nodes/")?;
    node.split('/').next()?.parse().ok()
}

fn index(value: &Value) -> Option<usize> {
    usize::try_from(value.as_u64()?).ok()
}

fn list<'a>(value: &'a Value, key: &str) -> impl Iterator<Item = &'a Value> {
    value
        .get(key)
        .and_then(Value::as_array)
        .into_iter()
        .flatten()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn animations_skins_cameras_and_extensions_tie() {
        let pointer = json!({ "KHR_animation_pointer": { "pointer": "/nodes/2/scale" } });
        let json = json!({
            "nodes": [
                {},
                {},
                {},
                {},
                { "camera": 0 },
                { "extensions": { "KHR_lights_punctual": {} } },
                { "extensions": { "X_of_mesh": {}, "KHR_lights_punctual": {} } },
                { "extensions": { "MSFT_lod": {}, "EXT_mesh_gpu_instancing": {} } },
            ],
            "animations": [
                { "channels": [{ "target": { "node": 1 } }, { "target": { "node": 99 } }] },
                { "channels": [{ "target": { "extensions": pointer } }, {}] },
            ],
            "skins": [{ "joints": [3, "x"] }],
        });
        let mut nodes = vec![Node::default(); 8];
        mark(&json, &mut nodes);
        let ties: Vec<NodeTie> = nodes.iter().map(|n| n.tie).collect();
        use NodeTie::{Mesh, None, Placement};
        let expected = [
            None, Placement, Placement, Placement, Placement, Placement, Mesh, None,
        ];
        assert_eq!(ties, expected);
    }
}
