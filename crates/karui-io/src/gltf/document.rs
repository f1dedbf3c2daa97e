//! The document with the bytes it refers to: buffers and buffer views.

use super::{
    budget::Budget,
    container,
    json::{self, At, ROOT},
    meshopt,
    uri::{self, Uri},
};
use crate::{
    error::{ErrorKind, Result},
    source::Source,
};
use serde_json::Value;
use std::{collections::HashMap, ops::Range, sync::Arc};

/// A glTF document in JSON and its binary data.
pub(super) struct Document {
    /// The document, without `buffers`.
    pub json: Value,
    buffers: Vec<Buffer>,
    views: Vec<View>,
    size: usize,
}

/// The first `length` bytes of a file or data URI; several buffers may name
/// one file.
struct Buffer {
    bytes: Arc<Vec<u8>>,
    length: usize,
}

impl Buffer {
    fn bytes(&self) -> &[u8] {
        &self.bytes[..self.length]
    }
}

struct View {
    bytes: ViewBytes,
    stride: Option<usize>,
}

/// Content and `byteStride` of a buffer view, if it is wanted.
pub(super) type LoadedView = Option<(Vec<u8>, Option<usize>)>;

enum ViewBytes {
    /// Part of a buffer.
    Part(usize, Range<usize>),
    /// Decompressed, or copied out of its buffer.
    Own(Vec<u8>),
    /// Not kept.
    Dropped,
}

/// Extensions that compress buffer views with meshoptimizer's codecs.
pub(super) const MESHOPT: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

impl Document {
    /// Reads the container, the JSON and all buffers.
    pub fn load(source: &mut Source<'_>) -> Result<(Self, Budget)> {
        let parts = container::split(source.bytes, &mut source.warnings)?;
        let mut json = json::parse(parts.json)?;
        let (buffers, bytes) = load_buffers(&json, parts.bin, source)?;
        json::remove(&mut json, "buffers");
        let budget = Budget::new(bytes, parts.json.len());
        let mut document = Self {
            json,
            buffers,
            views: Vec::new(),
            size: bytes,
        };
        document.load_views(&budget)?;
        Ok((document, budget))
    }

    /// A document with some of its buffer views; the others count as empty.
    pub fn of_views(json: Value, views: Vec<LoadedView>) -> Self {
        let own = |view: LoadedView| match view {
            Some((bytes, stride)) => View {
                bytes: ViewBytes::Own(bytes),
                stride,
            },
            None => View {
                bytes: ViewBytes::Dropped,
                stride: None,
            },
        };
        Self {
            json,
            buffers: Vec::new(),
            views: views.into_iter().map(own).collect(),
            size: 0,
        }
    }

    fn load_views(&mut self, budget: &Budget) -> Result<()> {
        for (i, view) in json::array(&self.json, "bufferViews", &ROOT)?
            .iter()
            .enumerate()
        {
            let at = ROOT.item("bufferViews", i);
            let view = self.load_view(view, budget, &at)?;
            self.views.push(view);
        }
        Ok(())
    }

    fn load_view(&self, view: &Value, budget: &Budget, at: &At<'_>) -> Result<View> {
        let stride = json::number(view, "byteStride", at)?;
        if let Some(stride) = stride.filter(|s| !(4..=252).contains(s)) {
            return Err(at.syntax("a byteStride of 4 to 252", stride.to_string()));
        }
        for name in MESHOPT {
            if let Some(compressed) = json::extension(view, name) {
                let at = at.key("extensions");
                let at = at.key(name);
                let (buffer, range) = self.view_range(compressed, &at)?;
                let bytes = &self.buffers[buffer].bytes()[range];
                let bytes = ViewBytes::Own(meshopt::decode_view(compressed, bytes, budget, &at)?);
                return Ok(View { bytes, stride });
            }
        }
        let (buffer, range) = self.view_range(view, at)?;
        let bytes = ViewBytes::Part(buffer, range);
        Ok(View { bytes, stride })
    }

    /// Buffer and range that `buffer`, `byteOffset` and `byteLength` name.
    fn view_range(&self, view: &Value, at: &At<'_>) -> Result<(usize, Range<usize>)> {
        let buffers = self.buffers.len();
        let Some(buffer) = json::index(view, "buffer", buffers, "buffer", at)? else {
            return Err(at.syntax("`buffer`", "none"));
        };
        let start = json::number(view, "byteOffset", at)?.unwrap_or(0);
        let length = json::required(view, "byteLength", at)?;
        let available = self.buffers[buffer].length;
        match start.checked_add(length) {
            Some(end) if end <= available => Ok((buffer, start..end)),
            _ => {
                let expected = format!("{length} bytes from byte {start}");
                let found = format!("a buffer of {available}");
                Err(at.fail(ErrorKind::truncated(expected, found)))
            }
        }
    }

    /// Bytes of all buffers as they were read.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Number of buffer views.
    pub fn view_count(&self) -> usize {
        self.views.len()
    }

    /// Content of a buffer view, which must exist.
    pub fn view(&self, index: usize) -> &[u8] {
        match &self.views[index].bytes {
            ViewBytes::Part(buffer, range) => &self.buffers[*buffer].bytes()[range.clone()],
            ViewBytes::Own(bytes) => bytes,
            ViewBytes::Dropped => &[],
        }
    }

    /// `byteStride` of a buffer view, which must exist.
    pub fn stride(&self, index: usize) -> Option<usize> {
        self.views[index].stride
    }

    /// Frees everything but the views in `keep` (by index).
    pub fn keep_views(&mut self, keep: &[bool]) {
        for i in 0..self.views.len() {
            let bytes = match keep.get(i) {
                Some(true) => ViewBytes::Own(self.view(i).to_vec()),
                _ => ViewBytes::Dropped,
            };
            self.views[i].bytes = bytes;
        }
        self.buffers = Vec::new();
    }
}

/// Files read for buffers so far, by path.
type Known = HashMap<String, Arc<Vec<u8>>>;

/// Reads all buffers; returns them and the bytes read in total.
fn load_buffers(
    json: &Value,
    bin: Option<&[u8]>,
    source: &Source<'_>,
) -> Result<(Vec<Buffer>, usize)> {
    let mut known = Known::new();
    let mut buffers = Vec::new();
    let mut total = 0;
    for (i, buffer) in json::array(json, "buffers", &ROOT)?.iter().enumerate() {
        let at = ROOT.item("buffers", i);
        let files = known.len();
        let is_data = !is_path(buffer);
        let buffer = load_buffer(buffer, bin.filter(|_| i == 0), source, &mut known, &at)?;
        if is_data || known.len() > files {
            total += buffer.bytes.len();
        }
        buffers.push(buffer);
    }
    Ok((buffers, total))
}

/// Whether a buffer names a file.
fn is_path(buffer: &Value) -> bool {
    json::text(buffer, "uri").is_some_and(|uri| !uri::is_data(uri))
}

fn load_buffer(
    buffer: &Value,
    bin: Option<&[u8]>,
    source: &Source<'_>,
    known: &mut Known,
    at: &At<'_>,
) -> Result<Buffer> {
    let length = json::required(buffer, "byteLength", at)?;
    let bytes = match (json::text(buffer, "uri"), bin) {
        (Some(uri), _) => load_uri(uri, source, known, &at.key("uri"))?,
        (None, Some(bin)) => Arc::new(bin.to_vec()),
        // The content of a fallback buffer is made by decompression.
        (None, None) if is_fallback(buffer) => {
            let (bytes, length) = (Arc::default(), 0);
            return Ok(Buffer { bytes, length });
        }
        (None, None) => return Err(at.syntax("a `uri` or a binary chunk", "neither")),
    };
    if bytes.len() < length {
        let (expected, found) = (format!("{length} bytes"), bytes.len().to_string());
        return Err(at.fail(ErrorKind::truncated(expected, found)));
    }
    Ok(Buffer { bytes, length })
}

fn is_fallback(buffer: &Value) -> bool {
    MESHOPT.iter().any(|name| {
        json::extension(buffer, name)
            .and_then(|e| e.get("fallback"))
            .and_then(Value::as_bool)
            == Some(true)
    })
}

fn load_uri(
    uri: &str,
    source: &Source<'_>,
    known: &mut Known,
    at: &At<'_>,
) -> Result<Arc<Vec<u8>>> {
    let path = match uri::decode(uri).map_err(|kind| at.fail(kind))? {
        Uri::Data { bytes, .. } => return Ok(Arc::new(bytes)),
        Uri::Path(path) => path,
    };
    if let Some(bytes) = known.get(&path) {
        return Ok(Arc::clone(bytes));
    }
    let Some(bytes) = companion(&path, source, at)? else {
        return Err(at.syntax(format!("the file `{path}` beside the model"), "none"));
    };
    let bytes = Arc::new(bytes);
    known.insert(path, Arc::clone(&bytes));
    Ok(bytes)
}

/// Reads a file beside the model; `None` if there is none.
pub(super) fn companion(path: &str, source: &Source<'_>, at: &At<'_>) -> Result<Option<Vec<u8>>> {
    source.companion(path).map_err(|error| match *error.kind {
        kind @ ErrorKind::UnsafePath(_) => at.fail(kind),
        kind => crate::Error::new(error.place, kind).in_file(error.path),
    })
}
