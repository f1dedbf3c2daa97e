//! The indexed triangle mesh that every operation takes and returns.

use super::attributes::{Attribute, Attributes, gathered};
use crate::geom::Aabb;
use glam::{DVec3, Vec3};

/// An indexed triangle mesh in the GPU's layout: one vertex is one set of
/// attributes, so a position on a UV seam occurs once a side.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TriMesh {
    /// Vertex positions, model units.
    pub positions: Vec<Vec3>,
    /// Vertex indices, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Per-vertex attributes.
    pub attributes: Attributes,
    /// Per-triangle attributes, e.g. PLY face properties.
    pub face_attributes: Vec<Attribute>,
    /// Materials by triangle range, in order and without gap or overlap. Empty
    /// means one range without material.
    pub ranges: Vec<MaterialRange>,
}

/// Consecutive triangles of one material (a glTF primitive).
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct MaterialRange {
    /// First triangle.
    pub first: u32,
    /// Number of triangles; may be 0.
    pub count: u32,
    /// Index into [`Scene::materials`](super::Scene::materials).
    pub material: Option<u32>,
    /// Index of the primitive in the file this range was read from, counted
    /// over all meshes of the file; carried untouched, into other meshes too,
    /// so that a writer can restore what Karui does not model.
    pub source: Option<u32>,
}

impl MaterialRange {
    /// The triangles as an index range.
    #[must_use]
    pub fn triangles(&self) -> std::ops::Range<usize> {
        self.first as usize..self.first as usize + self.count as usize
    }
}

impl TriMesh {
    /// A mesh without attributes. Indices are not checked; see `validate`.
    #[must_use]
    pub fn new(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Self {
        Self {
            positions,
            triangles,
            ..Self::default()
        }
    }

    /// Bounding box of all vertices, referenced or not.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        Aabb::of(self.positions.iter().copied())
    }

    /// Corners of triangle `t` in double precision.
    #[must_use]
    pub fn corners(&self, t: usize) -> [DVec3; 3] {
        self.triangles[t].map(|v| self.positions[v as usize].as_dvec3())
    }

    /// The ranges, one of them for a mesh that has none.
    #[must_use]
    pub fn ranges_or_whole(&self) -> Vec<MaterialRange> {
        if !self.ranges.is_empty() {
            return self.ranges.clone();
        }
        vec![MaterialRange {
            count: self.triangles.len() as u32,
            ..MaterialRange::default()
        }]
    }

    /// Index of the range of every triangle; 0 for a mesh without ranges.
    #[must_use]
    pub fn range_of_triangles(&self) -> Vec<u32> {
        let mut range_of = vec![0; self.triangles.len()];
        for (i, range) in self.ranges.iter().enumerate() {
            range_of[range.triangles()].fill(i as u32);
        }
        range_of
    }

    /// Keeps the vertices named by `sources`, in that order, with their
    /// attributes. Triangles are left as they are.
    pub fn gather_vertices(&mut self, sources: &[u32]) {
        self.positions = gathered(&self.positions, sources);
        self.attributes.gather(sources);
    }

    /// Keeps the triangles for which `keep` says so, with face attributes and
    /// ranges; ranges may become empty but stay in the list.
    pub fn retain_triangles(&mut self, mut keep: impl FnMut(usize) -> bool) {
        let kept: Vec<u32> = (0..self.triangles.len())
            .filter(|&t| keep(t))
            .map(|t| t as u32)
            .collect();
        self.gather_triangles(&kept);
    }

    /// Takes these triangles, in ascending order; one may be there several
    /// times.
    pub(crate) fn gather_triangles(&mut self, kept: &[u32]) {
        let mut next = 0;
        for range in &mut self.ranges {
            let end = range.first + range.count;
            let count = kept[next as usize..].partition_point(|&t| t < end) as u32;
            (range.first, range.count) = (next, count);
            next += count;
        }
        self.triangles = gathered(&self.triangles, kept);
        for attribute in &mut self.face_attributes {
            *attribute = attribute.gathered(kept);
        }
    }

    /// Drops vertices that no triangle uses and returns, for every vertex
    /// kept, its former index. Order is kept.
    pub fn remove_unreferenced_vertices(&mut self) -> Vec<u32> {
        let mut new_index = vec![u32::MAX; self.positions.len()];
        for &v in self.triangles.iter().flatten() {
            new_index[v as usize] = 0;
        }
        let mut kept = Vec::new();
        for (v, new) in new_index.iter_mut().enumerate().filter(|(_, n)| **n == 0) {
            *new = kept.len() as u32;
            kept.push(v as u32);
        }
        if kept.len() < self.positions.len() {
            self.gather_vertices(&kept);
            for v in self.triangles.iter_mut().flatten() {
                *v = new_index[*v as usize];
            }
        }
        kept
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_ranges() -> TriMesh {
        let positions = (0..6).map(|i| Vec3::splat(i as f32)).collect();
        let mut mesh = TriMesh::new(positions, vec![[0, 1, 2], [1, 2, 3], [3, 4, 5]]);
        let range = |first, count, material| MaterialRange {
            first,
            count,
            material: Some(material),
            source: None,
        };
        mesh.ranges = vec![range(0, 2, 7), range(2, 1, 8)];
        mesh
    }

    #[test]
    fn retain_keeps_ranges_in_step() {
        let mut mesh = two_ranges();
        mesh.retain_triangles(|t| t != 0);
        assert_eq!(mesh.triangles, [[1, 2, 3], [3, 4, 5]]);
        assert_eq!(mesh.range_of_triangles(), [0, 1]);
        mesh.retain_triangles(|t| t == 1);
        assert_eq!(mesh.ranges[0].count, 0);
        assert_eq!(mesh.ranges[1].triangles(), 0..1);
    }

    #[test]
    fn unreferenced_vertices_go() {
        let mut mesh = two_ranges();
        mesh.retain_triangles(|t| t == 2);
        assert_eq!(mesh.remove_unreferenced_vertices(), [3, 4, 5]);
        assert_eq!(mesh.triangles, [[0, 1, 2]]);
        assert_eq!(mesh.positions[0], Vec3::splat(3.0));
    }
}
