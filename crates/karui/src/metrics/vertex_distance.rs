//! Distance of every vertex, for error maps.

use crate::error::{Error, Result};
use crate::mesh::TriMesh;
use crate::progress::{Progress, Silent, step};
use crate::spatial::{Bvh, Hit, morton};
use glam::Vec3;
use rayon::prelude::*;

/// Vertices a task takes.
const CHUNK: usize = 1024;

/// Chunks between two looks at whether to go on.
const BATCH: usize = 64;

/// Distance of every vertex of `from`, used by a triangle or not, to the
/// surface of `to`, in model units.
///
/// # Errors
/// As [`Bvh::build`] for `to`; [`Error::NotFinite`] for a vertex of `from`.
pub fn vertex_distances(from: &TriMesh, to: &TriMesh) -> Result<Vec<f32>> {
    vertex_distances_to(&from.positions, &Bvh::build(to)?)
}

/// As [`vertex_distances`], with an observer.
///
/// # Errors
/// Those of [`vertex_distances`]; [`Error::Cancelled`].
pub fn vertex_distances_observed(
    from: &TriMesh,
    to: &TriMesh,
    progress: &dyn Progress,
) -> Result<Vec<f32>> {
    step(progress, "distances", 0.0)?;
    distances(&from.positions, &Bvh::build(to)?, progress)
}

/// As [`vertex_distances`], for points and a surface that is already indexed.
///
/// # Errors
/// [`Error::NotFinite`] for a point with a NaN or infinite coordinate.
pub fn vertex_distances_to(points: &[Vec3], to: &Bvh) -> Result<Vec<f32>> {
    distances(points, to, &Silent)
}

fn distances(points: &[Vec3], to: &Bvh, progress: &dyn Progress) -> Result<Vec<f32>> {
    if let Some(index) = points.iter().position(|p| !p.is_finite()) {
        return Err(Error::NotFinite {
            what: "position".into(),
            index,
        });
    }
    let order = morton::order(points);
    let mut distances = vec![0.0; points.len()];
    let mut done = 0;
    for batch in order.chunks(BATCH * CHUNK) {
        step(progress, "distances", done as f32 / order.len() as f32)?;
        let chunks: Vec<Vec<f32>> = batch
            .par_chunks(CHUNK)
            .map(|chunk| chunk_distances(points, chunk, to))
            .collect();
        for (&v, distance) in batch.iter().zip(chunks.into_iter().flatten()) {
            distances[v as usize] = distance;
        }
        done += batch.len();
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes;
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// Stops at the third report.
    #[derive(Default)]
    struct Impatient(AtomicUsize);

    impl Progress for Impatient {
        fn report(&self, _: &'static str, fraction: f32) {
            assert!((0.0..=1.0).contains(&fraction));
            self.0.fetch_add(1, Ordering::Relaxed);
        }

        fn cancelled(&self) -> bool {
            self.0.load(Ordering::Relaxed) > 2
        }
    }

    #[test]
    fn observed_distances_are_the_same_and_can_be_stopped() {
        let (fine, coarse) = (shapes::icosphere(7), shapes::icosphere(2));
        assert!(fine.positions.len() > 2 * BATCH * CHUNK);
        let known = vertex_distances(&fine, &coarse);
        assert_eq!(vertex_distances_observed(&fine, &coarse, &Silent), known);
        let observer = Impatient::default();
        let stopped = vertex_distances_observed(&fine, &coarse, &observer);
        assert_eq!(stopped, Err(Error::Cancelled));
        assert_eq!(observer.0.load(Ordering::Relaxed), 3);
    }
}
