//! What a log has to know of its mesh: which vertices are one point of the
//! surface, and which share their attributes.

use crate::error::{Error, Result};
use crate::mesh::TriMesh;
use crate::simplify::wedges::Normals;
use std::borrow::Cow;

/// No id.
pub(super) const NONE: u32 = u32::MAX;

/// The mesh as it was taken apart.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::simplify) struct Base {
    pub vertices: u32,
    pub triangles: u32,
    /// Hash of the triangles.
    pub connectivity: u64,
    /// Hash of the positions.
    pub shape: u64,
    /// Triangles that took part, ascending; empty if all did.
    pub source: Vec<u32>,
    /// Points.
    pub point: Ids,
    /// Wedges; none if there are neither attributes nor materials.
    pub wedge: Option<Ids>,
    pub normals: Normals,
}

/// Ids of the corners of all triangles.
#[derive(Debug, Clone, Default, PartialEq)]
pub(in crate::simplify) struct Ids {
    /// By vertex; empty if it is the vertex itself.
    pub of_vertex: Vec<u32>,
    /// Corners that have another, ascending, and what they have.
    pub other: Vec<(u32, u32)>,
}

impl Base {
    /// `source`, `point` and `wedge` are those of the triangles that take
    /// part; `source` is empty if all do, `wedge` if there are none.
    pub fn of(
        mesh: &TriMesh,
        source: &[u32],
        point: &[[u32; 3]],
        wedge: &[[u32; 3]],
        normals: Normals,
    ) -> Self {
        Self {
            vertices: mesh.positions.len() as u32,
            triangles: mesh.triangles.len() as u32,
            connectivity: connectivity(mesh),
            shape: shape(mesh),
            source: source.to_vec(),
            point: Ids::of(mesh, source, point),
            wedge: (!wedge.is_empty()).then(|| Ids::of(mesh, source, wedge)),
            normals,
        }
    }

    /// Checks that a mesh has the vertices and triangles of this one; tells
    /// whether it has its positions, too.
    pub fn check(&self, mesh: &TriMesh) -> Result<bool> {
        let what = if mesh.positions.len() != self.vertices as usize {
            "number of vertices"
        } else if mesh.triangles.len() != self.triangles as usize {
            "number of triangles"
        } else if connectivity(mesh) != self.connectivity {
            "triangles"
        } else {
            return Ok(shape(mesh) == self.shape);
        };
        Err(Error::OtherMesh { what })
    }
}

impl Ids {
    fn of(mesh: &TriMesh, source: &[u32], ids: &[[u32; 3]]) -> Self {
        let mut of_vertex = vec![NONE; mesh.positions.len()];
        let mut other = Vec::new();
        for (t, ids) in ids.iter().enumerate() {
            let vertices = mesh.triangles[source_of(source, t)];
            for k in 0..3 {
                let known = &mut of_vertex[vertices[k] as usize];
                if *known == NONE {
                    *known = ids[k];
                } else if *known != ids[k] {
                    other.push(((3 * t + k) as u32, ids[k]));
                }
            }
        }
        let is_own = |(v, &id): (usize, &u32)| id == v as u32 || id == NONE;
        if of_vertex.iter().enumerate().all(is_own) {
            of_vertex.clear();
        }
        Self { of_vertex, other }
    }

    /// Id of a vertex, but for corners that have another.
    pub fn of_vertex(&self, v: u32) -> u32 {
        self.of_vertex.get(v as usize).copied().unwrap_or(v)
    }

    /// Ids by triangle, of those that take part.
    pub fn triangles<'a>(&self, mesh: &'a TriMesh, source: &[u32]) -> Cow<'a, [[u32; 3]]> {
        if self.of_vertex.is_empty() && self.other.is_empty() && source.is_empty() {
            return Cow::Borrowed(&mesh.triangles);
        }
        let count = match source.len() {
            0 => mesh.triangles.len(),
            count => count,
        };
        let of = |t: usize| mesh.triangles[source_of(source, t)].map(|v| self.of_vertex(v));
        let mut ids: Vec<[u32; 3]> = (0..count).map(of).collect();
        for &(corner, id) in &self.other {
            ids[corner as usize / 3][corner as usize % 3] = id;
        }
        ids.into()
    }

    /// One more than the largest id.
    pub fn count(&self, vertices: u32) -> usize {
        let own = match self.of_vertex.is_empty() {
            true => vertices as usize,
            false => self
                .of_vertex
                .iter()
                .map(|&id| count_to(id))
                .max()
                .unwrap_or(0),
        };
        let other = self.other.iter().map(|&(_, id)| count_to(id)).max();
        own.max(other.unwrap_or(0))
    }

    /// The first vertex that has the id, of every id; the first of all for ids
    /// that none has.
    pub fn first_vertices(&self, mesh: &TriMesh, source: &[u32]) -> Vec<u32> {
        let mut first = vec![NONE; self.count(mesh.positions.len() as u32)];
        let mut claim = |id: u32, v: u32| {
            if let Some(known) = first.get_mut(id as usize) {
                *known = v.min(*known);
            }
        };
        (0..mesh.positions.len() as u32).for_each(|v| claim(self.of_vertex(v), v));
        for &(corner, id) in &self.other {
            let triangle = mesh.triangles[source_of(source, corner as usize / 3)];
            claim(id, triangle[corner as usize % 3]);
        }
        first
            .iter_mut()
            .filter(|v| **v == NONE)
            .for_each(|v| *v = 0);
        first
    }
}

fn count_to(id: u32) -> usize {
    if id == NONE { 0 } else { id as usize + 1 }
}

fn source_of(source: &[u32], t: usize) -> usize {
    source.get(t).map_or(t, |&t| t as usize)
}

fn connectivity(mesh: &TriMesh) -> u64 {
    hash(mesh.triangles.as_flattened().iter().copied())
}

fn shape(mesh: &TriMesh) -> u64 {
    hash(
        mesh.positions
            .iter()
            .flat_map(|p| p.to_array().map(f32::to_bits)),
    )
}

/// Tells meshes apart, not attackers.
fn hash(words: impl Iterator<Item = u32>) -> u64 {
    words.fold(0xcbf2_9ce4_8422_2325, |hash: u64, word| {
        let mixed = (hash ^ u64::from(word)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        mixed ^ mixed >> 32
    })
}
