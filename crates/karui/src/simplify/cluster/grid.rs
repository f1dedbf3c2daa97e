//! The grid: which cell a vertex lies in.

use crate::mesh::{PositionIds, TriMesh};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Bits of a place along an axis.
const PLACE_BITS: u32 = 31;
/// Bits of the fraction of [`Grid::keys`]'s scale.
const FRACTION_BITS: u32 = 11;
/// Bits of the number of a cell along an axis.
const CELL_BITS: u32 = 20;
/// Vertices a task takes.
const CHUNK: usize = 1 << 14;
/// Marks the key of a locked vertex, which is a cell of its own.
const LOCKED: u64 = 1 << 63;

/// The scale at which the whole mesh lies in one cell.
pub(super) const COARSEST: u32 = 1 << FRACTION_BITS;
/// The scale of the finest grid, about a million cells along the longest side.
pub(super) const FINEST: u32 = 1 << (CELL_BITS + FRACTION_BITS);

/// Vertices in whole steps along the sides of a cube around the mesh, so that
/// cells of any size are found with integers, the same on every machine.
pub(super) struct Grid {
    /// Along each axis, in steps.
    places: [Vec<u32>; 3],
    /// Locked vertices with their keys.
    locked: Vec<(u32, u64)>,
    origin: DVec3,
    /// Side of the cube, model units.
    extent: f64,
}

impl Grid {
    pub fn new(mesh: &TriMesh, ids: &PositionIds, locks: Option<&[bool]>) -> Self {
        let bounds = mesh.bounds();
        let origin = bounds.min.as_dvec3();
        let extent = (bounds.max.as_dvec3() - origin).max_element().max(0.0);
        let steps = f64::from((1u32 << PLACE_BITS) - 1);
        let per_unit = if extent > 0.0 { steps / extent } else { 0.0 };
        let along = |axis: usize| {
            let place = |p: &Vec3| ((f64::from(p[axis]) - origin[axis]) * per_unit) as u32;
            mesh.positions.par_iter().map(place).collect()
        };
        Self {
            places: [0, 1, 2].map(along),
            locked: locks.map_or_else(Vec::new, |locks| locked_keys(ids, locks)),
            origin,
            extent,
        }
    }

    /// Writes the cell of every vertex on the grid of `scale / 2048` cells
    /// along the longest side. Equal keys are equal cells.
    pub fn keys(&self, scale: u32, keys: &mut Vec<u64>) {
        let [x, y, z] = &self.places;
        keys.resize(x.len(), 0);
        keys.par_chunks_mut(CHUNK)
            .zip(x.par_chunks(CHUNK))
            .zip(y.par_chunks(CHUNK).zip(z.par_chunks(CHUNK)))
            .for_each(|((keys, x), (y, z))| {
                for (((k, x), y), z) in keys.iter_mut().zip(x).zip(y).zip(z) {
                    *k = key([*x, *y, *z], scale);
                }
            });
        for &(v, key) in &self.locked {
            keys[v as usize] = key;
        }
    }

    /// Side of a cell, model units.
    pub fn cell_size(&self, scale: u32) -> f64 {
        self.extent * f64::from(COARSEST) / f64::from(scale)
    }

    /// Corners of a cell, `None` for that of a locked vertex.
    pub fn cell_box(&self, key: u64, scale: u32) -> Option<[DVec3; 2]> {
        if key & LOCKED != 0 {
            return None;
        }
        let along =
            |axis: u32| (key >> (axis * (CELL_BITS + 1)) & ((1 << (CELL_BITS + 1)) - 1)) as f64;
        let size = self.cell_size(scale);
        let min = self.origin + DVec3::new(along(0), along(1), along(2)) * size;
        Some([min, min + size])
    }

    /// Places of the corners of a triangle.
    pub fn triangle(&self, triangle: [u32; 3]) -> [[u32; 3]; 3] {
        triangle.map(|v| self.places.each_ref().map(|along| along[v as usize]))
    }
}

/// Cell of a place, its number along each axis in 21 bits.
pub(super) fn key(place: [u32; 3], scale: u32) -> u64 {
    let [x, y, z] =
        place.map(|p| (u64::from(p) * u64::from(scale)) >> (PLACE_BITS + FRACTION_BITS));
    x | y << (CELL_BITS + 1) | z << (2 * (CELL_BITS + 1))
}

/// Every vertex at a position where one is locked gets the key of the position.
fn locked_keys(ids: &PositionIds, locks: &[bool]) -> Vec<(u32, u64)> {
    let mut held = vec![false; ids.count];
    for (&id, _) in ids
        .of_vertex
        .iter()
        .zip(locks)
        .filter(|(_, locked)| **locked)
    {
        held[id as usize] = true;
    }
    (ids.of_vertex.iter().zip(0..))
        .filter(|(id, _)| held[**id as usize])
        .map(|(&id, v)| (v, LOCKED | u64::from(id)))
        .collect()
}

/// Whether all three differ.
pub(super) fn differ<T: PartialEq>([a, b, c]: &[T; 3]) -> bool {
    // Without branches: whether corners share a cell is anybody's guess.
    (a != b) & (b != c) & (c != a)
}
