//! The triangles around every point of a surface.

use crate::error::{Error, Result};
use crate::mesh::{PositionIds, TriMesh};
use glam::DVec3;

/// Points, the distinct positions of a mesh, each with the triangles it is a
/// corner of: a UV seam is not a border.
pub(super) struct Stars {
    pub(super) ids: PositionIds,
    pub(super) points: Vec<DVec3>,
    /// The corners of point `p` are `corners[starts[p]..starts[p + 1]]`.
    starts: Vec<u32>,
    /// The other two points of a triangle, in its direction.
    corners: Vec<[u32; 2]>,
}

impl Stars {
    /// Triangles that name a point twice take no part.
    ///
    /// # Errors
    /// [`Error::IndexOutOfRange`]; [`Error::NotFinite`] for a position;
    /// [`Error::TooLarge`] for more than `u32::MAX` triangle corners.
    pub(super) fn of(mesh: &TriMesh) -> Result<Self> {
        check(mesh)?;
        let ids = PositionIds::of_mesh(mesh);
        let triangles = ids.triangles(&mesh.triangles);
        let proper = || {
            let differ = |[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
            triangles.iter().copied().filter(differ)
        };
        let mut starts = vec![0u32; ids.count + 1];
        for p in proper().flatten() {
            starts[p as usize + 1] += 1;
        }
        for p in 0..ids.count {
            starts[p + 1] += starts[p];
        }
        let mut next = starts.clone();
        let mut corners = vec![[0; 2]; starts[ids.count] as usize];
        for [a, b, c] in proper() {
            for (p, others) in [(a, [b, c]), (b, [c, a]), (c, [a, b])] {
                corners[next[p as usize] as usize] = others;
                next[p as usize] += 1;
            }
        }
        let first = ids.first_vertices();
        let place = |&v: &u32| mesh.positions[v as usize].as_dvec3();
        let points = first.iter().map(place).collect();
        Ok(Self {
            ids,
            points,
            starts,
            corners,
        })
    }

    /// The other two points of every triangle at point `p`.
    pub(super) fn around(&self, p: usize) -> &[[u32; 2]] {
        &self.corners[self.starts[p] as usize..self.starts[p + 1] as usize]
    }

    /// Values of points, given to the vertices that lie there.
    pub(super) fn spread<T: Copy>(&self, of_points: &[T]) -> Vec<T> {
        let at = |&id: &u32| of_points[id as usize];
        self.ids.of_vertex.iter().map(at).collect()
    }
}

fn check(mesh: &TriMesh) -> Result<()> {
    mesh.validate_indices()?;
    let limit = u32::MAX as usize;
    let found = mesh.triangles.len().saturating_mul(3);
    if found > limit {
        let what = "triangle corners";
        return Err(Error::TooLarge { what, found, limit });
    }
    match mesh.positions.iter().position(|p| !p.is_finite()) {
        Some(index) => Err(Error::NotFinite {
            what: "position".into(),
            index,
        }),
        None => Ok(()),
    }
}
