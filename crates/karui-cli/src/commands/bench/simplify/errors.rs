//! How far a simplified mesh is from the original, and what is wrong with it.

use super::attributes::{AttributeErrors, attribute_errors};
use anyhow::Result;
use karui::TriMesh;
use karui::mesh::PositionIds;
use karui::metrics::{
    Samples, Surface, SurfaceDistanceOptions, flipped, quality, surface_distance_between,
};
use rayon::prelude::*;
use serde::Serialize;

/// What was measured of one result.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Errors {
    /// Triangles left.
    pub triangles: usize,
    /// Two-sided distances, the worse direction, shares of the diagonal.
    pub mean: f64,
    pub rms: f64,
    pub max: f64,
    /// Triangles that face away from the nearest point of the original, beyond
    /// those of the original itself.
    pub new_flips: usize,
    /// Edges with more than two triangles, beyond the original's.
    pub new_non_manifold: usize,
    /// Largest distance between the open borders, share of the diagonal;
    /// infinite if only one of the two has any, `None` if neither.
    pub border: Option<f64>,
    /// Only where the original has attributes.
    pub attributes: AttributeErrors,
}

/// A mesh that results are compared with.
pub struct Reference<'a> {
    mesh: &'a TriMesh,
    surface: Surface,
    flips: usize,
    non_manifold: usize,
    border: Option<Surface>,
}

impl<'a> Reference<'a> {
    pub fn new(mesh: &'a TriMesh) -> Result<Self> {
        let surface = Surface::new(mesh)?;
        Ok(Self {
            mesh,
            flips: flipped(mesh, surface.bvh())?,
            non_manifold: quality(mesh)?.non_manifold_edges,
            border: border(mesh)?,
            surface,
        })
    }

    /// Measures `result` with so many face samples and edge samples.
    pub fn measure(&self, result: &TriMesh, samples: u64) -> Result<Errors> {
        if result.triangles.is_empty() {
            return Ok(Errors::NOTHING_LEFT);
        }
        let options = SurfaceDistanceOptions {
            samples: Samples::Count(samples),
            ..SurfaceDistanceOptions::default()
        };
        let surface = Surface::new(result)?;
        let distance = surface_distance_between(&self.surface, &surface, &options)?;
        let diagonal = distance.diagonal.max(f64::MIN_POSITIVE);
        let drift = match (&self.border, border(result)?) {
            (None, None) => None,
            (Some(before), Some(after)) => {
                let drift = surface_distance_between(before, &after, &options)?;
                Some(drift.max() / diagonal)
            }
            _ => Some(f64::INFINITY),
        };
        let flips = flipped(result, self.surface.bvh())?;
        let non_manifold = quality(result)?.non_manifold_edges;
        let sides = [(self.mesh, self.surface.bvh()), (result, surface.bvh())];
        Ok(Errors {
            triangles: result.triangles.len(),
            mean: distance.mean() / diagonal,
            rms: distance.rms() / diagonal,
            max: distance.max() / diagonal,
            new_flips: flips.saturating_sub(self.flips),
            new_non_manifold: non_manifold.saturating_sub(self.non_manifold),
            border: drift,
            attributes: attribute_errors(sides, samples)?,
        })
    }
}

impl Errors {
    const NOTHING_LEFT: Self = Self {
        triangles: 0,
        mean: f64::INFINITY,
        rms: f64::INFINITY,
        max: f64::INFINITY,
        new_flips: 0,
        new_non_manifold: 0,
        border: None,
        attributes: AttributeErrors::NONE,
    };
}

/// The edges of one triangle only, seams not counted, as triangles without
/// area: the distance between two of these is that between the curves.
fn border(mesh: &TriMesh) -> Result<Option<Surface>> {
    let ids = PositionIds::of_mesh(mesh);
    let mut sides: Vec<[u32; 2]> = (ids.triangles(&mesh.triangles).iter())
        .filter(|[a, b, c]| a != b && b != c && c != a)
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    sides.par_sort_unstable();
    let open = sides.chunk_by(|a, b| a == b).filter(|same| same.len() == 1);
    let triangles: Vec<_> = open
        .map(|same| [same[0][0], same[0][1], same[0][1]])
        .collect();
    if triangles.is_empty() {
        return Ok(None);
    }
    let place = |&v: &u32| mesh.positions[v as usize];
    let positions = ids.first_vertices().iter().map(place).collect();
    Ok(Some(Surface::new(&TriMesh::new(positions, triangles))?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use karui::mesh::shapes;

    fn measured(before: &TriMesh, after: &TriMesh) -> Errors {
        let reference = Reference::new(before).unwrap();
        reference.measure(after, 10_000).unwrap()
    }

    #[test]
    fn a_mesh_is_at_no_distance_from_itself() {
        let grid = shapes::grid(8, 8);
        let found = measured(&grid, &grid);
        assert_eq!(found.triangles, 128);
        assert!(found.max < 1e-15 && found.border.unwrap() < 1e-15);
        assert!(found.attributes.uv.unwrap() < 1e-6);
        let closed = shapes::icosphere(2);
        assert_eq!(measured(&closed, &closed).border, None);
    }

    #[test]
    fn a_border_drifts_by_what_it_was_moved() {
        let before = shapes::grid(4, 4);
        let mut after = before.clone();
        // Inside its own plane, so that the surface hardly differs.
        for p in after.positions.iter_mut().filter(|p| p.x == 1.0) {
            p.x = 0.9;
        }
        let found = measured(&before, &after);
        let expected = 0.1 / 2f64.sqrt();
        assert!((found.border.unwrap() - expected).abs() < 1e-6, "{found:?}");
        let lost = measured(&before, &shapes::icosphere(1));
        assert_eq!(lost.border, Some(f64::INFINITY));
    }

    #[test]
    fn a_shift_is_the_mean_and_the_most() {
        let before = shapes::closed_cube(4);
        let mut after = before.clone();
        after.positions.iter_mut().for_each(|p| *p *= 1.1);
        let found = measured(&before, &after);
        // The corners move most, by a tenth of half the diagonal.
        assert!((found.max - 0.05).abs() < 1e-6, "{found:?}");
        assert!(found.mean > 0.0 && found.mean < found.rms && found.rms < found.max);
        assert_eq!(measured(&before, &TriMesh::default()).mean, f64::INFINITY);
        let turned = TriMesh::new(
            before.positions.clone(),
            before
                .triangles
                .iter()
                .map(|&[a, b, c]| [a, c, b])
                .collect(),
        );
        assert_eq!(measured(&before, &turned).new_flips, before.triangles.len());
        let mut book = before.clone();
        book.positions.push(Vec3::splat(2.0));
        let [a, b, _] = book.triangles[0];
        book.triangles.push([a, b, book.positions.len() as u32 - 1]);
        assert_eq!(measured(&before, &book).new_non_manifold, 1);
    }
}
