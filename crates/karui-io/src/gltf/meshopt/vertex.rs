//! Mode ATTRIBUTES: bytes of consecutive vertices as differences, in groups
//! of 16 with as many bits as the group needs.

use super::{Bytes, version};
use crate::error::ErrorKind;

const MARK: u8 = 0xa0;
const BLOCK_BYTES: usize = 8192;
const BLOCK_VERTICES: usize = 256;
const GROUP: usize = 16;
/// Least size of the tail, by version.
const TAIL: [usize; 2] = [32, 24];
/// Bits a value takes, by the two bits of the group's header. Version 1 uses
/// the second and third row.
const BITS: [[u8; 4]; 3] = [[0, 2, 4, 8], [0, 1, 2, 4], [1, 2, 4, 8]];

/// Vertices in a block, a multiple of the group size.
fn block_vertices(stride: usize) -> usize {
    let fit = BLOCK_BYTES / stride / GROUP * GROUP;
    fit.min(BLOCK_VERTICES)
}

/// Decodes `count` vertices of `stride` bytes, a multiple of 4 up to 256.
pub(super) fn decode(bytes: &[u8], count: usize, stride: usize) -> Result<Vec<u8>, ErrorKind> {
    let mut data = Bytes { rest: bytes };
    let version = version(&mut data, MARK, 1)?;
    let channels = if version == 0 { 0 } else { stride / 4 };
    let tail = (stride + channels).max(TAIL[usize::from(version)]);
    let Some(split) = data.rest.len().checked_sub(tail) else {
        let found = data.rest.len().to_string();
        return Err(ErrorKind::truncated(
            format!("a tail of {tail} bytes"),
            found,
        ));
    };
    let (body, tail) = data.rest.split_at(split);
    let (first, channels) = tail[tail.len() - stride - channels..].split_at(stride);
    let mut decoder = Decoder {
        data: Bytes { rest: body },
        version,
        channels,
        last: first.to_vec(),
        out: Vec::new(),
    };
    let mut left = count;
    while left > 0 {
        let vertices = left.min(block_vertices(stride));
        decoder.block(vertices)?;
        left -= vertices;
    }
    if !decoder.data.rest.is_empty() {
        let found = format!("{} more", decoder.data.rest.len());
        return Err(ErrorKind::syntax("the end of the compressed data", found));
    }
    Ok(decoder.out)
}

struct Decoder<'a> {
    data: Bytes<'a>,
    version: u8,
    /// How each group of 4 bytes is predicted (version 1).
    channels: &'a [u8],
    /// The last vertex decoded.
    last: Vec<u8>,
    out: Vec<u8>,
}

impl Decoder<'_> {
    fn block(&mut self, vertices: usize) -> Result<(), ErrorKind> {
        let stride = self.last.len();
        let control = match self.version {
            0 => &[][..],
            _ => self.data.take(stride / 4)?,
        };
        let mut planes = vec![[0; BLOCK_VERTICES]; stride];
        for (k, plane) in planes.iter_mut().enumerate() {
            let control = control.get(k / 4).map(|c| c >> (k % 4 * 2) & 3);
            self.plane(plane, vertices, control)?;
        }
        let start = self.out.len();
        self.out.resize(start + vertices * stride, 0);
        for (k, planes) in planes.chunks_exact(4).enumerate() {
            let channel = self.channels.get(k).copied().unwrap_or(0);
            self.undo_differences(planes, start, k * 4, channel)?;
        }
        let last = self.out.len() - stride;
        self.last.copy_from_slice(&self.out[last..]);
        Ok(())
    }

    /// One byte of all vertices of a block. `control` is that of version 1.
    fn plane(
        &mut self,
        plane: &mut [u8; BLOCK_VERTICES],
        vertices: usize,
        control: Option<u8>,
    ) -> Result<(), ErrorKind> {
        match control {
            None => self.groups(plane, vertices, BITS[0]),
            Some(0) => self.groups(plane, vertices, BITS[1]),
            Some(1) => self.groups(plane, vertices, BITS[2]),
            Some(2) => Ok(()),
            Some(_) => {
                plane[..vertices].copy_from_slice(self.data.take(vertices)?);
                Ok(())
            }
        }
    }

    fn groups(
        &mut self,
        plane: &mut [u8; BLOCK_VERTICES],
        vertices: usize,
        bits: [u8; 4],
    ) -> Result<(), ErrorKind> {
        let groups = vertices.div_ceil(GROUP);
        let header = self.data.take(groups.div_ceil(4))?;
        for (g, group) in plane.chunks_exact_mut(GROUP).take(groups).enumerate() {
            let code = header[g / 4] >> (g % 4 * 2) & 3;
            decode_group(&mut self.data, group, bits[usize::from(code)])?;
        }
        Ok(())
    }

    /// Adds up the differences of bytes `column..column + 4` of every vertex of
    /// the block that starts at `start` in the output.
    fn undo_differences(
        &mut self,
        planes: &[[u8; BLOCK_VERTICES]],
        start: usize,
        column: usize,
        channel: u8,
    ) -> Result<(), ErrorKind> {
        let stride = self.last.len();
        let mut last = [0; 4];
        last.copy_from_slice(&self.last[column..column + 4]);
        for (i, vertex) in self.out[start..].chunks_exact_mut(stride).enumerate() {
            let read = [planes[0][i], planes[1][i], planes[2][i], planes[3][i]];
            last = predict(read, last, channel)?;
            vertex[column..column + 4].copy_from_slice(&last);
        }
        Ok(())
    }
}

/// Four bytes from their encoded difference to the previous ones: as bytes,
/// as 16-bit numbers or as 32 bits that were xored and rotated.
fn predict(read: [u8; 4], last: [u8; 4], channel: u8) -> Result<[u8; 4], ErrorKind> {
    match channel & 3 {
        0 => Ok(std::array::from_fn(|j| {
            unzigzag8(read[j]).wrapping_add(last[j])
        })),
        1 => {
            let half = |b: [u8; 4], j: usize| u16::from_le_bytes([b[j], b[j + 1]]);
            let sum = |j| unzigzag16(half(read, j)).wrapping_add(half(last, j));
            let [[a, b], [c, d]] = [sum(0), sum(2)].map(u16::to_le_bytes);
            Ok([a, b, c, d])
        }
        2 => {
            let word = u32::from_le_bytes(read).rotate_right(u32::from(channel >> 4));
            Ok((word ^ u32::from_le_bytes(last)).to_le_bytes())
        }
        other => Err(ErrorKind::syntax(
            "a channel mode of 0 to 2",
            other.to_string(),
        )),
    }
}

fn unzigzag8(v: u8) -> u8 {
    (v & 1).wrapping_neg() ^ (v >> 1)
}

fn unzigzag16(v: u16) -> u16 {
    (v & 1).wrapping_neg() ^ (v >> 1)
}

fn zigzag8(v: u8) -> u8 {
    ((v as i8) >> 7) as u8 ^ (v << 1)
}

/// 16 values of `bits` bits; the largest stands for a full byte that follows.
fn decode_group(data: &mut Bytes<'_>, group: &mut [u8], bits: u8) -> Result<(), ErrorKind> {
    match bits {
        0 => group.fill(0),
        8 => group.copy_from_slice(data.take(GROUP)?),
        _ => {
            let escape = (1u8 << bits) - 1;
            let packed = data.take(GROUP * usize::from(bits) / 8)?;
            for (i, value) in group.iter_mut().enumerate() {
                let v = unpack(packed, i, bits);
                *value = if v == escape { data.byte()? } else { v };
            }
        }
    }
    Ok(())
}

/// Value `i` of `bits` bits: highest bits first, but single bits lowest first.
fn unpack(packed: &[u8], i: usize, bits: u8) -> u8 {
    let per_byte = 8 / usize::from(bits);
    let slot = i % per_byte;
    let slot = if bits == 1 { slot } else { per_byte - 1 - slot };
    packed[i / per_byte] >> (slot * usize::from(bits)) & ((1 << bits) - 1)
}

/// Encodes vertices of `stride` bytes (a multiple of 4 up to 256) as version
/// 0, the one `EXT_meshopt_compression` asks for.
pub(in super::super) fn encode(vertices: &[u8], stride: usize) -> Vec<u8> {
    let mut out = vec![MARK];
    let mut last = vertices.get(..stride).unwrap_or(&[]).to_vec();
    last.resize(stride, 0);
    let first = last.clone();
    for block in vertices.chunks(block_vertices(stride) * stride) {
        for (k, last) in last.iter_mut().enumerate() {
            encode_plane(&mut out, block.iter().skip(k).step_by(stride), last);
        }
    }
    out.resize(out.len() + TAIL[0].saturating_sub(stride), 0);
    out.extend(first);
    out
}

fn encode_plane<'a>(out: &mut Vec<u8>, bytes: impl Iterator<Item = &'a u8>, last: &mut u8) {
    let mut differences = Vec::with_capacity(BLOCK_VERTICES);
    for &byte in bytes {
        differences.push(zigzag8(byte.wrapping_sub(*last)));
        *last = byte;
    }
    differences.resize(differences.len().next_multiple_of(GROUP), 0);
    let groups = differences.len() / GROUP;
    let header = out.len();
    out.resize(header + groups.div_ceil(4), 0);
    for (g, group) in differences.chunks_exact(GROUP).enumerate() {
        let code = best_code(group);
        out[header + g / 4] |= code << (g % 4 * 2);
        encode_group(out, group, BITS[0][usize::from(code)]);
    }
}

/// The header code whose encoding of the group is the shortest.
fn best_code(group: &[u8]) -> u8 {
    if group.iter().all(|&v| v == 0) {
        return 0;
    }
    let escapes = |bits: u8| group.iter().filter(|&&v| v >= (1 << bits) - 1).count();
    let sizes = [(GROUP, 3), (4 + escapes(2), 1), (8 + escapes(4), 2)];
    let shortest = sizes.into_iter().min_by_key(|&(size, _)| size);
    shortest.map_or(3, |(_, code)| code)
}

fn encode_group(out: &mut Vec<u8>, group: &[u8], bits: u8) {
    match bits {
        0 => {}
        8 => out.extend_from_slice(group),
        _ => {
            let escape = (1u8 << bits) - 1;
            for values in group.chunks_exact(8 / usize::from(bits)) {
                let pack = |byte, &v: &u8| byte << bits | v.min(escape);
                out.push(values.iter().fold(0, pack));
            }
            out.extend(group.iter().filter(|&&v| v >= escape));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use meshopt_rs::vertex::{
        VertexEncodingVersion,
        buffer::{decode_vertex_buffer, encode_vertex_buffer, encode_vertex_buffer_bound},
    };
    use proptest::prelude::*;

    type Vertex = [u8; 12];

    /// Smooth, noisy and constant bytes side by side, so that every group
    /// width occurs.
    fn vertices(count: usize, seed: u32) -> Vec<Vertex> {
        let mut state = seed;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        };
        let vertex = |i: usize| {
            std::array::from_fn(|k| match k % 4 {
                0 => (i * 3) as u8,
                1 => random(),
                2 => random() & 3,
                _ => 77,
            })
        };
        (0..count).map(vertex).collect()
    }

    /// What the reference implementation (npm `meshoptimizer` 1.x) makes of
    /// [`mixed`] in version 1 at its levels 0 and 2.
    const VERSION_1: [&str; 2] = [
        "oVpVWan/AAAoGDjId+egP2AP4I/Xh9ioV/in1wBQwG/vMDhICNiH17/vkD/wn9cXaLhn97/PMCDQf9/vt3gn6JfX\
        T6CwX/8/AFAoGDjId1UBNmXZj4IEAwRmGZdmBD2YZn0DBAMGmXZj2QQDBPZgAAB/gv8AAFhYWFhYWFhYWFhYWFhY\
        WFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWD8AWFhYWFhYVQEqrqrqBASu\
        ququBAQEq6q6qwQEBKq6q6oEBOqgAAAE/wAAAgYKDhIWGh4iJiouMjY6PkJGSk5SVlpeYmZqbnJ2en6ChoqOkpaa\
        nqKmqq6ytrq+wsbKztLW2t7i5uru8vb6PwD+/fn18e1UAQAAgAIAgICAggiCCIiIiIAAAP8AAL7goJUv9E5amzmJ\
        g7Abqq2vU60sUmff+zZ3rNMC9+jPu4hFkus7g4Qs7n8vH/dheSzZvMq+tFJb/ML0vvFIIT8AMh2Ni7E4VQEqqqqq\
        qqqqqqqqqqqqqqqqqqAAAFUBABIYBgBAgZJCEgBCQCEkmABgAABVASqrqq4LC6q6quoLC6uqrqoLC7qq6qsLCwuq\
        oAAAAAAAAAAAAAAAAAAAPQUAAQAAAAAAAAAA",
        "oXo3W6kAKOc4N4jnX8Cf8B9w14fYV6gHWNf/UD+Q7884twgneNe/EG/AD2DXF2hHmPe/MM8gL4Df70iH2Bdo10+g\
        T6D/ryjnODeIVQE2U9VKggMDVRlPZQMELVSlPQMEBZS1UpQD9lAAAIGCAFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhY\
        WFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFhYWFUBKqqqqqqqqqqqqqqqqqqqqqqg\
        AAAAAgYKDhIWGh4iJiouMjY6PkJGSk5SVlpeYmZqbnJ2en6ChoqOkpaanqKmqq6ytrq+wsbKztLW2t7i5uru8vb6\
        /gIGCg4SAAIVUAAAAL7goJUv9E5amzmJg7Abqq2vU60sUmff+zZ3rNMC9+jPu4hFkus7g4Qs7n8vH/dheSzZvMq+\
        tFJb/ML0vvFIITIdjYuxOFUBKqqqqqqqqqqqqqqqqqqqqqqgAABVAQASGAYAQIGSQhIAQkAhJJgAYAAAVQEqq6qu\
        CwuquqrqCwurqq6qCwu6quqrCwsLqqAAAAAAAAAAAAAAAAAAAD0FAAEAAAAAAQEAAA==",
    ];

    fn mixed() -> Vec<u8> {
        let mut state = 7u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        };
        let mut bytes = Vec::new();
        for i in 0..70u32 {
            bytes.extend(((i * 37 % 64) as f32 / 4.0).to_le_bytes());
            bytes.extend(
                [(i * 300) as u16, (i * i) as u16]
                    .map(u16::to_le_bytes)
                    .as_flattened(),
            );
            bytes.extend([random(), 5, i as u8, random() & 1]);
            bytes.extend((i % 7).to_le_bytes());
        }
        bytes
    }

    #[test]
    fn version_1_of_the_reference_implementation() {
        use base64::{Engine, prelude::BASE64_STANDARD};
        for text in VERSION_1 {
            let bytes = BASE64_STANDARD.decode(text).unwrap();
            assert_eq!(decode(&bytes, 70, 16).unwrap(), mixed());
            for end in 0..bytes.len() {
                assert!(decode(&bytes[..end], 70, 16).is_err());
            }
        }
    }

    proptest! {
        #[test]
        fn agrees_with_another_implementation(count in 1usize..1000, seed: u32) {
            let vertices = vertices(count, seed);
            let ours = encode(vertices.as_flattened(), 12);
            let mut theirs = vec![0; encode_vertex_buffer_bound(count, 12)];
            let version = VertexEncodingVersion::default();
            let size = encode_vertex_buffer(&mut theirs, &vertices, version).unwrap();
            prop_assert_eq!(&ours, &theirs[..size]);
            let mut decoded = vec![[0; 12]; count];
            prop_assert!(decode_vertex_buffer(&mut decoded, &ours).is_ok());
            prop_assert_eq!(&decoded, &vertices);
            prop_assert_eq!(decode(&ours, count, 12).unwrap(), vertices.as_flattened());
        }

        #[test]
        fn damage_is_never_a_panic(count in 1usize..300, at: usize, byte: u8, cut: usize) {
            let mut bytes = encode(vertices(count, 1).as_flattened(), 12);
            let at = at % bytes.len();
            bytes[at] = byte;
            let _ = decode(&bytes, count, 12);
            bytes.truncate(cut % bytes.len());
            prop_assert!(decode(&bytes, count, 12).is_err());
        }
    }
}
