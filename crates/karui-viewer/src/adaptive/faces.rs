//! Faces that come and go, told as slots: what stays is found by what it is.

use crate::live::{Frame, Slots, octahedral};
use glam::Vec3;
use karui::PolyMesh;
use std::collections::HashMap;

/// A vertex by its bits: position, then normal as it is sent.
type Bits = [u32; 4];

/// Four vertices; the last two the same in a triangle.
type Face = [u32; 4];

/// Vertices that a page keeps at most before it starts anew.
const MOST_VERTICES: usize = 4_000_000;

/// What a page has of a mesh that is another in every frame.
#[derive(Debug, Clone)]
pub(super) struct Faces {
    vertices: HashMap<Bits, u32>,
    drawn: Vec<Face>,
    /// Where each is drawn.
    place: HashMap<Face, u32>,
    slots: Slots<4>,
}

impl Faces {
    pub fn new() -> Self {
        Self {
            vertices: HashMap::new(),
            drawn: Vec::new(),
            place: HashMap::new(),
            slots: Slots::new(),
        }
    }

    /// Vertices that have been sent.
    pub fn sent(&self) -> u32 {
        self.vertices.len() as u32
    }

    /// Whether the page has so much that it had better start anew.
    pub fn is_full(&self) -> bool {
        self.vertices.len() > MOST_VERTICES
    }

    /// Writes what has to change for the page to have this mesh, which has normals.
    pub fn update(&mut self, mesh: &PolyMesh, frame: &mut Frame) {
        let faces = self.numbered(mesh, frame);
        let (stays, pending) = self.compare(&faces);
        self.settle(&stays, pending);
        let mut runs = self.slots.resize(self.drawn.len());
        for (at, face) in self.drawn.iter().enumerate() {
            runs.set(at, *face);
        }
        runs.write(frame);
    }

    /// The faces in quads and triangles over the page's vertices.
    fn numbered(&mut self, mesh: &PolyMesh, frame: &mut Frame) -> Vec<Face> {
        let normals = mesh.attributes.normals.as_deref().unwrap_or_default();
        let number = |v: usize| {
            let normal = normals.get(v).copied().unwrap_or(Vec3::Z);
            self.number(mesh.positions[v], normal, frame)
        };
        let numbers: Vec<u32> = (0..mesh.positions.len()).map(number).collect();
        let mut faces = Vec::with_capacity(mesh.face_count());
        for corners in mesh.offsets.windows(2) {
            let corners = &mesh.indices[corners[0] as usize..corners[1] as usize];
            let at = |i: usize| numbers[corners[i.min(corners.len() - 1)] as usize];
            let fans = (1..corners.len().saturating_sub(1)).step_by(2);
            faces.extend(fans.map(|i| [at(0), at(i), at(i + 1), at(i + 2)]));
        }
        faces
    }

    fn number(&mut self, position: Vec3, normal: Vec3, frame: &mut Frame) -> u32 {
        let folded = octahedral(normal);
        let [x, y, z] = position.to_array().map(f32::to_bits);
        let [a, b] = folded.map(|v| u32::from(v as u16));
        let next = self.vertices.len() as u32;
        *self
            .vertices
            .entry([x, y, z, a << 16 | b])
            .or_insert_with(|| {
                frame.vertex(position, folded);
                next
            })
    }

    /// Which slots stay as they are, and the faces that have none.
    fn compare(&self, faces: &[Face]) -> (Vec<bool>, Vec<Face>) {
        let mut stays = vec![false; self.drawn.len()];
        let mut pending = Vec::new();
        for face in faces {
            match self.place.get(face).map(|&at| &mut stays[at as usize]) {
                Some(stays) if !*stays => *stays = true,
                _ => pending.push(*face),
            }
        }
        (stays, pending)
    }

    /// New faces where old ones were; the last ones close what gaps are left.
    fn settle(&mut self, stays: &[bool], pending: Vec<Face>) {
        let free: Vec<usize> = (0..stays.len()).filter(|&at| !stays[at]).collect();
        for &at in &free {
            self.place.remove(&self.drawn[at]);
        }
        let reused = free.len().min(pending.len());
        for (&at, &face) in free.iter().zip(&pending) {
            self.drawn[at] = face;
            self.place.insert(face, at as u32);
        }
        for &face in &pending[reused..] {
            self.place.insert(face, self.drawn.len() as u32);
            self.drawn.push(face);
        }
        for &at in free[reused..].iter().rev() {
            self.drawn.swap_remove(at);
            if let Some(&moved) = self.drawn.get(at) {
                self.place.insert(moved, at as u32);
            }
        }
    }
}
