//! The finished tree of tiles.

use super::super::block::{Block, Part};
use super::super::manifest::{Kind, Manifest};
use super::super::next::manifests;
use super::super::write::whole;
use super::super::{Error, Result, Store};
use super::cell::Cell;
use super::gather::mesh;
use crate::mesh::TriMesh;
use glam::{DVec3, Vec3};
use std::collections::BTreeMap;

/// A tree of tiles whose meshes are in a store.
#[derive(Debug, Clone, PartialEq)]
pub struct TileTree {
    /// The nodes, root first, parents before their children.
    pub nodes: Vec<TileNode>,
    /// Least corner of the root's cube, model units.
    pub min: DVec3,
    /// Side of the root's cube, model units.
    pub side: f64,
}

/// A node of a tree of tiles: a cell and its mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct TileNode {
    /// Index of its parent, below its own; none for the root.
    pub parent: Option<u32>,
    /// Times that the root's cube is halved to its own.
    pub depth: u32,
    /// Its place among cells of its depth along x, y and z.
    pub cell: [u32; 3],
    /// Triangles of its mesh.
    pub triangles: u64,
    /// How far its mesh is from the input: a sum of distances measured from each level to
    /// the next, 0 for a leaf, never below a child's; model units.
    pub error: f64,
    /// Name of the block that holds its mesh.
    pub block: String,
}

/// The tree that a finished plan with [`super::TileCut`] has left in its store.
///
/// # Errors
/// [`Error::Missing`] if it is not finished; [`Error::Damaged`], those of the store.
pub fn tile_tree(store: &dyn Store) -> Result<TileTree> {
    let kept = kept(store)?;
    let made = made(store, &kept)?;
    let keys = kept.iter().find_map(|manifest| manifest.phase.keys);
    let (Some(keys), true) = (keys, made.contains_key(&Cell::ROOT)) else {
        let name = "the mesh of the whole".into();
        return Err(Error::Missing { name });
    };
    let mut nodes: Vec<TileNode> = Vec::with_capacity(made.len());
    let mut number = BTreeMap::new();
    for (&cell, block) in &made {
        let parent = (cell.depth > 0).then(|| number.get(&cell.parent()).copied());
        let head = Block::open(store, block)?.head;
        number.insert(cell, nodes.len() as u32);
        nodes.push(TileNode {
            parent: parent.flatten(),
            depth: cell.depth,
            cell: cell.place(),
            triangles: head.triangles,
            error: head.error,
            block: block.clone(),
        });
    }
    let (min, side) = keys.root();
    Ok(TileTree { nodes, min, side })
}

/// Phases that make meshes of the tree.
pub(super) fn kept(store: &dyn Store) -> Result<Vec<Manifest>> {
    let mut all = manifests(store)?;
    all.retain(|m| matches!(m.phase.kind, Kind::Leaves | Kind::Parents));
    Ok(all)
}

/// Cells of closed phases that are not empty, the largest first, and their blocks.
pub(super) fn made(store: &dyn Store, kept: &[Manifest]) -> Result<BTreeMap<Cell, String>> {
    let mut made = BTreeMap::new();
    for manifest in kept {
        let results = manifest.results(store)?.unwrap_or_default();
        for (row, result) in manifest.rows.iter().zip(results) {
            if result.triangles > 0 {
                made.insert(Cell::of(row), result.output);
            }
        }
    }
    Ok(made)
}

/// The mesh of a node, each vertex once.
///
/// # Errors
/// [`Error::Damaged`], those of the store.
pub fn tile_mesh(store: &dyn Store, node: &TileNode) -> Result<TriMesh> {
    Ok(mesh(whole(store, &node.block)?.0))
}

/// The corners of the box around some thousand triangles of a node.
///
/// # Errors
/// [`Error::Damaged`], those of the store.
pub fn tile_sample(store: &dyn Store, node: &TileNode) -> Result<[Vec3; 2]> {
    let block = Block::open(store, &node.block)?;
    let corners = |part: Part| part.positions;
    let positions = block.pages(0..1)?.into_iter().flat_map(corners);
    let both = [Vec3::INFINITY, Vec3::NEG_INFINITY];
    Ok(positions.fold(both, |[min, max], p| [min.min(p), max.max(p)]))
}
