//! A scene as a tree of tiles: from afar one stand-in for all, nearer one for every
//! group, at last the objects themselves.
//!
//! The groups are those of a [`Tree`]; a tile is a group that is worth loading on its
//! own, so it holds no fewer triangles than [`HlodOptions::triangles`] if there are as
//! many, and a child no more than half of those of its parent.

mod arrange;
mod coarse;
mod content;
mod fill;
mod objects;
mod options;

#[cfg(test)]
mod tests;

pub use options::HlodOptions;

use super::proxy::Proxy;
use super::{Bounds, Tree};
use crate::error::Result;
use crate::mesh::Scene;
use crate::progress::step;
use crate::render::Picture;
use coarse::Coarse;
use objects::Placed;

/// A scene, its groups, and what is drawn of them at which error.
#[derive(Debug, Clone)]
pub struct Hlod<'a> {
    scene: &'a Scene,
    objects: Vec<Placed>,
    tree: Tree,
    /// By mesh.
    coarse: Vec<Option<Coarse>>,
    tiles: Vec<Tile>,
}

/// What is drawn in place of the tiles below it.
#[derive(Debug, Clone)]
pub struct Tile {
    /// Index of the tile it is below; `None` for the first only. Parents come first.
    pub parent: Option<u32>,
    /// Box around its objects, world units.
    pub bounds: Bounds,
    /// Largest distance between what is drawn and the objects' surfaces, world units;
    /// never less than that of a tile below, 0 for the objects themselves.
    pub error: f64,
    /// What a client is to be told as error, world units: [`Tile::error`], but for a
    /// stand-in at least what is [`ChooseOptions::error`](super::proxy::ChooseOptions)
    /// pixels long when its group covers as many as it was looked at with. Nearer its
    /// surface may still be right, but nobody knows how it looks. Never less than that
    /// of a tile below.
    pub refine: f64,
    /// Triangles drawn.
    pub triangles: usize,
    /// What is drawn.
    pub content: TileContent,
}

/// What is drawn in a [`Tile`].
#[derive(Debug, Clone)]
pub enum TileContent {
    /// These objects as they are.
    Objects(Vec<u32>),
    /// The same objects as the tile below, each at its coarsest level.
    Coarse(Vec<u32>),
    /// A stand-in for all tiles below.
    Proxy(Box<Proxy>),
    /// Nothing: no stand-in has fewer triangles than the tiles below.
    Nothing,
}

impl<'a> Hlod<'a> {
    /// Groups the objects of a scene (each placed mesh is one; coarser stand-ins of
    /// nodes are left out), cuts the groups into tiles and makes a stand-in for each
    /// that is not made of objects. `images` are the scene's, decoded.
    ///
    /// Skins and morph targets are at rest. The result is the same for any number of
    /// threads.
    ///
    /// # Errors
    /// [`Error::Empty`](crate::Error::Empty) for a scene without triangles; those of
    /// [`Tree::build`], of [`simplify`](crate::simplify()) and of
    /// [`choose`](super::proxy::choose()); [`Error::BadOption`](crate::Error::BadOption),
    /// [`Error::Cancelled`](crate::Error::Cancelled).
    pub fn build(
        scene: &'a Scene,
        images: &[Option<Picture>],
        options: &HlodOptions<'_>,
    ) -> Result<Self> {
        options.check()?;
        step(options.progress, "objects", 0.0)?;
        let (objects, perceived) = objects::gather(scene, images)?;
        let coarse = coarse::make(scene, &objects, options)?;
        let tree = Tree::build(perceived, &options.tree_options())?;
        let mut hlod = Self {
            scene,
            objects,
            tree,
            coarse,
            tiles: Vec::new(),
        };
        hlod.tiles = arrange::arrange(&hlod, options.triangles);
        fill::fill(&mut hlod, images, options)?;
        Ok(hlod)
    }

    /// The tiles, the root first.
    #[must_use]
    pub fn tiles(&self) -> &[Tile] {
        &self.tiles
    }

    /// The groups.
    #[must_use]
    pub fn tree(&self) -> &Tree {
        &self.tree
    }

    /// Number of objects.
    #[must_use]
    pub fn object_count(&self) -> usize {
        self.objects.len()
    }

    /// Node and mesh of the scene that an object is; `None` beyond the last.
    #[must_use]
    pub fn source(&self, object: u32) -> Option<(u32, u32)> {
        let placed = self.objects.get(object as usize)?;
        Some((placed.node, placed.mesh))
    }

    /// Name of the node of an object, if it has one.
    #[must_use]
    pub fn node_name(&self, object: u32) -> Option<String> {
        let (node, _) = self.source(object)?;
        self.scene.nodes[node as usize].name.clone()
    }

    /// Name of the mesh of an object, if it has one.
    #[must_use]
    pub fn mesh_name(&self, object: u32) -> Option<String> {
        let (_, mesh) = self.source(object)?;
        self.scene.meshes[mesh as usize].name.clone()
    }

    fn triangles_of(&self, object: u32) -> usize {
        let mesh = self.objects[object as usize].mesh as usize;
        self.scene.meshes[mesh].mesh.triangles.len()
    }

    fn coarse_of(&self, object: u32) -> Option<&Coarse> {
        self.coarse[self.objects[object as usize].mesh as usize].as_ref()
    }
}
