//! Modes TRIANGLES and INDICES: vertex indices by what was used shortly
//! before.

use super::{Bytes, push_varint, version};
use crate::error::ErrorKind;

const TRIANGLES: u8 = 0xe0;
const SEQUENCE: u8 = 0xd0;
/// Entries of the table of frequent codes at the end of a triangle stream.
const TABLE: usize = 16;
/// The table this encoder writes, the one of the reference implementation.
const CODES: [u8; TABLE] = [
    0x00, 0x76, 0x87, 0x56, 0x67, 0x78, 0xa9, 0x86, 0x65, 0x89, 0x68, 0x98, 0x01, 0x69, 0, 0,
];

/// The last 16 edges and vertices, and the next index that was not used yet.
struct State {
    edges: [[u32; 2]; 16],
    edge: usize,
    vertices: [u32; 16],
    vertex: usize,
    next: u32,
    last: u32,
}

impl State {
    fn new() -> Self {
        Self {
            edges: [[u32::MAX; 2]; 16],
            edge: 0,
            vertices: [u32::MAX; 16],
            vertex: 0,
            next: 0,
            last: 0,
        }
    }

    fn push_edge(&mut self, a: u32, b: u32) {
        self.edges[self.edge] = [a, b];
        self.edge = (self.edge + 1) % 16;
    }

    fn push_vertex(&mut self, v: u32) {
        self.vertices[self.vertex] = v;
        self.vertex = (self.vertex + 1) % 16;
    }

    /// The edge pushed `back` edges before the last.
    fn edge_back(&self, back: usize) -> [u32; 2] {
        self.edges[(self.edge + 31 - back) % 16]
    }

    /// The vertex pushed `back` vertices before the last.
    fn vertex_back(&self, back: usize) -> u32 {
        self.vertices[(self.vertex + 31 - back) % 16]
    }

    fn take_next(&mut self) -> u32 {
        let next = self.next;
        self.next = next.wrapping_add(1);
        next
    }

    /// A difference to the last index that was written out in full.
    fn read_index(&mut self, data: &mut Bytes<'_>) -> Result<u32, ErrorKind> {
        self.last = self.last.wrapping_add(unzigzag(data.varint()?));
        Ok(self.last)
    }

    fn write_index(&mut self, data: &mut Vec<u8>, index: u32) {
        push_varint(data, zigzag(index.wrapping_sub(self.last)));
        self.last = index;
    }

    /// An index by its code: 0 the next new one, 15 in full, otherwise the
    /// vertex used `code - 1` vertices ago.
    fn by_code(&mut self, code: u8, data: &mut Bytes<'_>) -> Result<u32, ErrorKind> {
        match code {
            0 => Ok(self.take_next()),
            15 => self.read_index(data),
            back => Ok(self.vertex_back(usize::from(back) - 1)),
        }
    }
}

fn zigzag(d: u32) -> u32 {
    (d << 1) ^ (((d as i32) >> 31) as u32)
}

fn unzigzag(v: u32) -> u32 {
    (v >> 1) ^ (v & 1).wrapping_neg()
}

/// Decodes `count` indices of whole triangles.
pub(super) fn decode_triangles(bytes: &[u8], count: usize) -> Result<Vec<u32>, ErrorKind> {
    let mut data = Bytes { rest: bytes };
    let version = version(&mut data, TRIANGLES, 1)?;
    let codes = data.take(count / 3)?;
    let Some(split) = data.rest.len().checked_sub(TABLE) else {
        let found = data.rest.len().to_string();
        return Err(ErrorKind::truncated("a table of 16 codes", found));
    };
    let (body, table) = data.rest.split_at(split);
    let mut data = Bytes { rest: body };
    let mut state = State::new();
    // One byte of `codes` is there for each triangle.
    let mut indices = Vec::with_capacity(count);
    for &code in codes {
        let triangle = if code < 0xf0 {
            decode_on_edge(&mut state, code, &mut data, version)?
        } else {
            decode_alone(&mut state, code, table, &mut data)?
        };
        indices.extend(triangle);
    }
    expect_end(&data)?;
    Ok(indices)
}

fn expect_end(data: &Bytes<'_>) -> Result<(), ErrorKind> {
    if data.rest.is_empty() {
        return Ok(());
    }
    let found = format!("{} more bytes", data.rest.len());
    Err(ErrorKind::syntax("the end of the compressed data", found))
}

/// A triangle on one of the last edges, by the third vertex.
fn decode_on_edge(
    state: &mut State,
    code: u8,
    data: &mut Bytes<'_>,
    version: u8,
) -> Result<[u32; 3], ErrorKind> {
    let [a, b] = state.edge_back(usize::from(code >> 4));
    let third = code & 15;
    let c = match third {
        13 | 14 if version > 0 => {
            let step = if third == 13 { u32::MAX } else { 1 };
            state.last = state.last.wrapping_add(step);
            state.last
        }
        0 => state.take_next(),
        15 => state.read_index(data)?,
        back => state.vertex_back(usize::from(back)),
    };
    if third == 0 || third >= last_codes(version) {
        state.push_vertex(c);
    }
    state.push_edge(c, b);
    state.push_edge(a, c);
    Ok([a, b, c])
}

/// The first code of a third vertex that does not stand for a recent one.
fn last_codes(version: u8) -> u8 {
    if version > 0 { 13 } else { 15 }
}

/// A triangle that shares no edge with the last ones.
fn decode_alone(
    state: &mut State,
    code: u8,
    table: &[u8],
    data: &mut Bytes<'_>,
) -> Result<[u32; 3], ErrorKind> {
    let in_table = code < 0xfe;
    let pair = if in_table {
        table[usize::from(code & 15)]
    } else {
        data.byte()?
    };
    if !in_table && pair == 0 {
        state.next = 0;
    }
    let codes = [if code == 0xff { 15 } else { 0 }, pair >> 4, pair & 15];
    let [a, b, c] = by_codes(state, codes, data)?;
    for (v, code) in [(a, 0), (b, codes[1]), (c, codes[2])] {
        if code == 0 || code == 15 {
            state.push_vertex(v);
        }
    }
    state.push_edge(b, a);
    state.push_edge(c, b);
    state.push_edge(a, c);
    Ok([a, b, c])
}

/// New indices are counted before those in full are read, as the encoder does;
/// the order matters only between indices of one kind.
fn by_codes(
    state: &mut State,
    codes: [u8; 3],
    data: &mut Bytes<'_>,
) -> Result<[u32; 3], ErrorKind> {
    let mut triangle = [0; 3];
    for (index, code) in triangle.iter_mut().zip(codes) {
        *index = state.by_code(code, data)?;
    }
    Ok(triangle)
}

/// Decodes any list of `count` indices.
pub(super) fn decode_sequence(bytes: &[u8], count: usize) -> Result<Vec<u32>, ErrorKind> {
    let mut data = Bytes { rest: bytes };
    version(&mut data, SEQUENCE, 1)?;
    let mut last = [0u32; 2];
    let mut indices = Vec::new();
    for _ in 0..count {
        let v = data.varint()?;
        let last = &mut last[(v & 1) as usize];
        *last = last.wrapping_add(unzigzag(v >> 1));
        indices.push(*last);
    }
    // Four bytes of padding that old decoders read beyond the end.
    data.take(4)?;
    expect_end(&data)?;
    Ok(indices)
}

/// Encodes any list of indices below 2^29.
pub(in super::super) fn encode_sequence(indices: &[u32]) -> Vec<u8> {
    let mut out = vec![SEQUENCE | 1];
    let mut last = [0u32; 2];
    let mut current = 0;
    for &index in indices {
        // Staying with one of two baselines as long as it is near.
        let far = |b: usize| (index.wrapping_sub(last[b]) as i32).unsigned_abs();
        if far(current) >= 30 {
            current ^= 1;
        }
        let v = zigzag(index.wrapping_sub(last[current]));
        push_varint(&mut out, v << 1 | current as u32);
        last[current] = index;
    }
    out.extend([0; 4]);
    out
}

/// Encodes whole triangles. Their corners may come back rotated.
pub(in super::super) fn encode_triangles(indices: &[u32]) -> Vec<u8> {
    let mut encoder = Encoder {
        state: State::new(),
        codes: Vec::with_capacity(indices.len() / 3),
        data: Vec::new(),
    };
    for triangle in indices.as_chunks::<3>().0 {
        encoder.triangle(*triangle);
    }
    let mut out = vec![TRIANGLES | 1];
    out.extend(encoder.codes);
    out.extend(encoder.data);
    out.extend(CODES);
    out
}

struct Encoder {
    state: State,
    codes: Vec<u8>,
    data: Vec<u8>,
}

impl Encoder {
    fn triangle(&mut self, triangle: [u32; 3]) {
        match self.find_edge(triangle) {
            Some((back, corner)) => self.on_edge(back, rotated(triangle, corner)),
            None => {
                let [_, b, c] = triangle;
                let next = self.state.next;
                let corner = if b == next {
                    1
                } else {
                    2 * usize::from(c == next)
                };
                self.alone(rotated(triangle, corner));
            }
        }
    }

    /// How far back an edge of the triangle is, and the corner it starts at.
    fn find_edge(&self, t: [u32; 3]) -> Option<(u8, usize)> {
        (0..15).find_map(|back| {
            let edge = self.state.edge_back(usize::from(back));
            let corner = (0..3).find(|&i| edge == [t[i], t[(i + 1) % 3]])?;
            Some((back, corner))
        })
    }

    fn find_vertex(&self, v: u32) -> Option<u8> {
        (0..16).find(|&back| self.state.vertex_back(usize::from(back)) == v)
    }

    fn on_edge(&mut self, back: u8, [a, b, c]: [u32; 3]) {
        let state = &self.state;
        let recent = self.find_vertex(c).filter(|code| (1..13).contains(code));
        let code = match recent {
            Some(code) => code,
            None if c == state.next => 0,
            None if c == state.last.wrapping_sub(1) => 13,
            None if c == state.last.wrapping_add(1) => 14,
            None => 15,
        };
        self.codes.push(back << 4 | code);
        match code {
            0 => drop(self.state.take_next()),
            13 | 14 => self.state.last = c,
            15 => self.state.write_index(&mut self.data, c),
            _ => {}
        }
        if recent.is_none() {
            self.state.push_vertex(c);
        }
        self.state.push_edge(c, b);
        self.state.push_edge(a, c);
    }

    fn alone(&mut self, triangle: [u32; 3]) {
        let [a, b, c] = triangle;
        let restart = triangle == [0, 1, 2] && self.state.next > 0;
        if restart {
            self.state.next = 0;
            self.state.vertices = [u32::MAX; 16];
        }
        // Recent vertices are looked up before any of this triangle is pushed.
        let recent = [b, c].map(|v| self.find_vertex(v).filter(|&back| back < 14));
        let first = if a == self.state.next { 0 } else { 15 };
        if first == 0 {
            self.state.take_next();
        }
        let [second, third] = [(b, recent[0]), (c, recent[1])].map(|(v, back)| match back {
            Some(back) => back + 1,
            None if v == self.state.next => {
                self.state.take_next();
                0
            }
            None => 15,
        });
        self.push_codes(first, second << 4 | third, restart);
        for (v, code) in [(a, first), (b, second), (c, third)] {
            if code == 15 {
                self.state.write_index(&mut self.data, v);
            }
            if code == 0 || code == 15 {
                self.state.push_vertex(v);
            }
        }
        self.state.push_edge(b, a);
        self.state.push_edge(c, b);
        self.state.push_edge(a, c);
    }

    fn push_codes(&mut self, first: u8, pair: u8, restart: bool) {
        let in_table = CODES[..14].iter().position(|&code| code == pair);
        match in_table {
            Some(i) if first == 0 && !restart => self.codes.push(0xf0 | i as u8),
            _ => {
                self.codes.push(0xfe | u8::from(first == 15));
                self.data.push(pair);
            }
        }
    }
}

fn rotated([a, b, c]: [u32; 3], corner: usize) -> [u32; 3] {
    match corner {
        0 => [a, b, c],
        1 => [b, c, a],
        _ => [c, a, b],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use meshopt_rs::index::{
        IndexEncodingVersion,
        buffer::{decode_index_buffer, encode_index_buffer, encode_index_buffer_bound},
        sequence::{decode_index_sequence, encode_index_sequence, encode_index_sequence_bound},
    };
    use proptest::prelude::*;

    /// A grid in strips, with some triangles anywhere.
    fn triangles(width: u32, odd: &[[u32; 3]]) -> Vec<u32> {
        let mut indices = Vec::new();
        for i in 0..width * 4 {
            let (a, b) = (i + i / width, i + i / width + width + 1);
            indices.extend([a, a + 1, b, b, a + 1, b + 1]);
        }
        indices.extend(odd.as_flattened());
        indices.extend([0, 1, 2]);
        indices
    }

    fn canonical(indices: &[u32]) -> Vec<[u32; 3]> {
        let lowest = |t: &[u32; 3]| *[0, 1, 2].map(|i| rotated(*t, i)).iter().min().unwrap();
        let (triangles, _) = indices.as_chunks::<3>();
        triangles.iter().map(lowest).collect()
    }

    proptest! {
        #[test]
        fn triangles_agree_with_another_implementation(
            width in 1u32..40,
            odd: Vec<[u16; 3]>,
            turn in 0usize..3,
        ) {
            let odd: Vec<_> = odd.iter().map(|t| t.map(u32::from)).collect();
            let mut indices = triangles(width, &odd);
            let turned = turn.min(indices.len());
            indices[turned..].chunks_exact_mut(3).for_each(|t| t.rotate_left(turn));
            let ours = encode_triangles(&indices);
            let mut theirs = vec![0; encode_index_buffer_bound(indices.len(), 1 << 16)];
            let size =
                encode_index_buffer(&mut theirs, &indices, IndexEncodingVersion::V1).unwrap();
            prop_assert_eq!(&ours, &theirs[..size]);
            let mut decoded = vec![0u32; indices.len()];
            prop_assert!(decode_index_buffer(&mut decoded, &ours).is_ok());
            prop_assert_eq!(canonical(&decoded), canonical(&indices));
            prop_assert_eq!(decode_triangles(&ours, indices.len()).unwrap(), decoded);
        }

        #[test]
        fn sequences_agree_with_another_implementation(
            indices in prop::collection::vec(0u32..1 << 29, 0..100),
        ) {
            let ours = encode_sequence(&indices);
            let mut theirs = vec![0; encode_index_sequence_bound(indices.len(), 1 << 31)];
            let size =
                encode_index_sequence(&mut theirs, &indices, IndexEncodingVersion::V1);
            prop_assert_eq!(&decode_sequence(&theirs[..size], indices.len()).unwrap(), &indices);
            let mut decoded = vec![0u32; indices.len()];
            prop_assert!(decode_index_sequence(&mut decoded, &ours).is_ok());
            prop_assert_eq!(&decoded, &indices);
        }

        #[test]
        fn damage_is_never_a_panic(at: usize, byte: u8, cut: usize) {
            let indices = triangles(9, &[[7, 300, 5]]);
            let mut bytes = encode_triangles(&indices);
            let short = &bytes[..cut % bytes.len()];
            prop_assert!(decode_triangles(short, indices.len()).is_err());
            let at = at % bytes.len();
            bytes[at] = byte;
            let _ = decode_triangles(&bytes, indices.len());
            let _ = decode_sequence(&bytes, indices.len());
        }
    }
}
