//! Files of numbered sections, each under its checksum.
//!
//! `KARUISEC`, the version, sections (`u32` each), checksum of what follows up to the first
//! section (`u64`); for each section its bytes and their checksum (`u64` each); the sections.

use super::bytes::Reader;
use super::checksum::checksum;
use super::{Error, Result, Store};

const MAGIC: [u8; 8] = *b"KARUISEC";
const VERSION: u32 = 1;
const PREFIX: u64 = 24;
/// Bytes that say where a section is.
const ENTRY: u64 = 16;

/// Puts sections together.
pub(super) fn to_bytes(sections: &[Vec<u8>]) -> Vec<u8> {
    let entry = |s: &Vec<u8>| [s.len() as u64, checksum(s)];
    let words = sections.iter().flat_map(entry);
    let table: Vec<u8> = words.flat_map(u64::to_le_bytes).collect();
    let mut bytes = MAGIC.to_vec();
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend((sections.len() as u32).to_le_bytes());
    bytes.extend(checksum(&table).to_le_bytes());
    bytes.extend(table);
    sections.iter().for_each(|section| bytes.extend(section));
    bytes
}

/// A file of sections in the store.
pub(super) struct Sections<'a> {
    store: &'a dyn Store,
    name: &'a str,
    /// Start, end and checksum of each.
    table: Vec<(u64, u64, u64)>,
}

impl<'a> Sections<'a> {
    /// Reads the table.
    ///
    /// # Errors
    /// [`Error::Damaged`], those of the store.
    pub fn open(store: &'a dyn Store, name: &'a str) -> Result<Self> {
        let prefix = store.get_range(name, 0..PREFIX)?;
        let mut reader = Reader(&prefix);
        if reader.take(MAGIC.len()) != Some(&MAGIC) || reader.u32() != Some(VERSION) {
            return Err(damaged(
                name,
                "it does not begin with KARUISEC and version 1",
            ));
        }
        let count = u64::from(reader.u32().unwrap_or_default());
        let first = PREFIX + ENTRY * count;
        let bytes = store.get_range(name, PREFIX..first)?;
        if reader.u64() != Some(checksum(&bytes)) {
            return Err(damaged(name, "the checksum of its table is another"));
        }
        let mut at = first;
        let (entries, _) = bytes.as_chunks::<{ ENTRY as usize }>();
        let mut table = Vec::new();
        for entry in entries {
            let mut reader = Reader(entry);
            let [length, sum] = [reader.u64(), reader.u64()].map(Option::unwrap_or_default);
            let start = at;
            at = at.saturating_add(length);
            table.push((start, at, sum));
        }
        Ok(Self { store, name, table })
    }

    /// Reads one section.
    ///
    /// # Errors
    /// [`Error::Damaged`], those of the store.
    pub fn get(&self, section: usize) -> Result<Vec<u8>> {
        let entry = self.table.get(section);
        let &(start, end, sum) =
            entry.ok_or_else(|| damaged(self.name, "it has fewer sections"))?;
        let bytes = self.store.get_range(self.name, start..end)?;
        if checksum(&bytes) == sum {
            return Ok(bytes);
        }
        Err(damaged(self.name, "the checksum of a section is another"))
    }

    /// Reads everything, to see whether it is whole.
    ///
    /// # Errors
    /// As [`Sections::get`].
    pub fn verify(&self) -> Result<()> {
        (0..self.table.len()).try_for_each(|section| self.get(section).map(drop))
    }
}

fn damaged(name: &str, problem: &'static str) -> Error {
    Error::Damaged {
        name: name.into(),
        problem,
    }
}
