//! The contents of tiles, one after another and several at a time.

use super::{
    content::Z_UP_FROM_Y_UP,
    extent::Extent,
    publish::Draft,
    tree::{TileContent, TileContents, TilesOptions, Up},
};
use crate::{
    error::{Error, Result},
    glb_bytes,
    gltf::Inspected,
};
use glam::{DVec3, Mat4};
use karui::{
    Progress, Scene,
    mesh::{Node, Transform},
    progress,
};
use rayon::prelude::*;
use std::sync::Arc;

/// Contents made between two looks at the observer.
const BATCH: usize = 128;

/// A content that was written.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stored {
    /// Around all of it, relative to its origin, z up.
    pub extent: Extent,
    pub bytes: u64,
}

/// A content to be written.
pub(super) struct Order {
    pub node: u32,
    /// Where its frame begins, in the frame of the input.
    pub origin: DVec3,
    /// Its file.
    pub name: String,
}

/// Writes all contents; `None` for tiles without.
pub(super) fn write_contents(
    draft: &Draft,
    orders: &[Order],
    contents: &dyn TileContents,
    options: &TilesOptions,
    progress: &dyn Progress,
) -> Result<Vec<Option<Stored>>> {
    let mut stored = Vec::with_capacity(orders.len());
    for batch in orders.chunks(BATCH) {
        let done = stored.len() as f32 / orders.len().max(1) as f32;
        progress::step(progress, "contents", done).map_err(|e| Error::file("", e.into()))?;
        let one = |order: &Order| match contents.content(order.node, order.origin)? {
            Some(content) => store(draft, &order.name, content, options),
            None => Ok(None),
        };
        let batch: Vec<Result<Option<Stored>>> = batch.par_iter().map(one).collect();
        for result in batch {
            stored.push(result?);
        }
    }
    Ok(stored)
}

/// Writes one content. One without anything to draw is none.
fn store(
    draft: &Draft,
    name: &str,
    content: TileContent,
    options: &TilesOptions,
) -> Result<Option<Stored>> {
    let mut scene = content.scene;
    if options.up == Up::Z {
        y_up(&mut scene);
    }
    let gltf = Inspected { scene };
    let extent = extent_of(&gltf);
    if extent.is_empty() {
        return Ok(None);
    }
    // Quantised positions move by up to half a step of 16 bits.
    let size = (extent.max - extent.min).max_element();
    let moved = if options.gltf.quantize {
        size / 65535.0
    } else {
        0.0
    };
    let mut write = options.gltf.clone();
    if let Some(features) = content.features {
        write.features = Some(Arc::new(features));
    }
    let glb = glb_bytes(&gltf.scene, &write).map_err(|e| e.in_file(name))?;
    Ok(Some(Stored {
        extent: extent.grown(moved),
        bytes: draft.write(name, &glb)?,
    }))
}

/// Around all that is drawn, z up.
fn extent_of(gltf: &Inspected) -> Extent {
    let meshes: Vec<Vec<DVec3>> = (0..gltf.scene.meshes.len())
        .map(|m| gltf.points(m))
        .collect();
    let mut extent = Extent::EMPTY;
    for placed in gltf.placed() {
        let matrix = Z_UP_FROM_Y_UP * placed.world_from_mesh;
        for p in meshes.get(placed.mesh as usize).into_iter().flatten() {
            extent = extent.with(matrix.transform_point3(*p));
        }
    }
    extent
}

/// Turns a scene with z up so that y is up, as glTF has it.
fn y_up(scene: &mut Scene) {
    let matrix = Mat4::from_cols_array(&[
        1.0, 0.0, 0.0, 0.0, //
        0.0, 0.0, -1.0, 0.0, //
        0.0, 1.0, 0.0, 0.0, //
        0.0, 0.0, 0.0, 1.0,
    ]);
    let root = scene.nodes.len() as u32;
    scene.nodes.push(Node {
        transform: Transform::Matrix(matrix),
        children: std::mem::take(&mut scene.roots),
        ..Node::default()
    });
    scene.roots.push(root);
}
