//! Makes any mesh one that half-edge connectivity can describe.

mod drop;
mod orient;
mod split;

use super::{PositionIds, TriMesh};
use crate::error::{Error, Result};

/// What [`repair`] does, in this order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RepairOptions {
    /// Drop triangles with two corners at one position. Default `true`.
    pub drop_degenerate: bool,
    /// Drop other triangles whose area is exactly 0. Default `false`, because
    /// the long side of such a triangle becomes a hole without width.
    pub drop_zero_area: bool,
    /// Drop triangles with the positions of an earlier one in the same cyclic
    /// order. A triangle turned over is none: together the two are a leaf seen
    /// from both sides. Default `true`.
    pub drop_duplicates: bool,
    /// Turn triangles over so that neighbours agree, as few as possible of each
    /// part. Stored normals are left as they are. Default `false`.
    pub orient: bool,
    /// Cut the mesh open along non-manifold and inconsistent edges and apart at
    /// non-manifold vertices by duplicating vertices. Default `true`.
    pub split_non_manifold: bool,
    /// Drop vertices that no triangle uses. Default `true`.
    pub drop_unreferenced: bool,
}

impl Default for RepairOptions {
    fn default() -> Self {
        Self {
            drop_degenerate: true,
            drop_zero_area: false,
            drop_duplicates: true,
            orient: false,
            split_non_manifold: true,
            drop_unreferenced: true,
        }
    }
}

/// How much [`repair`] found to do.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct RepairCounts {
    /// Degenerate triangles dropped.
    pub degenerate: usize,
    /// Triangles of no area dropped.
    pub zero_area: usize,
    /// Duplicate triangles dropped.
    pub duplicates: usize,
    /// Triangles turned over.
    pub flipped: usize,
    /// Edges cut open: non-manifold or inconsistent.
    pub split_edges: usize,
    /// Positions whose triangles were taken apart into several fans.
    pub split_vertices: usize,
    /// Vertices added by splitting.
    pub added_vertices: usize,
    /// Unreferenced vertices dropped.
    pub unreferenced: usize,
}

/// The result of [`repair`].
#[derive(Debug, Clone, PartialEq)]
pub struct Repaired {
    /// The mesh.
    pub mesh: TriMesh,
    /// Which of its vertices belong together. Vertices split apart still lie
    /// at one position, so these ids, not [`PositionIds::of_mesh`], make it
    /// manifold: pass them on to [`Halfedge::of_mesh`](super::Halfedge::of_mesh).
    pub ids: PositionIds,
    /// What was done.
    pub counts: RepairCounts,
}

/// Repairs `mesh`. With [`RepairOptions::split_non_manifold`] and
/// [`RepairOptions::drop_degenerate`] the result always has half-edge
/// connectivity: at most two triangles at an edge, in opposite directions, and
/// one fan at a vertex (cutting as in Guéziec et al., "Cutting and Stitching",
/// 2001). Positions never move.
///
/// # Errors
/// What [`TriMesh::validate`] finds wrong; [`Error::TooLarge`].
pub fn repair(mesh: &TriMesh, options: &RepairOptions) -> Result<Repaired> {
    mesh.validate()?;
    // Splitting may give every corner a vertex of its own.
    let limit = u32::MAX as usize;
    let found = mesh
        .positions
        .len()
        .saturating_add(mesh.triangles.len().saturating_mul(3));
    if found > limit {
        let what = "vertices and corners";
        return Err(Error::TooLarge { what, found, limit });
    }
    let mut repaired = Repaired {
        mesh: mesh.clone(),
        ids: PositionIds::of_mesh(mesh),
        counts: RepairCounts::default(),
    };
    repaired.drop_triangles(options);
    if options.orient {
        repaired.orient();
    }
    if options.split_non_manifold {
        repaired.split();
    }
    if options.drop_unreferenced {
        repaired.drop_unreferenced();
    }
    Ok(repaired)
}
