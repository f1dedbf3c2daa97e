//! Takes a mesh apart into points with one fan of triangles each.
//!
//! Triangles hang together across an edge if they share it in space. Where
//! more than two meet, those that also share the vertices of the file are
//! taken for one sheet, so that parts which merely touch stay apart; what is
//! left is kept together as a non-manifold edge.

use crate::mesh::{DisjointSets, PositionIds, TriMesh};

/// A triangle's side: its two positions, sorted, and what tells sheets apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Side {
    ends: [u32; 2],
    range: u32,
    vertices: [u32; 2],
    corner: u32,
    forward: bool,
}

/// Points of every triangle (of those listed in `kept`) and the position id
/// of every point.
pub(crate) fn points(
    mesh: &TriMesh,
    ids: &PositionIds,
    kept: &[u32],
    range_of: &[u32],
) -> (Vec<[u32; 3]>, Vec<u32>) {
    let mut sides = sides(mesh, ids, kept, range_of);
    sides.sort_unstable();
    let mut fans = DisjointSets::new(kept.len() * 3);
    for edge in sides.chunk_by(|a, b| a.ends == b.ends) {
        link_edge(edge, &mut fans);
    }
    number(mesh, ids, kept, &mut fans)
}

fn sides(mesh: &TriMesh, ids: &PositionIds, kept: &[u32], range_of: &[u32]) -> Vec<Side> {
    let mut sides = Vec::with_capacity(kept.len() * 3);
    for (i, &t) in kept.iter().enumerate() {
        let triangle = mesh.triangles[t as usize];
        for k in 0..3 {
            let (v, w) = (triangle[k], triangle[(k + 1) % 3]);
            let (p, q) = (ids.of_vertex[v as usize], ids.of_vertex[w as usize]);
            let forward = p < q;
            let (ends, vertices) = if forward {
                ([p, q], [v, w])
            } else {
                ([q, p], [w, v])
            };
            sides.push(Side {
                ends,
                range: range_of[t as usize],
                vertices,
                corner: (3 * i + k) as u32,
                forward,
            });
        }
    }
    sides
}

fn link_edge(edge: &[Side], fans: &mut DisjointSets) {
    if edge.len() <= 2 {
        link_all(edge.iter(), fans);
        return;
    }
    let sheet = |a: &Side, b: &Side| a.vertices == b.vertices && a.range == b.range;
    let is_sheet = |s: &[Side]| s.len() == 2 && s[0].forward != s[1].forward;
    let groups = || edge.chunk_by(sheet);
    groups()
        .filter(|s| is_sheet(s))
        .for_each(|s| link_all(s.iter(), fans));
    link_all(groups().filter(|s| !is_sheet(s)).flatten(), fans);
}

fn link_all<'a>(sides: impl Iterator<Item = &'a Side>, fans: &mut DisjointSets) {
    let mut first: Option<&Side> = None;
    for side in sides {
        match first {
            None => first = Some(side),
            Some(one) => {
                fans.unite(one.corner_at(0), side.corner_at(0));
                fans.unite(one.corner_at(1), side.corner_at(1));
            }
        }
    }
}

impl Side {
    /// The triangle's corner at the lesser (0) or greater (1) end.
    fn corner_at(&self, end: usize) -> u32 {
        let next = self.corner - self.corner % 3 + (self.corner % 3 + 1) % 3;
        if (end == 0) == self.forward {
            self.corner
        } else {
            next
        }
    }
}

fn number(
    mesh: &TriMesh,
    ids: &PositionIds,
    kept: &[u32],
    fans: &mut DisjointSets,
) -> (Vec<[u32; 3]>, Vec<u32>) {
    let mut point_of_fan = vec![u32::MAX; kept.len() * 3];
    let mut positions = Vec::new();
    let mut triangles = Vec::with_capacity(kept.len());
    for (i, &t) in kept.iter().enumerate() {
        let mut points = [0; 3];
        for (k, point) in points.iter_mut().enumerate() {
            let fan = fans.find((3 * i + k) as u32) as usize;
            if point_of_fan[fan] == u32::MAX {
                point_of_fan[fan] = positions.len() as u32;
                let vertex = mesh.triangles[t as usize][k];
                positions.push(ids.of_vertex[vertex as usize]);
            }
            *point = point_of_fan[fan];
        }
        triangles.push(points);
    }
    (triangles, positions)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn point_count(mesh: &TriMesh) -> usize {
        let kept: Vec<u32> = (0..mesh.triangles.len() as u32).collect();
        let ids = PositionIds::of_mesh(mesh);
        points(mesh, &ids, &kept, &mesh.range_of_triangles())
            .1
            .len()
    }

    fn mesh(positions: usize, triangles: &[[u32; 3]]) -> TriMesh {
        let place = |i: usize| Vec3::new(i as f32, (i * i) as f32, 0.0);
        TriMesh::new((0..positions).map(place).collect(), triangles.to_vec())
    }

    #[test]
    fn a_bow_tie_becomes_two_points() {
        assert_eq!(point_count(&mesh(5, &[[0, 1, 2], [2, 3, 4]])), 6);
        assert_eq!(point_count(&mesh(4, &[[0, 1, 2], [2, 1, 3]])), 4);
    }

    #[test]
    fn three_wings_on_an_edge_stay_together() {
        let wings = [[0, 1, 2], [1, 0, 3], [0, 1, 4]];
        assert_eq!(point_count(&mesh(5, &wings)), 5);
    }

    #[test]
    fn parts_that_touch_along_an_edge_come_apart() {
        let mut parts = mesh(8, &[[0, 1, 2], [1, 0, 3], [4, 5, 6], [5, 4, 7]]);
        parts.positions[4] = parts.positions[0];
        parts.positions[5] = parts.positions[1];
        assert_eq!(point_count(&parts), 8);
    }
}
