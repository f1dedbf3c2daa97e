//! `KHR_mesh_quantization`: positions on a grid of 16 bits, which the node
//! that shows the mesh scales and moves back into place.

use super::{
    encode::shorts,
    json,
    lod::{LOD, weights_target},
    primitive::triangle_mode,
};
use glam::{DMat4, DQuat, DVec3, Vec3};
use karui::{Scene, mesh::TriMesh};
use serde_json::{Value, json};

/// Name of the extension.
pub(super) const QUANTIZATION: &str = "KHR_mesh_quantization";

/// A grid of 65,536 points along each axis: position = offset + scale * point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Grid {
    offset: Vec3,
    scale: f32,
}

impl Grid {
    /// The grid that spans the mesh and the differences of its morph targets.
    /// Its cells are cubes, so that normals stay what they are.
    fn of(mesh: &TriMesh) -> Self {
        let mut low = Vec3::INFINITY;
        let mut high = Vec3::NEG_INFINITY;
        for &position in &mesh.positions {
            low = low.min(position);
            high = high.max(position);
        }
        let extent = (high - low).max_element();
        let differences = mesh
            .attributes
            .morphs
            .iter()
            .filter_map(|m| m.positions.as_ref());
        let step = differences
            .flatten()
            .fold(0.0f32, |most, d| most.max(d.abs().max_element()));
        let scale = (extent / 65535.0).max(step / 32767.0);
        let usable = scale.is_finite() && scale > f32::MIN_POSITIVE;
        Self {
            offset: if low.is_finite() { low } else { Vec3::ZERO },
            scale: if usable { scale } else { 1.0 },
        }
    }

    /// The grid point nearest to a position.
    pub fn point(self, position: Vec3) -> [u16; 3] {
        let steps = (position - self.offset) / self.scale;
        steps
            .to_array()
            .map(|s| s.round().clamp(0.0, 65535.0) as u16)
    }

    /// A difference of positions in steps of the grid.
    pub fn difference(self, difference: Vec3) -> [i16; 3] {
        let steps = difference / self.scale;
        steps
            .to_array()
            .map(|s| s.round().clamp(-32767.0, 32767.0) as i16)
    }
}

/// A grid for every mesh whose positions can be quantised. Left alone are
/// skinned meshes (their node's transform has no effect), instanced ones (the
/// instances' transforms come between node and mesh) and those with points or
/// lines, which are passed through as they are.
pub(super) fn plan(scene: &Scene, json: &Value) -> Vec<Option<Grid>> {
    let mut fits: Vec<bool> = vec![true; scene.meshes.len()];
    let skinned = (0..scene.nodes.len()).filter(|&n| scene.nodes[n].skin.is_some());
    let instanced = (0..scene.nodes.len()).filter(|&n| scene.nodes[n].placements.is_some());
    for node in skinned.chain(instanced) {
        if let Some(mesh) = scene.nodes[node].mesh {
            fits[mesh as usize] = false;
        }
    }
    let pointers = uses(json, "KHR_animation_pointer");
    let raw_meshes = json.get("meshes").and_then(Value::as_array);
    for (m, fits) in fits.iter_mut().enumerate() {
        let mesh = &scene.meshes[m].mesh;
        let raw = raw_meshes.and_then(|meshes| meshes.get(m)?.get("primitives")?.as_array());
        let other = raw.is_some_and(|p| p.iter().any(|p| triangle_mode(p).is_none()));
        let driven = pointers && !mesh.attributes.morphs.is_empty();
        *fits &= !mesh.triangles.is_empty() && !other && !driven;
    }
    let grid = |(m, fits): (usize, bool)| fits.then(|| Grid::of(&scene.meshes[m].mesh));
    fits.into_iter().enumerate().map(grid).collect()
}

/// Whether the document says that it uses an extension.
pub(super) fn uses(json: &Value, extension: &str) -> bool {
    let used = json.get("extensionsUsed").and_then(Value::as_array);
    used.is_some_and(|names| names.iter().any(|n| n == extension))
}

/// Scales and moves the nodes that show quantised meshes. A node that nothing
/// else depends on takes the transform itself, others get a child with the
/// mesh. `grid` is asked with the mesh index that the node names.
pub(super) fn place(json: &mut Value, grid: impl Fn(usize) -> Option<Grid>) {
    let fixed = fixed_nodes(json);
    let Some(nodes) = json.get_mut("nodes").and_then(Value::as_array_mut) else {
        return;
    };
    let mut moved = Vec::new();
    for (n, fixed) in fixed.into_iter().enumerate() {
        let mesh = nodes[n].get("mesh").and_then(Value::as_u64);
        let Some(grid) = mesh.and_then(|m| grid(m as usize)) else {
            continue;
        };
        if fixed {
            let index = nodes.len();
            let child = split(&mut nodes[n], index, grid);
            moved.push((n, index));
            nodes.push(child);
        } else {
            fold(&mut nodes[n], grid);
        }
    }
    retarget_weights(json, &moved);
}

/// Which nodes must keep their transform: those with children, cameras, other
/// extensions, and those that animations or skins name.
fn fixed_nodes(json: &Value) -> Vec<bool> {
    let nodes = json.get("nodes").and_then(Value::as_array);
    let stays = |node: &Value| {
        let extensions = node.get("extensions").and_then(Value::as_object);
        let others = extensions.is_some_and(|e| e.keys().any(|k| k != LOD));
        others || node.get("children").is_some() || node.get("camera").is_some()
    };
    let mut fixed: Vec<bool> = nodes.into_iter().flatten().map(stays).collect();
    let list = |key: &str| {
        json.get(key)
            .and_then(Value::as_array)
            .into_iter()
            .flatten()
    };
    let channels = list("animations").filter_map(|a| a.get("channels")?.as_array());
    let targets = channels.flatten().filter_map(|c| c.pointer("/target/node"));
    let joints = list("skins")
        .filter_map(|s| s.get("joints")?.as_array())
        .flatten();
    let skeletons = list("skins").filter_map(|s| s.get("skeleton"));
    for node in targets.chain(joints).chain(skeletons) {
        if let Some(fixed) = node.as_u64().and_then(|n| fixed.get_mut(n as usize)) {
            *fixed = true;
        }
    }
    fixed
}

/// Moves the mesh of a node into a new child, whose index is `child`.
fn split(node: &mut Value, child: usize, grid: Grid) -> Value {
    let mut new = json!({});
    for key in ["mesh", "weights"] {
        if let Some(value) = json::remove(node, key) {
            new[key] = value;
        }
    }
    new["translation"] = shorts(&grid.offset.to_array());
    new["scale"] = shorts(&[grid.scale; 3]);
    match node.get_mut("children").and_then(Value::as_array_mut) {
        Some(children) => children.push(json!(child)),
        None => node["children"] = json!([child]),
    }
    new
}

/// Multiplies the transform of a node with that of the grid.
fn fold(node: &mut Value, grid: Grid) {
    let numbers = |key: &str| -> Option<Vec<f64>> {
        node.get(key)?
            .as_array()?
            .iter()
            .map(Value::as_f64)
            .collect()
    };
    let offset = grid.offset.as_dvec3();
    let size = f64::from(grid.scale);
    if let Some(matrix) = numbers("matrix").and_then(|m| <[f64; 16]>::try_from(m).ok()) {
        let placed = DMat4::from_cols_array(&matrix)
            * DMat4::from_translation(offset)
            * DMat4::from_scale(DVec3::splat(size));
        node["matrix"] = shorts(&placed.as_mat4().to_cols_array());
        return;
    }
    let vector = |key, default| {
        let found = numbers(key).and_then(|v| <[f64; 3]>::try_from(v).ok());
        found.map_or(default, DVec3::from_array)
    };
    let rotation = numbers("rotation").and_then(|v| <[f64; 4]>::try_from(v).ok());
    let rotation = rotation.map_or(DQuat::IDENTITY, DQuat::from_array);
    let scale = vector("scale", DVec3::ONE);
    let translation = vector("translation", DVec3::ZERO) + rotation * (scale * offset);
    node["translation"] = shorts(&translation.as_vec3().to_array());
    node["scale"] = shorts(&(scale * size).as_vec3().to_array());
}

/// Points channels that drive morph weights to the nodes the meshes moved to.
fn retarget_weights(json: &mut Value, moved: &[(usize, usize)]) {
    let animations = json.get_mut("animations").and_then(Value::as_array_mut);
    for animation in animations.into_iter().flatten() {
        let channels = animation.get_mut("channels").and_then(Value::as_array_mut);
        for channel in channels.into_iter().flatten() {
            let node = weights_target(channel);
            let Ok(i) = moved.binary_search_by_key(&node, |&(from, _)| Some(from)) else {
                continue;
            };
            channel["target"]["node"] = json!(moved[i].1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid() -> Grid {
        let corners = vec![Vec3::new(-1.0, 2.0, 3.0), Vec3::new(3.0, 4.0, 3.5)];
        Grid::of(&TriMesh::new(corners, Vec::new()))
    }

    fn world(node: &Value, point: [u16; 3]) -> DVec3 {
        let numbers = |key: &str, default: &[f64]| -> Vec<f64> {
            let found = node.get(key).and_then(Value::as_array);
            found.map_or(default.to_vec(), |v| {
                v.iter().filter_map(Value::as_f64).collect()
            })
        };
        let point = DVec3::from_array(point.map(f64::from));
        let scale = DVec3::from_slice(&numbers("scale", &[1.0; 3]));
        let rotation = DQuat::from_slice(&numbers("rotation", &[0.0, 0.0, 0.0, 1.0]));
        DVec3::from_slice(&numbers("translation", &[0.0; 3])) + rotation * (scale * point)
    }

    #[test]
    fn points_come_back_within_half_a_step() {
        let grid = grid();
        for position in [Vec3::new(-1.0, 2.0, 3.0), Vec3::new(0.3, 2.7, 3.1)] {
            let point = grid.point(position);
            let mut node = json!({"mesh": 0});
            fold(&mut node, grid);
            let back = world(&node, point).as_vec3();
            assert!(back.abs_diff_eq(position, 4.0 / 65535.0 * 0.51), "{back}");
        }
    }

    #[test]
    fn folding_is_the_same_as_a_child() {
        let grid = grid();
        let raw = json!({"mesh": 0, "translation": [1.0, 2.0, 3.0], "scale": [2.0, 1.0, 0.5],
            "rotation": [0.0, 0.6, 0.0, 0.8]});
        let mut folded = raw.clone();
        fold(&mut folded, grid);
        let mut parent = raw;
        let child = split(&mut parent, 1, grid);
        assert_eq!(parent["children"], json!([1]));
        assert!(parent.get("mesh").is_none());
        let inner = world(&child, [500, 60000, 7]);
        let numbers = |key: &str| -> Vec<f64> {
            parent[key]
                .as_array()
                .unwrap()
                .iter()
                .filter_map(Value::as_f64)
                .collect()
        };
        let outer = DVec3::from_slice(&numbers("translation"))
            + DQuat::from_slice(&numbers("rotation"))
                * (DVec3::from_slice(&numbers("scale")) * inner);
        assert!(outer.abs_diff_eq(world(&folded, [500, 60000, 7]), 1e-5));
    }

    #[test]
    fn animated_nodes_get_a_child_and_keep_their_channels() {
        let mut json = json!({
            "nodes": [{"mesh": 0, "weights": [1.0]}, {"mesh": 0}],
            "animations": [{"channels": [
                {"sampler": 0, "target": {"node": 0, "path": "weights"}},
                {"sampler": 1, "target": {"node": 0, "path": "translation"}}]}]
        });
        place(&mut json, |_| Some(grid()));
        assert_eq!(json["nodes"][0], json!({"children": [2]}));
        assert_eq!(json["nodes"][2]["weights"], json!([1.0]));
        assert!(json["nodes"][1].get("scale").is_some());
        let targets = |i: usize| json["animations"][0]["channels"][i]["target"]["node"].clone();
        assert_eq!([targets(0), targets(1)], [json!(2), json!(0)]);
    }
}
