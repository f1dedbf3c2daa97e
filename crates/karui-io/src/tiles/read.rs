//! Reading one tileset file.

use super::{
    Tileset,
    findings::{Findings, Notes},
    parse::parse,
    to_json::to_json,
};
use crate::{
    error::{Error, ErrorKind, Place, Result},
    source::load,
};
use std::path::Path;

/// Reads a tileset file. External tilesets and subtrees are not followed;
/// [`locate`](super::locate) tells where they are.
///
/// # Errors
/// [`Io`](ErrorKind::Io) if it cannot be read, [`Syntax`](ErrorKind::Syntax)
/// with a JSON pointer for the first thing in it that is not as it has to be.
pub fn read(path: impl AsRef<Path>) -> Result<Tileset> {
    let path = path.as_ref();
    let text = load(path, &crate::ReadOptions::default())?;
    read_bytes(&text, path)
}

/// [`read`] of a file that lies in memory; `name` is for messages.
///
/// # Errors
/// As [`read`].
pub fn read_bytes(text: &[u8], name: impl AsRef<Path>) -> Result<Tileset> {
    let name = name.as_ref();
    let mut findings = Findings::default();
    let mut notes = Notes {
        file: name,
        findings: &mut findings,
    };
    let tileset = parse(text, &mut notes).map_err(|e| e.in_file(name))?;
    match findings.errors.into_iter().next() {
        None => Ok(tileset),
        Some(first) => {
            let kind = ErrorKind::syntax(first.expected, first.found);
            Err(Error::new(Place::Pointer(first.place), kind).in_file(name))
        }
    }
}

impl Tileset {
    /// The text of a tileset file. What [`read_bytes`] makes of it is equal.
    #[must_use]
    pub fn to_json(&self) -> Vec<u8> {
        to_json(self)
    }
}
