//! The coarsest level of every mesh.

use super::objects::Placed;
use super::options::HlodOptions;
use crate::error::Result;
use crate::geom::DMat4;
use crate::lod::simplify_measured;
use crate::mesh::{NamedMesh, Scene, TriMesh};
use crate::metrics::{Samples, Surface, SurfaceDistanceOptions, surface_distance};
use crate::progress::step;
use crate::simplify::SimplifyOptions;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Points at which a level is measured, either way.
const SAMPLES: u64 = 50_000;

/// A mesh with fewer triangles.
#[derive(Debug, Clone)]
pub(super) struct Coarse {
    pub mesh: TriMesh,
    /// Largest measured distance to the original, model units.
    pub error: f64,
}

/// Levels of the meshes that are placed; none where it would have more than half of
/// the triangles.
pub(super) fn make(
    scene: &Scene,
    objects: &[Placed],
    options: &HlodOptions<'_>,
) -> Result<Vec<Option<Coarse>>> {
    let mut is_placed = vec![false; scene.meshes.len()];
    objects
        .iter()
        .for_each(|o| is_placed[o.mesh as usize] = true);
    step(options.progress, "coarsest levels", 0.0)?;
    let given = given(scene);
    let level = |(m, named): (usize, &NamedMesh)| match given.get(&(m as u32)) {
        _ if !is_placed[m] => Ok(None),
        Some(&level) => measured(&named.mesh, &scene.meshes[level as usize].mesh),
        None => level(&named.mesh, options),
    };
    scene.meshes.par_iter().enumerate().map(level).collect()
}

/// Coarsest levels that the scene has by itself ([`Node::lods`]), by mesh.
fn given(scene: &Scene) -> BTreeMap<u32, u32> {
    let mut given = BTreeMap::new();
    for node in &scene.nodes {
        let level = node.lods.as_ref().and_then(|l| l.nodes.last());
        let level = level.and_then(|&n| scene.nodes.get(n as usize));
        let Some((mesh, level)) = node.mesh.zip(level) else {
            continue;
        };
        // Elsewhere it would have to be placed anew.
        if let Some(coarse) = level.mesh.filter(|_| level.transform == node.transform) {
            given.entry(mesh).or_insert(coarse);
        }
    }
    given.retain(|_, level| (*level as usize) < scene.meshes.len());
    given
}

fn measured(mesh: &TriMesh, level: &TriMesh) -> Result<Option<Coarse>> {
    if level.triangles.is_empty() || 2 * level.triangles.len() > mesh.triangles.len() {
        return Ok(None);
    }
    let options = SurfaceDistanceOptions {
        samples: Samples::Count(SAMPLES),
        ..SurfaceDistanceOptions::default()
    };
    let error = surface_distance(mesh, level, &options)?.max();
    Ok(error.is_finite().then(|| Coarse {
        mesh: level.clone(),
        error,
    }))
}

fn level(mesh: &TriMesh, options: &HlodOptions<'_>) -> Result<Option<Coarse>> {
    let how = SimplifyOptions {
        stop: options.coarsest,
        ..SimplifyOptions::default()
    };
    let found = simplify_measured(mesh, &Surface::new(mesh)?, &how, SAMPLES, 0)?;
    let error = found.max();
    let triangles = found.simplified.mesh.triangles.len();
    step(options.progress, "coarsest levels", 1.0)?;
    let is_coarse = triangles > 0 && 2 * triangles <= mesh.triangles.len() && error.is_finite();
    Ok(is_coarse.then_some(Coarse {
        mesh: found.simplified.mesh,
        error,
    }))
}

/// At most how much longer a length becomes.
pub(super) fn stretch(matrix: &DMat4) -> f64 {
    let columns = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|c| c.truncate());
    let [x, y, z] = columns;
    let largest = columns.map(|c| c.length()).into_iter().fold(0.0, f64::max);
    let skew = [x.dot(y), y.dot(z), z.dot(x)].map(f64::abs);
    // Gershgorin's bound on the eigenvalues of the squared lengths.
    let most = skew.into_iter().fold(0.0, f64::max);
    (largest * largest + 2.0 * most).sqrt()
}
