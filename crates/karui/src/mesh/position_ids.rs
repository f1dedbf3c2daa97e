//! Which vertices lie at the same position.

use super::TriMesh;
use crate::error::{Error, Result};
use glam::Vec3;
use rayon::prelude::*;

/// Links the vertices that share a position, so that a UV seam is never a
/// hole. Two positions are the same if their bits are, -0 counting as 0.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct PositionIds {
    /// Position id of every vertex. Ids are numbered by first appearance, so
    /// `of_vertex[v] <= v`.
    pub of_vertex: Vec<u32>,
    /// Number of distinct positions.
    pub count: usize,
}

impl PositionIds {
    /// Links `positions`; at most `u32::MAX` of them. Takes time proportional
    /// to their number.
    #[must_use]
    pub fn of(positions: &[Vec3]) -> Self {
        let keys: Vec<Key> = positions.par_iter().map(|&p| key(p)).collect();
        numbered(&first_equal(&keys))
    }

    /// Links the vertices of `mesh` by position.
    #[must_use]
    pub fn of_mesh(mesh: &TriMesh) -> Self {
        Self::of(&mesh.positions)
    }

    /// Every vertex its own position, for work on vertex ids.
    #[must_use]
    pub fn distinct(vertices: usize) -> Self {
        Self {
            of_vertex: (0..vertices as u32).collect(),
            count: vertices,
        }
    }

    /// Checks that these ids have one entry per vertex of `mesh`, all below
    /// `count`, and that every triangle's vertices exist.
    ///
    /// # Errors
    /// [`Error::LengthMismatch`], [`Error::Broken`] or
    /// [`Error::IndexOutOfRange`].
    pub fn validate_for(&self, mesh: &TriMesh) -> Result<()> {
        let (expected, found) = (mesh.positions.len(), self.of_vertex.len());
        if expected != found {
            let what = "position ids".into();
            return Err(Error::LengthMismatch {
                what,
                expected,
                found,
            });
        }
        if self.count > found {
            let rule = "there are no more position ids than vertices";
            return Err(Error::Broken {
                rule,
                index: self.count,
            });
        }
        let is_bad = |&id: &u32| id as usize >= self.count;
        if let Some(index) = self.of_vertex.par_iter().position_first(is_bad) {
            let rule = "position ids lie below their count";
            return Err(Error::Broken { rule, index });
        }
        mesh.validate_indices()
    }

    /// `triangles` with every vertex replaced by its position id. Every vertex
    /// must exist.
    #[must_use]
    pub fn triangles(&self, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
        let linked = |t: &[u32; 3]| t.map(|v| self.of_vertex[v as usize]);
        triangles.par_iter().map(linked).collect()
    }

    /// The first vertex at every position.
    #[must_use]
    pub fn first_vertices(&self) -> Vec<u32> {
        let mut first = Vec::with_capacity(self.count);
        for (v, &id) in self.of_vertex.iter().enumerate() {
            if id as usize == first.len() {
                first.push(v as u32);
            }
        }
        first
    }

    /// The vertices of every position: those of `p` are
    /// `vertices[starts[p]..starts[p + 1]]`, in increasing order.
    #[must_use]
    pub fn groups(&self) -> (Vec<u32>, Vec<u32>) {
        let mut starts = vec![0u32; self.count + 1];
        for &id in &self.of_vertex {
            starts[id as usize + 1] += 1;
        }
        for p in 0..self.count {
            starts[p + 1] += starts[p];
        }
        let mut next = starts.clone();
        let mut vertices = vec![0; self.of_vertex.len()];
        for (v, &id) in self.of_vertex.iter().enumerate() {
            vertices[next[id as usize] as usize] = v as u32;
            next[id as usize] += 1;
        }
        (starts, vertices)
    }
}

type Key = [u32; 3];

fn key(p: Vec3) -> Key {
    // Adding zero turns -0 into 0 and changes nothing else.
    p.to_array().map(|x| (x + 0.0).to_bits())
}

fn hash([x, y, z]: Key) -> u64 {
    let folded = (u64::from(x) | u64::from(y) << 32).wrapping_mul(0x9e37_79b9_7f4a_7c15)
        ^ u64::from(z).wrapping_mul(0xc2b2_ae3d_27d4_eb4f);
    let mixed = (folded ^ folded >> 32).wrapping_mul(0xd6e8_feb8_6659_fd93);
    mixed ^ mixed >> 32
}

/// For every key the index of the first one equal to it. The keys are dealt
/// to shards by their hash; each shard then fits a table in the cache.
fn first_equal(keys: &[Key]) -> Vec<u32> {
    let bits = (keys.len() / 8192).max(1).ilog2().min(12);
    let shard_of = |k: &Key| (hash(*k) >> 48) as usize & ((1 << bits) - 1);
    let mut starts = vec![0usize; (1 << bits) + 1];
    for k in keys {
        starts[shard_of(k) + 1] += 1;
    }
    for s in 0..1 << bits {
        starts[s + 1] += starts[s];
    }
    let mut next = starts.clone();
    let mut order = vec![0u32; keys.len()];
    for (i, k) in keys.iter().enumerate() {
        let place = &mut next[shard_of(k)];
        order[*place] = i as u32;
        *place += 1;
    }
    let found: Vec<Vec<u32>> = starts
        .par_windows(2)
        .map(|range| first_in_shard(keys, &order[range[0]..range[1]]))
        .collect();
    let mut first = vec![0; keys.len()];
    for (&i, f) in order.iter().zip(found.into_iter().flatten()) {
        first[i as usize] = f;
    }
    first
}

/// Open addressing with linear probing; `members` come in increasing order.
fn first_in_shard(keys: &[Key], members: &[u32]) -> Vec<u32> {
    const FREE: u32 = u32::MAX;
    let mask = (members.len() * 2).next_power_of_two() - 1;
    let mut table = vec![FREE; mask + 1];
    let find = |&i: &u32| {
        let key = keys[i as usize];
        let mut slot = hash(key) as usize & mask;
        while table[slot] != FREE && keys[table[slot] as usize] != key {
            slot = (slot + 1) & mask;
        }
        if table[slot] == FREE {
            table[slot] = i;
        }
        table[slot]
    };
    members.iter().map(find).collect()
}

fn numbered(first: &[u32]) -> PositionIds {
    let mut ids = PositionIds {
        of_vertex: Vec::with_capacity(first.len()),
        count: 0,
    };
    for (v, &f) in first.iter().enumerate() {
        let id = if f as usize == v {
            ids.count += 1;
            ids.count as u32 - 1
        } else {
            ids.of_vertex[f as usize]
        };
        ids.of_vertex.push(id);
    }
    ids
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes;
    use proptest::prelude::*;
    use std::collections::BTreeMap;

    /// The definition, by an ordered map.
    fn plain(positions: &[Vec3]) -> PositionIds {
        let mut ids = BTreeMap::new();
        let of_vertex = positions.iter().map(|p| {
            let next = ids.len() as u32;
            *ids.entry(p.to_array().map(|x| if x == 0.0 { 0 } else { x.to_bits() }))
                .or_insert(next)
        });
        let of_vertex = of_vertex.collect();
        PositionIds {
            of_vertex,
            count: ids.len(),
        }
    }

    #[test]
    fn zero_has_one_sign_and_ids_follow_first_appearance() {
        let ids = PositionIds::of(&[Vec3::X, Vec3::ZERO, Vec3::X, -Vec3::ZERO, Vec3::Y]);
        assert_eq!(ids.of_vertex, [0, 1, 0, 1, 2]);
        assert_eq!(ids.count, 3);
        assert_eq!(ids.first_vertices(), [0, 1, 4]);
        assert_eq!(ids.groups(), (vec![0, 2, 4, 5], vec![0, 2, 1, 3, 4]));
    }

    #[test]
    fn foreign_ids_are_errors() {
        let mesh = shapes::triangle();
        let ids = |of_vertex: &[u32], count| PositionIds {
            of_vertex: of_vertex.to_vec(),
            count,
        };
        ids(&[0, 1, 1], 2).validate_for(&mesh).unwrap();
        for (of_vertex, count) in [(&[0, 1][..], 2), (&[0, 1, 2], 2), (&[0, 1, 2], usize::MAX)] {
            assert!(ids(of_vertex, count).validate_for(&mesh).is_err());
        }
    }

    #[test]
    fn seams_of_the_zoo_close() {
        let count = |mesh: &TriMesh| PositionIds::of_mesh(mesh).count;
        assert_eq!(count(&shapes::cube(1)), 8);
        assert_eq!(
            count(&shapes::cube(5)),
            shapes::closed_cube(5).positions.len()
        );
        assert_eq!(
            count(&shapes::textured_sphere(9, 13)),
            shapes::uv_sphere(9, 13).positions.len()
        );
        assert_eq!(count(&shapes::empty()), 0);
    }

    #[test]
    fn many_shards_agree_with_the_definition() {
        let some = |i: u32| (i.wrapping_mul(2_654_435_761) >> 20) as f32 * 0.25 - 100.0;
        let positions: Vec<Vec3> = (0..200_000)
            .map(|i| Vec3::new(some(i / 2), some(i / 3), some(i / 700)))
            .collect();
        let ids = PositionIds::of(&positions);
        assert_eq!(ids, plain(&positions));
        assert!(ids.count < positions.len());
    }

    proptest! {
        #[test]
        fn agrees_with_the_definition(raw in prop::collection::vec([-2i8..3, -2i8..3, -2i8..3], 0..300)) {
            let positions: Vec<Vec3> = raw.iter()
                .map(|&[x, y, z]| Vec3::new(f32::from(x) * -0.5, f32::from(y) / 3.0, f32::from(z) * -0.0))
                .collect();
            prop_assert_eq!(PositionIds::of(&positions), plain(&positions));
        }
    }
}
