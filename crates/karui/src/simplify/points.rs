//! From the triangles of a mesh to triangles over points that have one fan
//! each: what [`super::wedges::prepare`] does, in little more than linear time
//! where the mesh is manifold, which nearly all of it nearly always is.

use super::sheets;
use super::wedges::{self, Classes, Normals};
use crate::mesh::{Attributes, PositionIds, TriMesh};
use rayon::prelude::*;
use smallvec::SmallVec;

/// Points looked at by one task.
const TASK: usize = 4096;

/// A mesh over points.
pub(super) struct Points {
    /// Points of every triangle that is kept.
    pub triangle: Vec<[u32; 3]>,
    /// Triangle of the mesh that each of them is.
    pub source: Vec<u32>,
    /// A vertex at every point.
    pub vertex: Vec<u32>,
    /// Wedges of every triangle; empty if there are neither attributes nor
    /// materials.
    pub wedge: Vec<[u32; 3]>,
    /// Vertex of the mesh that every wedge stands for. A wedge belongs to one
    /// point.
    pub wedge_vertex: Vec<u32>,
    /// What becomes of the normals.
    pub normals: Normals,
}

/// Links equal positions, leaves out triangles without three of them and
/// duplicates, and splits points where several fans meet. The mesh must be
/// valid.
pub(super) fn points(mesh: &TriMesh) -> Points {
    let ids = PositionIds::of_mesh(mesh);
    let linked = |t: usize| mesh.triangles[t].map(|v| ids.of_vertex[v as usize]);
    let is_whole = |&t: &u32| {
        let [a, b, c] = linked(t as usize);
        a != b && b != c && c != a
    };
    let all = 0..mesh.triangles.len() as u32;
    let mut source: Vec<u32> = all.filter(is_whole).collect();
    let mut triangle: Vec<[u32; 3]> = source.iter().map(|&t| linked(t as usize)).collect();
    let mut vertex = ids.first_vertices();
    let (class, normals) = wedges::classes(mesh, &ids);
    let odd = odd_points(&triangle, ids.count);
    if odd.contains(&true) {
        let split = Split::of(mesh, &ids, &class, &triangle, &source, &odd);
        split.apply(&mut triangle, &mut source, &mut vertex);
    }
    let is_bare = mesh.attributes == Attributes::default() && mesh.ranges.len() <= 1;
    let (wedge, wedge_vertex) = match is_bare {
        true => Default::default(),
        false => wedges_of(mesh, &class, &triangle, &source, ids.count),
    };
    Points {
        triangle,
        source,
        vertex,
        wedge,
        wedge_vertex,
        normals,
    }
}

/// Wedges of every triangle: the vertex that stands for the corner's, or one
/// of its own where the point has been split off.
fn wedges_of(
    mesh: &TriMesh,
    class: &Classes,
    triangle: &[[u32; 3]],
    source: &[u32],
    positions: usize,
) -> (Vec<[u32; 3]>, Vec<u32>) {
    let wedges = |&t: &u32| mesh.triangles[t as usize].map(|v| class.of_vertex[v as usize]);
    let mut wedge: Vec<[u32; 3]> = source.iter().map(wedges).collect();
    let mut vertex: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    let mut split: Vec<(u32, u32, usize)> = Vec::new();
    for (t, points) in triangle.iter().enumerate() {
        for (k, &p) in points.iter().enumerate() {
            if p as usize >= positions {
                split.push((p, wedge[t][k], 3 * t + k));
            }
        }
    }
    split.sort_unstable();
    for same in split.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        for &(_, _, corner) in same {
            wedge[corner / 3][corner % 3] = vertex.len() as u32;
        }
        vertex.push(same[0].1);
    }
    (wedge, vertex)
}

/// Points whose triangles are not one fan, open or closed.
fn odd_points(triangles: &[[u32; 3]], points: usize) -> Vec<bool> {
    let mut start = vec![0u32; points + 1];
    for &p in triangles.iter().flatten() {
        start[p as usize] += 1;
    }
    let mut sum = 0;
    for s in &mut start {
        sum += *s;
        *s = sum;
    }
    // Filled from behind, every start ends where its own list begins.
    let mut list = vec![0u32; sum as usize];
    for (t, triangle) in triangles.iter().enumerate().rev() {
        for &p in triangle {
            start[p as usize] -= 1;
            list[start[p as usize] as usize] = t as u32;
        }
    }
    let mut odd = vec![false; points];
    odd.par_chunks_mut(TASK).enumerate().for_each(|(i, odd)| {
        for (k, odd) in odd.iter_mut().enumerate() {
            let p = i * TASK + k;
            let at = &list[start[p] as usize..start[p + 1] as usize];
            *odd = !is_fan(p as u32, at, triangles);
        }
    });
    odd
}

/// Whether the triangles `at` a point follow one upon the other.
fn is_fan(p: u32, at: &[u32], triangles: &[[u32; 3]]) -> bool {
    let sides: SmallVec<[(u32, u32); 12]> = at
        .iter()
        .map(|&t| match triangles[t as usize] {
            [a, b, c] if a == p => (b, c),
            [a, b, c] if b == p => (c, a),
            [a, b, _] => (a, b),
        })
        .collect();
    if sides.len() > 256 {
        // A hub: left to the sort.
        return false;
    }
    let starts_with = |q: u32| sides.iter().filter(move |s| s.0 == q);
    let opens = |s: &&(u32, u32)| sides.iter().all(|o| o.1 != s.0);
    let Some(first) = sides.iter().find(opens).or(sides.first()) else {
        return true;
    };
    let mut at = first;
    for seen in 1..=sides.len() {
        let mut next = starts_with(at.1);
        match (next.next(), next.next()) {
            (None, _) => return seen == sides.len(),
            (Some(other), None) if other == first => return seen == sides.len(),
            (Some(other), None) => at = other,
            _ => return false,
        }
    }
    false
}

/// The triangles at odd points, taken apart.
struct Split {
    /// Points of those that stay, by their place in the list of all.
    moved: Vec<(u32, [u32; 3])>,
    /// Places of duplicates in the list of all.
    dropped: Vec<u32>,
    /// Vertices of the points that are new.
    vertex: Vec<u32>,
}

impl Split {
    fn of(
        mesh: &TriMesh,
        ids: &PositionIds,
        class: &Classes,
        triangle: &[[u32; 3]],
        source: &[u32],
        odd: &[bool],
    ) -> Self {
        let touches = |t: &[u32; 3]| t.iter().any(|&p| odd[p as usize]);
        let places: Vec<u32> = (0..triangle.len() as u32)
            .filter(|&i| touches(&triangle[i as usize]))
            .collect();
        let candidates: Vec<u32> = places.iter().map(|&i| source[i as usize]).collect();
        let range_of = mesh.range_of_triangles();
        let kept = wedges::distinct_triangles(mesh, ids, &candidates, class, &range_of);
        let (fans, position_of) = sheets::points(mesh, ids, &kept, &range_of);
        let mut split = Self {
            moved: Vec::new(),
            dropped: Vec::new(),
            vertex: Vec::new(),
        };
        // The first fan at a position keeps the position's id.
        let first = ids.first_vertices();
        let mut taken = vec![false; ids.count];
        let mut id_of = vec![u32::MAX; position_of.len()];
        let mut kept = kept.iter().zip(&fans).peekable();
        for (&i, t) in places.iter().zip(&candidates) {
            let Some((_, fans)) = kept.next_if(|k| k.0 == t) else {
                split.dropped.push(i);
                continue;
            };
            let points = std::array::from_fn(|k| {
                let (fan, position) = (fans[k] as usize, triangle[i as usize][k]);
                if !odd[position as usize] {
                    return position;
                }
                if id_of[fan] == u32::MAX {
                    let is_first = !std::mem::replace(&mut taken[position as usize], true);
                    id_of[fan] = if is_first {
                        position
                    } else {
                        split.vertex.push(first[position as usize]);
                        (ids.count + split.vertex.len() - 1) as u32
                    };
                }
                id_of[fan]
            });
            split.moved.push((i, points));
        }
        split
    }

    fn apply(&self, triangle: &mut Vec<[u32; 3]>, source: &mut Vec<u32>, vertex: &mut Vec<u32>) {
        for &(i, points) in &self.moved {
            triangle[i as usize] = points;
        }
        vertex.extend(&self.vertex);
        if self.dropped.is_empty() {
            return;
        }
        let mut keep = vec![true; triangle.len()];
        self.dropped.iter().for_each(|&i| keep[i as usize] = false);
        let mut kept = keep.iter();
        triangle.retain(|_| kept.next().is_none_or(|&k| k));
        let mut kept = keep.iter();
        source.retain(|_| kept.next().is_none_or(|&k| k));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes;

    /// Triangles by the places of their corners, and how many points there are.
    fn summary(points: &Points) -> (Vec<u32>, usize) {
        let mut used = vec![false; points.vertex.len()];
        points
            .triangle
            .iter()
            .flatten()
            .for_each(|&p| used[p as usize] = true);
        let count = used.iter().filter(|u| **u).count();
        (points.source.clone(), count)
    }

    #[test]
    fn zoo_is_taken_apart_as_by_the_exact_driver() {
        for (name, mesh) in shapes::zoo() {
            let quick = points(&mesh);
            let slow = wedges::prepare(&mesh);
            let slow = (slow.source_triangle, slow.surface.position.len());
            assert_eq!(summary(&quick), slow, "{name}");
        }
    }
}
