//! Removal of parts that are too small to be seen.

use super::in_range;
use crate::error::Result;
use crate::geom::Aabb;
use crate::mesh::{Components, PositionIds, TriMesh};

/// Options of [`prune`]; the smaller bound holds if both are set.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PruneOptions {
    /// Size up to which parts go, model units.
    pub error: Option<f64>,
    /// Size up to which parts go, as a share of the diagonal of the mesh's
    /// bounding box.
    pub relative_error: Option<f64>,
}

impl PruneOptions {
    /// Parts up to this size, model units.
    #[must_use]
    pub fn error(error: f64) -> Self {
        Self {
            error: Some(error),
            ..Self::default()
        }
    }

    /// Parts up to this share of the diagonal.
    #[must_use]
    pub fn relative_error(error: f64) -> Self {
        Self {
            relative_error: Some(error),
            ..Self::default()
        }
    }

    fn bound(&self, mesh: &TriMesh) -> Option<f64> {
        let relative = self.relative_error.map(|e| e * mesh.bounds().diagonal());
        let bounds = [self.error, relative].into_iter().flatten();
        bounds.reduce(f64::min)
    }
}

/// A mesh without its small parts, and what they were.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Pruned {
    /// The mesh that is left, without vertices that no triangle uses.
    pub mesh: TriMesh,
    /// For every vertex left, its index in the input.
    pub vertices: Vec<u32>,
    /// Parts removed.
    pub components: usize,
    /// Triangles removed.
    pub triangles: usize,
    /// Size of the largest part removed, model units: the error that their
    /// absence is.
    pub error: f64,
}

/// Removes the connected parts of `mesh` whose bounding boxes have a diagonal
/// of at most the bound. Parts are linked by positions, so that seams do not
/// separate. The largest part always stays. Takes time linear in the triangles.
///
/// # Errors
/// What [`TriMesh::validate`] finds; [`Error::BadOption`](crate::Error::BadOption)
/// for a bound below 0.
///
/// # Examples
/// ```
/// use karui::{mesh::shapes, simplify::{PruneOptions, prune}};
///
/// // Cubes with sides of 1 and 0.5.
/// let pruned = prune(&shapes::touching_parts(), &PruneOptions::error(0.9))?;
/// assert_eq!((pruned.components, pruned.mesh.triangles.len()), (1, 12));
/// # Ok::<(), karui::Error>(())
/// ```
pub fn prune(mesh: &TriMesh, options: &PruneOptions) -> Result<Pruned> {
    mesh.validate()?;
    for (name, bound) in [
        ("prune.error", options.error),
        ("prune.relative_error", options.relative_error),
    ] {
        in_range(name, bound, 0.0..=f64::MAX, "0 or more")?;
    }
    let parts = Components::of(mesh, &PositionIds::of_mesh(mesh))?;
    let sizes = sizes(mesh, &parts);
    let bound = options.bound(mesh).unwrap_or(f64::NEG_INFINITY);
    let largest = largest(&sizes);
    let goes = |part: usize| sizes[part] <= bound && Some(part) != largest;
    let gone = (0..parts.count).filter(|&part| goes(part));
    let mut pruned = Pruned {
        components: gone.clone().count(),
        error: gone.map(|part| sizes[part]).fold(0.0, f64::max),
        mesh: mesh.clone(),
        ..Pruned::default()
    };
    if pruned.components == 0 {
        pruned.vertices = (0..mesh.positions.len() as u32).collect();
        return Ok(pruned);
    }
    let left = &mut pruned.mesh;
    left.retain_triangles(|t| !goes(parts.of_triangle[t] as usize));
    pruned.triangles = mesh.triangles.len() - left.triangles.len();
    pruned.vertices = left.remove_unreferenced_vertices();
    Ok(pruned)
}

/// Diagonals of the boxes around all parts.
fn sizes(mesh: &TriMesh, parts: &Components) -> Vec<f64> {
    let mut boxes = vec![Aabb::EMPTY; parts.count];
    for (triangle, &part) in mesh.triangles.iter().zip(&parts.of_triangle) {
        let corners = triangle.map(|v| mesh.positions[v as usize]);
        let around = &mut boxes[part as usize];
        *around = corners.into_iter().fold(*around, Aabb::with);
    }
    boxes.iter().map(|b| b.diagonal()).collect()
}

/// The first of the largest.
fn largest(sizes: &[f64]) -> Option<usize> {
    (0..sizes.len()).reduce(|best, part| {
        if sizes[part] > sizes[best] {
            part
        } else {
            best
        }
    })
}
