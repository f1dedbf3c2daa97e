//! Nodes and scenes: what is as it was read stays as it is, the rest is
//! written over it.

use super::{
    encode::shorts,
    json::{self, ROOT},
    lod,
    material::set,
    node::{self, Counts, read_node},
    write_image::put,
};
use glam::{Mat4, Quat, Vec3};
use karui::{
    Scene,
    mesh::{Node, Transform},
};
use serde_json::{Value, json};

/// Brings `nodes` and `scenes` of the document in step with the scene. `mesh`
/// gives the index of a mesh in the file and its number of morph targets;
/// `None` for one that is not written.
pub(super) fn write_nodes(
    json: &mut Value,
    scene: &Scene,
    meshes: usize,
    mesh: impl Fn(u32) -> Option<(usize, usize)>,
) {
    let raw = json::remove(json, "nodes").and_then(|n| match n {
        Value::Array(nodes) => Some(nodes),
        _ => None,
    });
    let raw = raw.unwrap_or_default();
    let counts = Counts {
        nodes: raw.len(),
        meshes,
        skins: json::count(json, "skins"),
    };
    let read = |raw: &Value| read_node(raw, &counts, &ROOT).unwrap_or_default();
    let before: Vec<Node> = raw.iter().map(read).collect();
    write_roots(json, scene, &before);
    let mut raw = raw.into_iter();
    let mut written = Vec::with_capacity(scene.nodes.len());
    for (n, node) in scene.nodes.iter().enumerate() {
        let old = raw.next();
        let changed = before.get(n).is_none_or(|b| b != node);
        let mut new = old.unwrap_or_else(|| json!({}));
        if changed {
            write_node(&mut new, node, before.get(n), counts.skins);
        }
        refer_to_mesh(&mut new, node.mesh.map(&mesh));
        if new.get("children").is_some_and(|c| c == &json!([])) {
            json::remove(&mut new, "children");
        }
        written.push(new);
    }
    json["nodes"] = Value::Array(written);
}

fn write_node(raw: &mut Value, node: &Node, before: Option<&Node>, skins: usize) {
    set(raw, "name", json!(node.name), node.name.is_none());
    set(
        raw,
        "children",
        json!(node.children),
        node.children.is_empty(),
    );
    set(raw, "mesh", json!(node.mesh), node.mesh.is_none());
    let skin = node.skin.filter(|&s| (s as usize) < skins);
    set(raw, "skin", json!(skin), skin.is_none());
    if before.is_none_or(|b| b.transform != node.transform) {
        write_transform(raw, node.transform);
    }
    if before.is_none_or(|b| b.lods != node.lods) {
        lod::write(raw, node.lods.as_ref());
    }
}

/// Renumbers the mesh of a node, or removes it with what needs a mesh.
fn refer_to_mesh(raw: &mut Value, mesh: Option<Option<(usize, usize)>>) {
    match mesh {
        Some(Some((index, morphs))) => {
            raw["mesh"] = json!(index);
            if json::count(raw, "weights") != morphs {
                json::remove(raw, "weights");
            }
        }
        _ => {
            for key in ["mesh", "skin", "weights"] {
                json::remove(raw, key);
            }
        }
    }
}

/// A transform as glTF writes it: only what differs from the identity.
fn write_transform(raw: &mut Value, transform: Transform) {
    for key in ["matrix", "translation", "rotation", "scale"] {
        json::remove(raw, key);
    }
    match transform {
        Transform::Matrix(matrix) => {
            let numbers = shorts(&matrix.to_cols_array());
            set(raw, "matrix", numbers, matrix == Mat4::IDENTITY);
        }
        Transform::Trs {
            translation,
            rotation,
            scale,
        } => {
            let [t, s] = [translation, scale].map(|v| shorts(&v.to_array()));
            set(raw, "translation", t, translation == Vec3::ZERO);
            let r = shorts(&rotation.to_array());
            set(raw, "rotation", r, rotation == Quat::IDENTITY);
            set(raw, "scale", s, scale == Vec3::ONE);
        }
    }
}

/// Sets the roots of the scene shown by default if they changed.
fn write_roots(json: &mut Value, scene: &Scene, before: &[Node]) {
    if node::roots(json, before).is_ok_and(|roots| roots == scene.roots) {
        return;
    }
    let shown = node::default_scene(json).ok().flatten();
    let mut raw = shown
        .and_then(|s| json.pointer(&format!("/scenes/{s}")).cloned())
        .unwrap_or_else(|| json!({}));
    set(
        &mut raw,
        "nodes",
        json!(scene.roots),
        scene.roots.is_empty(),
    );
    put(json, "scenes", shown.unwrap_or(0), raw);
    if shown.is_none() {
        json["scene"] = json!(0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unchanged_nodes_stay_as_they_are() {
        let raw = json!([{"mesh": 0, "rotation": [0, 0, 0, 1], "camera": 1,
            "extensions": {"X": {}}}, {"matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 5,0,0,1]}]);
        let mut json = json!({"nodes": raw.clone(), "scenes": [{"nodes": [0, 1]}]});
        let counts = Counts {
            nodes: 2,
            meshes: 1,
            skins: 0,
        };
        let mut scene = Scene::default();
        let nodes = raw.as_array().unwrap().iter();
        scene.nodes = nodes
            .map(|n| read_node(n, &counts, &ROOT).unwrap())
            .collect();
        scene.roots = vec![0, 1];
        write_nodes(&mut json, &scene, 1, |m| Some((m as usize, 0)));
        assert_eq!(json["nodes"], raw);
        scene.nodes[0].name = Some("new".into());
        scene.nodes[1].transform = Transform::default();
        scene.roots = vec![1];
        write_nodes(&mut json, &scene, 1, |_| None);
        let expected = json!([{"rotation": [0, 0, 0, 1], "camera": 1, "extensions": {"X": {}},
            "name": "new"}, {}]);
        assert_eq!(json["nodes"], expected);
        assert_eq!(json["scenes"], json!([{"nodes": [1]}]));
    }
}
