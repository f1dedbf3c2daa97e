//! The hierarchy as bytes, little-endian: `KARUIHEH`, the version, then
//!
//! - vertices, faces, nodes and dependents (`u32` each);
//! - the counts of the build (four `u32`), the box around the mesh (six `f32`),
//!   hashes of the triangles and positions of the mesh (`u64` each);
//! - for every face the triangle that it is (`u32`);
//! - for every half-edge the vertex it starts at and the other half (`u32` each);
//! - for every node half-edge, parent, two children, centre (three `f32`), radius
//!   (`f32`), axis, sine (`f32`), first dependent (`u32` where nothing is said);
//! - the dependents (`u32` each);
//! - a checksum of all before (`u64`).

use super::node::Node;
use super::options::BuildCounts;
use super::surface::{Half, Surface};
use super::{Hierarchy, MeshHash};
use crate::error::{Error, Result};
use crate::geom::{Aabb, Vec3};
use bytemuck::{Pod, cast_slice, try_cast_slice};

const MAGIC: [u8; 8] = *b"KARUIHEH";
const VERSION: u32 = 1;
/// Words before the arrays, after the magic.
const HEADER: usize = 19;

impl Hierarchy {
    /// The hierarchy as bytes, the same on every machine.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let sizes = [
            self.vertices,
            self.triangle_of_face.len(),
            self.nodes.len(),
            self.dependents.len(),
            self.counts.dropped,
            self.counts.split_edges,
            self.counts.split_vertices,
            self.counts.coarsest,
        ];
        let mut words: Vec<u32> = vec![VERSION];
        words.extend(sizes.map(|n| n as u32));
        for corner in [self.bounds.min, self.bounds.max] {
            words.extend(corner.to_array().map(f32::to_bits));
        }
        for hash in [self.mesh.triangles, self.mesh.positions] {
            words.extend([hash as u32, (hash >> 32) as u32]);
        }
        words.extend(&self.triangle_of_face);
        words.extend(cast_slice::<Half, u32>(&self.surface.halves));
        words.extend(cast_slice::<Node, u32>(&self.nodes));
        words.extend(&self.dependents);
        let mut bytes = Vec::with_capacity(MAGIC.len() + 4 * words.len() + 8);
        bytes.extend(MAGIC);
        bytes.extend(words.iter().flat_map(|w| w.to_le_bytes()));
        let sum = checksum(&bytes);
        bytes.extend(sum.to_le_bytes());
        bytes
    }

    /// Reads what [`Self::to_bytes`] has written, and makes sure that it holds
    /// together: bytes that are taken give cuts that hold together, too. Takes
    /// memory for what is there, never on the word of a length.
    ///
    /// # Errors
    /// [`Error::BadHierarchy`] with the number of the byte, or [`Error::Broken`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        let bad = |at, problem| Error::BadHierarchy { at, problem };
        if !bytes.starts_with(&MAGIC) {
            return Err(bad(0, "it does not begin with KARUIHEH"));
        }
        let end = bytes.len().saturating_sub(8);
        let body = bytes.get(MAGIC.len()..end).unwrap_or_default();
        let (words, []) = body.as_chunks::<4>() else {
            return Err(bad(end, "it ends within a number"));
        };
        let words: Vec<u32> = words.iter().map(|w| u32::from_le_bytes(*w)).collect();
        let Some((header, arrays)) = words.split_first_chunk::<HEADER>() else {
            return Err(bad(bytes.len(), "it ends within the header"));
        };
        if header[0] != VERSION {
            return Err(bad(MAGIC.len(), "the version is not 1, the only one known"));
        }
        let (found, expected) = (4 * arrays.len() as u64, length(header));
        if found != expected {
            return Err(bad(bytes.len(), "its length is not what its header says"));
        }
        if bytes[end..] != checksum(&bytes[..end]).to_le_bytes() {
            return Err(bad(end, "the checksum is another"));
        }
        let hierarchy = Self::of_words(header, arrays);
        hierarchy.validate()?;
        Ok(hierarchy)
    }

    /// From a header and arrays that are as long as it says.
    fn of_words(header: &[u32; HEADER], arrays: &[u32]) -> Self {
        let [_, vertices, faces, nodes, _, counts @ ..] = *header;
        let mut rest = arrays;
        let mut take = |words: usize| {
            let (first, others) = rest.split_at(words.min(rest.len()));
            rest = others;
            first
        };
        let float = |i: usize| f32::from_bits(counts[i]);
        let long = |i: usize| u64::from(counts[i]) | u64::from(counts[i + 1]) << 32;
        Self {
            vertices: vertices as usize,
            triangle_of_face: take(faces as usize).to_vec(),
            surface: Surface {
                halves: collected(take(6 * faces as usize)),
            },
            nodes: collected(take(WORDS_OF_NODE * nodes as usize)),
            dependents: rest.to_vec(),
            bounds: Aabb {
                min: Vec3::new(float(4), float(5), float(6)),
                max: Vec3::new(float(7), float(8), float(9)),
            },
            mesh: MeshHash {
                triangles: long(10),
                positions: long(12),
            },
            counts: BuildCounts {
                dropped: counts[0] as usize,
                split_edges: counts[1] as usize,
                split_vertices: counts[2] as usize,
                coarsest: counts[3] as usize,
            },
        }
    }
}

const WORDS_OF_NODE: usize = size_of::<Node>() / 4;

/// Bytes of the arrays, by the header.
fn length(header: &[u32; HEADER]) -> u64 {
    let [faces, nodes, dependents] = [header[2], header[3], header[4]].map(u64::from);
    4 * (7 * faces + WORDS_OF_NODE as u64 * nodes + dependents)
}

/// Words as what they stand for; that is made of words, so nothing is left over.
fn collected<T: Pod>(words: &[u32]) -> Vec<T> {
    try_cast_slice(words).unwrap_or_default().to_vec()
}

/// What closes the bytes of a hierarchy: a hash of those before.
#[must_use]
pub fn checksum(bytes: &[u8]) -> u64 {
    let mixed = |hash: u64, word: u64| {
        let product = (hash ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        product ^ product >> 29
    };
    let (words, rest) = bytes.as_chunks::<8>();
    let hash = words
        .iter()
        .fold(bytes.len() as u64, |h, w| mixed(h, u64::from_le_bytes(*w)));
    rest.iter().fold(hash, |h, &b| mixed(h, b.into()))
}
