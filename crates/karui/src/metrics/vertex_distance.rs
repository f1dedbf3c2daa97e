//! Distance of every vertex, for error maps.

use crate::error::{Error, Result};
use crate::mesh::TriMesh;
use crate::spatial::{Bvh, Hit, morton};
use glam::Vec3;
use rayon::prelude::*;

/// Vertices a task takes.
const CHUNK: usize = 1024;

/// Distance of every vertex of `from`, used by a triangle or not, to the
/// surface of `to`, in model units.
///
/// # Errors
/// As [`Bvh::build`] for `to`; [`Error::NotFinite`] for a vertex of `from`.
pub fn vertex_distances(from: &TriMesh, to: &TriMesh) -> Result<Vec<f32>> {
    vertex_distances_to(&from.positions, &Bvh::build(to)?)
}

/// As [`vertex_distances`], for points and a surface that is already indexed.
///
/// # Errors
/// [`Error::NotFinite`] for a point with a NaN or infinite coordinate.
pub fn vertex_distances_to(points: &[Vec3], to: &Bvh) -> Result<Vec<f32>> {
    if let Some(index) = points.iter().position(|p| !p.is_finite()) {
        return Err(Error::NotFinite {
            what: "position".into(),
            index,
        });
    }
    let order = morton::order(points);
    let chunks: Vec<Vec<f32>> = order
        .par_chunks(CHUNK)
        .map(|chunk| chunk_distances(points, chunk, to))
        .collect();
    let mut distances = vec![0.0; points.len()];
    for (&v, distance) in order.iter().zip(chunks.into_iter().flatten()) {
        distances[v as usize] = distance;
    }
    Ok(distances)
}

fn chunk_distances(points: &[Vec3], chunk: &[u32], to: &Bvh) -> Vec<f32> {
    let mut near: Option<Hit> = None;
    let mut distance = |&v: &u32| {
        let point = points[v as usize].as_dvec3();
        let hit = match &near {
            Some(near) => to.closest_near(point, near),
            None => to.closest(point),
        };
        near = Some(hit);
        hit.distance_squared.sqrt() as f32
    };
    chunk.iter().map(&mut distance).collect()
}
