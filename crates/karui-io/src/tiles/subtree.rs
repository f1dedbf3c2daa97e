//! Subtree files: which tiles, contents and further subtrees of an implicit
//! tree there are (3D Tiles 1.1, "Subtrees").

use super::{
    at::At,
    findings::Notes,
    implicit::{cells, offset},
    model::Scheme,
    parse::{into_object, shown},
};
use crate::error::{Error, ErrorKind, Place, Result};
use serde_json::{Map, Value};
use std::ops::Range;

const MAGIC: &[u8; 4] = b"subt";
const HEADER: usize = 24;
/// Levels of a subtree that are read: bitstreams of 171 MiB.
pub(super) const MAX_LEVELS: [u32; 2] = [15, 10];

/// Which of a row of elements there are.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Availability {
    Constant(bool),
    Bits(Vec<u8>),
}

impl Availability {
    pub fn get(&self, i: u64) -> bool {
        match self {
            Self::Constant(all) => *all,
            Self::Bits(bytes) => {
                let byte = bytes.get((i / 8) as usize).copied().unwrap_or(0);
                byte >> (i % 8) & 1 == 1
            }
        }
    }

    /// How many of the first `length` there are.
    pub fn count(&self, length: u64) -> u64 {
        match self {
            Self::Constant(all) => length * u64::from(*all),
            Self::Bits(bytes) => {
                let whole = (length / 8) as usize;
                let ones = |b: &u8| u64::from(b.count_ones());
                let full: u64 = bytes.iter().take(whole).map(ones).sum();
                let rest = (length / 8 * 8..length).filter(|&i| self.get(i));
                full + rest.count() as u64
            }
        }
    }

    /// Whether there are none, as far as can be told at once.
    pub fn is_none(&self) -> bool {
        *self == Self::Constant(false)
    }
}

/// A subtree file.
#[derive(Debug)]
pub(super) struct Subtree {
    pub tiles: Availability,
    /// One for each content of the tile template.
    pub contents: Vec<Availability>,
    pub children: Availability,
    /// The JSON, for its metadata.
    pub json: Map<String, Value>,
    /// Bytes of every buffer view; empty where they could not be had.
    pub views: Vec<Vec<u8>>,
}

/// Shape of the subtrees of a tree.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layout {
    pub scheme: Scheme,
    pub levels: u32,
}

impl Layout {
    /// Tiles of a subtree; `None` if there are more than are read.
    pub fn tiles(self) -> Option<u64> {
        let limit = MAX_LEVELS[usize::from(self.scheme == Scheme::Octree)];
        (self.levels <= limit).then(|| offset(self.scheme, self.levels))?
    }

    /// Subtrees below a subtree.
    pub fn children(self) -> u64 {
        cells(self.scheme, self.levels).unwrap_or(0)
    }
}

/// JSON and binary chunk of a file.
fn split<'a>(file: &'a [u8], notes: &mut Notes<'_>) -> Result<(&'a [u8], &'a [u8])> {
    if !file.starts_with(MAGIC) {
        if file.trim_ascii_start().starts_with(b"{") {
            return Ok((file, &[]));
        }
        let kind = ErrorKind::syntax("`subt` or a JSON object", "other bytes");
        return Err(Error::new(Place::Byte(0), kind));
    }
    let word = |at: usize| -> Option<u64> {
        let bytes = file.get(at..at + 8)?;
        Some(u64::from_le_bytes(bytes.try_into().ok()?))
    };
    let (Some(version), Some(json), Some(binary)) = (file.get(4..8), word(8), word(16)) else {
        let kind = ErrorKind::truncated("24 bytes of header", file.len().to_string());
        return Err(Error::new(Place::Byte(0), kind));
    };
    if version != 1u32.to_le_bytes() {
        let found = format!("{version:?}");
        let kind = ErrorKind::syntax("version 1", found);
        return Err(Error::new(Place::Byte(4), kind));
    }
    let there = (file.len() - HEADER) as u64;
    let total = json.checked_add(binary);
    if total.is_none_or(|t| t > there) {
        let expected = format!("{json} bytes of JSON and {binary} of data");
        let kind = ErrorKind::truncated(expected, there.to_string());
        return Err(Error::new(Place::Byte(8), kind));
    }
    if !json.is_multiple_of(8) || !binary.is_multiple_of(8) {
        let found = format!("{json} and {binary} bytes");
        notes.error(
            "",
            "subtree-padding",
            "chunks of multiples of 8 bytes",
            found,
        );
    }
    let end = HEADER + json as usize;
    if total != Some(there) {
        let found = format!("{there} bytes");
        let expected = format!("{} bytes behind the header", json + binary);
        notes.error("", "subtree-length", expected, found);
    }
    Ok((&file[HEADER..end], &file[end..end + binary as usize]))
}

/// Reads a subtree. `companion` gives the bytes of a file that a buffer names,
/// and notes it if it cannot.
///
/// # Errors
/// If the file is no subtree at all; everything else is noted.
pub(super) fn read(
    file: &[u8],
    layout: Layout,
    contents: usize,
    notes: &mut Notes<'_>,
    companion: &mut dyn FnMut(&str, &mut Notes<'_>) -> Option<Vec<u8>>,
) -> Result<Subtree> {
    let (json, binary) = split(file, notes)?;
    let json: Map<String, Value> = serde_json::from_slice(json).map_err(|e| {
        let kind = ErrorKind::syntax("a JSON object", e.to_string());
        Error::new(
            Place::Byte(if binary.is_empty() { 0 } else { HEADER as u64 }),
            kind,
        )
    })?;
    let views = views(&json, binary, notes, companion);
    let mut reader = Reader {
        json: &json,
        views: &views,
    };
    let tiles = layout.tiles().unwrap_or(0);
    let tile_availability = reader.one("tileAvailability", tiles, notes);
    let contents = reader.contents(contents, tiles, notes);
    let children = reader.one("childSubtreeAvailability", layout.children(), notes);
    Ok(Subtree {
        tiles: tile_availability,
        contents,
        children,
        json,
        views,
    })
}

/// Bytes of all buffer views.
fn views(
    json: &Map<String, Value>,
    binary: &[u8],
    notes: &mut Notes<'_>,
    companion: &mut dyn FnMut(&str, &mut Notes<'_>) -> Option<Vec<u8>>,
) -> Vec<Vec<u8>> {
    let list = |key: &str| json.get(key).and_then(Value::as_array);
    let buffers = list("buffers").map_or(&[][..], Vec::as_slice);
    let mut files: Vec<Option<Vec<u8>>> = vec![None; buffers.len()];
    let mut found = Vec::new();
    let at = At::Document;
    let at = at.key("bufferViews");
    let mut budget = 64 * (binary.len() as u64 + 1024);
    for (i, view) in list("bufferViews").into_iter().flatten().enumerate() {
        let at = at.index(i);
        let number = |key: &str| view.get(key).and_then(Value::as_u64);
        let buffer = number("buffer").map_or(usize::MAX, |b| b as usize);
        let Some(description) = buffers.get(buffer) else {
            let expected = format!("one of {} buffers", buffers.len());
            let named = view.get("buffer").map_or_else(|| "none".into(), shown);
            notes.error(at.key("buffer"), "subtree-buffer", expected, named);
            found.push(Vec::new());
            continue;
        };
        let bytes = match description.get("uri").and_then(Value::as_str) {
            None => binary,
            Some(uri) => {
                if files[buffer].is_none() {
                    files[buffer] = Some(companion(uri, notes).unwrap_or_default());
                    budget += 64 * files[buffer].as_ref().map_or(0, Vec::len) as u64;
                }
                files[buffer].as_deref().unwrap_or_default()
            }
        };
        let length = description.get("byteLength").and_then(Value::as_u64);
        let length = length.unwrap_or(0).min(bytes.len() as u64);
        found.push(
            match part(number("byteOffset"), number("byteLength"), length) {
                // Views may overlap: a small file must not become a large one.
                Some(range) if range.len() as u64 <= budget => {
                    budget -= range.len() as u64;
                    bytes[range].to_vec()
                }
                _ => {
                    let expected = format!("a range within the {length} bytes of buffer {buffer}");
                    notes.error(at, "subtree-buffer-view", expected, shown(view));
                    Vec::new()
                }
            },
        );
    }
    found
}

fn part(offset: Option<u64>, length: Option<u64>, available: u64) -> Option<Range<usize>> {
    let start = offset.unwrap_or(0);
    let end = start.checked_add(length?)?;
    (end <= available).then_some(start as usize..end as usize)
}

struct Reader<'a> {
    json: &'a Map<String, Value>,
    views: &'a [Vec<u8>],
}

impl Reader<'_> {
    fn one(&mut self, key: &str, length: u64, notes: &mut Notes<'_>) -> Availability {
        let at = At::Document;
        match self.json.get(key) {
            Some(value) => self.availability(value, length, &at.key(key), notes),
            None => {
                notes.error(at, "required", format!("`{key}`"), "none");
                Availability::Constant(false)
            }
        }
    }

    fn contents(
        &mut self,
        expected: usize,
        tiles: u64,
        notes: &mut Notes<'_>,
    ) -> Vec<Availability> {
        let at = At::Document;
        let at = at.key("contentAvailability");
        let none = vec![Availability::Constant(false); expected];
        match self.json.get("contentAvailability") {
            Some(Value::Array(items)) => {
                if items.len() != expected {
                    let found = format!("an array of {}", items.len());
                    let expected = format!("{expected}, one for each content");
                    notes.error(at, "content-availability-count", expected, found);
                }
                let read = items.iter().enumerate().take(expected);
                let mut read: Vec<_> = read
                    .map(|(i, item)| self.availability(item, tiles, &at.index(i), notes))
                    .collect();
                read.resize(expected, Availability::Constant(false));
                read
            }
            // The form of the extension that came before 1.1.
            Some(one @ Value::Object(_)) if expected == 1 => {
                notes.warn(at, "content-availability-array", "an array", "an object");
                vec![self.availability(one, tiles, &at, notes)]
            }
            Some(other) => {
                notes.error(at, "type", "an array", shown(other));
                none
            }
            None => {
                if expected > 0 {
                    notes.error(at, "required", format!("{expected} availabilities"), "none");
                }
                none
            }
        }
    }

    fn availability(
        &self,
        value: &Value,
        length: u64,
        at: &At<'_>,
        notes: &mut Notes<'_>,
    ) -> Availability {
        let Some(json) = into_object(value.clone(), at, notes) else {
            return Availability::Constant(false);
        };
        let found = match (json.get("bitstream"), json.get("constant")) {
            (Some(view), None) => self.bits(view, length, at, notes),
            (None, Some(constant)) => match constant.as_u64() {
                Some(c @ (0 | 1)) => Some(Availability::Constant(c == 1)),
                _ => {
                    notes.error(
                        at.key("constant"),
                        "availability-constant",
                        "0 or 1",
                        shown(constant),
                    );
                    None
                }
            },
            (a, _) => {
                let found = if a.is_some() { "both" } else { "neither" };
                notes.error(at, "availability", "`bitstream` or `constant`", found);
                None
            }
        };
        let Some(found) = found else {
            return Availability::Constant(false);
        };
        if let Some(stated) = json.get("availableCount") {
            let counted = found.count(length);
            if stated.as_u64() != Some(counted) {
                let at = at.key("availableCount");
                notes.error(at, "available-count", counted.to_string(), shown(stated));
            }
        }
        found
    }

    fn bits(
        &self,
        view: &Value,
        length: u64,
        at: &At<'_>,
        notes: &mut Notes<'_>,
    ) -> Option<Availability> {
        let at = at.key("bitstream");
        let bytes = view.as_u64().and_then(|v| self.views.get(v as usize));
        let Some(bytes) = bytes else {
            let expected = format!("one of {} buffer views", self.views.len());
            notes.error(at, "availability", expected, shown(view));
            return None;
        };
        let needed = length.div_ceil(8);
        if bytes.len() as u64 != needed {
            let found = format!("{} bytes", bytes.len());
            notes.error(
                at,
                "bitstream-length",
                format!("{needed} bytes for {length} bits"),
                found,
            );
            return None;
        }
        let bits = Availability::Bits(bytes.clone());
        if (length..needed * 8).any(|i| bits.get(i)) {
            notes.error(
                at,
                "bitstream-padding",
                "0 in the bits behind the last",
                "1",
            );
        }
        Some(bits)
    }
}
