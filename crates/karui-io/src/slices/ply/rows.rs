//! Where the rows of a PLY element lie, so that any of them can be read.

use super::super::file::FileAt;
use crate::{
    Place,
    error::{Error, ErrorKind, Result},
    ply::{
        columns::{Body, Table, read_ascii, read_binary},
        header::{Element, Encoding},
    },
    text::{Lines, Words},
    warnings::Warnings,
};
use std::ops::Range;

/// An element of the file and where its rows are.
#[derive(Debug)]
pub(super) struct Rows {
    pub element: Element,
    pub encoding: Encoding,
    pub layout: Layout,
    /// What follows the last row.
    pub end: Mark,
}

#[derive(Debug)]
pub(super) enum Layout {
    /// Every row has the same size.
    Fixed {
        start: u64,
        stride: u64,
        list: Option<KnownList>,
    },
    /// The starts of some rows, the first among them.
    Marked(Vec<Mark>),
}

/// A list that has three values in every row, because else the file would have
/// another size.
#[derive(Debug, Clone, Copy)]
pub(super) struct KnownList {
    /// Offset of the length within a row, bytes.
    pub offset: usize,
    /// Bytes of the length.
    pub size: usize,
}

/// The start of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Mark {
    pub row: u64,
    /// Offset into the file, bytes.
    pub offset: u64,
    /// Lines before it; 0 throughout a binary file.
    pub line: u64,
}

impl Rows {
    /// Number of rows.
    pub fn count(&self) -> u64 {
        self.element.count as u64
    }

    /// Portions that the rows are read in, at most `most` rows each.
    pub fn portions(&self, most: u64) -> u64 {
        match &self.layout {
            Layout::Fixed { .. } => self.count().div_ceil(most),
            Layout::Marked(marks) => marks.len() as u64,
        }
    }

    /// The rows of one portion; none beyond the last.
    pub fn portion(&self, number: u64, most: u64) -> Range<u64> {
        let count = self.count();
        let Layout::Marked(marks) = &self.layout else {
            let start = number.saturating_mul(most).min(count);
            return start..start.saturating_add(most).min(count);
        };
        let row = |i: u64| marks.get(i as usize).map_or(count, |m| m.row);
        row(number)..row(number.saturating_add(1))
    }

    /// Reads some rows and makes something of them. Errors that name a place
    /// in the piece read come back with the place in the file.
    pub fn read<T>(
        &self,
        file: &FileAt,
        rows: Range<u64>,
        make: impl FnOnce(Table) -> Result<T>,
    ) -> Result<T> {
        let (from, end) = self.around(&rows);
        let bytes = file.read(from.offset, end.saturating_sub(from.offset))?;
        let element = Element {
            count: (rows.end - rows.start) as usize,
            ..self.element.clone()
        };
        let skipped = (rows.start - from.row) as usize;
        let table = self.parse(&element, &bytes, skipped);
        table.and_then(make).map_err(|e| shifted(e, from))
    }

    /// The last known start before the rows, and the first after them.
    fn around(&self, rows: &Range<u64>) -> (Mark, u64) {
        match &self.layout {
            Layout::Fixed { start, stride, .. } => {
                let mark = Mark {
                    row: rows.start,
                    offset: start + stride * rows.start,
                    line: 0,
                };
                (mark, start + stride * rows.end)
            }
            Layout::Marked(marks) => {
                let before = marks.partition_point(|m| m.row <= rows.start);
                let after = marks.partition_point(|m| m.row < rows.end);
                let from = before.checked_sub(1).map_or(self.end, |i| marks[i]);
                let end = marks.get(after).map_or(self.end.offset, |m| m.offset);
                (from, end)
            }
        }
    }

    fn parse(&self, element: &Element, bytes: &[u8], skipped: usize) -> Result<Table> {
        if self.encoding == Encoding::Ascii {
            let mut lines = Lines::new(bytes);
            let blank = |line: &[u8]| Words::new(line).rest().is_empty();
            for _ in 0..skipped {
                while lines.next().is_some_and(blank) {}
            }
            // Values too many in a row were told of when the file was opened.
            return read_ascii(element, &mut lines, &mut Warnings::default());
        }
        let mut body = Body {
            bytes,
            at: 0,
            encoding: self.encoding,
        };
        if let Layout::Fixed { stride, list, .. } = &self.layout {
            if let Some(list) = list {
                list.check(bytes, *stride as usize, self.encoding)?;
            }
        } else if skipped > 0 {
            let before = Element {
                count: skipped,
                ..element.clone()
            };
            read_binary(&before, &mut body)?;
        }
        read_binary(element, &mut body)
    }
}

impl KnownList {
    /// Whether the length is three in every row.
    fn check(self, bytes: &[u8], stride: usize, encoding: Encoding) -> Result<()> {
        let low = match encoding {
            Encoding::BigEndian => self.size - 1,
            _ => 0,
        };
        let is_three = |length: &[u8]| {
            let expected = |i: usize| if i == low { 3 } else { 0 };
            length.iter().enumerate().all(|(i, &b)| b == expected(i))
        };
        let length = |row: usize| {
            let at = row * stride + self.offset;
            bytes.get(at..at + self.size).unwrap_or(&[])
        };
        let rows = bytes.len() / stride.max(1);
        match (0..rows).find(|&row| !is_three(length(row))) {
            None => Ok(()),
            Some(row) => {
                let at = row * stride + self.offset;
                let expected = "a list of 3 values, as the size of the file tells for all";
                let found = format!("a length of bytes {:?}", length(row));
                let kind = ErrorKind::syntax(expected, found);
                Err(Error::new(Place::Byte(at as u64), kind))
            }
        }
    }
}

/// The error with its place counted from the start of the file.
fn shifted(mut error: Error, from: Mark) -> Error {
    match &mut error.place {
        Place::Byte(at) => *at += from.offset,
        Place::Line(line) => *line += from.line,
        Place::File | Place::Pointer(_) => {}
    }
    error
}
