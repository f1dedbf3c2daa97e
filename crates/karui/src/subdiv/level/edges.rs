//! Edges from faces.

use super::Faces;
use std::collections::HashMap;
use std::collections::hash_map::Entry;

pub(in crate::subdiv) struct Found {
    pub edges: Vec<[u32; 2]>,
    pub corner_edges: Vec<u32>,
    /// Whether an edge is of more than two faces, of two that run through it in the same
    /// sense, twice of one, or from a vertex to itself.
    pub odd: Vec<bool>,
}

/// What is known of an edge while faces are read.
struct Seen {
    edge: u32,
    faces: u32,
    last: u32,
}

/// Numbers the edges by first appearance. An edge from a vertex to itself and one that its
/// face has already are new ones.
pub(in crate::subdiv) fn of_faces(faces: &Faces, corners: &[u32]) -> Found {
    let mut found = Found {
        edges: Vec::with_capacity(corners.len() / 2),
        corner_edges: Vec::with_capacity(corners.len()),
        odd: Vec::new(),
    };
    let mut seen: HashMap<[u32; 2], Seen> = HashMap::with_capacity(corners.len() / 2);
    for face in 0..faces.count() {
        let face_corners = &corners[faces.corners(face)];
        for (i, &a) in face_corners.iter().enumerate() {
            let b = face_corners[(i + 1) % face_corners.len()];
            let edge = if a == b {
                found.push([a, b], true)
            } else {
                found.find(&mut seen, face as u32, [a, b])
            };
            found.corner_edges.push(edge);
        }
    }
    found
}

impl Found {
    fn push(&mut self, ends: [u32; 2], odd: bool) -> u32 {
        self.edges.push(ends);
        self.odd.push(odd);
        self.edges.len() as u32 - 1
    }

    fn find(&mut self, seen: &mut HashMap<[u32; 2], Seen>, face: u32, ends: [u32; 2]) -> u32 {
        let key = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        match seen.entry(key) {
            Entry::Vacant(entry) => {
                let edge = self.push(ends, false);
                let (faces, last) = (1, face);
                entry.insert(Seen { edge, faces, last });
                edge
            }
            Entry::Occupied(mut entry) => {
                let known = entry.get_mut();
                let edge = known.edge as usize;
                if known.last == face {
                    self.odd[edge] = true;
                    return self.push(ends, true);
                }
                self.odd[edge] |= known.faces > 1 || self.edges[edge] == ends;
                known.faces += 1;
                known.last = face;
                known.edge
            }
        }
    }
}
