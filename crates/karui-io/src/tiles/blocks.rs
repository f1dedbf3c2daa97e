//! Tiles out of the blocks of a model that does not fit into memory.

use super::{
    implicit::Cell,
    model::{Refine, Scheme},
    tree::{CellTree, TileContent, TileTree, TilesOptions, TilesWritten, TreeNode, Up},
    write::write_with_progress,
    write_implicit::write_implicit_with_progress,
};
use crate::error::{Error, ErrorKind, Result};
use glam::{DVec3, Vec3};
use karui::{
    Progress, Scene,
    mesh::Material,
    outofcore::{self, Store, TileNode, tile_mesh, tile_sample, tile_tree},
};
use rayon::prelude::*;
use std::path::Path;

/// Levels of a subtree file.
const SUBTREE_LEVELS: u32 = 6;

/// Writes the tree that a finished plan has left in a store
/// ([`karui::outofcore::TileCut`]) as a tileset in a new folder, with explicit tiling. Cells
/// with a single child are passed over: both show the same. Takes the memory of some tiles.
///
/// # Errors
/// As [`write`](super::write()); [`Blocks`](ErrorKind::Blocks) for what is wrong in the store.
pub fn write_blocks(
    folder: impl AsRef<Path>,
    store: &dyn Store,
    options: &TilesOptions,
    progress: &dyn Progress,
) -> Result<TilesWritten> {
    let nodes = branching(&tile_tree(store).map_err(failed)?.nodes);
    let node = |node: &TileNode| {
        // A point of the content to begin with: boxes are made to fit what is stored.
        let [min, max] = tile_sample(store, node).map_err(failed)?;
        Ok(TreeNode {
            parent: node.parent,
            min: min.as_dvec3(),
            max: max.as_dvec3(),
            error: node.error,
            refine: Refine::Replace,
        })
    };
    let tree = TileTree {
        nodes: nodes.par_iter().map(node).collect::<Result<_>>()?,
    };
    let content = |n: u32, origin: DVec3| content(store, &nodes[n as usize], origin);
    write_with_progress(folder, &tree, &content, options, progress)
}

/// As [`write_blocks`], with implicit tiling: a quadtree where one layer of cells holds the
/// whole, else an octree. Needs a plan with [`karui::outofcore::TileCut::aligned`].
///
/// Every level has half the error of the one above, so the root's is the least for which no
/// tile's is too small.
///
/// # Errors
/// As [`write_blocks`]; [`Geometry`](ErrorKind::Geometry) if a content leaves its cell.
pub fn write_blocks_implicit(
    folder: impl AsRef<Path>,
    store: &dyn Store,
    options: &TilesOptions,
    progress: &dyn Progress,
) -> Result<TilesWritten> {
    let tree = tile_tree(store).map_err(failed)?;
    let cells = cells(&tree, options.up);
    let content = |n: u32, origin: DVec3| content(store, &tree.nodes[n as usize], origin);
    write_implicit_with_progress(folder, &cells, &content, options, progress)
}

fn failed(error: outofcore::Error) -> Error {
    Error::file("", ErrorKind::Blocks(error))
}

/// Without nodes that have a single child.
fn branching(nodes: &[TileNode]) -> Vec<TileNode> {
    let mut children = vec![0; nodes.len()];
    let parents = nodes.iter().filter_map(|node| node.parent);
    parents.for_each(|parent| children[parent as usize] += 1);
    let mut kept: Vec<TileNode> = Vec::new();
    // Where each node went: itself, or what is above it.
    let mut place: Vec<Option<u32>> = Vec::new();
    for (node, children) in nodes.iter().zip(children) {
        let parent = node.parent.and_then(|parent| place[parent as usize]);
        if children == 1 {
            place.push(parent);
            continue;
        }
        place.push(Some(kept.len() as u32));
        kept.push(TileNode {
            parent,
            ..node.clone()
        });
    }
    kept
}

fn cells(tree: &outofcore::TileTree, up: Up) -> CellTree {
    let deepest = tree.nodes.iter().map(|n| n.depth).max().unwrap_or(0);
    let axis = match up {
        Up::Y => 1,
        Up::Z => 2,
    };
    let flat = tree.nodes.iter().all(|node| node.cell[axis] == 0);
    let halved = |depth: u32| f64::from(depth).exp2();
    let mut max = tree.min + tree.side;
    if flat {
        max[axis] = tree.min[axis] + tree.side / halved(deepest);
    }
    let scaled = |node: &TileNode| node.error * halved(node.depth);
    CellTree {
        scheme: if flat {
            Scheme::Quadtree
        } else {
            Scheme::Octree
        },
        min: tree.min,
        max,
        error: tree.nodes.iter().map(scaled).fold(0.0, f64::max),
        refine: Refine::Replace,
        cells: tree.nodes.iter().map(|node| cell(node, up)).collect(),
        subtree_levels: SUBTREE_LEVELS,
    }
}

/// Cells count northwards and upwards, which is -z and y where y is up.
fn cell(node: &TileNode, up: Up) -> Cell {
    let [x, y, z] = node.cell;
    let (north, up) = match up {
        Up::Z => (y, z),
        Up::Y => ((1 << node.depth) - 1 - z, y),
    };
    Cell {
        level: node.depth,
        x,
        y: north,
        z: up,
    }
}

fn content(store: &dyn Store, node: &TileNode, origin: DVec3) -> Result<Option<TileContent>> {
    let mut mesh = tile_mesh(store, node).map_err(failed)?;
    let local = |p: &Vec3| (p.as_dvec3() - origin).as_vec3();
    mesh.positions = mesh.positions.iter().map(local).collect();
    mesh.ranges = vec![karui::mesh::MaterialRange {
        count: mesh.triangles.len() as u32,
        material: Some(0),
        ..karui::mesh::MaterialRange::default()
    }];
    let mut scene = Scene::from_mesh(mesh);
    scene.materials = vec![Material {
        metallic: 0.0,
        roughness: 1.0,
        // One-sided: what of a held border is smaller than a pixel may turn its back in a
        // client's whole numbers, and would be seen dark.
        double_sided: false,
        ..Material::default()
    }];
    Ok(Some(TileContent {
        scene,
        features: None,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn node(parent: Option<u32>, depth: u32) -> TileNode {
        TileNode {
            parent,
            depth,
            cell: [0; 3],
            triangles: 1,
            error: 0.0,
            block: String::new(),
        }
    }

    #[test]
    fn chains_become_one_node() {
        // 0 - 1 - { 2, 3 - 4 - { 5, 6 } }
        let nodes = [
            (None, 0),
            (Some(0), 1),
            (Some(1), 2),
            (Some(1), 2),
            (Some(3), 3),
        ];
        let mut nodes: Vec<_> = nodes.into_iter().map(|(p, d)| node(p, d)).collect();
        nodes.extend([node(Some(4), 4), node(Some(4), 4)]);
        let kept = branching(&nodes);
        let found: Vec<_> = kept.iter().map(|n| (n.parent, n.depth)).collect();
        let expected = [
            (None, 1),
            (Some(0), 2),
            (Some(0), 3),
            (Some(2), 4),
            (Some(2), 4),
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn north_is_against_z_where_y_is_up() {
        let node = TileNode {
            cell: [1, 2, 3],
            ..node(None, 3)
        };
        let found = [Up::Y, Up::Z]
            .map(|up| cell(&node, up))
            .map(|c| [c.x, c.y, c.z]);
        assert_eq!(found, [[1, 4, 2], [1, 2, 3]]);
    }
}
