//! Collecting arrays for a new buffer.

use super::{
    accessor::{Component, Kind, Layout},
    meshopt,
};
use crate::error::{Error, ErrorKind, Place, Result};
use serde_json::{Value, json};

/// GPU use of a buffer view.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Use {
    /// Vertex attributes.
    Vertices,
    /// Indices of triangles.
    Triangles,
    /// Indices of lines.
    Indices,
    /// Anything else.
    Other,
}

impl Use {
    fn target(self) -> Option<u32> {
        match self {
            Self::Vertices => Some(34962),
            Self::Triangles | Self::Indices => Some(34963),
            Self::Other => None,
        }
    }
}

/// A typed array to be written.
#[derive(Debug, Clone)]
pub(super) struct Array {
    pub component: Component,
    pub kind: Kind,
    pub normalized: bool,
    /// Number of elements.
    pub count: usize,
    /// Bytes from one element to the next.
    pub stride: usize,
    pub bytes: Vec<u8>,
    /// Least and greatest value of each component, if they are to be told.
    pub range: Option<[Vec<Value>; 2]>,
}

/// A buffer view to be written.
struct View {
    /// What else is said about it.
    json: Value,
    bytes: Vec<u8>,
    stride: Option<usize>,
    usage: Use,
}

/// Accessors and buffer views of a new document.
#[derive(Default)]
pub(super) struct Packer {
    /// In the order of their indices.
    pub accessors: Vec<Value>,
    views: Vec<View>,
}

/// What a packer turns into.
pub(super) struct Packed {
    pub views: Vec<Value>,
    /// The buffer.
    pub bin: Vec<u8>,
    /// Length of a second buffer that only decompression fills; 0 if nothing
    /// is compressed.
    pub fallback: usize,
}

/// Name of the extension written.
pub(super) const MESHOPT: &str = "EXT_meshopt_compression";

impl Packer {
    /// Adds an array; returns the index of its accessor.
    pub fn push(&mut self, array: Array, usage: Use) -> usize {
        let mut accessor = json!({
            "bufferView": self.views.len(),
            "componentType": array.component.code(),
            "count": array.count,
            "type": array.kind.name(),
        });
        if array.normalized {
            accessor["normalized"] = json!(true);
        }
        if let Some([min, max]) = array.range {
            accessor["min"] = json!(min);
            accessor["max"] = json!(max);
        }
        self.views.push(View {
            json: json!({}),
            bytes: array.bytes,
            stride: Some(array.stride),
            usage,
        });
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// Adds bytes that no accessor describes, with what is to be said about
    /// the view; returns its index.
    pub fn push_view(&mut self, json: Value, bytes: Vec<u8>) -> usize {
        self.views.push(View {
            json,
            bytes,
            stride: None,
            usage: Use::Other,
        });
        self.views.len() - 1
    }

    /// Adds an accessor over a new buffer view; returns its index.
    pub fn push_accessor(
        &mut self,
        mut accessor: Value,
        bytes: Vec<u8>,
        stride: Option<usize>,
        usage: Use,
    ) -> usize {
        accessor["bufferView"] = json!(self.views.len());
        self.views.push(View {
            json: json!({}),
            bytes,
            stride,
            usage,
        });
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// The scalars of an accessor that was pushed as an [`Array`].
    pub fn scalars(&self, accessor: usize) -> Option<Vec<f64>> {
        let accessor = self.accessors.get(accessor)?;
        let view = self.views.get(accessor["bufferView"].as_u64()? as usize)?;
        let component = Component::from_code(accessor["componentType"].as_u64()? as usize)?;
        let layout = Layout {
            component,
            kind: Kind::Scalar,
            normalized: false,
        };
        let stride = view.stride.unwrap_or(component.size());
        let count = accessor["count"].as_u64()? as usize;
        let elements = view.bytes.chunks(stride).take(count);
        Some(elements.map(|e| layout.scalar(e)).collect())
    }

    /// Lays all views out, compressed if that makes them smaller.
    pub fn finish(self, compress: bool) -> (Vec<Value>, Packed) {
        let mut packed = Packed {
            views: Vec::with_capacity(self.views.len()),
            bin: Vec::new(),
            fallback: 0,
        };
        for view in self.views {
            let coded = compress.then(|| view.compress()).flatten();
            match coded {
                Some(coded) if coded.bytes.len() < view.bytes.len() => {
                    packed.add_coded(&view, coded)
                }
                _ => packed.add_plain(view),
            }
        }
        (self.accessors, packed)
    }
}

/// A compressed view.
struct Coded {
    bytes: Vec<u8>,
    mode: &'static str,
    stride: usize,
}

impl View {
    /// `None` if no mode fits.
    fn compress(&self) -> Option<Coded> {
        if self.bytes.is_empty() {
            return None;
        }
        let (mode, stride, bytes) = match self.usage {
            Use::Vertices | Use::Other => {
                let stride = self.stride.filter(|s| s.is_multiple_of(4) && *s <= 256)?;
                (
                    "ATTRIBUTES",
                    stride,
                    meshopt::encode_vertices(&self.bytes, stride),
                )
            }
            Use::Triangles | Use::Indices => {
                let size = self.stride?;
                let indices = self.indices(size)?;
                if self.usage == Use::Triangles {
                    ("TRIANGLES", size, meshopt::encode_triangles(&indices))
                } else {
                    ("INDICES", size, meshopt::encode_sequence(&indices))
                }
            }
        };
        Some(Coded {
            bytes,
            mode,
            stride,
        })
    }

    /// The indices, if they are of a size and range that can be compressed.
    fn indices(&self, size: usize) -> Option<Vec<u32>> {
        let word = |b: &[u8]| b.iter().rev().fold(0, |w, &b| w << 8 | u32::from(b));
        let indices: Vec<u32> = self.bytes.chunks_exact(size).map(word).collect();
        let in_range = indices.iter().all(|&i| i < 1 << 29);
        (matches!(size, 2 | 4) && in_range).then_some(indices)
    }

    /// The JSON object, but for where the bytes are.
    fn describe(&self) -> Value {
        let mut json = self.json.clone();
        if self.usage == Use::Vertices
            && let Some(stride) = self.stride
        {
            json["byteStride"] = json!(stride);
        }
        if let Some(target) = self.usage.target() {
            json["target"] = json!(target);
        }
        json
    }
}

impl Packed {
    /// Views start at multiples of 8, as metadata of 64-bit values asks for.
    fn place(&mut self, bytes: &[u8]) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(8), 0);
        let offset = self.bin.len();
        self.bin.extend_from_slice(bytes);
        offset
    }

    fn add_plain(&mut self, view: View) {
        let mut json = view.describe();
        json["buffer"] = json!(0);
        json["byteOffset"] = json!(self.place(&view.bytes));
        json["byteLength"] = json!(view.bytes.len());
        self.views.push(json);
    }

    fn add_coded(&mut self, view: &View, coded: Coded) {
        let mut json = view.describe();
        self.fallback = self.fallback.next_multiple_of(8);
        json["buffer"] = json!(1);
        json["byteOffset"] = json!(self.fallback);
        json["byteLength"] = json!(view.bytes.len());
        json["extensions"] = json!({ MESHOPT: {
            "buffer": 0,
            "byteOffset": self.place(&coded.bytes),
            "byteLength": coded.bytes.len(),
            "byteStride": coded.stride,
            "count": view.bytes.len() / coded.stride,
            "mode": coded.mode,
        }});
        self.fallback += view.bytes.len();
        self.views.push(json);
    }
}

/// A size that the format or its 32-bit indices cannot hold.
pub(super) fn too_large(what: &'static str, found: usize, limit: u64) -> Error {
    let found = found as u64;
    Error::new(Place::File, ErrorKind::TooLarge { what, found, limit })
}

/// Checks the number of vertices or accessors against 32-bit indices.
pub(super) fn check_count(what: &'static str, found: usize) -> Result<()> {
    let limit = u64::from(u32::MAX - 1);
    if found as u64 > limit {
        return Err(too_large(what, found, limit));
    }
    Ok(())
}
