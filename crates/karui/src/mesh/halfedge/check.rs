//! The invariants of half-edges, for tests and after mutations.

use super::{FaceId, Halfedge, HalfedgeId, NONE, VertexId};
use crate::error::{Error, Result};

impl Halfedge {
    /// Checks every invariant by its definition.
    ///
    /// # Errors
    /// [`Error::Broken`] with the first rule that does not hold.
    pub fn validate(&self) -> Result<()> {
        self.validate_lengths()?;
        (0..self.origin.len()).try_for_each(|h| self.validate_half(h))?;
        (0..self.of_face.len()).try_for_each(|f| self.validate_face(f))?;
        self.validate_loops()?;
        self.validate_vertices()
    }

    fn validate_lengths(&self) -> Result<()> {
        let halves = self.origin.len();
        ensure(halves.is_multiple_of(2), "halves come in pairs", halves)?;
        for array in [&self.next, &self.prev, &self.face] {
            ensure(array.len() == halves, "one entry a half-edge", array.len())?;
        }
        let below = |values: &[u32], n: usize| values.iter().position(|&x| x as usize >= n);
        let below_or_none =
            |values: &[u32], n: usize| values.iter().position(|&x| x != NONE && x as usize >= n);
        let wrong = [
            below(&self.origin, self.of_vertex.len()),
            below(&self.next, halves),
            below(&self.prev, halves),
            below_or_none(&self.face, self.of_face.len()),
            below_or_none(&self.of_vertex, halves),
            below(&self.of_face, halves),
        ];
        let first = wrong.into_iter().flatten().next();
        ensure(
            first.is_none(),
            "every id names an element",
            first.unwrap_or_default(),
        )
    }

    fn validate_half(&self, h: usize) -> Result<()> {
        let id = HalfedgeId(h as u32);
        let (next, prev) = (self.next(id), self.prev(id));
        ensure(self.prev(next) == id, "prev undoes next", h)?;
        ensure(self.next(prev) == id, "next undoes prev", h)?;
        ensure(
            self.origin(next) == self.target(id),
            "next starts where this ends",
            h,
        )?;
        ensure(
            self.face(next) == self.face(id),
            "next has the same face",
            h,
        )?;
        ensure(self.origin(id) != self.target(id), "ends differ", h)?;
        let both_open = self.is_boundary(id) && self.is_boundary(self.twin(id));
        ensure(!both_open, "an edge has a face", h)?;
        let anchored = self.halfedge_of_vertex(self.origin(id)).is_some();
        ensure(anchored, "the origin knows a half-edge", h)
    }

    fn validate_face(&self, f: usize) -> Result<()> {
        let id = FaceId(f as u32);
        let first = self.halfedge_of_face(id);
        ensure(
            self.face(first) == Some(id),
            "a face's half-edge is its own",
            f,
        )?;
        ensure(
            self.loop_from(first).nth(2).is_some(),
            "a face has three corners",
            f,
        )
    }

    /// Every half-edge with a face is met by that face's loop.
    fn validate_loops(&self) -> Result<()> {
        let mut met = vec![false; self.origin.len()];
        for f in 0..self.of_face.len() {
            for h in self.loop_from(self.halfedge_of_face(FaceId(f as u32))) {
                met[h.0 as usize] = true;
            }
        }
        let stray = (0..met.len()).find(|&h| !met[h] && self.face[h] != NONE);
        ensure(
            stray.is_none(),
            "a face is one loop",
            stray.unwrap_or_default(),
        )
    }

    /// Every half-edge is met by the ring of its origin.
    fn validate_vertices(&self) -> Result<()> {
        let mut met = vec![false; self.origin.len()];
        for v in 0..self.of_vertex.len() {
            let id = VertexId(v as u32);
            for (i, h) in self.ring(id).enumerate() {
                ensure(self.origin(h) == id, "a ring leaves its vertex", v)?;
                let open_inside = i > 0 && self.is_boundary(h);
                ensure(!open_inside, "a ring starts at the boundary", v)?;
                met[h.0 as usize] = true;
            }
        }
        let stray = met.iter().position(|m| !m);
        ensure(
            stray.is_none(),
            "faces around a vertex form one fan",
            stray.unwrap_or_default(),
        )
    }
}

fn ensure(holds: bool, rule: &'static str, index: usize) -> Result<()> {
    if holds {
        return Ok(());
    }
    Err(Error::Broken { rule, index })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes;

    #[test]
    fn every_kind_of_damage_is_found() {
        type Damage = fn(&mut Halfedge);
        let damages: [(&str, Damage); 10] = [
            ("halves come in pairs", |t| drop(t.origin.split_off(1))),
            ("one entry a half-edge", |t| t.prev.clear()),
            ("every id names an element", |t| t.next[3] = 9999),
            ("prev undoes next", |t| t.next.swap(0, 5)),
            ("next starts where this ends", |t| {
                t.origin[2] = t.origin[2].wrapping_add(1) % 35
            }),
            ("next has the same face", |t| {
                t.face[0] = (t.face[0] + 1) % 48
            }),
            ("the origin knows a half-edge", |t| t.of_vertex[0] = NONE),
            ("a face's half-edge is its own", |t| t.of_face.swap(0, 1)),
            ("a ring leaves its vertex", |t| t.of_vertex.swap(0, 1)),
            ("a ring starts at the boundary", |t| {
                let inner = t.ring(VertexId(0)).nth(1);
                t.of_vertex[0] = inner.map_or(NONE, |h| h.0);
            }),
        ];
        let mesh = shapes::grid(6, 4);
        let sound = Halfedge::new(&mesh.triangles, mesh.positions.len()).unwrap();
        sound.validate().unwrap();
        for (expected, damage) in damages {
            let mut damaged = sound.clone();
            damage(&mut damaged);
            match damaged.validate() {
                Err(Error::Broken { rule, .. }) => assert_eq!(rule, expected),
                other => panic!("{expected}: {other:?}"),
            }
        }
    }
}
