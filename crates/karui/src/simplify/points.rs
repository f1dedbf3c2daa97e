//! From the triangles of a mesh to triangles over points that have one fan
//! each: what [`super::wedges::prepare`] does, in little more than linear time
//! where the mesh is manifold, which nearly all of it nearly always is.

use super::sheets;
use super::wedges::{self, Classes, Normals};
use crate::mesh::{Attributes, PositionIds, TriMesh};
use rayon::prelude::*;
use smallvec::SmallVec;
use std::borrow::Cow;

/// Points looked at by one task.
const TASK: usize = 4096;

/// A mesh over points.
pub(super) struct Points<'a> {
    /// Points of every triangle that is kept.
    pub triangle: Cow<'a, [[u32; 3]]>,
    /// Triangle of the mesh that each of them is; empty if all are kept.
    pub source: Vec<u32>,
    /// A vertex at every point; empty if every vertex is a point.
    vertex: Vec<u32>,
    /// Wedges of every triangle; empty if there are neither attributes nor
    /// materials.
    pub wedge: Vec<[u32; 3]>,
    /// Vertex of the mesh that every wedge stands for. A wedge belongs to one
    /// point.
    pub wedge_vertex: Vec<u32>,
    /// What becomes of the normals.
    pub normals: Normals,
    /// Whether the triangles at every point were one fan from the start.
    pub fans: bool,
}

impl Points<'_> {
    /// Of values by vertex those of the points.
    pub fn gathered<'a, T: Copy + Sync + Send>(&self, values: &'a [T]) -> Cow<'a, [T]> {
        if self.vertex.is_empty() {
            return values.into();
        }
        let vertices = self.vertex.par_iter();
        let gathered: Vec<T> = vertices.map(|&v| values[v as usize]).collect();
        gathered.into()
    }
}

/// Links equal positions, leaves out triangles without three of them and
/// duplicates, and splits points where several fans meet. The mesh must be
/// valid. One that is as it should be is not copied.
pub(super) fn points(mesh: &TriMesh) -> Points<'_> {
    let ids = PositionIds::of_mesh(mesh);
    let linked = |t: &[u32; 3]| t.map(|v| ids.of_vertex[v as usize]);
    let is_whole = |[a, b, c]: [u32; 3]| a != b && b != c && c != a;
    let keeps_vertices = ids.count == mesh.positions.len();
    let triangles = mesh.triangles.par_iter().with_min_len(TASK);
    let keeps_triangles = triangles.all(|t| is_whole(linked(t)));
    let all = 0..mesh.triangles.len() as u32;
    let source: Vec<u32> = match keeps_triangles {
        true => Vec::new(),
        false => all
            .clone()
            .filter(|&t| is_whole(linked(&mesh.triangles[t as usize])))
            .collect(),
    };
    let triangle: Cow<'_, [[u32; 3]]> = match (keeps_vertices, keeps_triangles) {
        (true, true) => Cow::Borrowed(&mesh.triangles),
        (_, true) => ids.triangles(&mesh.triangles).into(),
        (_, false) => {
            let kept = source
                .par_iter()
                .map(|&t| linked(&mesh.triangles[t as usize]));
            Cow::Owned(kept.collect())
        }
    };
    let odd = odd_points(&triangle, ids.count);
    let has_odd = odd.contains(&true);
    let is_bare = mesh.attributes == Attributes::default() && mesh.ranges.len() <= 1;
    let vertex = match keeps_vertices {
        true => Vec::new(),
        false => ids.first_vertices(),
    };
    let points = Points {
        triangle,
        source,
        vertex,
        wedge: Vec::new(),
        wedge_vertex: Vec::new(),
        normals: Normals::Kept,
        fans: !has_odd,
    };
    if is_bare && !has_odd {
        return points;
    }
    let (class, normals) = wedges::classes(mesh, &ids);
    let mut triangle = points.triangle.into_owned();
    let mut source = match keeps_triangles {
        true => all.collect(),
        false => points.source,
    };
    let mut vertex = ids.first_vertices();
    if has_odd {
        let split = Split::of(mesh, &ids, &class, &triangle, &source, &odd);
        split.apply(&mut triangle, &mut source, &mut vertex);
    }
    let (wedge, wedge_vertex) = match is_bare {
        true => Default::default(),
        false => wedges_of(mesh, &class, &triangle, &source, ids.count),
    };
    Points {
        triangle: triangle.into(),
        source,
        vertex,
        wedge,
        wedge_vertex,
        normals,
        fans: !has_odd,
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
    // The triangles at a point are a chain: its last one, and of every corner
    // of a triangle the one before.
    const NONE: u32 = u32::MAX;
    let mut last = vec![NONE; points];
    let mut before = Vec::with_capacity(triangles.len());
    for (t, triangle) in triangles.iter().enumerate() {
        let exchange = |p: u32| std::mem::replace(&mut last[p as usize], t as u32);
        before.push(triangle.map(exchange));
    }
    let is_odd = |p: usize| {
        let mut sides = SmallVec::<[(u32, u32); 12]>::new();
        let mut t = last[p];
        while t != NONE {
            let [a, b, c] = triangles[t as usize];
            let (k, side) = match p as u32 {
                p if p == a => (0, (b, c)),
                p if p == b => (1, (c, a)),
                _ => (2, (a, b)),
            };
            sides.push(side);
            t = before[t as usize][k];
        }
        !is_fan(&mut sides)
    };
    let tasks = (0..points).into_par_iter().with_min_len(TASK);
    tasks.map(is_odd).collect()
}

/// Whether these sides, opposite to a point, are one chain, open or closed.
fn is_fan(sides: &mut [(u32, u32)]) -> bool {
    // A hub is left to the sort.
    const HUB: usize = 256;
    let count = sides.len();
    let is_repeated = |i: usize| sides[..i].iter().any(|s| s.0 == sides[i].0);
    if count > HUB || (1..count).any(is_repeated) {
        return false;
    }
    let Some(&(mut begin, mut end)) = sides.first() else {
        return true;
    };
    let mut seen = 1;
    while let Some(i) = sides[seen..].iter().position(|s| s.0 == end) {
        sides.swap(seen, seen + i);
        end = sides[seen].1;
        seen += 1;
    }
    if begin == end || sides[..seen].iter().any(|s| s.0 == end) {
        return begin == end && seen == count;
    }
    while let Some(i) = sides[seen..].iter().position(|s| s.1 == begin) {
        sides.swap(seen, seen + i);
        begin = sides[seen].0;
        seen += 1;
    }
    seen == count
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

    /// Triangles that are kept, and how many points there are.
    fn summary(points: &Points) -> (Vec<u32>, usize) {
        let mut used: Vec<u32> = points.triangle.iter().flatten().copied().collect();
        used.sort_unstable();
        used.dedup();
        let all = 0..points.triangle.len() as u32;
        let source = match points.source.is_empty() {
            true => all.collect(),
            false => points.source.clone(),
        };
        (source, used.len())
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

    #[test]
    fn one_chain_is_a_fan() {
        let is_fan = |sides: &[(u32, u32)]| is_fan(&mut sides.to_vec());
        assert!(is_fan(&[]) && is_fan(&[(1, 2)]));
        // Closed; open, from the middle on.
        assert!(is_fan(&[(1, 2), (3, 1), (2, 3)]));
        assert!(is_fan(&[(2, 3), (1, 2), (3, 4), (0, 1)]));
        // Two chains; two cycles; a cycle with a tail, from either; twice.
        assert!(!is_fan(&[(1, 2), (3, 4)]));
        assert!(!is_fan(&[(1, 2), (2, 1), (3, 4), (4, 3)]));
        assert!(!is_fan(&[(1, 2), (2, 3), (3, 2)]));
        assert!(!is_fan(&[(2, 3), (3, 2), (1, 2)]));
        assert!(!is_fan(&[(1, 2), (1, 3), (2, 1)]));
        assert!(!is_fan(&[(1, 3), (2, 3), (3, 4)]));
    }
}
