//! Connected parts of a mesh.

use super::disjoint_sets::DisjointSets;
use super::{MaterialRange, PositionIds, TriMesh};
use crate::error::{Error, Result};

/// Which part of a mesh each triangle belongs to. Triangles belong together if
/// a chain of triangles with common vertices joins them.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Components {
    /// Component of every triangle, numbered by first appearance.
    pub of_triangle: Vec<u32>,
    /// Number of components.
    pub count: usize,
}

impl Components {
    /// Components of `mesh` with its vertices linked by `ids`, normally
    /// [`PositionIds::of_mesh`].
    ///
    /// # Errors
    /// [`Error::IndexOutOfRange`] or, if `ids` belong to another mesh,
    /// [`Error::LengthMismatch`].
    pub fn of(mesh: &TriMesh, ids: &PositionIds) -> Result<Self> {
        ids.validate_for(mesh)?;
        Ok(of_triangles(&ids.triangles(&mesh.triangles), ids.count))
    }

    /// The triangles of every component in order: those of `c` are
    /// `triangles[starts[c]..starts[c + 1]]`.
    #[must_use]
    pub fn groups(&self) -> (Vec<u32>, Vec<u32>) {
        let by_component = PositionIds {
            of_vertex: self.of_triangle.clone(),
            count: self.count,
        };
        by_component.groups()
    }

    /// Every component as a mesh of its own, with its vertices, attributes and
    /// material ranges (as many as `mesh` has, some of them empty).
    ///
    /// # Errors
    /// What [`TriMesh::validate`] finds wrong with `mesh`;
    /// [`Error::LengthMismatch`] if these are the components of another mesh.
    pub fn extract(&self, mesh: &TriMesh) -> Result<Vec<TriMesh>> {
        mesh.validate()?;
        let (expected, found) = (mesh.triangles.len(), self.of_triangle.len());
        if expected != found {
            let what = "components of triangles".into();
            return Err(Error::LengthMismatch {
                what,
                expected,
                found,
            });
        }
        let is_bad = |&c: &u32| c as usize >= self.count;
        let index = self.of_triangle.iter().position(is_bad);
        if index.is_some() || self.count > found {
            let rule = "components are numbered below their count";
            let index = index.unwrap_or(self.count);
            return Err(Error::Broken { rule, index });
        }
        let (starts, triangles) = self.groups();
        let mut new_index = vec![u32::MAX; mesh.positions.len()];
        let part = |range: &[u32]| {
            let chosen = &triangles[range[0] as usize..range[1] as usize];
            extract(mesh, chosen, &mut new_index)
        };
        Ok(starts.windows(2).map(part).collect())
    }
}

pub(crate) fn of_triangles(triangles: &[[u32; 3]], vertices: usize) -> Components {
    let mut sets = DisjointSets::new(vertices);
    for &[a, b, c] in triangles {
        sets.unite(a, b);
        sets.unite(b, c);
    }
    let mut number = vec![u32::MAX; vertices];
    let mut count = 0;
    let label = |t: &[u32; 3]| {
        let slot = &mut number[sets.find(t[0]) as usize];
        if *slot == u32::MAX {
            *slot = count;
            count += 1;
        }
        *slot
    };
    let of_triangle = triangles.iter().map(label).collect();
    Components {
        of_triangle,
        count: count as usize,
    }
}

/// The chosen triangles, in increasing order, with the vertices they use in
/// their order of `mesh`. `new_index` is scratch space, all `u32::MAX` before
/// and after, so that many small parts do not each cost the whole mesh.
fn extract(mesh: &TriMesh, chosen: &[u32], new_index: &mut [u32]) -> TriMesh {
    let triangles = || chosen.iter().map(|&t| mesh.triangles[t as usize]);
    let mut vertices: Vec<u32> = triangles().flatten().collect();
    vertices.sort_unstable();
    vertices.dedup();
    for (new, &v) in vertices.iter().enumerate() {
        new_index[v as usize] = new as u32;
    }
    let triangles = triangles().map(|t| t.map(|v| new_index[v as usize]));
    let part = TriMesh {
        positions: vertices
            .iter()
            .map(|&v| mesh.positions[v as usize])
            .collect(),
        triangles: triangles.collect(),
        attributes: mesh.attributes.gathered(&vertices),
        face_attributes: mesh
            .face_attributes
            .iter()
            .map(|a| a.gathered(chosen))
            .collect(),
        ranges: ranges_within(&mesh.ranges, chosen),
    };
    for &v in &vertices {
        new_index[v as usize] = u32::MAX;
    }
    part
}

fn ranges_within(ranges: &[MaterialRange], chosen: &[u32]) -> Vec<MaterialRange> {
    let before = |t: usize| chosen.partition_point(|&c| (c as usize) < t) as u32;
    let within = |range: &MaterialRange| {
        let [first, end] = [range.triangles().start, range.triangles().end].map(before);
        MaterialRange {
            first,
            count: end - first,
            ..*range
        }
    };
    ranges.iter().map(within).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes;

    #[test]
    fn parts_of_the_zoo() {
        let count = |mesh: &TriMesh| {
            Components::of(mesh, &PositionIds::of_mesh(mesh))
                .unwrap()
                .count
        };
        assert_eq!(count(&shapes::empty()), 0);
        assert_eq!(count(&shapes::cube(2)), 1);
        assert_eq!(count(&shapes::bow_tie()), 1);
        assert_eq!(count(&shapes::touching_parts()), 2);
        let cube = shapes::cube(2);
        let apart = PositionIds::distinct(cube.positions.len());
        assert_eq!(Components::of(&cube, &apart).unwrap().count, 6);
    }

    #[test]
    fn extracted_parts_are_the_former_triangles_with_everything_on_them() {
        let mut mesh = shapes::loaded_sphere(8, 12);
        // Without the equator two caps remain.
        mesh.retain_triangles(|t| !(72..120).contains(&t));
        let components = Components::of(&mesh, &PositionIds::of_mesh(&mesh)).unwrap();
        let parts = components.extract(&mesh).unwrap();
        assert_eq!(parts.len(), 2);
        for (c, part) in parts.iter().enumerate() {
            part.validate().unwrap();
            let mut expected = mesh.clone();
            expected.retain_triangles(|t| components.of_triangle[t] == c as u32);
            expected.remove_unreferenced_vertices();
            assert_eq!(part, &expected);
        }
    }
}
