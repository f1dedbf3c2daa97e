//! A mesh made ready to be measured.

use super::sides::sorted_sides;
use crate::error::Result;
use crate::geom::{Aabb, area};
use crate::mesh::{PositionIds, TriMesh};
use crate::spatial::Bvh;
use glam::{DVec3, Vec3};

/// A mesh made ready for distance measurement: build it once if one original
/// is compared with many levels of detail.
///
/// Vertices at exactly one position count once here, and so do the edges
/// between them, so that a UV seam changes no figure.
#[derive(Debug, Clone)]
pub struct Surface {
    pub(super) bvh: Bvh,
    /// Positions without duplicates, in the order in which the triangles first
    /// use them, which keeps neighbours close.
    pub(super) positions: Vec<Vec3>,
    /// Triangles between them, in leaf order of the hierarchy.
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) edges: Vec<[u32; 2]>,
    /// Sum of the areas of all triangles before each, and of all.
    pub(super) areas: Vec<f64>,
    /// Sum of the lengths of all edges before each, and of all.
    pub(super) lengths: Vec<f64>,
    /// Position of every vertex of the mesh, [`UNUSED`] if no triangle uses it.
    position_of: Vec<u32>,
}

/// Marks a vertex that no triangle uses.
const UNUSED: u32 = u32::MAX;

impl Surface {
    /// Welds, sorts and measures the triangles of `mesh`.
    ///
    /// # Errors
    /// As [`Bvh::build`]: no triangles, indices out of range, corners that
    /// are not finite.
    pub fn new(mesh: &TriMesh) -> Result<Self> {
        let bvh = Bvh::build(mesh)?;
        let (position_of, kept) = number_by_first_use(mesh, bvh.order());
        let renumber = |&t: &u32| mesh.triangles[t as usize].map(|v| position_of[v as usize]);
        let triangles: Vec<[u32; 3]> = bvh.order().iter().map(renumber).collect();
        let mut edges = sorted_sides(&triangles);
        edges.dedup();
        let mut surface = Self {
            bvh,
            positions: kept.iter().map(|&v| mesh.positions[v as usize]).collect(),
            triangles,
            edges,
            areas: Vec::new(),
            lengths: Vec::new(),
            position_of,
        };
        let triangle_area = |&t: &[u32; 3]| area(t.map(|v| surface.position(v)));
        let edge_length = |&[p, q]: &[u32; 2]| surface.position(p).distance(surface.position(q));
        let areas = running_sum(surface.triangles.iter().map(triangle_area));
        let lengths = running_sum(surface.edges.iter().map(edge_length));
        (surface.areas, surface.lengths) = (areas, lengths);
        Ok(surface)
    }

    /// The hierarchy over its triangles.
    #[must_use]
    pub fn bvh(&self) -> &Bvh {
        &self.bvh
    }

    /// Box around all triangles; its diagonal is the unit of relative errors.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.bvh.bounds()
    }

    /// Sum of the areas of all triangles, model units squared.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.areas.last().copied().unwrap_or(0.0)
    }

    /// Sum of the lengths of all edges, each counted once; model units.
    #[must_use]
    pub fn edge_length(&self) -> f64 {
        self.lengths.last().copied().unwrap_or(0.0)
    }

    pub(super) fn position(&self, p: u32) -> DVec3 {
        self.positions[p as usize].as_dvec3()
    }

    /// Number of vertices of the mesh, unused ones included.
    pub(super) fn vertex_count(&self) -> usize {
        self.position_of.len()
    }

    /// One value a position from one a vertex: the largest of those that share
    /// the position.
    pub(super) fn largest_at_positions(&self, of_vertices: &[f32]) -> Vec<f32> {
        let mut largest = vec![f32::NEG_INFINITY; self.positions.len()];
        for (&p, &value) in self.position_of.iter().zip(of_vertices) {
            if let Some(slot) = largest.get_mut(p as usize) {
                *slot = slot.max(value);
            }
        }
        largest
    }
}

/// Numbers positions in the order in which triangles use them: the number of
/// every vertex, and a vertex for every number.
fn number_by_first_use(mesh: &TriMesh, order: &[u32]) -> (Vec<u32>, Vec<u32>) {
    let ids = PositionIds::of_mesh(mesh);
    let mut number = vec![UNUSED; ids.count];
    let mut used = vec![false; mesh.positions.len()];
    let mut kept = Vec::new();
    for &v in order.iter().flat_map(|&t| &mesh.triangles[t as usize]) {
        used[v as usize] = true;
        let slot = &mut number[ids.of_vertex[v as usize] as usize];
        if *slot == UNUSED {
            *slot = kept.len() as u32;
            kept.push(v);
        }
    }
    let vertices = ids.of_vertex.iter().zip(used);
    let number_of = |(&id, used)| if used { number[id as usize] } else { UNUSED };
    (vertices.map(number_of).collect(), kept)
}

fn running_sum(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut sum = 0.0;
    let sums = values.map(|v| {
        sum += v;
        sum
    });
    std::iter::once(0.0).chain(sums).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A unit square of two triangles that share no vertex, and a stray one.
    fn split_square() -> TriMesh {
        let p = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        let stray = p(9.0, 9.0);
        TriMesh::new(
            vec![
                p(0., 0.),
                p(1., 0.),
                p(1., 1.),
                stray,
                p(0., 0.),
                p(1., 1.),
                p(0., 1.),
            ],
            vec![[0, 1, 2], [4, 5, 6]],
        )
    }

    #[test]
    fn seams_count_once_and_strays_not_at_all() {
        let surface = Surface::new(&split_square()).unwrap();
        assert_eq!(surface.positions.len(), 4);
        assert_eq!(surface.edges.len(), 5);
        assert_eq!(surface.area(), 1.0);
        assert!((surface.edge_length() - (4.0 + 2f64.sqrt())).abs() < 1e-15);
        assert_eq!(surface.bounds().max, Vec3::new(1.0, 1.0, 0.0));
    }

    #[test]
    fn shared_positions_take_the_largest_value() {
        let surface = Surface::new(&split_square()).unwrap();
        let values = surface.largest_at_positions(&[1., 2., 3., 99., 5., 0., 7.]);
        let mut sorted = values.clone();
        sorted.sort_by(f32::total_cmp);
        assert_eq!(sorted, [2., 3., 5., 7.]);
    }
}
