//! A scene's groups and their stand-ins, written as a tileset.

use super::{
    model::Refine,
    tree::{TileContent, TileTree, TilesOptions, TilesWritten, TreeNode},
    write::write_with_progress,
};
use crate::error::Result;
use crate::{FeatureColumn, FeatureTable, FeatureValues};
use glam::DVec3;
use karui::Progress;
use karui::hlod::proxy::{FEATURE_ID, NO_OBJECT};
use karui::hlod::tiles::Hlod;
use karui::mesh::{Attribute, AttributeValues, Scene};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// Writes the tiles of a scene with explicit tiling: what is near replaces what stands
/// for it. Every content has a property table, one row for each object in it, with the
/// number of the object and the names of its node and mesh, so that picking works in
/// stand-ins as well; what stands for several objects at once has a row of its own.
///
/// # Errors
/// As [`write`](super::write()).
pub fn write_hlod(
    folder: impl AsRef<Path>,
    hlod: &Hlod<'_>,
    options: &TilesOptions,
    progress: &dyn Progress,
) -> Result<TilesWritten> {
    let node = |tile: &karui::hlod::tiles::Tile| TreeNode {
        parent: tile.parent,
        min: tile.bounds.min,
        max: tile.bounds.max,
        error: tile.refine,
        refine: Refine::Replace,
    };
    let tree = TileTree {
        nodes: hlod.tiles().iter().map(node).collect(),
    };
    let content = |tile: u32, origin: DVec3| Ok(content(hlod, tile, origin));
    write_with_progress(folder, &tree, &content, options, progress)
}

fn content(hlod: &Hlod<'_>, tile: u32, origin: DVec3) -> Option<TileContent> {
    let mut scene = hlod.content(tile, origin)?;
    let rows = Rows::of(&scene);
    rows.number(&mut scene);
    let features = (!rows.objects.is_empty()).then(|| rows.table(hlod));
    Some(TileContent { scene, features })
}

/// The objects of one content, in order.
struct Rows {
    objects: Vec<u32>,
    row: BTreeMap<u32, u32>,
}

impl Rows {
    fn of(scene: &Scene) -> Self {
        let of_vertices = scene.meshes.iter().flat_map(|m| &m.mesh.attributes.custom);
        let of_places = scene
            .nodes
            .iter()
            .filter_map(|n| n.placements.as_ref())
            .flat_map(|p| &p.attributes);
        let ids = of_vertices.chain(of_places).filter_map(ids);
        let mut row: BTreeMap<u32, u32> = ids.flatten().map(|&id| (id, 0)).collect();
        for (i, row) in (0..).zip(row.values_mut()) {
            *row = i;
        }
        Self {
            objects: row.keys().copied().collect(),
            row,
        }
    }

    /// Replaces numbers of objects by those of rows.
    fn number(&self, scene: &mut Scene) {
        let renumber = |attribute: &mut Attribute| {
            if let (FEATURE_ID, AttributeValues::U32(ids)) =
                (attribute.name.as_str(), &mut attribute.values)
            {
                ids.iter_mut().for_each(|id| *id = self.row[id]);
            }
        };
        let meshes = scene.meshes.iter_mut();
        meshes
            .flat_map(|m| &mut m.mesh.attributes.custom)
            .for_each(renumber);
        let places = scene.nodes.iter_mut().filter_map(|n| n.placements.as_mut());
        places
            .flat_map(|p| &mut Arc::make_mut(p).attributes)
            .for_each(renumber);
    }

    fn table(&self, hlod: &Hlod<'_>) -> FeatureTable {
        let name = |of: &dyn Fn(u32) -> Option<String>| {
            let names = self.objects.iter().map(|&o| of(o).unwrap_or_default());
            FeatureValues::Text(names.collect())
        };
        let column = |name: &str, values| FeatureColumn {
            name: name.to_owned(),
            values,
        };
        let group = |object| (object == NO_OBJECT).then(|| "group".to_owned());
        FeatureTable {
            class: "object".to_owned(),
            columns: vec![
                column("object", FeatureValues::U32(self.objects.clone())),
                column("node", name(&|o| hlod.node_name(o).or_else(|| group(o)))),
                column("mesh", name(&|o| hlod.mesh_name(o))),
            ],
        }
    }
}

fn ids(attribute: &Attribute) -> Option<&Vec<u32>> {
    match &attribute.values {
        AttributeValues::U32(ids) if attribute.name == FEATURE_ID => Some(ids),
        _ => None,
    }
}
