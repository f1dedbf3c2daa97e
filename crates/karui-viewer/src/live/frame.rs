//! One answer, byte by byte: `docs/viewer-protocol.md`.

use glam::Vec3;

/// The first four bytes of a frame: `KRV1`.
pub const MAGIC: u32 = u32::from_le_bytes(*b"KRV1");

/// Bytes before the vertices.
pub const HEADER_BYTES: usize = 64;

/// Bit of the flags: forget all that came before.
pub const FLAG_RESET: u32 = 1;
/// Bit of the flags: all is there that was asked for.
pub const FLAG_COMPLETE: u32 = 2;
/// Bit of the flags: a budget has left something out.
pub const FLAG_TRUNCATED: u32 = 4;

/// What the slots of a frame hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Triangles of a half-edge hierarchy: three vertices each.
    HalfEdge = 1,
    /// Clusters: one number each.
    Clusters = 2,
    /// Faces of a subdivision surface: four vertices each, the last two the same in a
    /// triangle.
    Adaptive = 3,
}

/// What stands in a header beside the counts of what follows.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Header {
    pub kind: Kind,
    pub seq: u32,
    pub flags: u32,
    pub triangles: usize,
    pub microseconds: u128,
    /// Half-edge: splits and collapses; clusters: those that came and went; adaptive: faces.
    pub changes: [usize; 2],
    /// Half-edge: floor, square pixels; clusters: threshold, pixels.
    pub level: f64,
}

/// A frame on its way: vertices first, then numbers of variable length.
#[derive(Debug, Default)]
pub(crate) struct Frame {
    positions: Vec<u8>,
    normals: Vec<u8>,
    /// LEB128.
    pub(crate) body: Vec<u8>,
    vertices: u32,
    pub(super) definitions: u32,
    pub(super) runs: u32,
    pub(super) slots: u32,
}

impl Frame {
    /// A vertex that the page does not have yet.
    pub fn vertex(&mut self, position: Vec3, normal: [i16; 2]) {
        for x in position.to_array() {
            self.positions.extend_from_slice(&x.to_le_bytes());
        }
        for x in normal {
            self.normals.extend_from_slice(&x.to_le_bytes());
        }
        self.vertices += 1;
    }

    /// A number, seven bits a byte, the lowest first; the highest bit says that more follow.
    #[inline]
    pub fn number(&mut self, mut value: u32) {
        while value >= 0x80 {
            self.body.push(value as u8 | 0x80);
            value >>= 7;
        }
        self.body.push(value as u8);
    }

    /// A number as the difference from the one before, zigzag: 0, -1, 1, -2 are 0, 1, 2, 3.
    #[inline]
    pub fn step(&mut self, from: u32, to: u32) {
        let step = to.wrapping_sub(from) as i32;
        self.number(((step << 1) ^ (step >> 31)) as u32);
    }

    /// All of it. `known` is the number of vertices that the page had before.
    pub fn finish(self, header: &Header, known: u32) -> Vec<u8> {
        let micros = u32::try_from(header.microseconds).unwrap_or(u32::MAX);
        let words = [
            MAGIC,
            header.kind as u32,
            header.seq,
            header.flags,
            known,
            self.vertices,
            self.definitions,
            self.runs,
            self.slots,
            header.triangles as u32,
            micros,
            header.changes[0] as u32,
            header.changes[1] as u32,
            (header.level as f32).to_bits(),
            self.body.len() as u32,
            0,
        ];
        let mut bytes: Vec<u8> = words.iter().flat_map(|w| w.to_le_bytes()).collect();
        bytes.extend_from_slice(&self.positions);
        bytes.extend_from_slice(&self.normals);
        bytes.extend_from_slice(&self.body);
        bytes
    }
}
