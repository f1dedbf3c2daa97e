//! The mesh of what has been split, in an order that does not depend on what was made when.

use super::mesh::AdaptiveMesh;
use super::store::{NONE, Store};
use super::values::{Place, Skin, Values};
use rayon::prelude::*;

/// Parts that the cage's faces are drawn in, each by one thread.
const PARTS: usize = 32;

/// Memory of drawing, for the next frame.
#[derive(Debug, Clone, Default)]
pub(super) struct Drawing {
    parts: Vec<Part>,
    /// Wedges that have become vertices.
    pub wedges: Vec<u32>,
    /// Of every point, the frame in which a vertex was first at it, and that.
    firsts: Vec<[u32; 2]>,
    /// Of every vertex the corner of the deepest tier that it was drawn at, its number in
    /// texture coordinates, and the next vertex of its wedge; only if that is going to matter.
    places: Vec<Place>,
    texels: Vec<u32>,
    others: Vec<u32>,
}

/// Faces in order: their sizes, the cage's faces they are of, their depths, and of every
/// corner its wedge and, if that is going to matter, its place.
#[derive(Debug, Clone, Default)]
struct Part {
    sizes: Vec<u32>,
    bases: Vec<u32>,
    depths: Vec<u8>,
    wedges: Vec<u32>,
    places: Vec<Place>,
}

impl Drawing {
    pub fn draw(
        &mut self,
        (store, skin): (&mut Store, &mut Skin),
        frame: u32,
        limit: bool,
        to: &mut AdaptiveMesh,
    ) {
        let faces = store.tiers[0].faces.len() as u32;
        let size = faces.div_ceil(PARTS as u32);
        self.parts.resize_with(PARTS, Part::default);
        let shared = &*store;
        self.parts.par_iter_mut().enumerate().for_each(|(i, part)| {
            part.clear();
            let mut pen = Pen {
                store: shared,
                frame,
                places: !limit || !skin.is_plain(),
                part,
            };
            let first = i as u32 * size;
            for face in first..(first + size).min(faces) {
                if !shared.is_hole(0, face) {
                    pen.face(0, face, face);
                }
            }
        });
        to.clear();
        match &mut skin.uvs {
            Some(uvs) => self.join_at_seams((store, uvs), frame, to),
            None => self.join(store, frame, to),
        }
        if !limit {
            self.deepen_points(store, frame);
        }
        self.number_points(store, frame, to);
        self.place_vertices(store, limit, to);
        if !skin.is_plain() {
            self.find_places(to);
        }
        skin.put_on(store, (&self.places, &to.parents), limit, &mut to.mesh);
    }

    /// Puts the parts one after the other; vertices are numbered as they come.
    fn join(&mut self, store: &mut Store, frame: u32, to: &mut AdaptiveMesh) {
        self.wedges.clear();
        store.drawn.resize(store.wedges.len(), [0; 2]);
        for part in &self.parts {
            for &wedge in &part.wedges {
                let drawn = &mut store.drawn[wedge as usize];
                if drawn[0] != frame {
                    *drawn = [frame, self.wedges.len() as u32];
                    self.wedges.push(wedge);
                }
                to.mesh.indices.push(drawn[1]);
            }
            part.push_faces(to);
        }
    }

    /// The same, a wedge being as many vertices as it has texture coordinates.
    fn join_at_seams(
        &mut self,
        (store, uvs): (&mut Store, &mut Values),
        frame: u32,
        to: &mut AdaptiveMesh,
    ) {
        self.wedges.clear();
        self.texels.clear();
        self.others.clear();
        store.drawn.resize(store.wedges.len(), [0; 2]);
        for part in &self.parts {
            for (&wedge, &place) in part.wedges.iter().zip(&part.places) {
                let texel = uvs.point(store, place);
                let [drawn, first] = store.drawn[wedge as usize];
                let mut vertex = if drawn == frame { first } else { NONE };
                while vertex != NONE && self.texels[vertex as usize] != texel {
                    vertex = self.others[vertex as usize];
                }
                if vertex == NONE {
                    vertex = self.wedges.len() as u32;
                    self.wedges.push(wedge);
                    self.texels.push(texel);
                    self.others.push(if drawn == frame { first } else { NONE });
                    store.drawn[wedge as usize] = [frame, vertex];
                }
                to.mesh.indices.push(vertex);
            }
            part.push_faces(to);
        }
    }

    /// Finds the deepest tier that every point was drawn in.
    fn deepen_points(&self, store: &mut Store, frame: u32) {
        for part in &self.parts {
            for (&wedge, &[t, corner]) in part.wedges.iter().zip(&part.places) {
                let v = store.tiers[t as usize].corners[corner as usize];
                let point = &mut store.points[store.wedges[wedge as usize].point as usize];
                if point.frame != frame || point.place[0] < t {
                    (point.frame, point.place) = (frame, [t, v]);
                }
            }
        }
    }

    /// Finds the place in the deepest tier of every vertex.
    fn find_places(&mut self, mesh: &AdaptiveMesh) {
        self.places.clear();
        self.places.resize(self.wedges.len(), [0, NONE]);
        let places = self.parts.iter().flat_map(|part| &part.places);
        for (&vertex, &place) in mesh.mesh.indices.iter().zip(places) {
            let to = &mut self.places[vertex as usize];
            if to[1] == NONE || to[0] < place[0] {
                *to = place;
            }
        }
    }

    /// Numbers points, so that what was made when does not show.
    fn number_points(&mut self, store: &Store, frame: u32, to: &mut AdaptiveMesh) {
        self.firsts.resize(store.points.len(), [0; 2]);
        let cage = store.tiers[0].vertices.len() as u32;
        for (v, &wedge) in (0..).zip(&self.wedges) {
            let point = store.wedges[wedge as usize].point;
            let first = &mut self.firsts[point as usize];
            if first[0] != frame {
                *first = [frame, if point < cage { point } else { cage + v }];
            }
            to.points.push(first[1]);
        }
    }

    fn place_vertices(&self, store: &mut Store, limit: bool, to: &mut AdaptiveMesh) {
        let shared = &*store;
        let wedges = self.wedges.par_iter().with_min_len(4096);
        let wedges = wedges.map(|&wedge| &shared.wedges[wedge as usize]);
        let normals = to.mesh.attributes.normals.get_or_insert_default();
        wedges.clone().map(|w| w.normal).collect_into_vec(normals);
        wedges
            .map(|w| w.limit)
            .collect_into_vec(&mut to.mesh.positions);
        if limit {
            return;
        }
        for (position, &wedge) in to.mesh.positions.iter_mut().zip(&self.wedges) {
            let point = store.wedges[wedge as usize].point;
            let [t, v] = store.points[point as usize].place;
            *position = store.position(t as usize, v).as_vec3();
        }
    }
}

impl Part {
    fn push_faces(&self, to: &mut AdaptiveMesh) {
        for &size in &self.sizes {
            let end = to.mesh.offsets[to.mesh.offsets.len() - 1] + size;
            to.mesh.offsets.push(end);
        }
        to.parents.extend_from_slice(&self.bases);
        to.depths.extend_from_slice(&self.depths);
    }

    fn clear(&mut self) {
        self.sizes.clear();
        self.bases.clear();
        self.depths.clear();
        self.wedges.clear();
        self.places.clear();
    }
}

/// Draws faces into a part.
struct Pen<'a> {
    store: &'a Store,
    frame: u32,
    places: bool,
    part: &'a mut Part,
}

impl Pen<'_> {
    fn face(&mut self, t: usize, face: u32, base: u32) {
        let tier = &self.store.tiers[t];
        let corners = tier.corners_of(face);
        if !tier.face_stamps[face as usize].is_split(self.frame) {
            return self.push(t, corners, base, 2 * t);
        }
        for c in corners.clone() {
            let e = tier.corner_edges[c as usize];
            if !self.store.is_split(t, e, self.frame) {
                self.diamond(t, c, e, base);
            }
        }
        for c in corners {
            self.child(t, c, base);
        }
    }

    /// The diamond over the edge after a corner, or this side of it.
    fn diamond(&mut self, t: usize, corner: u32, e: u32, base: u32) {
        let [a, b, center] = self.store.half(t, corner);
        if !self.store.is_merged(t, e, self.frame) {
            return self.push(t + 1, [a, b, center], base, 2 * t + 1);
        }
        // It is drawn once, from the place that comes first.
        let sides = self.store.known_sides(t, e);
        if sides[0] == corner {
            let across = self.store.half(t, sides[1])[2];
            self.push(t + 1, [a, across, b, center], base, 2 * t + 1);
        }
    }

    /// The child at a corner, if both diamonds beside it have been split, or the half of it
    /// that has.
    fn child(&mut self, t: usize, corner: u32, base: u32) {
        let split = |e: u32| self.store.is_split(t, e, self.frame);
        let [before, after] = self.store.beside(t, corner).map(split);
        let child = self.store.tiers[t].child(corner);
        let half = match [before, after] {
            [true, true] => return self.face(t + 1, child, base),
            [true, false] => [0, 2, 3],
            [false, true] => [0, 1, 2],
            [false, false] => return,
        };
        self.push(t + 1, half.map(|i| 4 * child + i), base, 2 * t + 2);
    }

    fn push(&mut self, t: usize, corners: impl IntoIterator<Item = u32>, base: u32, depth: usize) {
        let before = self.part.wedges.len();
        for corner in corners {
            self.part.wedges.push(self.store.known_wedge(t, corner));
            if self.places {
                self.part.places.push([t as u32, corner]);
            }
        }
        self.part
            .sizes
            .push((self.part.wedges.len() - before) as u32);
        self.part.bases.push(base);
        self.part.depths.push(depth as u8);
    }
}
