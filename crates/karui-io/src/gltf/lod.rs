//! `MSFT_lod`: nodes that stand in for others at a distance.

use super::{
    encode::shorts,
    json::{self, At},
};
use crate::error::Result;
use karui::mesh::LodLinks;
use serde_json::{Value, json};

/// Name of the extension.
pub(super) const LOD: &str = "MSFT_lod";
const COVERAGE: &str = "MSFT_screencoverage";

/// Reads the links of a node; `nodes` is the number of nodes of the file.
pub(super) fn read(node: &Value, nodes: usize, at: &At<'_>) -> Result<Option<LodLinks>> {
    let Some(extension) = json::extension(node, LOD) else {
        return Ok(None);
    };
    let at_extensions = at.key("extensions");
    let ids = json::indices(extension, "ids", nodes, "node", &at_extensions.key(LOD))?;
    let none = Value::Null;
    let extras = node.get("extras").unwrap_or(&none);
    // Extras may hold anything; only numbers are ours.
    let coverage = extras.get(COVERAGE).and_then(Value::as_array);
    let coverage = coverage.map_or(&[][..], Vec::as_slice).iter();
    let coverage = coverage.filter_map(Value::as_f64).map(|c| c as f32);
    Ok(Some(LodLinks {
        nodes: ids,
        coverage: coverage.collect(),
    }))
}

/// Sets or removes the links of a node.
pub(super) fn write(node: &mut Value, lods: Option<&LodLinks>) {
    json::remove_extension(node, LOD);
    if let Some(extras) = node.get_mut("extras") {
        json::remove(extras, COVERAGE);
        if extras.as_object().is_some_and(serde_json::Map::is_empty) {
            json::remove(node, "extras");
        }
    }
    let Some(lods) = lods.filter(|l| !l.nodes.is_empty()) else {
        return;
    };
    json::set_extension(node, LOD, json!({ "ids": lods.nodes }));
    if !lods.coverage.is_empty() {
        if !node["extras"].is_object() {
            node["extras"] = json!({});
        }
        node["extras"][COVERAGE] = shorts(&lods.coverage);
    }
}

/// Lets the stand-ins of a morphing node morph with it: every channel that
/// drives its weights is repeated for each of them, on the same sampler.
/// `morphs` tells whether a node's mesh has morph targets, `lods` lists the
/// stand-ins of a node.
pub(super) fn share_weight_channels(
    animation: &mut Value,
    morphs: impl Fn(usize) -> bool,
    lods: impl Fn(usize) -> Vec<u32>,
) {
    let Some(channels) = animation.get_mut("channels").and_then(Value::as_array_mut) else {
        return;
    };
    let driven: Vec<usize> = channels.iter().filter_map(weights_target).collect();
    let mut added = Vec::new();
    for channel in channels.iter() {
        let Some(node) = weights_target(channel) else {
            continue;
        };
        for lod in lods(node) {
            if morphs(lod as usize) && !driven.contains(&(lod as usize)) {
                let mut copy = channel.clone();
                copy["target"]["node"] = json!(lod);
                added.push(copy);
            }
        }
    }
    channels.extend(added);
}

/// The node whose morph weights a channel drives.
pub(super) fn weights_target(channel: &Value) -> Option<usize> {
    let target = channel.get("target")?;
    let is_weights = target.get("path")?.as_str()? == "weights";
    is_weights.then(|| target.get("node")?.as_u64().map(|n| n as usize))?
}

#[cfg(test)]
mod tests {
    use super::*;
    use json::ROOT;

    #[test]
    fn links_round_trip_beside_other_extras() {
        let mut node = json!({"extras": {"mine": 1}});
        let lods = LodLinks {
            nodes: vec![2, 1],
            coverage: vec![0.5, 0.25, 0.0],
        };
        write(&mut node, Some(&lods));
        assert_eq!(read(&node, 3, &ROOT).unwrap(), Some(lods));
        assert!(read(&node, 2, &ROOT).is_err());
        write(&mut node, None);
        assert_eq!(node, json!({"extras": {"mine": 1}}));
    }

    #[test]
    fn weight_channels_are_repeated_once() {
        let channel =
            |node: u32, path: &str| json!({"sampler": 7, "target": {"node": node, "path": path}});
        let mut animation = json!({"channels": [
            channel(0, "weights"), channel(0, "rotation"), channel(3, "weights")
        ]});
        let lods = |node| if node == 0 { vec![1, 2, 3] } else { vec![] };
        share_weight_channels(&mut animation, |node| node != 2, lods);
        let expected = json!([
            channel(0, "weights"),
            channel(0, "rotation"),
            channel(3, "weights"),
            channel(1, "weights")
        ]);
        assert_eq!(animation["channels"], expected);
    }
}
