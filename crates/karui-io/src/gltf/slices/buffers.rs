//! Buffers that stay in their files, and the accessors into them.

use super::super::{
    accessor::{Elements, Layout},
    container,
    document::{LoadedView, MESHOPT},
    json::{self, At, ROOT},
    uri::{self, Uri},
};
use crate::{
    Place,
    error::{Error, ErrorKind, Result},
    slices::file::FileAt,
    source::relative_path,
};
use serde_json::Value;
use std::{collections::HashMap, ops::Range, path::Path, sync::Arc};

/// Bytes of a document in JSON at most: it is read as a whole.
const DOCUMENT: u64 = 512 << 20;

/// Where the bytes of a buffer are.
enum Bytes {
    /// In a file, from an offset on.
    File(Arc<FileAt>, u64),
    /// In a data URI.
    Memory(Vec<u8>),
    /// To be made by decompression.
    Fallback,
}

struct Buffer {
    bytes: Bytes,
    length: u64,
}

struct View {
    buffer: usize,
    start: u64,
    length: u64,
    stride: Option<usize>,
    is_compressed: bool,
}

/// All buffers and views of a document.
pub(super) struct Buffers {
    buffers: Vec<Buffer>,
    views: Vec<View>,
}

/// An array in a buffer.
#[derive(Debug, Clone)]
pub(super) struct AccessorAt {
    pub layout: Layout,
    /// Elements.
    pub count: u64,
    buffer: usize,
    start: u64,
    stride: usize,
}

/// A file in two parts.
pub(super) struct Container {
    pub json: Vec<u8>,
    /// Offset and length of the binary chunk.
    pub bin: Option<(u64, u64)>,
}

/// Takes a file apart; whatever is not GLB is taken for JSON.
pub(super) fn split(file: &FileAt) -> Result<Container> {
    let head = file.read(0, file.len.min(container::HEADER as u64))?;
    if !head.starts_with(container::MAGIC) {
        let json = read_document(file, 0, file.len)?;
        return Ok(Container { json, bin: None });
    }
    let header = file.read(0, container::HEADER as u64)?;
    let [_, version, length] = words(&header);
    if version != 2 {
        let kind = ErrorKind::unsupported(format!("GLB version {version}"));
        return Err(Error::new(Place::Byte(4), kind));
    }
    let end = u64::from(length);
    if end > file.len {
        let kind = ErrorKind::truncated(format!("{end} bytes"), file.len.to_string());
        return Err(Error::new(Place::Byte(8), kind));
    }
    let first = chunk(file, container::HEADER as u64, end)?;
    let Some((container::JSON, start, length)) = first else {
        let kind = ErrorKind::syntax("a first chunk with JSON", "none");
        return Err(Error::new(Place::Byte(container::HEADER as u64), kind));
    };
    let next = start + length.next_multiple_of(4);
    let bin = match chunk(file, next, end)? {
        Some((container::BIN, start, length)) => Some((start, length)),
        _ => None,
    };
    let json = read_document(file, start, length)?;
    Ok(Container { json, bin })
}

fn words<const N: usize>(bytes: &[u8]) -> [u32; N] {
    let words = bytes.as_chunks::<4>().0;
    std::array::from_fn(|i| words.get(i).map_or(0, |&w| u32::from_le_bytes(w)))
}

/// Type, start and length of the chunk at `at`; `None` at the end.
fn chunk(file: &FileAt, at: u64, end: u64) -> Result<Option<(u32, u64, u64)>> {
    if at >= end {
        return Ok(None);
    }
    let [length, kind] = words(&file.read(at, container::CHUNK_HEADER as u64)?);
    let (start, length) = (at + container::CHUNK_HEADER as u64, u64::from(length));
    if start + length > end {
        let left = end.saturating_sub(start).to_string();
        let kind = ErrorKind::truncated(format!("a chunk of {length} bytes"), left);
        return Err(Error::new(Place::Byte(at), kind));
    }
    Ok(Some((kind, start, length)))
}

fn read_document(file: &FileAt, at: u64, length: u64) -> Result<Vec<u8>> {
    if length > DOCUMENT {
        let kind = ErrorKind::TooLarge {
            what: "size of the JSON in bytes",
            found: length,
            limit: DOCUMENT,
        };
        return Err(Error::new(Place::Byte(at), kind));
    }
    file.read(at, length)
}

impl Buffers {
    /// Finds all buffers and views; none is read.
    pub fn find(json: &Value, bin: Option<(u64, u64)>, file: &Arc<FileAt>) -> Result<Self> {
        let mut known = HashMap::new();
        let mut buffers = Vec::new();
        for (i, raw) in json::array(json, "buffers", &ROOT)?.iter().enumerate() {
            let at = ROOT.item("buffers", i);
            let bin = bin.filter(|_| i == 0);
            buffers.push(find_buffer(raw, bin, file, &mut known, &at)?);
        }
        let mut found = Self {
            buffers,
            views: Vec::new(),
        };
        for (i, raw) in json::array(json, "bufferViews", &ROOT)?.iter().enumerate() {
            let view = found.find_view(raw, &ROOT.item("bufferViews", i))?;
            found.views.push(view);
        }
        Ok(found)
    }

    fn find_view(&self, raw: &Value, at: &At<'_>) -> Result<View> {
        let stride = json::number(raw, "byteStride", at)?;
        if let Some(stride) = stride.filter(|s| !(4..=252).contains(s)) {
            return Err(at.syntax("a byteStride of 4 to 252", stride.to_string()));
        }
        let is_compressed = MESHOPT
            .iter()
            .any(|name| json::extension(raw, name).is_some());
        let buffers = self.buffers.len();
        let Some(buffer) = json::index(raw, "buffer", buffers, "buffer", at)? else {
            return Err(at.syntax("`buffer`", "none"));
        };
        let start = json::number(raw, "byteOffset", at)?.unwrap_or(0) as u64;
        let length = json::required(raw, "byteLength", at)? as u64;
        let available = self.buffers[buffer].length;
        if !is_compressed && start.checked_add(length).is_none_or(|end| end > available) {
            let expected = format!("{length} bytes from byte {start}");
            let found = format!("a buffer of {available}");
            return Err(at.fail(ErrorKind::truncated(expected, found)));
        }
        Ok(View {
            buffer,
            start,
            length,
            stride,
            is_compressed,
        })
    }

    /// Content and stride of each view that `wanted` says, for what is read as a whole.
    pub fn views(&self, wanted: &[bool]) -> Result<Vec<LoadedView>> {
        let load = |(i, view): (usize, &View)| {
            if !wanted.get(i).is_some_and(|&w| w) {
                return Ok(None);
            }
            refuse_compressed(view, &ROOT.item("bufferViews", i))?;
            let bytes = self.bytes(view.buffer, view.start, view.length)?;
            Ok(Some((bytes, view.stride)))
        };
        self.views.iter().enumerate().map(load).collect()
    }

    /// Where accessor `index`, which must exist, lies.
    pub fn accessor(&self, json: &Value, index: usize) -> Result<AccessorAt> {
        let at = ROOT.item("accessors", index);
        let raw = &json["accessors"][index];
        let layout = Layout::parse(raw, &at)?;
        let count = json::required(raw, "count", &at)? as u64;
        if count == 0 {
            return Err(at.syntax("a count of at least 1", "0"));
        }
        let views = self.views.len();
        let view = json::index(raw, "bufferView", views, "bufferView", &at)?;
        let (Some(view), None) = (view, raw.get("sparse")) else {
            let feature = "an accessor that is sparse or without a buffer view, in slices,";
            return Err(at.fail(ErrorKind::unsupported(feature)));
        };
        let view = &self.views[view];
        refuse_compressed(view, &at)?;
        let size = layout.size();
        let stride = view.stride.unwrap_or(size);
        if stride < size {
            return Err(at.syntax(
                format!("a byteStride of at least {size}"),
                stride.to_string(),
            ));
        }
        let offset = json::number(raw, "byteOffset", &at)?.unwrap_or(0) as u64;
        let span = (count - 1).checked_mul(stride as u64);
        let end = span.and_then(|s| s.checked_add(size as u64)?.checked_add(offset));
        if end.is_none_or(|end| end > view.length) {
            let expected = format!("{count} elements of {size} bytes from byte {offset}");
            let found = format!("a buffer view of {}", view.length);
            return Err(at.fail(ErrorKind::truncated(expected, found)));
        }
        Ok(AccessorAt {
            layout,
            count,
            buffer: view.buffer,
            start: view.start + offset,
            stride,
        })
    }

    /// Some elements of an accessor, which must exist.
    pub fn read(&self, of: &AccessorAt, range: Range<u64>) -> Result<Elements<'static>> {
        let count = range.end.saturating_sub(range.start);
        let size = of.layout.size() as u64;
        let length = match count {
            0 => 0,
            _ => (count - 1) * of.stride as u64 + size,
        };
        let start = of.start + range.start * of.stride as u64;
        let bytes = self.bytes(of.buffer, start, length)?;
        Ok(Elements::spaced(
            of.layout,
            count as usize,
            of.stride,
            bytes,
        ))
    }

    /// An error in element `i` of an accessor.
    pub fn fail(&self, of: &AccessorAt, i: u64, kind: ErrorKind) -> Error {
        let at = of.start + i * of.stride as u64;
        match &self.buffers[of.buffer].bytes {
            Bytes::File(file, start) => {
                Error::new(Place::Byte(start + at), kind).in_file(&file.path)
            }
            _ => ROOT.item("buffers", of.buffer).fail(kind),
        }
    }

    fn bytes(&self, buffer: usize, start: u64, length: u64) -> Result<Vec<u8>> {
        match &self.buffers[buffer].bytes {
            Bytes::File(file, offset) => {
                let read = file.read(offset + start, length);
                read.map_err(|e| e.in_file(&file.path))
            }
            Bytes::Memory(bytes) => {
                let range = start as usize..(start + length) as usize;
                Ok(bytes.get(range).unwrap_or_default().to_vec())
            }
            Bytes::Fallback => Err(ROOT.item("buffers", buffer).syntax("a `uri`", "none")),
        }
    }
}

fn refuse_compressed(view: &View, at: &At<'_>) -> Result<()> {
    if !view.is_compressed {
        return Ok(());
    }
    let feature = "compressed glTF in slices (`karui convert` writes it as plain GLB)";
    Err(at.fail(ErrorKind::unsupported(feature)))
}

/// Files opened for buffers so far.
type Known = HashMap<String, Arc<FileAt>>;

fn find_buffer(
    raw: &Value,
    bin: Option<(u64, u64)>,
    file: &Arc<FileAt>,
    known: &mut Known,
    at: &At<'_>,
) -> Result<Buffer> {
    let length = json::required(raw, "byteLength", at)? as u64;
    let (bytes, available) = match (json::text(raw, "uri"), bin) {
        (Some(uri), _) => {
            let at = at.key("uri");
            match uri::decode(uri).map_err(|kind| at.fail(kind))? {
                Uri::Data { bytes, .. } => {
                    let available = bytes.len() as u64;
                    (Bytes::Memory(bytes), available)
                }
                Uri::Path(path) => {
                    let found = companion(&path, &file.path, known, &at)?;
                    let available = found.len;
                    (Bytes::File(found, 0), available)
                }
            }
        }
        (None, Some((start, available))) => (Bytes::File(Arc::clone(file), start), available),
        (None, None) => {
            return Ok(Buffer {
                bytes: Bytes::Fallback,
                length: 0,
            });
        }
    };
    if available < length {
        let kind = ErrorKind::truncated(format!("{length} bytes"), available.to_string());
        return Err(at.fail(kind));
    }
    Ok(Buffer { bytes, length })
}

/// Opens a file beside the model, once.
fn companion(uri: &str, model: &Path, known: &mut Known, at: &At<'_>) -> Result<Arc<FileAt>> {
    if let Some(file) = known.get(uri) {
        return Ok(Arc::clone(file));
    }
    let Some(relative) = relative_path(uri) else {
        return Err(at.fail(ErrorKind::UnsafePath(uri.to_owned())));
    };
    let path = model.parent().unwrap_or(Path::new("")).join(relative);
    let file = Arc::new(FileAt::open(&path)?);
    known.insert(uri.to_owned(), Arc::clone(&file));
    Ok(file)
}
